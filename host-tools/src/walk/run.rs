//! A walk on a client: up, orders, down.

use super::error::WalkError;
use super::foresight::Foresight;
use super::joints::{axes, positions};
use super::knots::{Knots, PACE, PERIOD};
use super::order::Order;
use super::replay::Replay;
use super::sequence::{Phase, Sequence, Settings};
use crate::bus::Bus;
use crate::client::{Client, Goal, MoveRequest, Overrides, StreamEnd, StreamKnot, Target};
use crate::gait::Quadruped;
use crate::robot::Robot;
use canter_shared::time::Tick;
use canter_shared::wire::command::ProfileKind;

/// The fastest that axes go to where the motion begins, in rad/s: a leg that touches somebody
/// there should not hurt.
const APPROACH_VELOCITY: f64 = 1.5;

/// And how hard they may set out, in rad/s^2.
const APPROACH_ACCELERATION: f64 = 10.0;

/// Knots from one order to the next: looking ahead takes milliseconds, and knots must not wait.
const KNOTS_PER_ORDER: u64 = 5;

/// Moments of a cycle at which a stop is tried before the start.
const MOMENTS: u32 = 8;

/// How long a stop that would break a limit is put off, in s beyond two cycles: then it is taken
/// all the same.
const STOP_PATIENCE: f64 = 1.0;

/// Where orders come from: a person's keys, lines of a file, a script.
pub trait Orders {
    /// The next order that is there at `time`, in s of the motion, while the robot is in `phase`. It
    /// is asked every 50 ms of the motion until a stop is taken, and must answer at once.
    fn next(&mut self, time: f64, phase: Phase) -> Option<Order>;

    /// Hears that an order was refused, and why. The robot goes on as before.
    fn refused(&mut self, order: &Order, why: &WalkError);

    /// Hears, once for each knot, how far the motion is.
    fn passes(&mut self, time: f64, phase: Phase) {
        let _ = (time, phase);
    }
}

/// How a walk came out.
#[derive(Debug, Clone)]
pub struct Walked {
    /// When the axes passed the motion's time 0: the tick that all of them began at.
    pub start: Tick,
    /// Each axis at the end, in the order of [`axes`](super::joints::axes).
    pub ends: Vec<StreamEnd>,
    /// What it was.
    pub replay: Replay,
}

/// Walks a robot whose axes the client holds and has enabled: a synchronised move of the joints to
/// where the motion begins, then one stream until the robot sits.
///
/// # Errors
/// A motion that breaks a limit or a reach: nothing moves then. Whatever stops it later: all axes are
/// then stopped together.
pub fn walk<B: Bus>(
    client: &mut Client<B>,
    robot: &Robot,
    settings: &Settings,
    orders: &mut dyn Orders,
) -> Result<Walked, WalkError> {
    let quadruped = Quadruped::of(robot)?;
    let knots = try_out(&quadruped, settings)?;
    let axes = axes(&quadruped);
    client.move_together(robot, &approach(&quadruped, settings)?, |_| {})?;
    let mut led = Led {
        foresight: Foresight::new(&quadruped),
        knots,
        orders,
        has_stopped: false,
        waiting: None,
        taken: Vec::new(),
        error: None,
    };
    let streamed = client.stream(&axes, PACE, std::iter::from_fn(|| led.next()));
    if let Some(error) = led.error {
        return Err(error);
    }
    let ends = streamed?;
    Ok(Walked {
        start: ends.first().map(|end| end.leaves).unwrap_or_default(),
        ends,
        replay: Replay {
            quadruped,
            settings: *settings,
            orders: led.taken,
            duration: led.knots.time(),
        },
    })
}

/// The motion from its beginning, once all of it has been seen to keep the limits without an order, and
/// with a stop at several moments.
///
/// # Errors
/// The first limit or reach that is broken.
pub(super) fn try_out(quadruped: &Quadruped, settings: &Settings) -> Result<Knots, WalkError> {
    let knots = Knots::new(Sequence::new(quadruped.clone(), settings)?)?;
    Foresight::new(quadruped).look_at_stops(&knots, MOMENTS)?;
    Ok(knots)
}

/// The move to where the motion begins.
fn approach(quadruped: &Quadruped, settings: &Settings) -> Result<MoveRequest, WalkError> {
    let start = Sequence::new(quadruped.clone(), settings)?.advance(0.0)?;
    let goals = axes(quadruped).into_iter().zip(positions(&start));
    let limits = quadruped.mounts.iter().flat_map(|mount| &mount.limits);
    let (mut velocity, mut acceleration) = (APPROACH_VELOCITY, APPROACH_ACCELERATION);
    for limits in limits {
        velocity = velocity.min(limits.velocity().radians());
        acceleration = acceleration.min(limits.slower_acceleration().radians());
    }
    Ok(MoveRequest {
        goals: goals
            .map(|(axis, position)| Goal {
                axis,
                target: Target::Absolute(position),
            })
            .collect(),
        profile: ProfileKind::Beta,
        duration: None,
        limits: Overrides {
            velocity: Some(velocity),
            acceleration: Some(acceleration),
            deceleration: Some(acceleration),
            jerk: None,
        },
        independent: false,
    })
}

/// A motion under way.
struct Led<'a> {
    foresight: Foresight,
    knots: Knots,
    orders: &'a mut dyn Orders,
    /// Whether a stop was taken.
    has_stopped: bool,
    /// A stop that would break a limit now, and until when it is put off.
    waiting: Option<f64>,
    taken: Vec<(f64, Order)>,
    error: Option<WalkError>,
}

impl Led<'_> {
    /// The next knots for the stream; none after the last, or where something is wrong.
    fn next(&mut self) -> Option<Vec<StreamKnot>> {
        // The first is where the axes rest.
        if self.knots.given().is_none()
            && let Err(error) = self.knots.next()
        {
            self.error = Some(error.into());
            return None;
        }
        self.hear();
        match self.knots.next() {
            Ok(knots) => knots.map(<[_]>::to_vec),
            Err(error) => {
                self.error = Some(error.into());
                None
            }
        }
    }

    /// Asks for an order, and looks ahead before it takes it.
    fn hear(&mut self) {
        let (time, phase) = (self.knots.time(), self.knots.sequence().phase());
        self.orders.passes(time, phase);
        if self.has_stopped || !self.knots.number().is_multiple_of(KNOTS_PER_ORDER) {
            return;
        }
        let order = match self.waiting {
            Some(_) => Order::Stop,
            None => match self.orders.next(time, phase) {
                Some(order) => order,
                None => return,
            },
        };
        let seen = self.foresight.look(&self.knots, Some(&order));
        let is_over = self.waiting.is_some_and(|until| time >= until);
        match seen {
            Err(_) if order == Order::Stop && !is_over => {
                let cycles = 2.0 * self.knots.sequence().period();
                self.waiting = self.waiting.or(Some(time + cycles + STOP_PATIENCE));
            }
            Err(why) if order != Order::Stop => self.orders.refused(&order, &why),
            _ => match self.knots.order(&order) {
                Ok(()) => {
                    self.has_stopped = order == Order::Stop;
                    self.taken.push((time, order));
                }
                Err(why) => self.orders.refused(&order, &why.into()),
            },
        }
    }
}

// An order is heard within the look-ahead of the stream.
const _: () = assert!(KNOTS_PER_ORDER as f64 * PERIOD <= PACE.look_ahead.0 as f64 * 1e-3);
