# shellcheck shell=bash
# The fuzz targets: each over its committed inputs, and then for some seconds on from there.
# CANTER_FUZZ_SECONDS=600 tests/run fuzz looks for longer, CANTER_FUZZ_TARGETS="axis" in some only.
source tests/lib/common.sh
need_rust clippy rustfmt
need g++

seconds=${CANTER_FUZZ_SECONDS:-10}
project=tests/fuzz
build=$CARGO_TARGET_DIR/fuzz/build
tools=$CARGO_TARGET_DIR/fuzz-tools
version=0.13.1

say "format and lints"
manifest=(--manifest-path "$project/Cargo.toml")
cargo fmt "${manifest[@]}" --check
CARGO_TARGET_DIR=$build cargo clippy --locked "${manifest[@]}" --all-targets -- -D warnings

if [ ! -x "$tools/bin/cargo-fuzz" ]; then
    say "installing cargo-fuzz"
    CARGO_TARGET_DIR=$CARGO_TARGET_DIR/fuzz/tools cargo install --quiet --locked --root "$tools" cargo-fuzz@$version
fi
export PATH="$tools/bin:$PATH"
# cargo-fuzz asks for instrumentation that only a nightly compiler offers by itself. A sanitizer looks
# for what `forbid(unsafe_code)` rules out, so there is none, and the compiler stays the same.
export RUSTC_BOOTSTRAP=1
fuzz=(--fuzz-dir "$project" --target-dir "$build" --sanitizer none)

say "build"
cargo fuzz build "${fuzz[@]}"

mapfile -t targets < <(sed -n '/^\[\[bin\]\]/{n;s/^name = "\(.*\)"/\1/p}' "$project/Cargo.toml")
[ -z "${CANTER_FUZZ_TARGETS:-}" ] || read -ra targets <<<"$CANTER_FUZZ_TARGETS"
failed=()
for target in "${targets[@]}"; do
    committed=$project/corpus/$target
    [ -d "$committed" ] || die "$committed is missing: the inputs that $target begins with"
    say "$target: $(find "$committed" -type f | wc -l) inputs, then $seconds s"
    # What is found is kept out of the repository until somebody means to add it.
    found=$CARGO_TARGET_DIR/fuzz/found/$target
    crashes=$CARGO_TARGET_DIR/fuzz/crashes/$target
    mkdir -p "$found" "$crashes"
    run=(cargo fuzz run "${fuzz[@]}" "$target")
    log=$CARGO_TARGET_DIR/fuzz/$target.log
    if {
        "${run[@]}" "$committed" -- -runs=0 -artifact_prefix="$crashes/" &&
            "${run[@]}" "$found" "$committed" -- -max_total_time="$seconds" -max_len=512 -timeout=20 \
                -print_final_stats=1 -artifact_prefix="$crashes/"
    } >"$log" 2>&1; then
        tried=$(sed -n 's/^stat::number_of_executed_units: //p' "$log")
        grep -E '^#[0-9]+[[:space:]]+DONE' "$log"
        printf 'fuzz\t%s, inputs tried\t%s\tnone fails\n' "$target" "$tried" >>"$CANTER_MEASUREMENTS"
    else
        failed+=("$target")
        grep -Ev '^(INFO: |WARNING: Failed to find|#[0-9]+[[:space:]])' "$log" || true
        printf '\n%s fails; again with the input that is named above:\n    %s FILE\n' \
            "$target" "RUSTC_BOOTSTRAP=1 PATH=$tools/bin:\$PATH ${run[*]}"
    fi
done
[ ${#failed[@]} -eq 0 ] || die "these targets failed: ${failed[*]}"
