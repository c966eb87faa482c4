//! From a request to each axis's target, limits and duration, before anything is sent.

use super::request::{Goal, MoveRequest, Overrides, Target};
use super::{Client, ClientError};
use crate::bus::Bus;
use crate::robot::Robot;
use canter_shared::axis::state::State;
use canter_shared::limits::{DEFAULT_VALUES, LimitValues, Limits};
use canter_shared::motion::beta::Beta;
use canter_shared::motion::shortest_s_curve;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::time::{LONGEST_MOVE, Ticks};
use canter_shared::units::{Acceleration, Position, Velocity};
use canter_shared::wire::command::{
    ProfileKind, wire_acceleration, wire_jerk, wire_position, wire_velocity_limit,
};
use canter_shared::wire::id::AxisId;
use canter_shared::wire::layout::{
    ACCELERATION_FACTOR, JERK_FACTOR, POSITION_STEP, VELOCITY_LIMIT_FACTOR,
};
use std::f64::consts::TAU;

/// How far from the planned range the axis's own may be: what the wire rounds off the position
/// it reported and off the target, twice each.
pub(crate) const RANGE_MARGIN: Position = Position::from_counts(4 * POSITION_STEP.counts());

/// What one axis is going to be asked for.
pub(super) struct Planned {
    pub axis: AxisId,
    pub target: Position,
    pub duration: Ticks,
    pub limits: Limits,
    pub range: Position,
}

impl<B: Bus> Client<B> {
    /// Whether all of `axes` take moves, as far as is known.
    pub(super) fn check_enabled(&self, axes: &[AxisId]) -> Result<(), ClientError> {
        for axis in axes {
            let known = self.axes.get(axis);
            if let Some(fault) = known.and_then(|known| known.fault) {
                return Err(ClientError::Faulted { axis: *axis, fault });
            }
            match known.and_then(|known| known.state) {
                Some(State::OperationEnabled) => {}
                Some(state) => return Err(ClientError::NotEnabled { axis: *axis, state }),
                None => {
                    let bus = self.bus.description();
                    return Err(ClientError::NoAnswer { axis: *axis, bus });
                }
            }
        }
        Ok(())
    }

    /// Checks the request against all that is known, and finds each axis's duration.
    pub(super) fn plan(
        &mut self,
        robot: &Robot,
        request: &MoveRequest,
    ) -> Result<Vec<Planned>, ClientError> {
        let axes: Vec<AxisId> = request.goals.iter().map(|goal| goal.axis).collect();
        self.check_enabled(&axes)?;
        // Durations are found from where the axes are once they rest.
        let positions = self.wait_for_rest(&axes)?;
        let mut plan = Vec::new();
        for goal in &request.goals {
            let at = positions.get(&goal.axis).copied().unwrap_or_default();
            plan.push(plan_axis(goal, at, robot, request)?);
        }
        if let Some(asked) = request.duration {
            for planned in &mut plan {
                let ticks = Ticks::from_seconds_ceil(asked)
                    .filter(|ticks| *ticks <= LONGEST_MOVE)
                    .ok_or(ClientError::TooLong { axis: planned.axis })?;
                if ticks < planned.duration {
                    return Err(ClientError::TooShort {
                        axis: planned.axis,
                        asked,
                        shortest: planned.duration.seconds(),
                    });
                }
                planned.duration = ticks;
            }
        } else if !request.independent {
            let longest = plan.iter().map(|planned| planned.duration).max();
            for planned in &mut plan {
                planned.duration = longest.unwrap_or_default();
            }
        }
        Ok(plan)
    }
}

fn plan_axis(
    goal: &Goal,
    at: f64,
    robot: &Robot,
    request: &MoveRequest,
) -> Result<Planned, ClientError> {
    let axis = goal.axis;
    let own = robot.limits(axis);
    let mut limits = narrowed(axis, &own, &request.limits)?;
    if request.profile == ProfileKind::SCurve && request.limits != Overrides::default() {
        limits = on_the_wire(axis, &limits)?;
    }
    let radians = match goal.target {
        Target::Absolute(radians) => radians,
        Target::Relative(radians) => at + radians,
    };
    let outside = ClientError::OutsideTravel {
        axis,
        target: radians,
        minimum: own.position_minimum().radians(),
        maximum: own.position_maximum().radians(),
    };
    let Ok(target) = Position::from_radians(radians) else {
        return Err(outside);
    };
    let target = own.snap(target, POSITION_STEP);
    if !own.allow(target) {
        return Err(outside);
    }
    let target = wire_position(target);
    let from =
        Position::from_radians(at).map_err(|source| ClientError::Quantity { axis, source })?;
    let range = (target - from).abs() + RANGE_MARGIN;
    let duration = match request.profile {
        ProfileKind::Beta => Beta::shortest(range, &limits),
        ProfileKind::Trapezoid => {
            Trapezoid::shortest(range, &limits).map(|trapezoid| trapezoid.duration())
        }
        ProfileKind::SCurve => shortest_s_curve(range, &limits),
    };
    Ok(Planned {
        axis,
        target,
        duration: duration.ok_or(ClientError::TooLong { axis })?,
        limits,
        range,
    })
}

/// The limits that the wire can tell an axis, at most these.
fn on_the_wire(axis: AxisId, limits: &Limits) -> Result<Limits, ClientError> {
    let velocity = wire_velocity_limit(limits.velocity());
    let acceleration = wire_acceleration(limits.acceleration());
    let deceleration = wire_acceleration(limits.deceleration());
    let jerk = wire_jerk(limits.jerk());
    let least = |field, value, step: f64, unit| ClientError::BelowStep {
        axis,
        field,
        value,
        least: step * TAU,
        unit,
    };
    limits
        .narrowed(velocity, acceleration, deceleration, jerk)
        .ok_or(if velocity == Velocity::ZERO {
            let value = limits.velocity().radians();
            least("--vmax", value, VELOCITY_LIMIT_FACTOR, "rad/s")
        } else if acceleration == Acceleration::ZERO {
            let value = limits.acceleration().radians();
            least("--amax", value, ACCELERATION_FACTOR, "rad/s^2")
        } else if deceleration == Acceleration::ZERO {
            let value = limits.deceleration().radians();
            least("--dmax", value, ACCELERATION_FACTOR, "rad/s^2")
        } else {
            let value = limits.jerk().radians();
            least("--jmax", value, JERK_FACTOR, "rad/s^3")
        })
}

/// The axis's limits with those of one move, which must not be above them.
fn narrowed(axis: AxisId, own: &Limits, wanted: &Overrides) -> Result<Limits, ClientError> {
    let pick = |field: &'static str, own: f64, wanted: Option<f64>| match wanted {
        // The last digits of a limit are lost in its counts: who asks for the limit gets it.
        Some(value) if value > own * (1.0 + 1e-9) => Err(ClientError::AboveLimit {
            axis,
            field,
            value,
            limit: (own * 1e9).round() / 1e9,
        }),
        Some(value) => Ok(value),
        None => Ok(own),
    };
    // Values that no axis could have are refused by name before they are compared.
    Limits::new(&LimitValues {
        velocity: wanted.velocity.unwrap_or(DEFAULT_VALUES.velocity),
        acceleration: wanted.acceleration.unwrap_or(DEFAULT_VALUES.acceleration),
        deceleration: wanted.deceleration.unwrap_or(DEFAULT_VALUES.deceleration),
        jerk: wanted.jerk.unwrap_or(DEFAULT_VALUES.jerk),
        ..DEFAULT_VALUES
    })?;
    let limits = LimitValues {
        velocity: pick("--vmax", own.velocity().radians(), wanted.velocity)?,
        acceleration: pick("--amax", own.acceleration().radians(), wanted.acceleration)?,
        deceleration: pick("--dmax", own.deceleration().radians(), wanted.deceleration)?,
        jerk: pick("--jmax", own.jerk().radians(), wanted.jerk)?,
        ..DEFAULT_VALUES
    };
    Ok(Limits::new(&limits)?)
}
