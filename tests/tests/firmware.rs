//! What the boards' images take of their chips.
//!
//! The numbers are kept in tests/snapshots/firmware-sizes.txt, so that a change that makes an
//! image grow shows it. CANTER_UPDATE_SNAPSHOTS=1 writes the file anew.

mod firmware {
    mod frame;
    mod stack;
}
mod image;

use std::fs;

use canter_tests::{measurement, root};
use object::read::elf::{FileHeader, ProgramHeader};
use object::{Endianness, elf};

const SNAPSHOT: &str = "tests/snapshots/firmware-sizes.txt";

/// Where the chip's RAM begins; what lies below is flash.
const RAM: u32 = 0x2000_0000;

/// So that small chips stay within reach.
const FLASH_BOUND: u32 = 100 * 1024;
const RAM_BOUND: u32 = 24 * 1024;

const IMAGES: [&str; 3] = ["nucleo-g474re", "nucleo-f446re", "nucleo-h743zi2"];

/// How far flash may be from the snapshot: alignment, and what a builder's own paths could still change. RAM
/// must match.
const FLASH_TOLERANCE: u32 = 256;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sizes {
    /// Code, constants and the initial values of variables.
    flash: u32,
    /// Variables, tasks included; not the stack, which has the rest.
    ram: u32,
}

impl Sizes {
    fn of(file: &[u8]) -> Self {
        let broken = "an image is a 32-bit ELF file";
        let header = elf::FileHeader32::<Endianness>::parse(file).expect(broken);
        let endian = header.endian().expect(broken);
        let segments = header.program_headers(endian, file).expect(broken);
        let mut sizes = Self { flash: 0, ram: 0 };
        for segment in segments {
            if segment.p_type(endian) == elf::PT_LOAD {
                sizes.flash += segment.p_filesz(endian);
                if segment.p_vaddr(endian) >= RAM {
                    sizes.ram += segment.p_memsz(endian);
                }
            }
        }
        sizes
    }

    /// What the snapshot says of an image.
    fn kept(snapshot: &str, image: &str) -> Option<Self> {
        let mut lines = snapshot.lines().map(str::split_whitespace);
        let mut line = lines.find_map(|mut line| (line.next() == Some(image)).then_some(line))?;
        let mut value = |name| line.next()?.strip_prefix(name)?.parse().ok();
        Some(Self {
            flash: value("flash=")?,
            ram: value("ram=")?,
        })
    }
}

#[test]
fn the_images_keep_their_sizes() {
    let measured = IMAGES.map(|image| {
        let file = fs::read(image::path(image)).expect("the image can be read");
        let sizes = Sizes::of(&file);
        for (what, size, bound) in [
            ("flash", sizes.flash, FLASH_BOUND),
            ("static RAM", sizes.ram, RAM_BOUND),
        ] {
            measurement(
                "firmware",
                &format!("{image} {what}"),
                &format!("{size} B"),
                &format!("<= {bound} B"),
            );
            assert!(size <= bound, "{image} {what}: {size} B are over {bound} B");
        }
        (image, sizes)
    });

    let snapshot = root().join(SNAPSHOT);
    if std::env::var_os("CANTER_UPDATE_SNAPSHOTS").is_some() {
        let lines = measured
            .map(|(image, Sizes { flash, ram })| format!("{image} flash={flash} ram={ram}\n"));
        fs::write(&snapshot, lines.concat()).expect("the snapshot can be written");
        return;
    }
    let snapshot = fs::read_to_string(&snapshot).unwrap_or_default();
    for (image, sizes) in measured {
        let kept = Sizes::kept(&snapshot, image);
        let same = kept.is_some_and(|kept| {
            kept.flash.abs_diff(sizes.flash) <= FLASH_TOLERANCE && kept.ram == sizes.ram
        });
        assert!(
            same,
            "{image} takes {sizes:?}, {SNAPSHOT} says {kept:?}: where that is meant, run this again \
             with CANTER_UPDATE_SNAPSHOTS=1 and commit the file"
        );
    }
}
