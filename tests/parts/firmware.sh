# shellcheck shell=bash
# The image of the default board, as it would be flashed, and its lints.
source tests/lib/common.sh
need_images

board=(--package canter-firmware --no-default-features --features nucleo-g474re --bin nucleo-g474re)
image_cargo clippy "${board[@]}"
image_cargo build --profile firmware "${board[@]}"

say "tests"
cargo test --locked --release --package canter-tests --test firmware -- --nocapture
