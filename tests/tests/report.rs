//! The demonstration's report in a real browser: it runs without a complaint, asks for nothing, every
//! picture shows something, its text can be read and nothing is cut off, on a phone and on a desktop.

mod report {
    mod checks;
    mod scene;
}

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use canter_tests::browser::View;
use canter_tests::process::Process;
use tempfile::TempDir;

/// A report as the demonstration writes it.
static REPORT: LazyLock<(TempDir, PathBuf)> = LazyLock::new(|| {
    let directory = tempfile::tempdir().expect("a directory");
    let report = demo(&[], &directory.path().join("demo"));
    (directory, report)
});

/// Runs the demonstration, and where its report is.
fn demo(arguments: &[&str], out: &Path) -> PathBuf {
    let mut demo = Command::new(canter_tests::canter());
    demo.env_remove("CANTER_CAN").args(arguments);
    demo.args(["demo", "--out"]).arg(out);
    Process::spawn(&mut demo).finish().success();
    out.join("report.html")
}

const PHONE: View = View {
    width: 390,
    height: 844,
    dark: false,
    still: false,
    scripts: true,
};

const DESKTOP: View = View {
    width: 1280,
    height: 900,
    ..PHONE
};
