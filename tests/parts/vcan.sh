# shellcheck shell=bash
# The tests on SocketCAN: in this machine's kernel if it has CAN, else in emulated machines with one that has.
# CANTER_VCAN_ARGS is passed to the tests, as in CANTER_VCAN_ARGS="a_test --nocapture".
source tests/lib/common.sh
source tests/lib/guest.sh
need_rust
need_python
need can-utils iproute2

# Emulated machines: each waits half of its time, so two keep a core busy. One takes up to 1.5 GB.
GUESTS=$((2 * $(nproc)))
room=$(awk '/^MemAvailable:/ { print int($2 / 1500000) }' /proc/meminfo)
for most in 8 "$room"; do ((GUESTS <= most)) || GUESTS=$most; done
((GUESTS > 0)) || GUESTS=1
# A host that is far slower than those that were met; one test that hangs ends by itself.
LIMIT=2400

say "build"
mapfile -t programs < <(
    build_tests vcan --message-format=json-render-diagnostics |
        sed -n '/"kind":\["test"\]/s/.*"executable":"\([^"]*\)".*/\1/p'
)
CANTER_BIN=$CARGO_TARGET_DIR/release/canter
[ ${#programs[@]} = 1 ] || die "the vcan tests were not built"
read -ra arguments <<<"${CANTER_VCAN_ARGS:-}"
list=$("${programs[0]}" --list --format=terse "${arguments[@]}" | sed -n 's/: test$//p')
# Those that take longest are not to begin when all else is done.
long='a_minute_of|flood|drives'
mapfile -t tests < <(grep -E "$long" <<<"$list" || true; grep -Ev "$long" <<<"$list" || true)
[ ${#tests[@]} -gt 0 ] || die "there is no such test"

# Paths without spaces, whatever the repository's is called: they stand on the kernel's command line.
work=$(mktemp -d /tmp/canter-vcan.XXXXXX)
runners=()
finish() {
    # Nothing is left behind, be it interrupted or crashed: `timeout` leads a process group of all that it
    # started.
    local runner
    for runner in "${runners[@]}"; do kill -KILL -- "-$runner" 2>/dev/null || true; done
    rm -rf "$work"
}
trap finish EXIT

# run_tests NAME: begins what runs those tests that no other has begun, one after the other, in a machine of its
# own or on buses of its own.
run_tests() {
    local place=$work/$1
    mkdir "$place"
    cp tests/guest/session tests/guest/on_buses "$place"
    {
        # The working directory that cargo would give them, and a home that goes away.
        printf 'cd %q\n' "$PWD/tests"
        printf 'export %s=%q\n' PATH "$PATH" HOME "$work" LC_ALL C.UTF-8 CANTER_BIN "$CANTER_BIN" \
            CANTER_PYTHON "$CANTER_PYTHON" CANTER_MEASUREMENTS "$place/measurements" \
            RUST_BACKTRACE "${RUST_BACKTRACE:-0}"
        printf 'test=%q status=%q taken=%q\n' "${programs[0]}" "$place/status" "$taken"
        declare -p tests options
    } >"$place/environment"
    if [ -n "$emulated" ]; then
        guest_command "$place/session"
    else
        command=("${space[@]}" "$place/on_buses")
    fi
    mkfifo "$place/output"
    sed -u 's/\r$//' <"$place/output" | tee "$place/log" &
    readers+=("$!")
    timeout --kill-after=10 "$LIMIT" "${command[@]}" </dev/null >"$place/output" 2>&1 &
    runners+=("$!")
}

# What is no name of a test is for the test program.
options=() readers=() emulated=
taken=$work/taken
mkdir "$taken"
for argument in "${arguments[@]}"; do
    if [[ $argument == --* ]]; then options+=("$argument"); fi
done
# A network of its own keeps the machine's CAN interfaces out of it, and takes no rights where user
# namespaces are allowed.
space=(unshare --net)
[ "$(id -u)" = 0 ] || space=(unshare --net --map-root-user)
if "${space[@]}" ip link add dev vcan0 type vcan 2>/dev/null; then
    say "run ${#tests[@]} tests, in this kernel"
    run_tests here
else
    emulated=yes
    need_guest
    say "run ${#tests[@]} tests, in emulated machines with ${guest##*/}"
    for ((number = 0; number < GUESTS && number < ${#tests[@]}; number++)); do run_tests "$number"; done
fi
for process in "${runners[@]}" "${readers[@]}"; do wait "$process" || true; done
runners=()

# Each wrote its own: machines that append to one file of their host overwrite each other.
cat "$work"/*/measurements >>"$CANTER_MEASUREMENTS" 2>/dev/null || true

# The status file is the verdict: a kernel that stops early leaves none.
passed=0
for place in "$work"/*/; do
    [ "$place" != "$taken/" ] || continue
    [ -s "$place/status" ] || die "a run ended without a status: it crashed, or took more than $LIMIT s"
    [ "$(cat "$place/status")" = 0 ] || die "vcan tests failed"
    # A skipped test is a failed run.
    passed=$((passed + $(grep -c "^test result: ok\. 1 passed; 0 failed; 0 ignored" "$place/log" || true)))
done
[ "$passed" = ${#tests[@]} ] || die "$passed of ${#tests[@]} tests ran"
