//! The house keeps its own rules, and each rule is shown to bite.

use std::path::Path;
use std::process::Command;

use canter_tests::root;
use canter_tests::tidy::{ARROWS, Finding, Source, crate_arrows, no_machine_paths};

/// The files under `folder` (from the repository's root) with their text, build products and
/// binary files aside.
fn files(folder: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let entries = std::fs::read_dir(root().join(folder));
    for entry in entries.unwrap_or_else(|error| panic!("{folder}: {error}")) {
        let entry = entry.expect("a folder of the repository can be read");
        let name = entry.file_name().into_string().expect("names are UTF-8");
        let path = if folder.is_empty() {
            name.clone()
        } else {
            format!("{folder}/{name}")
        };
        let kind = entry
            .file_type()
            .expect("a folder of the repository can be read");
        if kind.is_dir() {
            if name != ".git" && name != "target" {
                found.extend(files(&path));
            }
        } else if kind.is_file()
            && name != ".git"
            && let Ok(text) = std::fs::read_to_string(entry.path())
        {
            found.push((path, text));
        }
    }
    found.sort();
    found
}

fn sources(folder: &str) -> Vec<Source> {
    let files = files(folder)
        .into_iter()
        .filter(|(path, _)| path.ends_with(".rs"));
    let sources: Vec<_> = files
        .map(|(path, text)| Source::new(&path, &text))
        .collect();
    assert!(!sources.is_empty(), "{folder} has no sources");
    sources
}

#[track_caller]
fn none(findings: impl IntoIterator<Item = Finding>) {
    let findings: Vec<_> = findings
        .into_iter()
        .map(|finding| finding.to_string())
        .collect();
    assert!(findings.is_empty(), "\n{}\n", findings.join("\n"));
}

/// What each finding says, shortened to its line and rule.
fn told(findings: &[Finding]) -> Vec<(usize, &str)> {
    findings
        .iter()
        .map(|finding| (finding.line, &*finding.rule))
        .collect()
}

#[test]
fn the_modules_of_shared_use_each_other_one_way() {
    none(sources("shared/src").iter().flat_map(Source::arrows));
    for (module, _) in ARROWS {
        let place = root().join("shared/src").join(module);
        let exists = place.is_dir() || place.with_extension("rs").is_file();
        assert!(
            exists,
            "the arrows name `{module}`, which shared/src has not"
        );
    }
}

#[test]
fn motion_never_sees_wire() {
    let motion = sources("shared/src").into_iter().filter(Source::is_motion);
    none(motion.flat_map(|source| source.never_mentions("wire")));
}

#[test]
fn the_device_cannot_panic_by_name() {
    let sources = sources("shared/src");
    let for_tests: Vec<_> = sources.iter().flat_map(Source::test_modules).collect();
    let product = sources.iter().filter(|source| !source.is_in(&for_tests));
    none(product.flat_map(Source::no_panics));
}

#[test]
fn shared_needs_no_std_and_no_unsafe_code() {
    let file = "shared/src/lib.rs";
    let text = std::fs::read_to_string(root().join(file)).expect("shared has a root");
    let source = Source::new(file, &text);
    none(source.has_attribute(
        "no_std",
        "the device has no std: take what is needed from core",
    ));
    none(source.has_attribute(
        "forbid(unsafe_code)",
        "keep unsafe code in firmware, where hardware asks",
    ));
}

#[test]
fn a_file_can_be_read_in_one_sitting() {
    none(sources("").iter().flat_map(Source::short));
}

#[test]
fn no_file_names_a_path_of_one_machine() {
    none(
        files("")
            .iter()
            .flat_map(|(file, text)| no_machine_paths(file, text)),
    );
}

#[test]
fn the_crates_use_each_other_one_way() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = root().join("Cargo.toml");
    let arguments = [
        "metadata",
        "--no-deps",
        "--offline",
        "--format-version=1",
        "--manifest-path",
    ];
    let output = Command::new(cargo)
        .args(arguments)
        .arg(manifest)
        .output()
        .expect("cargo runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata = serde_json::from_slice(&output.stdout).expect("cargo prints JSON");
    none(crate_arrows(&metadata));
}

/// The command that readers are told, that CI calls and that the hook calls is one.
#[test]
fn there_is_one_command_that_tests_everything() {
    let read = |file: &str| {
        let text = std::fs::read_to_string(root().join(file));
        text.unwrap_or_else(|error| panic!("{file}: {error}"))
    };
    let readme = read("README.md");
    let has = |text: &str, wanted: &str| text.lines().any(|line| line.trim() == wanted);
    let told = command_under_tests(&readme);
    assert_eq!(
        told,
        Some("tests/run"),
        "README.md, first code line under its heading on tests"
    );
    assert!(
        has(&read(".ci/run"), "exec tests/run"),
        ".ci/run does not call tests/run"
    );
    let workflow = ".github/workflows/ci.yml";
    assert!(
        has(&read(workflow), "- run: tests/run"),
        "{workflow} does not call tests/run"
    );
    assert!(root().join("tests/run").is_file(), "tests/run is missing");
}

/// The first line of the first code block under the heading that speaks of tests.
fn command_under_tests(markdown: &str) -> Option<&str> {
    let mut lines = markdown.lines();
    lines.find(|line| line.starts_with('#') && line.to_lowercase().contains("test"))?;
    lines
        .find(|line| line.starts_with("```") || line.starts_with('#'))?
        .strip_prefix("```")?;
    lines.next().map(str::trim)
}

#[test]
fn the_command_is_found_in_a_readme() {
    let block = "# canter\n```sh\ncargo run\n```\n## Testing\nWords.\n\n```sh\ntests/run\n```\n";
    assert_eq!(command_under_tests(block), Some("tests/run"));
    assert_eq!(command_under_tests("# canter\n```\ntests/run\n```\n"), None);
    assert_eq!(
        command_under_tests("## Tests\nWords.\n## More\n```\ntests/run\n```\n"),
        None
    );
}

// From here on: each rule fails on a small bad example, and on nothing else.

#[test]
fn an_arrow_the_wrong_way_is_found_in_every_form_of_path() {
    let wrong = |text: &str| {
        let findings = Source::new("shared/src/motion/beta.rs", text).arrows();
        findings
            .iter()
            .map(|finding| (finding.line, finding.rule.clone()))
            .collect::<Vec<_>>()
    };
    for bad in [
        "use crate::wire::Frame;",
        "use crate::{units::Position, wire::{self, Frame}};",
        "use crate::{\nunits::Position,\nwire::Frame};",
        "use super::super::wire;",
        "use super::{super::{wire as w}, profile};",
        "use canter_shared::wire;",
        "mod inner { use super::super::super::wire::Frame; }",
        "fn f() { let x = crate::wire::Frame::new(); }",
        "fn f(x: &[crate::wire::Frame]) {}",
        "pub(in crate::wire) fn f() {}",
        "macro_rules! m { () => { $crate::wire::Frame } }",
        "fn f() { m!(a, [crate::wire::A]); }",
        "#[cfg(test)] mod tests { use crate::wire; }",
    ] {
        let line = bad
            .lines()
            .position(|line| line.contains("wire"))
            .map(|index| index + 1);
        let findings = wrong(bad);
        assert_eq!(findings.len(), 1, "{bad}: {findings:?}");
        assert_eq!(Some(findings[0].0), line, "{bad}");
        assert_eq!(findings[0].1, "`motion` must not use `wire`", "{bad}");
    }
    for hidden in [
        "use crate::*;",
        "use crate as c;",
        "use crate::{self as c};",
        "use super::super::*;",
    ] {
        assert_eq!(
            wrong(hidden)[0].1,
            "`motion` uses `*` of the crate's root, which hides its module"
        );
    }
    let unknown = wrong("use crate::Frame;");
    assert_eq!(
        unknown[0].1,
        "`motion` uses `Frame` of the crate's root, which hides its module"
    );
    for good in [
        "use crate::{units::Position, limits::{self, Limits}, motion::stop};",
        "use super::{stop, retarget::*};",
        "use super::*;",
        "//! Sent by [`crate::wire`].\n/// See [`super::super::wire`].\nfn f() {}",
        "// crate::wire::Frame\npub(crate) fn f(&self) -> u8 { self as u8 }",
        "fn f() { \"crate::wire\"; wire(); a::wire::b(); self.x; core::mem::swap(); }",
        "mod tests { use super::*; use super::super::stop; }",
    ] {
        assert_eq!(wrong(good), [], "{good}");
    }
}

#[test]
fn a_module_without_a_place_is_found_and_the_root_is_free() {
    let new = Source::new("shared/src/extra/mod.rs", "").arrows();
    assert_eq!(
        told(&new),
        [(
            1,
            "the module `extra` has no place in the order of the modules"
        )]
    );
    let root = Source::new(
        "shared/src/lib.rs",
        "pub use crate::wire::Frame; pub use units::*;",
    );
    assert_eq!(root.arrows(), []);
    let message = new[0].to_string();
    assert!(
        message.starts_with("shared/src/extra/mod.rs:1: "),
        "{message}"
    );
    assert!(message.contains("; give it one in ARROWS"), "{message}");
}

#[test]
fn a_word_in_the_code_is_a_mention_and_in_a_comment_is_not() {
    let text = "// wire\n/// wire\nfn f() { \"wire\"; m!(wire); }\nfn wires() {}";
    let source = Source::new("shared/src/motion/stop.rs", text);
    assert_eq!(
        told(&source.never_mentions("wire")),
        [(3, "`wire` must not appear here")]
    );
    assert!(source.is_motion() && Source::new("shared/src/motion.rs", "").is_motion());
    assert!(!Source::new("shared/src/axis/motion.rs", "").is_motion());
}

#[test]
fn a_panic_is_found_unless_it_is_in_a_test_or_a_constant() {
    let found = |text: &str| {
        let findings = Source::new("shared/src/axis/state.rs", text).no_panics();
        findings
            .iter()
            .map(|finding| finding.line)
            .collect::<Vec<_>>()
    };
    for bad in [
        "fn f() { x.unwrap(); }",
        "fn f() { x\n.expect(\"y\"); }",
        "fn f() { core::panic!(); }",
        "fn f() { match x { _ => unreachable!(\"z\") } }",
        "fn f() { m!({ todo!() }) }",
        "macro_rules! m { () => { unimplemented!() } }",
        "#[cfg(not(test))] fn f() { x.unwrap() }",
        "#[cfg(test)] use a; fn f() { x.unwrap() }",
        "#[cfg(test)] mod tests { } fn f() { x.unwrap() }",
        "fn f<const N: usize>() { x.unwrap() } const A: u8 = 1;",
        "const fn f() { x.unwrap() }",
    ] {
        assert_eq!(found(bad), [bad.lines().count()], "{bad}");
    }
    for good in [
        "fn f() { x.unwrap_or(1).unwrap_or_default(); panic != 3; expect(1); }",
        "/// `x.unwrap()`\n#[expect(dead_code)] fn f() { \"panic!()\"; }",
        "#[cfg(test)] mod tests { fn f() { x.unwrap() } }",
        "#[cfg(test)]\n#[allow(dead_code)]\npub(crate) fn f(x: u8) -> u8 { x.unwrap() }",
        "#[cfg(all(test, feature = \"a\"))] mod tests { fn f() { x.unwrap() } }",
        "#![cfg(test)]\nfn f() { x.unwrap() }",
        "const A: u8 = match b { Some(b) => b, None => panic!(\"c\") };",
        "fn f() -> u8 { const { a.unwrap() } }",
    ] {
        assert_eq!(found(good), [0; 0], "{good}");
    }
}

#[test]
fn a_file_for_tests_only_is_known_by_its_declaration() {
    let text = "mod product; #[cfg(test)] #[rustfmt::skip] mod tests; #[cfg(test)] mod here {}";
    let beside = Source::new("shared/src/wire/slcan.rs", text).test_modules();
    assert_eq!(beside, ["shared/src/wire/slcan/tests"]);
    let within = Source::new("shared/src/wire/mod.rs", text).test_modules();
    assert_eq!(within, ["shared/src/wire/tests"]);
    for (file, is_test) in [
        ("shared/src/wire/tests.rs", true),
        ("shared/src/wire/tests/mod.rs", true),
        ("shared/src/wire/tests/more.rs", true),
        ("shared/src/wire/tests_of.rs", false),
        ("shared/src/wire.rs", false),
    ] {
        assert_eq!(Source::new(file, "").is_in(&within), is_test, "{file}");
    }
}

#[test]
fn a_missing_attribute_and_a_long_file_are_found() {
    let source = Source::new(
        "shared/src/lib.rs",
        &"#![forbid( unsafe_code )]\n".repeat(601),
    );
    assert_eq!(source.has_attribute("forbid(unsafe_code)", "cure"), []);
    let missing = source.has_attribute("no_std", "cure");
    assert_eq!(told(&missing), [(1, "`#![no_std]` is missing")]);
    let outer = Source::new("shared/src/lib.rs", "// #![no_std]\n#[no_std] fn f() {}");
    assert_eq!(outer.has_attribute("no_std", "cure").len(), 1);
    assert_eq!(
        told(&source.short()),
        [(601, "601 lines, where 600 are the most")]
    );
    assert_eq!(Source::new("a.rs", &"\n".repeat(600)).short(), []);
}

#[test]
fn a_machine_path_is_found_and_a_path_that_contains_its_name_is_not() {
    // Joined at run time, so that this file keeps the rule.
    let with = |before: &str, name: &str| format!("first\n{before}/{name}/x");
    for (before, name) in [
        ("", "home"),
        ("see ", "root"),
        ("\"", "work"),
        ("A=", "Users"),
        ("`", "home"),
    ] {
        let text = with(before, name);
        let findings = no_machine_paths("docs/a.md", &text);
        assert_eq!(findings.len(), 1, "{text}");
        assert_eq!(
            (&*findings[0].file, findings[0].line),
            ("docs/a.md", 2),
            "{text}"
        );
    }
    for (before, name) in [
        ("docs", "work"),
        ("~", "work"),
        ("$HOME", "work"),
        ("", "homes"),
        (".", "root"),
    ] {
        let text = with(before, name);
        assert_eq!(no_machine_paths("docs/a.md", &text), [], "{text}");
    }
}

#[test]
fn a_crate_that_depends_upwards_is_found() {
    let package = |name: &str, uses: &[&str]| {
        let uses: Vec<_> = uses
            .iter()
            .map(|name| serde_json::json!({ "name": name }))
            .collect();
        let manifest = Path::new(name).join("Cargo.toml");
        serde_json::json!({ "name": name, "manifest_path": manifest, "dependencies": uses })
    };
    let rules = |packages: &[serde_json::Value]| {
        let findings = crate_arrows(&serde_json::json!({ "packages": packages }));
        findings
            .into_iter()
            .map(|finding| finding.rule)
            .collect::<Vec<_>>()
    };
    let shared = package("canter-shared", &["libm"]);
    let host = package("canter", &["canter-shared", "clap"]);
    let firmware = package("canter-firmware", &["canter-shared"]);
    assert_eq!(
        rules(&[shared.clone(), host.clone(), firmware.clone()]),
        [""; 0]
    );
    let bad = package("canter-firmware", &["canter"]);
    assert_eq!(
        rules(&[host.clone(), bad]),
        ["`canter-firmware` must not depend on `canter`"]
    );
    let bad = package("canter", &["canter-firmware"]);
    assert_eq!(
        rules(&[bad, firmware]),
        ["`canter` must not depend on `canter-firmware`"]
    );
    let bad = package("canter-shared", &["canter"]);
    assert_eq!(
        rules(&[bad, host]),
        ["`canter-shared` must not depend on `canter`"]
    );
    let new = package("extra", &[]);
    assert_eq!(
        rules(&[shared, new]),
        ["the package `extra` has no place in the order of the packages"]
    );
}
