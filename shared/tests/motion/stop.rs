//! Stops.

use canter_shared::limits::Limits;
use canter_shared::motion::{Motion, Move, Profile};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;

/// Several hosts may say stop at once: what was begun is not begun again, only harder.
#[test]
fn a_repeated_stop_is_no_harder() {
    let limits = Limits::default();
    let mut motion = Motion::at_rest(Position::ZERO);
    let asked = Move {
        target: Position::from_counts(8 << 32),
        duration: Ticks(6_000),
        profile: Profile::Beta,
    };
    motion
        .start(Tick(0), Tick(0), asked, &limits)
        .expect("inside the limits");
    for begin in (100..5_900).step_by(100) {
        let mut once = motion.clone();
        let rest = once.stop(Tick(begin), &limits);
        for again in begin..rest.0 {
            let mut twice = once.clone();
            // Planned anew it may save the ticks that were lost to rounding, no more.
            let sooner = twice.stop(Tick(again), &limits);
            assert!(
                sooner <= rest && rest.0 - sooner.0 <= 2,
                "{sooner:?} {rest:?}"
            );
            for tick in again..rest.0 {
                let (now, next) = (twice.at(Tick(tick)), twice.at(Tick(tick + 1)));
                let change = (next.acceleration - now.acceleration).abs().radians();
                let jerk = limits.jerk().radians() * 1e-3;
                assert!(change <= 1.2 * jerk, "{begin}, {again}: {change} at {tick}");
            }
        }
    }
}
