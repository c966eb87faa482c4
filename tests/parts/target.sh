# shellcheck shell=bash
# The emulated Cortex-M4F: the node's image, and images that measure.
source tests/lib/common.sh
need_images
need qemu-system-arm

image_cargo build --profile firmware --package canter-firmware --no-default-features --features emulated --bin emulated
image_cargo build --profile firmware --package canter-images

say "tests"
cargo test --locked --release --package canter-tests --test target -- --nocapture
