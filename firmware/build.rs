//! Writes the chip's memory map for the root's memory.x, and the linker's arguments.

use std::{env, error::Error, fs, path::PathBuf};

/// The boards: feature, and the memory of the chip. Of its RAM the stack has the beginning, see [`STACK`].
const BOARDS: [(&str, &str); 4] = [
    // Half of the 512 KiB of flash: the processor can read one bank while the other is erased, so the
    // image is in the first and the parameters are in the second. RAM is SRAM1 and SRAM2; the CCM
    // behind them is left alone.
    (
        "NUCLEO_G474RE",
        "MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 256K
  STACK : ORIGIN = 0x20000000, LENGTH = 64K
  RAM   : ORIGIN = 0x20010000, LENGTH = 32K
}
",
    ),
    // The parameters are in the second and the third sector, which are 16 KiB each and so the quickest
    // to erase. The vector table is in the first one, and the code begins behind them: 3 x 16 KiB.
    (
        "NUCLEO_F446RE",
        "MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 512K
  STACK : ORIGIN = 0x20000000, LENGTH = 96K
  RAM   : ORIGIN = 0x20018000, LENGTH = 32K
}
_stext = ORIGIN(FLASH) + 48K;
",
    ),
    // The first of two banks; the parameters are at the end of the second. RAM is the processor's own
    // (DTCM), which no cache stands before.
    (
        "NUCLEO_H743ZI2",
        "MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 1024K
  STACK : ORIGIN = 0x20000000, LENGTH = 96K
  RAM   : ORIGIN = 0x20018000, LENGTH = 32K
}
",
    ),
    // What QEMU's netduinoplus2 machine has.
    (
        "EMULATED",
        "MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 1024K
  STACK : ORIGIN = 0x20000000, LENGTH = 64K
  RAM   : ORIGIN = 0x20010000, LENGTH = 64K
}
",
    ),
];

/// One that grows too large runs out of RAM, and not into the variables: see src/crash.rs.
const STACK: &str = "_stack_end = ORIGIN(STACK);
_stack_start = ORIGIN(STACK) + LENGTH(STACK);
ASSERT(_stack_start == ORIGIN(RAM), \"RAM must begin where the stack ends\");
";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    let has = |feature: &str| env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    // With none or several the crate's root says what is wrong.
    let memory = BOARDS.into_iter().find(|(feature, _)| has(feature));
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);
    fs::write(
        out.join("chip.x"),
        memory.map_or(String::new(), |(_, memory)| memory.to_owned() + STACK),
    )?;
    println!("cargo:rustc-link-search={}", out.display());

    // Without --nmagic the linker aligns sections to pages of 64 KiB, which no flash here has.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if has("STM32") {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
    Ok(())
}
