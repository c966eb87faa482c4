# shellcheck shell=bash
# Format, lints, docs, and the tests that need nothing but cargo, Python and a browser.
source tests/lib/common.sh
need_rust clippy rustfmt
need_python
need chromium

say "format"
cargo fmt --all --check

say "lints"
cargo clippy --locked --all-targets -- -D warnings
# The tests of the other parts have `test = false` and are passed over by --all-targets.
cargo clippy --locked --package canter-tests --test '*' -- -D warnings

say "docs"
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps

say "tests"
# `canter` is what some of them run; cargo builds it for the tests of its own package only.
cargo build --locked --package canter
cargo test --locked
cargo test --locked --package canter-tests --test report
