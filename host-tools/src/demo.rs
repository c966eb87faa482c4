//! The demonstration: a simulated robot is scanned, enabled, moved together, walked at a trot, stopped
//! in mid-move and disabled, and all that its nodes did is recorded and measured.
//!
//! | file | what it holds |
//! |---|---|
//! | `walk` | what is walked |
//! | `recording` | every frame, and every tick of every axis |
//! | `measure` | what the recording says |
//! | `promise` | what is asked of it |
//! | `posture` | where the robot really was, by its joints |
//! | `page` | the report |
//! | `scene` | the robot from the side, moving |

mod measure;
mod page;
mod posture;
mod promise;
mod recording;
mod scene;
mod walk;

use crate::client::{Arrival, Client, ClientError, Goal, MoveRequest, Overrides, Target};
use crate::robot::Robot;
use crate::sim::{Configuration, Load, SimulatedBus, Transmission};
use crate::walk::WalkError;
use canter_shared::time::Tick;
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;
use recording::Recorder;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::atomic::Ordering;

pub use measure::{Measurements, MoveMeasurement, WalkMeasurement};
pub use page::{page, rows};
pub use promise::{Promise, promises};
pub use recording::{Sample, Samples};
pub use walk::Walk;

/// The session of the demonstration: there is nobody else on its bus.
const SESSION: u16 = 0xCA27;

/// The part of the last move after which it is stopped: at its quickest.
const STOP_AFTER: f64 = 0.5;

/// A move of the demonstration, as it was asked for and as it came out.
#[derive(Debug, Clone)]
pub struct Performed {
    /// What it shows.
    pub title: &'static str,
    /// Along which profile.
    pub profile: ProfileKind,
    /// How it came out for each axis.
    pub arrivals: Vec<Arrival>,
}

/// What happened.
#[derive(Debug, Clone)]
pub struct Performance {
    /// The axes that answered to the scan.
    pub axes: Vec<AxisId>,
    /// The moves that arrived.
    pub moves: Vec<Performed>,
    /// The walk; none where the robot cannot walk.
    pub walk: Option<Walk>,
    /// When the last move was stopped on its way, and when all axes rested.
    pub stopped: (Tick, Tick),
    /// Every frame, in the order of the bus.
    pub frames: Vec<Transmission>,
    /// Every tick of every axis.
    pub samples: Samples,
    /// How much the bus carried.
    pub load: Load,
    /// Where all chance came from.
    pub seed: u64,
}

fn goals(axes: &[AxisId], angle: impl Fn(usize) -> f64) -> Vec<Goal> {
    axes.iter()
        .enumerate()
        .map(|(index, axis)| Goal {
            axis: *axis,
            target: Target::Absolute(angle(index)),
        })
        .collect()
}

/// Runs the demonstration on a robot; the same configuration gives the same performance.
///
/// # Errors
/// What a client on a real bus would meet: targets outside the travel of the robot file, say, or a trot
/// beyond its limits.
pub fn perform(
    robot: &Robot,
    configuration: &Configuration,
    mut say: impl FnMut(&str),
) -> Result<Performance, WalkError> {
    let mut bus = SimulatedBus::new(configuration);
    let recorder = Rc::new(RefCell::new(Recorder::default()));
    bus.observe(Rc::clone(&recorder));
    let mut client = Client::new(bus, SESSION);

    let nodes = client.scan()?;
    let axes: Vec<AxisId> = nodes.iter().map(|node| node.axis).collect();
    say(&format!("scanned: {} axes answer", axes.len()));
    client.check(&axes)?;
    client.hold(&axes)?;
    client.enable(&axes)?;
    say("enabled");

    let mut moves = Vec::new();
    // Each axis goes somewhere else, there and back, and all arrive together.
    let spread = |index: usize| (index % 3) as f64 - 1.3 + 0.17 * (index / 3) as f64;
    let back = |index: usize| -0.5 * spread(index);
    for (title, profile, goals) in [
        (
            "beta S-curve, together",
            ProfileKind::Beta,
            goals(&axes, spread),
        ),
        (
            "trapezoid, together",
            ProfileKind::Trapezoid,
            goals(&axes, back),
        ),
        (
            "beta S-curve, home",
            ProfileKind::Beta,
            goals(&axes, |_| 0.0),
        ),
    ] {
        let request = request(goals, profile);
        let arrivals = client.move_together(robot, &request, |_| {})?;
        say(&format!("moved: {title}"));
        moves.push(Performed {
            title,
            profile,
            arrivals,
        });
    }

    let walk = walk::walk(&mut client, robot, &mut say)?;
    if walk.is_some() {
        say("walked at a trot");
    }

    let far = request(goals(&axes, |index| 8.0 * spread(index)), ProfileKind::Beta);
    let interrupt = client.interrupt();
    let ended = client.move_together(robot, &far, |progress| {
        if progress.elapsed >= STOP_AFTER * progress.duration {
            interrupt.store(true, Ordering::Relaxed);
        }
    });
    match ended {
        Err(ClientError::Interrupted) => say("stopped in mid-move"),
        Err(error) => return Err(error.into()),
        Ok(_) => {}
    }
    let rest = client.now().next_tick();
    client.disable(&axes)?;
    client.release()?;
    say("disabled");

    let load = client.bus().load();
    let mut recorder = recorder.take();
    let stopped = measure::stop_tick(&recorder.frames).unwrap_or(rest);
    Ok(Performance {
        axes,
        moves,
        walk,
        stopped: (stopped, rest),
        frames: std::mem::take(&mut recorder.frames),
        samples: recorder.into_samples(),
        load,
        seed: configuration.seed,
    })
}

fn request(goals: Vec<Goal>, profile: ProfileKind) -> MoveRequest {
    MoveRequest {
        goals,
        profile,
        duration: None,
        limits: Overrides::default(),
        independent: false,
    }
}
