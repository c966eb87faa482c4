# shellcheck shell=bash
# The images of the boards, as they would be flashed, and their lints.
source tests/lib/common.sh
need_images

for board in nucleo-g474re nucleo-f446re nucleo-h743zi2; do
    image=(--package canter-firmware --no-default-features --features "$board" --bin "$board")
    image_cargo clippy "${image[@]}"
    image_cargo build --profile firmware "${image[@]}"
done

say "tests"
cargo test --locked --release --package canter-tests --test firmware -- --nocapture
