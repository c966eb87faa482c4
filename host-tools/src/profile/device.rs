//! The setpoints that a node would send for a move: the same code, limits and rounding.
//!
//! As `canter move` does it: target rounded to what a frame carries, duration up to whole ticks.
//! Positions are rad.

use super::error::PlanError;
use super::request::{AskedLimits, Kind, Request};
use crate::client::RANGE_MARGIN;
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::trajectory::{Peaks, Sample, Trajectory};
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::motion::{Motion, Move, PlanError as MotionError, Profile, shortest_s_curve};
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use canter_shared::wire::command::wire_position;

/// Seconds between two setpoints.
pub const TICK: f64 = 1e-3;

/// The setpoints of a move, held from tick to tick.
#[derive(Debug, Clone)]
pub struct Setpoints {
    motion: Motion,
    duration: Ticks,
    peaks: Peaks,
}

impl Setpoints {
    /// Plans as `canter move` and the node together do.
    ///
    /// # Errors
    /// What the device's moves do not have, limits that no axis can have, a duration that is too
    /// short, a place outside of the travel.
    pub fn new(request: &Request) -> Result<Self, PlanError> {
        refuse(request)?;
        let limits = limits(request)?;
        let from = wire_position(Position::from_radians(request.from)?);
        let target = wire_position(Position::from_radians(request.to)?);
        let range = (target - from).abs() + RANGE_MARGIN;
        let shortest = match request.kind {
            Kind::Trapezoid => Trapezoid::shortest(range, &limits).map(|shape| shape.duration()),
            Kind::SCurve => shortest_s_curve(range, &limits),
            _ => Beta::shortest(range, &limits),
        }
        .ok_or(MotionError::TooLong)?;
        let duration = match request.duration {
            None => shortest,
            Some(asked) => {
                let ticks = Ticks::from_seconds_ceil(asked).ok_or(MotionError::TooLong)?;
                if ticks < shortest {
                    return Err(ProfileError::TooShort {
                        duration: asked,
                        shortest: shortest.seconds(),
                    }
                    .into());
                }
                ticks
            }
        };
        let profile = match request.kind {
            Kind::Trapezoid => {
                let shape = Trapezoid::within(range, duration, &limits);
                let shape = shape.ok_or(MotionError::TooFast { shortest })?;
                Profile::ShapedTrapezoid {
                    acceleration: shape.acceleration(),
                    deceleration: shape.deceleration(),
                }
            }
            Kind::SCurve => Profile::SCurve,
            _ => Profile::Beta,
        };
        let asked = Move {
            target,
            duration,
            profile,
        };
        let mut motion = Motion::at_rest(from);
        let planned = motion.start(Tick(0), Tick(0), asked, &limits)?;
        let mut setpoints = Self {
            motion,
            duration: Ticks(planned.end.0 as u32),
            peaks: Peaks::default(),
        };
        setpoints.peaks = setpoints.largest();
        Ok(setpoints)
    }

    /// The limits that the move keeps: those that were named, and an axis's defaults.
    pub fn limits(request: &Request) -> AskedLimits {
        let asked = &request.limits;
        AskedLimits {
            velocity: asked.velocity.or(Some(DEFAULT_VALUES.velocity)),
            acceleration: asked.acceleration.or(Some(DEFAULT_VALUES.acceleration)),
            deceleration: asked
                .meant_deceleration()
                .or(Some(DEFAULT_VALUES.deceleration)),
            jerk: asked.jerk.or(Some(DEFAULT_VALUES.jerk)),
        }
    }

    fn sample(&self, tick: u32) -> Sample {
        let setpoint = self.motion.at(Tick(u64::from(tick)));
        let before = self.motion.at(Tick(u64::from(tick.saturating_sub(1))));
        let acceleration = setpoint.acceleration.radians();
        Sample {
            position: setpoint.position.radians(),
            velocity: setpoint.velocity.radians(),
            acceleration,
            // A setpoint has none; this is the change since the last one.
            jerk: (acceleration - before.acceleration.radians()) / TICK,
        }
    }

    fn largest(&self) -> Peaks {
        let ticks = (0..=self.duration.0).map(|tick| self.sample(tick));
        ticks.fold(Peaks::default(), |peaks, sample| Peaks {
            velocity: peaks.velocity.max(sample.velocity.abs()),
            acceleration: peaks.acceleration.max(sample.acceleration.abs()),
            jerk: peaks.jerk.max(sample.jerk.abs()),
        })
    }
}

impl Trajectory for Setpoints {
    fn duration(&self) -> f64 {
        self.duration.seconds()
    }

    /// The last setpoint that was sent by then.
    fn at(&self, time: f64) -> Sample {
        // A time that is written as a whole number of ticks is that tick.
        let ticks = time / TICK;
        let nearest = ticks.round();
        let tick = if (ticks - nearest).abs() < 1e-6 {
            nearest
        } else {
            ticks.floor()
        };
        self.sample(tick.clamp(0.0, f64::from(self.duration.0)) as u32)
    }

    /// The largest of the setpoints; jerk is the change of acceleration from one to the next.
    fn peaks(&self) -> Peaks {
        self.peaks
    }
}

fn refuse(request: &Request) -> Result<(), PlanError> {
    let not = |flag, cure| PlanError::NotOfProfile {
        flag,
        profile: request.kind,
        cure,
    };
    if !matches!(request.kind, Kind::Beta | Kind::Trapezoid | Kind::SCurve) {
        return Err(not("--device", "nodes send beta, trapezoid and s-curve"));
    }
    let cure = "nodes do not take it with a move; leave out --device";
    if request.exponent.is_some() {
        return Err(not("--device with --p", cure));
    }
    for (flag, value) in [
        ("--device with --v0", request.start_velocity),
        ("--device with --v1", request.stop_velocity),
        ("--device with --a0", request.start_acceleration),
        ("--device with --a1", request.stop_acceleration),
    ] {
        if value != 0.0 {
            return Err(not(flag, cure));
        }
    }
    Ok(())
}

fn limits(request: &Request) -> Result<Limits, PlanError> {
    let meant = Setpoints::limits(request);
    Ok(Limits::new(&LimitValues {
        velocity: meant.velocity.unwrap_or(DEFAULT_VALUES.velocity),
        acceleration: meant.acceleration.unwrap_or(DEFAULT_VALUES.acceleration),
        deceleration: meant.deceleration.unwrap_or(DEFAULT_VALUES.deceleration),
        jerk: meant.jerk.unwrap_or(DEFAULT_VALUES.jerk),
        ..DEFAULT_VALUES
    })?)
}
