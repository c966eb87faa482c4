//! What the robot walks in the demonstration.

use crate::bus::Bus;
use crate::client::{Client, StreamEnd};
use crate::gait::{Body, Kind, Quadruped, State};
use crate::robot::Robot;
use crate::walk::{Order, Orders, Phase, Settings, WalkError};
use canter_shared::time::{Tick, Ticks};

/// A slow run, in m/s.
const SPEED: f64 = 0.5;

/// The turn on the way, in rad/s: a radian in two seconds.
const TURNING: f64 = 0.5;

/// Since the first step, in s: when it begins to turn, when it goes straight on, when it stops.
const TURN: f64 = 2.0;
const STRAIGHT_ON: f64 = 3.2;
const STOP: f64 = 4.8;

/// The walk, as it was meant and as it began.
#[derive(Debug, Clone)]
pub struct Walk {
    /// The robot.
    pub quadruped: Quadruped,
    /// When its axes passed the motion's time 0.
    pub start: Tick,
    /// How the stream came out for each axis.
    pub ends: Vec<StreamEnd>,
    /// What all joints should have done, tick by tick from the start on.
    pub ideal: Vec<(Phase, State)>,
}

/// What is asked of the robot, and what it said.
struct Script {
    /// When it took its first step, in s of the motion.
    first_step: Option<f64>,
    /// What is still to come, the last first: when, since the first step, and what.
    orders: Vec<(f64, Order)>,
    refused: Vec<String>,
}

impl Script {
    fn new(body: Body) -> Self {
        let turning = Body {
            yaw_rate: TURNING,
            ..body
        };
        Self {
            first_step: None,
            orders: vec![
                (STOP, Order::Stop),
                (STRAIGHT_ON, Order::Body(body)),
                (TURN, Order::Body(turning)),
            ],
            refused: Vec::new(),
        }
    }
}

impl Orders for Script {
    fn next(&mut self, time: f64, phase: Phase) -> Option<Order> {
        if phase != Phase::Walking {
            return None;
        }
        let first_step = *self.first_step.get_or_insert(time);
        let is_due = |next: &mut (f64, Order)| first_step + next.0 <= time;
        self.orders.pop_if(is_due).map(|(_, order)| order)
    }

    fn refused(&mut self, _: &Order, why: &WalkError) {
        self.refused.push(why.to_string());
    }
}

/// Stands up, trots, turns on the way, sits down. None, with a word, for a robot that cannot: it has
/// not four legs, or they do not reach so far or do not go so fast.
///
/// # Errors
/// Whatever stops it on the way.
pub(super) fn walk<B: Bus>(
    client: &mut Client<B>,
    robot: &Robot,
    say: &mut impl FnMut(&str),
) -> Result<Option<Walk>, WalkError> {
    let body = Body {
        vx: SPEED,
        ..Body::standing(Quadruped::HEIGHT)
    };
    let mut script = Script::new(body);
    let settings = Settings::new(Kind::Trot.gait(), body);
    let walked = match crate::walk::walk(client, robot, &settings, &mut script) {
        // Found out before anything moved.
        Err(WalkError::Gait(why)) => {
            say(&format!("does not walk: {why}"));
            return Ok(None);
        }
        walked => walked?,
    };
    for words in script.refused {
        say(&format!("an order was refused: {words}"));
    }
    let states = walked.replay.states(Ticks(1).seconds())?;
    Ok(Some(Walk {
        ideal: states.collect::<Result<_, _>>()?,
        quadruped: walked.replay.quadruped,
        start: walked.start,
        ends: walked.ends,
    }))
}
