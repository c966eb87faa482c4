//! An axis whose setpoints are shaped for a mode of its machine.

use super::bench::{Bench, stopping_ticks, turns};
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::shaping::{ShaperKind, Shaping, ShapingError};
use canter_shared::motion::shortest_s_curve;
use canter_shared::wire::command::Command;
use std::f64::consts::TAU;

const FREQUENCY: f64 = 12.0;
const DAMPING: f64 = 0.02;

fn shaping() -> Shaping {
    Shaping::new(ShaperKind::Zvd, FREQUENCY, DAMPING).expect("in range")
}

fn shaped(limits: Limits) -> Bench {
    let mut bench = Bench::enabled(limits, 0.25);
    assert_eq!(bench.axis.shape(Some(&shaping())), Ok(()));
    bench
}

fn delay() -> u64 {
    shaping().delay().0.into()
}

/// A mass that the axis pulls by a spring: where it is and how fast, in rad.
#[derive(Default)]
struct Mass {
    position: f64,
    velocity: f64,
}

impl Mass {
    /// One tick behind a setpoint that goes on evenly.
    fn follow(&mut self, bench: &Bench) {
        const STEPS: u32 = 50;
        let rate = TAU * FREQUENCY;
        let h = 1e-3 / f64::from(STEPS);
        let (to, v) = (bench.setpoint.position.radians(), bench.velocity());
        for step in 0..STEPS {
            let before = f64::from(STEPS - step) * h;
            let spring = to - v * before - self.position;
            let pull = rate * rate * spring + 2.0 * DAMPING * rate * (v - self.velocity);
            self.velocity += h * pull;
            self.position += h * self.velocity;
        }
    }

    fn swing(&self, bench: &Bench) -> f64 {
        let away = self.position - bench.setpoint.position.radians();
        away.hypot(self.velocity / (TAU * FREQUENCY))
    }
}

fn swing_after_a_move(shaping: Option<&Shaping>) -> f64 {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.axis.shape(shaping), Ok(()));
    let mut mass = Mass::default();
    let shortest = shortest_s_curve(turns(0.25), &Limits::default()).expect("a short way");
    assert_eq!(bench.go_s_curve(0.25, shortest.0), Outcome::Accepted);
    while bench.axis.is_moving() {
        bench.step();
        mass.follow(&bench);
    }
    assert_eq!(bench.setpoint.position, turns(0.25));
    mass.swing(&bench)
}

#[test]
fn a_shaped_move_leaves_the_machine_at_rest() {
    let (plain, shaped) = (
        swing_after_a_move(None),
        swing_after_a_move(Some(&shaping())),
    );
    assert!(plain > 0.005, "{plain}");
    assert!(shaped < 0.01 * plain, "{shaped} of {plain}");
}

#[test]
fn a_shaped_move_arrives_exactly_and_late_by_the_delay() {
    let mut bench = shaped(Limits::default());
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    assert_eq!(u64::from(bench.answer().detail), 1_000 + delay());
    let ticks = bench.ticks_to_rest(2_000);
    assert!(ticks.abs_diff(1_000 + delay()) <= 1, "{ticks}");
    assert_eq!(bench.setpoint.position, turns(1.0));
    bench.stays(500);
}

#[test]
fn a_shaped_stop_rests_within_its_time_and_the_delay() {
    let limits = Limits::default();
    for emergency in [false, true] {
        let mut bench = shaped(limits);
        assert_eq!(bench.go(30.0, 20_000), Outcome::Accepted);
        bench.run(8_000);
        let velocity = bench.velocity();
        assert!(velocity > 10.0);
        let stop = if emergency {
            Command::EmergencyStop
        } else {
            Command::Stop { sequence: 0 }
        };
        assert_eq!(bench.send(stop), Outcome::Accepted);
        bench.ticks_to_rest(stopping_ticks(velocity, &limits) + delay());
        bench.step();
        let fault = emergency.then_some(Fault::EmergencyStop);
        assert_eq!(bench.axis.fault(), fault);
        bench.stays(300);
    }
}

#[test]
fn a_shaped_axis_that_is_disabled_stops_first_and_is_enabled_where_it_stands() {
    use canter_shared::wire::command::Action;
    let mut bench = shaped(Limits::default());
    assert_eq!(bench.go(3.0, 2_000), Outcome::Accepted);
    bench.run(1_000);
    assert_eq!(bench.control(Action::Disable), Outcome::Accepted);
    while bench.axis.state() != State::SwitchOnDisabled {
        bench.step();
    }
    let place = bench.setpoint.position;
    assert_eq!(bench.control(Action::Enable), Outcome::Accepted);
    bench.run(20);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    // The drive followed a little behind when its torque went.
    assert!((bench.setpoint.position - place).abs().radians() < 1e-5);
    assert_eq!(bench.go(0.0, 2_000), Outcome::Accepted);
    bench.ticks_to_rest(2_000 + delay() + 1);
    assert_eq!(bench.setpoint.position, turns(0.0));
}

/// Where one tap still slows down and another speeds up already, one limit must do for both.
#[test]
fn unequal_accelerations_are_kept_by_sense() {
    let limits = Limits::new(&LimitValues {
        acceleration: 50.0,
        deceleration: 400.0,
        ..DEFAULT_VALUES
    })
    .expect("in range");
    let mut bench = shaped(limits);
    // The first from rest, the others in mid-move.
    for (target, least, ticks) in [(3.0, 2_000, 900), (-3.0, 10, 650), (4.0, 10, 1_000)] {
        assert_eq!(bench.go_s_curve(target, least), Outcome::Accepted);
        for _ in 0..ticks {
            bench.step();
            let (v, a) = (bench.velocity(), bench.setpoint.acceleration.radians());
            let limit = if v * a < 0.0 { 400.0 } else { 50.0 };
            assert!(a.abs() <= limit, "{v} {a}");
        }
    }
}

#[test]
fn what_is_shaped_changes_only_at_rest() {
    let mut bench = shaped(Limits::default());
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    bench.run(1_001);
    // The move has ended, but not its last parts.
    assert_eq!(bench.axis.shape(None), Err(ShapingError::Moving));
    bench.ticks_to_rest(delay() + 1);
    assert_eq!(bench.axis.shape(None), Ok(()));
    assert_eq!(bench.go(0.0, 1_000), Outcome::Accepted);
    assert!(bench.ticks_to_rest(1_100).abs_diff(1_000) <= 1);
}
