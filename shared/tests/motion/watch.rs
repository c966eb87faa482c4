//! Holds every tick to the limits and to the tick before it.

use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::{Motion, Setpoint};
use canter_shared::time::Tick;
use canter_shared::units::Position;
use proptest::prelude::*;

pub fn position(radians: f64) -> Position {
    Position::from_radians(radians).expect("in range")
}

pub fn limits_strategy() -> impl Strategy<Value = Limits> {
    (0.1..200.0f64, 0.5..3.0f64, 0.5..3.0f64, 0.5..3.5f64).prop_map(
        |(velocity, acceleration, deceleration, jerk)| {
            Limits::new(&LimitValues {
                velocity,
                acceleration: 10f64.powf(acceleration),
                deceleration: 10f64.powf(deceleration),
                jerk: 10f64.powf(acceleration.max(deceleration)) * 10f64.powf(jerk),
                ..DEFAULT_VALUES
            })
            .expect("in range")
        },
    )
}

/// One tick in seconds.
const TICK: f64 = 1e-3;

/// Counts/s^2 by which two accelerations that follow each other may be off.
const ROUNDING: f64 = 64.0;

/// Checks one tick against the one before it.
pub struct Watch {
    pub limits: Limits,
    pub last: Setpoint,
    /// Whether the acceleration may step, as a trapezoid's does.
    pub steps: bool,
    /// Whether the jerk may be over its limit, as where a stop would leave the travel.
    pub travel_first: bool,
    /// What velocity and acceleration may be while they come down to limits that were lowered.
    fastest: f64,
    strongest: f64,
}

impl Watch {
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            last: Setpoint::default(),
            steps: false,
            travel_first: false,
            fastest: 0.0,
            strongest: 0.0,
        }
    }

    /// Holds what follows to other limits, to which what is too fast must come down.
    pub fn change_limits(&mut self, limits: Limits) {
        self.limits = limits;
        self.fastest = f64::INFINITY;
        self.strongest = self.last.acceleration.counts().abs() as f64;
    }

    /// Whether the speed would pass its limit while the jerk limit takes the acceleration back, or be gone
    /// before no more acceleration is left than the speed may rise with.
    pub fn carries_over_a_limit(&self) -> bool {
        let acceleration = self.last.acceleration.counts() as f64;
        let rises = self.limits.acceleration().counts() as f64;
        let jerk = self.limits.jerk().counts() as f64;
        let along = self.last.velocity.counts() as f64 * acceleration.signum();
        let square = acceleration * acceleration;
        along + square / (2.0 * jerk) > self.limits.velocity().counts() as f64
            || along <= 0.0 && along + (square - rises * rises) / (2.0 * jerk) > 0.0
    }

    /// Holds what follows to the velocity limit, unless it is above that already.
    pub fn adds_no_speed(&mut self) {
        if self.last.velocity.abs() <= self.limits.velocity() {
            self.fastest = 0.0;
        }
    }

    /// The longest that a controlled stop may take, in ticks: the acceleration is taken back, and what
    /// that makes of the speed is lost with a ramp up and a ramp down.
    pub fn longest_stop(&self) -> u64 {
        let acceleration = self.last.acceleration.counts().abs() as f64;
        let jerk = self.limits.jerk().counts() as f64;
        let deceleration = self.limits.deceleration().counts() as f64;
        let speed =
            self.last.velocity.counts().abs() as f64 + acceleration * acceleration / (2.0 * jerk);
        let seconds = acceleration / jerk + speed / deceleration + deceleration / jerk;
        (seconds * (1.0 + 1e-6) / TICK) as u64 + 2
    }

    pub fn check(&mut self, now: Setpoint) -> Result<(), TestCaseError> {
        let (limits, last) = (&self.limits, self.last);
        let counts = |value: i64| value as f64;
        let jerk = counts(limits.jerk().counts());
        let velocity = counts(now.velocity.counts());
        let acceleration = counts(now.acceleration.counts());

        // Above a limit that was lowered the speed comes down, once the acceleration that is left
        // has been taken back.
        let before = counts(last.velocity.counts());
        let left = counts(last.acceleration.counts());
        let carried = before + left * left.abs() / (2.0 * jerk);
        self.fastest = self.fastest.min(before.abs().max(carried.abs()) + 16.0);
        let fastest = counts(limits.velocity().counts()).max(self.fastest);
        prop_assert!(velocity.abs() <= fastest, "velocity {now:?} after {last:?}");
        let slows = velocity * acceleration < 0.0;
        let limit = if velocity == 0.0 {
            limits.acceleration().max(limits.deceleration())
        } else if slows {
            limits.deceleration()
        } else {
            limits.acceleration()
        };
        let strongest = counts(limit.counts()).max(self.strongest);
        prop_assert!(
            acceleration.abs() <= strongest,
            "acceleration {now:?} after {last:?}"
        );
        prop_assert!(limits.allow(now.position), "travel {now:?} after {last:?}");

        // Position, velocity and acceleration belong together: the trapezium rule's error is the
        // third (second, where the acceleration steps) derivative's share of a tick.
        let most =
            counts(limits.acceleration().max(limits.deceleration()).counts()).max(self.strongest);
        let bend = if self.steps || self.travel_first {
            most * TICK * TICK / 2.0
        } else {
            jerk * TICK * TICK * TICK / 6.0
        };
        let moved = counts((now.position - last.position).counts());
        let mean = (velocity + counts(last.velocity.counts())) / 2.0;
        prop_assert!(
            (moved - mean * TICK).abs() <= bend + 2.0,
            "moved {now:?} after {last:?}"
        );
        let change = velocity - counts(last.velocity.counts());
        prop_assert!(
            change.abs() <= most * TICK + ROUNDING,
            "step {now:?} after {last:?}"
        );
        if !self.steps && !self.travel_first {
            let change = acceleration - counts(last.acceleration.counts());
            let allowed = jerk * TICK * (1.0 + 1e-6) + ROUNDING;
            prop_assert!(
                change.abs() <= allowed,
                "jerk {now:?} after {last:?}: {}",
                change / allowed
            );
            let mean = (acceleration + counts(last.acceleration.counts())) / 2.0;
            let change = velocity - counts(last.velocity.counts());
            let bend = jerk * TICK * TICK / 2.0 + 8.0;
            prop_assert!(
                (change - mean * TICK).abs() <= bend,
                "rates {now:?} after {last:?}"
            );
        }
        self.strongest = (self.strongest - jerk * TICK * 0.99).max(0.0);
        self.last = now;
        Ok(())
    }

    /// Checks and folds the ticks after `now` up to `until`.
    pub fn run(&mut self, motion: &mut Motion, now: u64, until: u64) -> Result<(), TestCaseError> {
        for tick in now + 1..=until {
            self.check(motion.at(Tick(tick)))?;
            motion.fold(Tick(tick));
        }
        Ok(())
    }
}
