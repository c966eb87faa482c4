//! What a move leaves swinging, against an integration step by step and against known zeros.

use canter::profile::vibration::Resonance;
use canter::profile::{AskedLimits, Curve, Kind, Request, plan};
use canter_shared::motion::shaping::{Shaped, ShaperKind, Shaping};
use canter_shared::motion::trajectory::Trajectory;
use std::f64::consts::TAU;

fn curve(kind: Kind, from: f64, to: f64, limits: [f64; 4]) -> Curve {
    let [velocity, acceleration, deceleration, jerk] = limits.map(Some);
    let limits = AskedLimits {
        velocity,
        acceleration,
        deceleration,
        jerk,
    };
    let request = Request {
        limits,
        ..Request::rest_to_rest(kind, from, to)
    };
    plan(&request).expect("a move").curve
}

/// The mass's own equation, x'' = -2 z w (x' - q') - w^2 (x - q), by Runge and Kutta's rule of
/// fourth order from rest to the end; then how far it swings.
fn step_by_step<T: Trajectory>(resonance: &Resonance, trajectory: &T, steps: u32) -> f64 {
    let omega = TAU * resonance.frequency;
    let damping = resonance.damping;
    let rate = |time: f64, [x, v]: [f64; 2]| {
        let axis = trajectory.at(time);
        let force =
            -2.0 * damping * omega * (v - axis.velocity) - omega * omega * (x - axis.position);
        [v, force]
    };
    let plus = |state: [f64; 2], change: [f64; 2], by: f64| {
        [state[0] + change[0] * by, state[1] + change[1] * by]
    };
    let step = trajectory.duration() / f64::from(steps);
    let mut state = [trajectory.at(0.0).position, 0.0];
    for index in 0..steps {
        let time = f64::from(index) * step;
        let first = rate(time, state);
        let second = rate(time + step / 2.0, plus(state, first, step / 2.0));
        let third = rate(time + step / 2.0, plus(state, second, step / 2.0));
        let fourth = rate(time + step, plus(state, third, step));
        for (change, weight) in [(first, 1.0), (second, 2.0), (third, 2.0), (fourth, 1.0)] {
            state = plus(state, change, weight * step / 6.0);
        }
    }
    let end = trajectory.at(trajectory.duration());
    let (off, speed) = (state[0] - end.position, state[1] - end.velocity);
    let damped = omega * (1.0 - damping * damping).sqrt();
    off.hypot((speed + damping * omega * off) / damped)
}

const LIMITS: [f64; 4] = [2.0, 10.0, 7.0, 90.0];

#[test]
fn every_profile_as_an_integration_step_by_step() {
    for kind in Kind::ALL {
        let curve = curve(kind, 0.4, -1.1, LIMITS);
        for (frequency, damping) in [(0.3, 0.0), (1.7, 0.05), (6.1, 0.2), (12.0, 0.0)] {
            let resonance = Resonance { frequency, damping };
            let got = resonance.residual(&curve).expect("few cycles");
            let want = step_by_step(&resonance, &curve, 40_000);
            assert!(
                (got - want).abs() <= 1e-7,
                "{kind}, {resonance:?}: {got}, not {want}"
            );
            assert!(
                want > 1e-6,
                "{kind}, {resonance:?}: nothing to see in {want}"
            );
        }
    }
}

#[test]
fn behind_a_shaper_as_an_integration_step_by_step() {
    let curve = curve(Kind::SCurve, 0.0, 1.0, LIMITS);
    for kind in [ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Ei] {
        let shaping = Shaping::new(kind, 6.0, 0.1).expect("in range");
        let shaped = Shaped::in_ticks(curve.clone(), &shaping);
        let impulses: Vec<(f64, f64)> = shaping
            .impulses_in_ticks()
            .iter()
            .map(|impulse| (impulse.time, impulse.amplitude))
            .collect();
        // At its own frequency, where ZV and ZVD leave nothing, and beside it.
        for (frequency, damping) in [(6.0, 0.1), (5.1, 0.1), (8.3, 0.02)] {
            let resonance = Resonance { frequency, damping };
            let bare = resonance.residual(&curve).expect("few cycles");
            let got = bare * resonance.left_by(&impulses);
            let want = step_by_step(&resonance, &shaped, 40_000);
            assert!(
                (got - want).abs() <= 1e-7,
                "{kind}, {resonance:?}: {got}, not {want}"
            );
        }
        let own = Resonance {
            frequency: 6.0,
            damping: 0.1,
        };
        let left = own.left_by(&impulses);
        match kind {
            ShaperKind::Ei => assert!((0.01..=0.05).contains(&left), "{left}"),
            _ => assert!(left < 1e-12, "{left}"),
        }
    }
}

/// A constant acceleration over whole periods leaves an undamped mass as it found it.
#[test]
fn ramps_of_whole_periods_leave_nothing() {
    // Ramps of 2 / 10 = 0.2 s, a cruise of 0.3 s.
    let trapezoid = curve(Kind::Trapezoid, 0.0, 1.0, [2.0, 10.0, 10.0, 1.0]);
    let residual = |curve: &Curve, frequency: f64| {
        let damping = 0.0;
        let resonance = Resonance { frequency, damping };
        resonance.residual(curve).expect("few cycles")
    };
    for periods in 1..=5 {
        let zero = residual(&trapezoid, f64::from(periods) / 0.2);
        assert!(zero < 1e-14, "{zero}");
    }
    // Between them it does swing; and at the zeros of the other factor it does not: ramps half a
    // period apart, 0.5 s, cancel each other where they push against each other.
    assert!(residual(&trapezoid, 7.0) > 1e-3);
    assert!(residual(&trapezoid, 4.0) < 1e-14);
    // An s-curve whose jerk lasts one period, 10 / 100 s.
    let s_curve = curve(Kind::SCurve, 0.0, 1.0, [2.0, 10.0, 10.0, 100.0]);
    assert!(residual(&s_curve, 10.0) < 1e-13);
    assert!(residual(&s_curve, 7.3) > 1e-4);
}

#[test]
fn very_slow_springs_swing_by_the_whole_way_and_stiff_ones_hardly() {
    for kind in Kind::ALL {
        let curve = curve(kind, 3.0, 5.0, LIMITS);
        let residual = |frequency| {
            let damping = 0.0;
            let resonance = Resonance { frequency, damping };
            resonance.residual(&curve).expect("few cycles")
        };
        // The mass has not noticed yet: it is the whole way off.
        assert!((residual(1e-5) - 2.0).abs() < 1e-6, "{kind}");
        assert!(residual(300.0) < 1e-4, "{kind}");
    }
    let resonance = Resonance {
        frequency: 1e9,
        damping: 0.0,
    };
    let beta = curve(Kind::Beta, 3.0, 5.0, LIMITS);
    let error = resonance.residual(&beta).expect_err("too many cycles");
    assert!(error.to_string().contains("--resonance"), "{error}");
}
