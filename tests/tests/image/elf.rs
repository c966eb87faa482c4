//! Where an image's functions and variables are.

use std::fs;
use std::path::Path;

use object::read::elf::{FileHeader, Sym};
use object::{Endianness, elf};

/// The symbols of an image that stand for places in its memory.
pub struct Symbols(Vec<(String, u32)>);

impl Symbols {
    /// Reads those of the image in `path`.
    pub fn read(path: &Path) -> Self {
        let broken = "an image is a 32-bit ELF file";
        let file = fs::read(path).expect("the image can be read");
        let header = elf::FileHeader32::<Endianness>::parse(&*file).expect(broken);
        let endian = header.endian().expect(broken);
        let sections = header.sections(endian, &*file).expect(broken);
        let table = sections.symbols(endian, &*file, elf::SHT_SYMTAB);
        let table = table.expect(broken);
        let named = table.iter().filter_map(|symbol| {
            let name = symbol.name(endian, table.strings()).ok()?;
            // A function's lowest bit only says that its code is Thumb.
            let thumb = u32::from(symbol.st_type() == elf::STT_FUNC);
            Some((
                String::from_utf8_lossy(name).into_owned(),
                symbol.st_value(endian) & !thumb,
            ))
        });
        Self(named.collect())
    }

    /// The address of the only symbol whose name ends with `end`, a hash that the compiler adds aside.
    ///
    /// # Panics
    /// When there is none, or more than one.
    #[track_caller]
    pub fn address(&self, end: &str) -> u32 {
        let named: Vec<_> = self.0.iter().filter(|(name, _)| is(name, end)).collect();
        match named[..] {
            [(_, address)] => *address,
            _ => panic!("one symbol should be called {end}: {named:x?}"),
        }
    }
}

/// Whether a symbol, mangled or not, is called so.
fn is(symbol: &str, end: &str) -> bool {
    // The older mangling ends with "17h", a hash of 16 digits and "E".
    let path = symbol
        .strip_suffix('E')
        .and_then(|name| name.len().checked_sub(19).and_then(|at| name.get(..at)));
    symbol.ends_with(end) || path.is_some_and(|path| path.ends_with(end))
}
