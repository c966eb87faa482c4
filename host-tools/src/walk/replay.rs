//! The motion once more, from the orders that were taken.

use super::error::WalkError;
use super::joints::{JOINTS, axes, positions};
use super::knots::{Knots, PACE};
use super::order::Order;
use super::sequence::{Phase, Sequence, Settings};
use crate::client::StreamKnot;
use crate::gait::{GaitError, Quadruped, State};
use canter_shared::motion::Setpoint;
use canter_shared::motion::stream::{Knot, Stream};
use canter_shared::time::{TICKS_PER_SECOND, Tick};
use canter_shared::units::{Position, UnitError, Velocity};
use canter_shared::wire::command::{wire_position, wire_velocity};

/// What a walk was, to go through it again: for what setpoints should have been.
#[derive(Debug, Clone)]
pub struct Replay {
    /// The robot.
    pub quadruped: Quadruped,
    /// How it began.
    pub settings: Settings,
    /// The orders that were taken, each with the time in s of the motion at which it was.
    pub orders: Vec<(f64, Order)>,
    /// How long the motion lasted, in s.
    pub duration: f64,
}

impl Replay {
    /// What all joints did, every `step` s from 0 to the end, and in which phase.
    ///
    /// # Errors
    /// Settings or orders that were never walked. The first error is the last item.
    pub fn states(
        &self,
        step: f64,
    ) -> Result<impl Iterator<Item = Result<(Phase, State), GaitError>>, GaitError> {
        let mut player = Player::new(self)?;
        let (duration, mut index, mut is_over) = (self.duration, 0u32, false);
        Ok(std::iter::from_fn(move || {
            // What rounding makes of a whole number of steps is that number.
            let time = (f64::from(index) * step).min(duration);
            if is_over || !time.is_finite() {
                return None;
            }
            index += 1;
            let state = player.advance(time);
            is_over = state.is_err() || time > duration - 1e-6 * step;
            Some(state)
        }))
    }

    /// How far setpoints that axes make of the knots are from what the joints were to do, at the worst
    /// tick of the worst axis, in rad. What the wire rounds off is in it; what gets lost is not.
    ///
    /// # Errors
    /// Settings or orders that were never walked.
    pub fn deviation(&self) -> Result<f64, WalkError> {
        let axes = axes(&self.quadruped);
        let limits = self.quadruped.mounts.iter().flat_map(|mount| mount.limits);
        let limits: Vec<_> = limits.collect();
        let mut player = Player::new(self)?;
        let mut knots = Knots::new(Sequence::new(self.quadruped.clone(), &self.settings)?)?;
        let mut orders = self.orders.iter().peekable();
        let mut streams: Vec<Stream> = Vec::new();
        let mut worst: f64 = 0.0;
        let (mut number, mut tick) = (0u8, 0);
        loop {
            while let Some((_, order)) = orders.next_if(|(time, _)| *time <= knots.time()) {
                knots.order(order)?;
            }
            let Some(given) = knots.next()? else {
                return Ok(worst);
            };
            let given: Vec<Knot> = given.iter().map(on_the_wire).collect::<Result<_, _>>()?;
            if streams.is_empty() {
                let begin = |knot: &Knot| {
                    let state = Setpoint {
                        position: knot.position,
                        velocity: knot.velocity,
                        ..Setpoint::default()
                    };
                    Stream::new(Tick(0), number, state, PACE.period)
                };
                streams = given.iter().map(begin).collect();
                continue;
            }
            number = number.wrapping_add(1);
            for (joint, (stream, knot)) in streams.iter_mut().zip(&given).enumerate() {
                stream
                    .push(Tick(tick), number, knot, &limits[joint])
                    .map_err(|source| WalkError::Knot {
                        axis: axes[joint].get(),
                        source,
                    })?;
            }
            let end = tick + u64::from(PACE.period.get());
            while tick < end {
                tick += 1;
                let time = tick as f64 / TICKS_PER_SECOND as f64;
                let (_, state) = player.advance(time.min(self.duration))?;
                let ideal: [f64; JOINTS] = positions(&state);
                for (stream, ideal) in streams.iter().zip(ideal) {
                    let off = stream.at(Tick(tick)).position.radians() - ideal;
                    worst = worst.max(off.abs());
                }
            }
        }
    }
}

fn on_the_wire(knot: &StreamKnot) -> Result<Knot, UnitError> {
    Ok(Knot {
        position: wire_position(Position::from_radians(knot.position)?),
        velocity: wire_velocity(Velocity::from_radians(knot.velocity)?),
        acceleration: None,
    })
}

/// The motion with its orders.
struct Player<'a> {
    sequence: Sequence,
    orders: std::slice::Iter<'a, (f64, Order)>,
}

impl<'a> Player<'a> {
    fn new(replay: &'a Replay) -> Result<Self, GaitError> {
        Ok(Self {
            sequence: Sequence::new(replay.quadruped.clone(), &replay.settings)?,
            orders: replay.orders.iter(),
        })
    }

    fn advance(&mut self, time: f64) -> Result<(Phase, State), GaitError> {
        while let Some((when, order)) = self.orders.as_slice().first()
            && *when <= time
        {
            self.sequence.advance(*when)?;
            self.sequence.order(order)?;
            self.orders.next();
        }
        let state = self.sequence.advance(time)?;
        Ok((self.sequence.phase(), state))
    }
}
