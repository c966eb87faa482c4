# shellcheck shell=bash
# The emulated Cortex-M4F: the node's image, and images that measure.
source tests/lib/common.sh
need_images
need qemu-system-arm

image_cargo build --profile firmware --package canter-firmware --no-default-features --features emulated --bin emulated
image_cargo build --profile firmware --package canter-images

say "tests"
# `canter` is what they run.
cargo build --locked --release --package canter
# One at a time: the emulated node lives in real time.
cargo test --locked --release --package canter-tests --test target -- --nocapture --test-threads=1
