//! What each function of an image takes of the stack, read from its instructions (ARMv7-M Architecture
//! Reference Manual, A7.7): debugging information does not tell, it counts from a frame pointer.

use object::read::elf::{FileHeader, SectionHeader, Sym};
use object::{Endianness, elf};

/// A function, and what it takes of the stack at most.
#[derive(Debug)]
pub struct Frame {
    pub function: String,
    pub bytes: u32,
}

/// The function of an image that takes most.
pub fn largest(file: &[u8]) -> Frame {
    let broken = "an image is a 32-bit ELF file";
    let header = elf::FileHeader32::<Endianness>::parse(file).expect(broken);
    let endian = header.endian().expect(broken);
    let sections = header.sections(endian, file).expect(broken);
    let symbols = sections.symbols(endian, file, elf::SHT_SYMTAB);
    let symbols = symbols.expect(broken);
    // Where code begins, and where constants between it do.
    let mut kinds = Vec::new();
    let mut functions = Vec::new();
    for symbol in symbols.iter() {
        let name = symbol.name(endian, symbols.strings()).expect(broken);
        let (address, size) = (symbol.st_value(endian), symbol.st_size(endian));
        match name {
            [b'$', kind @ (b't' | b'd'), ..] => kinds.push((address, *kind == b't')),
            _ if symbol.st_type() == elf::STT_FUNC => functions.push((name, address & !1, size)),
            _ => {}
        }
    }
    kinds.sort_unstable();
    let is_code = |address: u32| {
        let after = kinds.partition_point(|(begin, _)| *begin <= address);
        after > 0 && kinds[after - 1].1
    };
    let frames = functions.into_iter().map(|(name, begin, size)| {
        let section = sections.iter().find(|section| {
            let from = section.sh_addr(endian);
            let inside = from..from + section.sh_size(endian);
            section.sh_type(endian) == elf::SHT_PROGBITS && inside.contains(&begin)
        });
        let section = section.expect("a function is in a section");
        let code = section.data(endian, file).expect(broken);
        let at = (begin - section.sh_addr(endian)) as usize;
        let code = &code[at..at + size as usize];
        let function = String::from_utf8_lossy(name).into_owned();
        let bytes = growth(code, |offset| is_code(begin + offset as u32))
            .unwrap_or_else(|| panic!("{function} takes as much of the stack as it likes"));
        Frame { function, bytes }
    });
    let largest = frames.max_by_key(|frame| frame.bytes);
    largest.expect("an image has functions")
}

/// The sum of all that a function's instructions take of the stack, whichever way it goes through them;
/// `None` where one takes what no constant says.
fn growth(code: &[u8], is_code: impl Fn(usize) -> bool) -> Option<u32> {
    let half = |offset: usize| {
        let bytes = code.get(offset..offset + 2)?;
        Some(u16::from_le_bytes([bytes[0], bytes[1]]))
    };
    let (mut offset, mut sum) = (0, 0);
    while let Some(first) = half(offset) {
        if !is_code(offset) {
            offset += 2;
            continue;
        }
        let is_wide = first >> 11 >= 0b11101;
        let second = if is_wide { half(offset + 2)? } else { 0 };
        sum += step(first, second)?;
        offset += if is_wide { 4 } else { 2 };
    }
    Some(sum)
}

/// What one instruction takes; `None` where no constant says it.
fn step(first: u16, second: u16) -> Option<u32> {
    let to_stack_pointer = second & 0x0F00 == 0x0D00;
    let low = u32::from(second & 0xFF);
    Some(match first {
        // SUB SP, SP, #imm7 * 4
        0xB080..=0xB0FF => u32::from(first & 0x7F) * 4,
        // PUSH
        0xB400..=0xB5FF => (first & 0x1FF).count_ones() * 4,
        0xE92D => second.count_ones() * 4,
        // VPUSH
        0xED2D | 0xED6D => low * 4,
        // STR Rt, [SP, #-imm8]!
        0xF84D if to_stack_pointer => low,
        // STRD Rt, Rt2, [SP, #-imm8 * 4]!
        0xE96D => low * 4,
        // SUB SP, SP, #const: a byte that is repeated or shifted
        0xF1AD | 0xF5AD if to_stack_pointer => expand(constant(first, second))?,
        // SUBW SP, SP, #imm12
        0xF2AD | 0xF6AD if to_stack_pointer => constant(first, second),
        // SUB SP, SP, Rm
        0xEBAD if to_stack_pointer => return None,
        _ => 0,
    })
}

/// The twelve bits of a constant, as an instruction scatters them.
fn constant(first: u16, second: u16) -> u32 {
    let [first, second] = [first, second].map(u32::from);
    (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | (second & 0xFF)
}

/// What twelve bits stand for; the patterns with several bytes are too large for any stack.
fn expand(constant: u32) -> Option<u32> {
    match constant >> 8 {
        0 => Some(constant),
        1..=3 => None,
        _ => Some((0x80 | constant & 0x7F).rotate_right(constant >> 7)),
    }
}

/// As an assembler encodes them.
#[test]
fn what_an_instruction_takes_is_read_from_it() {
    for (name, first, second, bytes) in [
        ("push {r7, lr}", 0xB580, 0, Some(8)),
        ("push.w {r8, r9, r10, r11}", 0xE92D, 0x0F00, Some(16)),
        ("vpush {d8, d9}", 0xED2D, 0x8B04, Some(16)),
        ("sub sp, #0x10", 0xB084, 0, Some(16)),
        ("sub.w sp, sp, #0x380", 0xF5AD, 0x7D60, Some(0x380)),
        ("sub.w sp, sp, #0x1380", 0xF5AD, 0x5D9C, Some(0x1380)),
        ("subw sp, sp, #0x7fc", 0xF2AD, 0x7DFC, Some(0x7FC)),
        ("str lr, [sp, #-8]!", 0xF84D, 0xED08, Some(8)),
        ("sub.w sp, sp, r4", 0xEBAD, 0x0D04, None),
        ("add sp, #0x10", 0xB004, 0, Some(0)),
        ("ldr r0, [r1]", 0x6808, 0, Some(0)),
    ] {
        assert_eq!(step(first, second), bytes, "{name}");
    }
}
