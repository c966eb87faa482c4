# shellcheck shell=bash
# Speed against other people's programs, in one run: ratios are printed, and none of them fails the
# part; results that disagree do.
source tests/lib/common.sh
need_rust clippy
need g++
python_with tests/bench/requirements.txt "$CARGO_TARGET_DIR/bench-venv"

# It is a workspace of its own, which `cargo fmt --all` and the like pass over.
bench=(--manifest-path tests/bench/Cargo.toml)
say "format and lints"
cargo fmt "${bench[@]}" --check
# Optimised as the build is, so that the peers are built once.
cargo clippy --locked --release "${bench[@]}" --all-targets -- -D warnings

say "build"
cargo build --locked --release "${bench[@]}"

say "run"
CANTER_BENCH_PYTHON=$CARGO_TARGET_DIR/bench-venv/bin/python "$CARGO_TARGET_DIR/release/canter-bench"
