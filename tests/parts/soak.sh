# shellcheck shell=bash
# Random robots under random faults against the invariants of docs/soak.md: more than a simulated hour
# over fixed seeds, the speed for 12 axes on one core, then what is broken on purpose.
source tests/lib/common.sh
need_rust

build_tests soak
canter=$CARGO_TARGET_DIR/release/canter
log=$CARGO_TARGET_DIR/soak.log

# number FIELD DOCUMENT: one number of a JSON document.
number() { sed -n "s/.*\"$1\":\([0-9.e+-]*\).*/\1/p" <<<"$2"; }

measure() { printf 'soak\t%s\t%s\t%s\n' "$1" "$(LC_ALL=C awk -v n="$2" 'BEGIN { printf "%.6g", n }')" "$3" >>"$CANTER_MEASUREMENTS"; }

say "an hour and more, all faults"
if ! document=$("$canter" --json soak --seed 1 --hours 1.2 --log "$log"); then
    die "an invariant was violated; $log plays it again: canter soak --replay $log"
fi
measure "simulated robot hours without a violation" "$(number robot_hours "$document")" "1 at least"
measure "seeds without a violation" "$(number seeds "$document")" "100 at least"
measure "setpoints in motion" "$(number setpoints_in_motion "$document")" "-"
measure "faults latched" "$(number faults_latched "$document")" "-"
measure "the slowest stop, of the time that its limits allow" "$(number slowest_stop "$document")" "1 at most"
measure "simulated seconds in a second, all cores" "$(number speed "$document")" "-"

say "speed: 12 axes, one core"
document=$("$canter" --json soak --seed 1 --hours 0.1 --axes 12 --threads 1 --faults none --log "$log")
measure "simulated seconds in a second, 12 axes, one core, checked" "$(number speed "$document")" "100 wished for"

say "tests"
cargo test --locked --release --test soak --test skew
