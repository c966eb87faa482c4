//! Compiles `ruckig.cpp` with the headers that the crate `ruckig` carries; its C++ itself is built
//! by that crate, and linked from there.

use std::path::PathBuf;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=src/ruckig.cpp");
    cc::Build::new()
        .cpp(true)
        .std("c++20")
        .define("NDEBUG", None)
        .include(ruckig().join("include"))
        .file("src/ruckig.cpp")
        .compile("canter_bench_ruckig");
}

/// The folder of the crate `ruckig`, as cargo has it.
fn ruckig() -> PathBuf {
    let cargo = std::env::var_os("CARGO").expect("cargo says where it is");
    let host = std::env::var("HOST").expect("cargo names the host");
    let output = Command::new(cargo)
        .args(["metadata", "--format-version=1", "--offline", "--locked"])
        .args(["--filter-platform", &host])
        .output()
        .expect("cargo runs");
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo metadata: {words}");
    let metadata: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("cargo prints JSON");
    let packages = metadata["packages"].as_array().expect("a list of packages");
    let manifest = packages
        .iter()
        .find(|package| package["name"] == "ruckig")
        .and_then(|package| package["manifest_path"].as_str())
        .expect("ruckig is a dependency, with a manifest");
    let manifest = PathBuf::from(manifest);
    manifest.parent().expect("a file is in a folder").into()
}
