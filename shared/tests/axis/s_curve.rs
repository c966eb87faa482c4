//! S-curves, and the limits that are told ahead of one.

use super::bench::{Bench, turns};
use canter_shared::axis::Outcome;
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::shortest_s_curve;
use canter_shared::time::Ticks;
use canter_shared::units::{Acceleration, Jerk, Velocity};
use canter_shared::wire::command::{Command, ProfileKind};
use canter_shared::wire::reason::Reason;

impl Bench {
    pub fn go_s_curve(&mut self, target: f64, milliseconds: u32) -> Outcome {
        let sequence = self.next();
        self.send(Command::Move {
            profile: ProfileKind::SCurve,
            staged: false,
            target: turns(target),
            duration: Ticks(milliseconds),
            sequence,
        })
    }

    fn ramps_at_most(&mut self, acceleration: f64, deceleration: f64) -> Outcome {
        let sequence = self.next();
        let limit = |value| Acceleration::from_radians(value).expect("in range");
        self.send(Command::RampLimits {
            acceleration: limit(acceleration),
            deceleration: limit(deceleration),
            sequence,
        })
    }

    fn peaks_at_most(&mut self, velocity: f64, jerk: f64) -> Outcome {
        let sequence = self.next();
        self.send(Command::PeakLimits {
            velocity: Velocity::from_radians(velocity).expect("in range"),
            jerk: Jerk::from_radians(jerk).expect("in range"),
            sequence,
        })
    }

    /// Runs until the axis rests; gives the greatest velocity, acceleration, deceleration and
    /// change of acceleration within a tick that it saw, in rad and seconds.
    fn peaks(&mut self) -> [f64; 4] {
        let mut peaks = [0f64; 4];
        while self.axis.is_moving() {
            let last = self.setpoint;
            self.step();
            let (v, a) = (self.setpoint.velocity, self.setpoint.acceleration);
            let jerk = (a.radians() - last.acceleration.radians()).abs() * 1e3;
            let seen = [v.radians(), a.radians(), -a.radians(), jerk];
            for (peak, seen) in peaks.iter_mut().zip(seen) {
                *peak = peak.max(seen);
            }
        }
        peaks
    }
}

fn limits(values: LimitValues) -> Limits {
    Limits::new(&values).expect("in range")
}

#[test]
fn an_s_curve_takes_the_time_that_the_host_predicts_and_keeps_the_jerk() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let shortest = shortest_s_curve(turns(2.0), &Limits::default()).expect("a short way");
    let too_fast = Outcome::Rejected(Reason::TooFast);
    assert_eq!(bench.go_s_curve(2.0, shortest.0 - 1), too_fast);
    assert_eq!(bench.answer().detail, shortest.0);
    assert_eq!(bench.go_s_curve(2.0, shortest.0), Outcome::Accepted);
    let begin = bench.tick;
    let [velocity, up, down, jerk] = bench.peaks();
    assert!(bench.tick - begin <= u64::from(shortest.0) + 1);
    assert_eq!(bench.setpoint.position, turns(2.0));
    assert!(velocity > 19.0 && up > 199.0 && down > 199.0);
    assert!(jerk <= 20_000.0 * (1.0 + 1e-6), "{jerk}");
}

#[test]
fn limits_that_are_told_hold_for_one_s_curve() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.ramps_at_most(50.0, 20.0), Outcome::Accepted);
    assert_eq!(bench.peaks_at_most(5.0, 1_000.0), Outcome::Accepted);
    // Too fast for them, though not for the axis: they go on waiting.
    let too_fast = Outcome::Rejected(Reason::TooFast);
    assert_eq!(bench.go_s_curve(1.0, 600), too_fast);
    let least = bench.answer().detail;
    assert_eq!(bench.go_s_curve(1.0, least), Outcome::Accepted);
    let [velocity, up, down, jerk] = bench.peaks();
    assert!((4.9..=5.0).contains(&velocity), "{velocity}");
    assert!((49.0..=50.0).contains(&up), "{up}");
    assert!((19.0..=20.0).contains(&down), "{down}");
    assert!(jerk <= 1_000.0 * (1.0 + 1e-6), "{jerk}");
    assert_eq!(bench.go_s_curve(0.0, 600), Outcome::Accepted);
}

#[test]
fn a_lower_speed_in_mid_move_is_come_down_to_without_a_dip() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go_s_curve(20.0, 7_000), Outcome::Accepted);
    while bench.velocity() < 17.9 {
        bench.step();
    }
    assert_eq!(bench.peaks_at_most(6.0, 20_000.0), Outcome::Accepted);
    assert_eq!(bench.go_s_curve(20.0, 1), Outcome::Accepted);
    let mut slow = false;
    while bench.axis.is_moving() && bench.place() < 19.0 {
        let before = bench.velocity();
        bench.step();
        let now = bench.velocity();
        slow |= now <= 6.0;
        let down_to = if slow { 5.999 } else { before.min(6.0) - 1e-6 };
        assert!(now >= down_to.min(before), "{before} {now}");
        assert!(now <= before.max(6.0) + 0.2, "{before} {now}");
    }
    assert!(slow);
    bench.peaks();
    assert_eq!(bench.setpoint.position, turns(20.0));
}

#[test]
fn an_s_curve_goes_on_from_whatever_is_under_way_without_a_step_of_acceleration() {
    let values = LimitValues {
        jerk: 4_000.0,
        ..DEFAULT_VALUES
    };
    for first in [ProfileKind::Beta, ProfileKind::SCurve] {
        let mut bench = Bench::enabled(limits(values), 0.0);
        let sequence = bench.next();
        let outcome = bench.send(Command::Move {
            profile: first,
            staged: false,
            target: turns(4.0),
            duration: Ticks(3_000),
            sequence,
        });
        assert_eq!(outcome, Outcome::Accepted);
        bench.run(700);
        assert_eq!(bench.go_s_curve(-1.0, 500), Outcome::Accepted);
        let [_, _, _, jerk] = bench.peaks();
        assert!(jerk <= 4_000.0 * (1.0 + 1e-6), "{first:?} {jerk}");
        assert_eq!(bench.setpoint.position, turns(-1.0));
    }
}

#[test]
fn limits_of_zero_are_refused() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let refused = Outcome::Rejected(Reason::BadValue);
    for (up, down) in [(0.0, 1.0), (1.0, 0.0)] {
        assert_eq!(bench.ramps_at_most(up, down), refused);
    }
    for (velocity, jerk) in [(0.0, 1.0), (1.0, 0.0)] {
        assert_eq!(bench.peaks_at_most(velocity, jerk), refused);
    }
}

#[test]
fn a_stop_forgets_limits_and_a_beta_move_leaves_them() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.peaks_at_most(1.0, 20_000.0), Outcome::Accepted);
    assert_eq!(bench.go(0.5, 1_000), Outcome::Accepted);
    bench.run(1_100);
    let too_fast = Outcome::Rejected(Reason::TooFast);
    assert_eq!(bench.go_s_curve(1.5, 1_000), too_fast);
    assert_eq!(bench.send(Command::Stop { sequence: 0 }), Outcome::Accepted);
    assert_eq!(bench.go_s_curve(1.5, 1_000), Outcome::Accepted);
}
