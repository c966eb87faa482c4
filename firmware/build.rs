//! Writes the chip's memory map for the root's memory.x, and the linker's arguments.

use std::{env, error::Error, fs, path::PathBuf};

/// Half of the 512 KiB of flash: the processor can read one bank while the other is erased, so the
/// image is in the first and the parameters are in the second. RAM is SRAM1 and SRAM2; the CCM behind
/// them is left alone.
const STM32G474RE: &str = "MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 256K
  RAM   : ORIGIN = 0x20000000, LENGTH = 96K
}
";

/// What QEMU's netduinoplus2 machine has: 1 MiB of flash, 128 KiB of RAM.
const STM32F405RG: &str = "MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 1024K
  RAM   : ORIGIN = 0x20000000, LENGTH = 128K
}
";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    let nucleo = env::var_os("CARGO_FEATURE_NUCLEO_G474RE").is_some();
    let chip = if nucleo { STM32G474RE } else { STM32F405RG };
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);
    fs::write(out.join("chip.x"), chip)?;
    println!("cargo:rustc-link-search={}", out.display());

    // Without --nmagic the linker aligns sections to pages of 64 KiB, which no flash here has.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if nucleo {
        println!("cargo:rustc-link-arg-bin=nucleo-g474re=-Tdefmt.x");
    }
    Ok(())
}
