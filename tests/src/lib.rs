//! What canter's end-to-end tests share.
//!
//! | module | what it holds |
//! |---|---|
//! | [`browser`] | a real browser without a window |
//! | [`process`] | a program under test: its lines as they come, its end, killed when dropped |
//! | [`candump`] | what was on a CAN bus, as seen by can-utils rather than by canter |
//! | [`trace`] | what a node's setpoints were, and what must hold for them |
//! | [`tidy`] | the rules of the house, as checks on the sources |
//!
//! Nothing here sleeps to wait for an event: each wait is for a line, a frame or an exit, and ends
//! with it. [`PATIENCE`] only bounds the wait of a test that has already failed.
#![forbid(unsafe_code)]

pub mod browser;
pub mod candump;
pub mod process;
pub mod tidy;
pub mod trace;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long a test waits for something that always comes. Generous, for a busy machine that
/// emulates another: no test passes or fails by it.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// The root of the repository.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The built `canter`: the one that CANTER_BIN names, else the one of the running test's profile.
///
/// # Panics
/// When it has not been built.
pub fn canter() -> PathBuf {
    let path = std::env::var_os("CANTER_BIN").map_or_else(
        || {
            // A test runs as target/PROFILE/deps/NAME-HASH, canter is target/PROFILE/canter.
            let test = std::env::current_exe().expect("a running program has a path");
            let profile = test.parent().and_then(Path::parent);
            profile.expect("cargo puts tests in deps/").join("canter")
        },
        PathBuf::from,
    );
    let built = path.is_file();
    assert!(
        built,
        "{} is missing: cargo build -p canter",
        path.display()
    );
    path
}

/// Prints a measurement, and keeps it for the table at the end of tests/run.
///
/// `part` is the part of tests/run, `value` a number with its unit, and `bound` what the test holds
/// it to (`-` for none).
///
/// # Panics
/// When the file that CANTER_MEASUREMENTS names cannot be written.
pub fn measurement(part: &str, what: &str, value: &str, bound: &str) {
    let fields = [part, what, value, bound];
    let [part, what, value, bound] = fields.map(|field| field.replace(['\t', '\n'], " "));
    println!("{part}: {what}: {value} ({bound})");
    if let Some(path) = std::env::var_os("CANTER_MEASUREMENTS") {
        // One write, so that tests that run side by side do not mix their lines.
        let line = format!("{part}\t{what}\t{value}\t{bound}\n");
        std::fs::File::options()
            .append(true)
            .create(true)
            .open(path)
            .and_then(|mut file| file.write_all(line.as_bytes()))
            .expect("the file that CANTER_MEASUREMENTS names can be appended to");
    }
}
