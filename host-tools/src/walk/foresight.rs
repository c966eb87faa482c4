//! An order tried out ahead, refused before it breaks a limit.
//!
//! A clone of the motion's knots is played ahead with the order in it: until it has come in wholly and
//! the gait has gone round twice, and then on to the seat. Each cubic between two knots is held
//! against the limits as its axis will do it. What is then walked without another order are these
//! very knots.

use super::error::WalkError;
use super::joints::JOINTS;
use super::knots::{Knots, PERIOD};
use super::order::Order;
use super::sequence::Phase;
use crate::client::StreamKnot;
use crate::gait::{GaitError, LEG_NAMES, Quadruped};
use crate::path::AxisBounds;
use crate::path::knots::{Rates, cubic_peaks, usable};

/// Cycles that are looked at after all has come in.
const CYCLES: f64 = 2.0;

/// A gait as slow as this is looked at from knot to knot, in s; slower ones in as many parts. A trot has
/// 40 knots in a cycle.
const FINE_CYCLE: f64 = 40.0 * PERIOD;

/// Ticks that a stop may lose, in s, as the stream on the axis counts them.
const STOP_TIME: f64 = 0.002;

/// The limits of all axes, and what of them knots may use.
#[derive(Debug, Clone)]
pub(super) struct Foresight {
    axes: [u8; JOINTS],
    bounds: [AxisBounds; JOINTS],
}

impl Foresight {
    pub(super) fn new(quadruped: &Quadruped) -> Self {
        let leg = |joint: usize| &quadruped.mounts[joint / 3];
        Self {
            axes: std::array::from_fn(|joint| leg(joint).leg.axes[joint % 3].get()),
            bounds: std::array::from_fn(|joint| {
                AxisBounds::of_limits(&leg(joint).limits[joint % 3])
            }),
        }
    }

    /// The motion from where it is, with an order or without, and from there to the seat.
    ///
    /// # Errors
    /// The first limit or reach that would be broken.
    pub(super) fn look(&self, knots: &Knots, order: Option<&Order>) -> Result<(), WalkError> {
        let mut ahead = Glance::new(self, knots);
        if let Some(order) = order {
            ahead.knots.order(order)?;
        }
        ahead.settle()?;
        ahead.sit()
    }

    /// The whole motion before it begins, with stops at so many moments of a cycle.
    ///
    /// # Errors
    /// The first limit or reach that would be broken.
    pub(super) fn look_at_stops(&self, knots: &Knots, moments: u32) -> Result<(), WalkError> {
        let mut ahead = Glance::new(self, knots);
        ahead.settle()?;
        let part = ahead.knots.sequence().period() / f64::from(moments);
        for _ in 0..moments {
            ahead.clone().sit()?;
            ahead.run(part)?;
        }
        Ok(())
    }

    /// Whether the cubic from one knot to the next keeps the limits, with room for the wire's rounding.
    fn hold(
        &self,
        from: &[StreamKnot],
        to: &[StreamKnot],
        period: f64,
        time: f64,
    ) -> Result<(), GaitError> {
        for (joint, ((from, to), bounds)) in from.iter().zip(to).zip(&self.bounds).enumerate() {
            let over = |what, value, limit, unit| {
                Err(GaitError::Limit {
                    axis: self.axes[joint],
                    leg: LEG_NAMES[joint / 3],
                    what,
                    value,
                    limit,
                    unit,
                    time,
                })
            };
            let Rates {
                velocity,
                acceleration,
            } = cubic_peaks(from, to, period);
            let most = usable(bounds, period);
            if velocity > most.velocity {
                return over("a velocity", velocity, most.velocity, "rad/s");
            }
            if acceleration > most.acceleration {
                return over(
                    "an acceleration",
                    acceleration,
                    most.acceleration,
                    "rad/s^2",
                );
            }
            // An axis must be able to stop inside its travel from each knot.
            let way =
                to.velocity.abs() * (STOP_TIME + to.velocity.abs() / (2.0 * bounds.acceleration));
            let end = to.position + way.copysign(to.velocity);
            for position in [to.position, end] {
                let inside = position.clamp(bounds.minimum, bounds.maximum);
                if position != inside {
                    return over("a position, or a way to stop,", position, inside, "rad");
                }
            }
        }
        Ok(())
    }
}

/// A motion played ahead.
#[derive(Clone)]
struct Glance<'a> {
    foresight: &'a Foresight,
    knots: Knots,
    given: Option<Vec<StreamKnot>>,
    /// From the last knot to the next, in s.
    period: f64,
}

impl<'a> Glance<'a> {
    fn new(foresight: &'a Foresight, knots: &Knots) -> Self {
        let mut knots = knots.clone();
        let given = knots.given().map(<[_]>::to_vec);
        let period = knots.period();
        let stride = (knots.sequence().period() / FINE_CYCLE).floor().max(1.0);
        knots.stride(stride as u64);
        Self {
            foresight,
            given,
            knots,
            period,
        }
    }

    /// One more knot. Tells whether there was one.
    fn step(&mut self) -> Result<bool, WalkError> {
        let time = self.knots.time();
        let Some(knots) = self.knots.next()? else {
            return Ok(false);
        };
        match &mut self.given {
            None => self.given = Some(knots.to_vec()),
            Some(given) => {
                self.foresight.hold(given, knots, self.period, time)?;
                given.copy_from_slice(knots);
            }
        }
        self.period = self.knots.period();
        Ok(true)
    }

    /// For some s.
    fn run(&mut self, seconds: f64) -> Result<(), WalkError> {
        let end = self.knots.time() + seconds;
        while self.knots.time() < end && self.step()? {}
        Ok(())
    }

    /// Until all that was asked for has come in, and some cycles more.
    fn settle(&mut self) -> Result<(), WalkError> {
        while !self.knots.sequence().is_settled() && self.step()? {}
        self.run(CYCLES * self.knots.sequence().period())
    }

    /// To the seat.
    fn sit(&mut self) -> Result<(), WalkError> {
        if self.knots.sequence().phase() != Phase::Sitting {
            self.knots.order(&Order::Stop)?;
        }
        while self.step()? {}
        Ok(())
    }
}
