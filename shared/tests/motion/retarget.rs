//! Another target in mid-move.

use canter_shared::limits::Limits;
use canter_shared::motion::{Motion, Move, Profile};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;

use super::watch::position;

#[test]
fn a_quick_retarget_is_laid_over_and_does_not_wait_for_a_stop() {
    let limits = Limits::default();
    let mut motion = Motion::at_rest(Position::ZERO);
    let asked = |radians: f64, ticks| Move {
        target: position(radians),
        duration: Ticks(ticks),
        profile: Profile::Beta,
    };
    motion
        .start(Tick(0), Tick(0), asked(1.0, 1_000), &limits)
        .expect("well inside the limits");
    let planned = motion
        .start(Tick(400), Tick(400), asked(-1.0, 1_000), &limits)
        .expect("well inside the limits");
    assert_eq!((planned.start, planned.end), (Tick(400), Tick(1_400)));
}
