# shellcheck shell=bash
# The tests on SocketCAN: in this machine's kernel if it has CAN, else in user-mode Linux.
# CANTER_VCAN_ARGS is passed to the tests, as in CANTER_VCAN_ARGS="a_test --nocapture".
source tests/lib/common.sh
need_rust
need_python
need can-utils iproute2

say "build"
cargo build --locked --release --package canter
CANTER_BIN=$CARGO_TARGET_DIR/release/canter
mapfile -t tests < <(
    cargo test --locked --release --package canter-tests --test 'vcan*' --no-run --message-format=json |
        sed -n '/"kind":\["test"\]/s/.*"executable":"\([^"]*\)".*/\1/p'
)
[ ${#tests[@]} -gt 0 ] || die "no vcan test was built"

# Paths without spaces, whatever the repository's is called: they stand on the kernel's command line.
work=$(mktemp -d /tmp/canter-vcan.XXXXXX)
runner=
finish() {
    # Nothing is left behind, be it interrupted or crashed: `timeout` leads a process group of all that
    # it started, and a killed user-mode Linux leaves helpers that hold its output open.
    if [ -n "$runner" ]; then kill -KILL -- "-$runner" 2>/dev/null || true; fi
    rm -rf "$work"
}
trap finish EXIT
{
    # The working directory that cargo would give them, and a home that goes away.
    printf 'cd %q\n' "$PWD/tests"
    printf 'export %s=%q\n' PATH "$PATH" HOME "$work" LC_ALL C.UTF-8 CANTER_BIN "$CANTER_BIN" CANTER_PYTHON "$CANTER_PYTHON" \
        CANTER_MEASUREMENTS "$CANTER_MEASUREMENTS" RUST_BACKTRACE "${RUST_BACKTRACE:-0}"
    echo "tests=($(printf '%q ' "${tests[@]}"))"
    echo "arguments=(${CANTER_VCAN_ARGS:-})"
    echo "status=$work/status started=$EPOCHREALTIME"
} >"$work/environment"
cp tests/uml/init tests/uml/on_buses "$work"

# A network of its own keeps the machine's CAN interfaces out of it, and takes no rights where user
# namespaces are allowed.
space=(unshare --net)
[ "$(id -u)" = 0 ] || space=(unshare --net --map-root-user)
if "${space[@]}" ip link add dev vcan0 type vcan 2>/dev/null; then
    say "run, in this kernel"
    command=("${space[@]}" "$work/on_buses")
else
    need user-mode-linux busybox-static
    say "run, in user-mode Linux"
    # Its memory is a file, which must be executable and large: /dev/shm is neither in containers.
    memory=$CARGO_TARGET_DIR
    if [ "$(df --output=avail -k /dev/shm 2>/dev/null | tail -1)" -gt 600000 ] 2>/dev/null &&
        ! grep -q ' /dev/shm .*noexec' /proc/mounts; then
        memory=/dev/shm
    fi
    command=(env TMPDIR="$memory" linux.uml mem=512M root=/dev/root rootfstype=hostfs rw
        init="$work/init" con=null con0=fd:0,fd:1 ssl=null uml_dir="$work" quiet)
fi

mkfifo "$work/output"
sed -u 's/\r$//' <"$work/output" | tee "$work/log" &
reader=$!
timeout --kill-after=10 900 "${command[@]}" </dev/null >"$work/output" 2>&1 &
runner=$!
wait "$runner" || true
kill -KILL -- "-$runner" 2>/dev/null || true
runner=
wait "$reader"

# The status file is the verdict: a kernel that stops early leaves none.
[ -s "$work/status" ] || die "the run ended without a status: it crashed, or took more than 900 s"
[ "$(cat "$work/status")" = 0 ] || die "vcan tests failed"

# A skipped test is a failed run.
for ((run = 1; run <= ${#tests[@]}; run++)); do
    result=$(grep "^test result: " "$work/log" | sed -n "${run}p" || true)
    [[ $result =~ ok\.\ ([0-9]+)\ passed ]] || die "a test program gave no result"
    [ "${BASH_REMATCH[1]}" -gt 0 ] || die "no test ran: $result"
    [[ $result == *" 0 ignored"* ]] || die "tests were skipped: $result"
    [[ $result == *" 0 filtered out"* ]] || [ -n "${CANTER_VCAN_ARGS:-}" ] || die "tests were left out: $result"
done
