//! The images that tests/run has built for the device.

pub mod elf;

use std::path::PathBuf;

use canter_tests::root;

/// The image called `name`, in profile `firmware`.
///
/// # Panics
/// When it has not been built: a missing image is a failed test, not a skipped one.
pub fn path(name: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let path = root()
        .join(target)
        .join("thumbv7em-none-eabihf/firmware")
        .join(name);
    let built = path.is_file();
    assert!(
        built,
        "{} is missing: build it with tests/run",
        path.display()
    );
    path
}
