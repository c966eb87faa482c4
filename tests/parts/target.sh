# shellcheck shell=bash
# The emulated Cortex-M4F: the node's image, and images that measure.
source tests/lib/common.sh
need_images
need qemu-system-arm

image_cargo build --profile firmware --package canter-firmware --no-default-features --features emulated --bin emulated
image_cargo build --profile firmware --package canter-images

say "tests"
build_tests target
# One at a time: the emulated node lives in real time.
cargo test --locked --release --test target -- --nocapture --test-threads=1
