//! The shape of a trapezoid waits for its trapezoid.

use super::bench::Bench;
use canter_shared::axis::Outcome;
use canter_shared::limits::Limits;
use canter_shared::time::Ticks;
use canter_shared::wire::command::Command;
use canter_shared::wire::reason::Reason;

impl Bench {
    fn shape(&mut self, acceleration: u32, deceleration: u32) -> Outcome {
        let sequence = self.next();
        self.send(Command::TrapezoidShape {
            acceleration: Ticks(acceleration),
            deceleration: Ticks(deceleration),
            sequence,
        })
    }

    /// How many ticks a move of a turn's sixteenth in a second speeds up and slows down.
    fn ramps(&mut self) -> (usize, usize) {
        let target = self.place() + 1.0 / 16.0;
        assert_eq!(self.go_trapezoid(target, 1_000), Outcome::Accepted);
        let mut signs = Vec::new();
        while self.axis.is_moving() {
            self.step();
            signs.push(self.setpoint.acceleration.counts().signum());
        }
        let count = |wanted| signs.iter().filter(|sign| **sign == wanted).count();
        (count(1), count(-1))
    }
}

/// The first setpoint of a phase is its entry, so the first phase shows one tick less.
fn is_shaped((up, down): (usize, usize)) -> bool {
    up.abs_diff(50) <= 1 && down.abs_diff(300) <= 1
}

#[test]
fn a_shape_is_used_once() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.shape(50, 300), Outcome::Accepted);
    let ramps = bench.ramps();
    assert!(is_shaped(ramps), "{ramps:?}");
    let ramps = bench.ramps();
    assert!(!is_shaped(ramps), "{ramps:?}");
}

#[test]
fn a_refused_trapezoid_keeps_the_shape() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.shape(50, 300), Outcome::Accepted);
    let too_fast = Outcome::Rejected(Reason::TooFast);
    assert_eq!(bench.go_trapezoid(1.0, 10), too_fast);
    let outside = Outcome::Rejected(Reason::OutsideTravel);
    assert_eq!(bench.go_trapezoid(1_001.0, 1_000_000), outside);
    let ramps = bench.ramps();
    assert!(is_shaped(ramps), "{ramps:?}");
}

#[test]
fn a_beta_move_leaves_the_shape() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.shape(50, 300), Outcome::Accepted);
    assert_eq!(bench.go(0.5, 1_000), Outcome::Accepted);
    bench.run(1_100);
    let ramps = bench.ramps();
    assert!(is_shaped(ramps), "{ramps:?}");
}

#[test]
fn a_stop_forgets_the_shape() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.shape(50, 300), Outcome::Accepted);
    assert_eq!(bench.send(Command::Stop { sequence: 0 }), Outcome::Accepted);
    let ramps = bench.ramps();
    assert!(!is_shaped(ramps), "{ramps:?}");
}

#[test]
fn a_shape_without_ramps_is_refused() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let longest = (1 << 22) - 1;
    for (up, down) in [(0, 10), (10, 0), (longest, 1)] {
        let refused = Outcome::Rejected(Reason::BadValue);
        assert_eq!(bench.shape(up, down), refused, "{up} {down}");
    }
}
