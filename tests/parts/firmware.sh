# shellcheck shell=bash
# The images of the boards, as they would be flashed, and their lints; the default board's is run.
source tests/lib/common.sh
need_images
need_python

for board in nucleo-g474re nucleo-f446re nucleo-h743zi2; do
    image=(--package canter-firmware --no-default-features --features "$board" --bin "$board")
    if [ -f ".cargo/$board.toml" ]; then image+=(--config ".cargo/$board.toml"); fi
    image_cargo clippy "${image[@]}"
    image_cargo build --profile firmware "${image[@]}"
done

say "tests"
cargo test --locked --release --test firmware -- --nocapture

say "the image of nucleo-g474re on an emulated chip"
package=$(cargo pkgid --locked --package canter-firmware)
"$CANTER_PYTHON" -B tests/board/check.py "$CARGO_TARGET_DIR/thumbv7em-none-eabihf/firmware/nucleo-g474re" \
    "${package##*[#@]}" canter.dbc
