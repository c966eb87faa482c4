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
cargo clippy --locked --test '*' -- -D warnings

say "docs"
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps

say "tests"
# That builds `canter` too, which many of them run. Always all packages: one alone would ask less of some libraries,
# and they would be built once more.
cargo test --locked
cargo test --locked --test report
