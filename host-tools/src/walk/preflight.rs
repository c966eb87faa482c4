//! What is checked before anything moves.

use super::budget::Budget;
use super::error::WalkError;
use super::joints::{JOINTS, axes, positions};
use super::run::try_out;
use super::sequence::{Sequence, Settings};
use crate::bus::{Bitrate, Bus};
use crate::client::{Client, ClientError};
use crate::gait::{LEG_NAMES, Quadruped};
use crate::robot::Robot;

/// How far an axis may be from where a walk may begin, in rad.
const TOLERANCE: f64 = 0.1;

/// One thing that was looked at and is well.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What was looked at.
    pub what: &'static str,
    /// What was found.
    pub found: String,
}

/// A walk that may begin.
#[derive(Debug, Clone)]
pub struct Preflight {
    /// What was looked at, in this order.
    pub items: Vec<Item>,
    /// The robot with the limits that count.
    pub robot: Robot,
    /// How it walks; begins standing where it stands already.
    pub settings: Settings,
    /// What it takes of the bus.
    pub budget: Budget,
}

/// Checks all that can be checked before anything moves. Changes nothing but what the client knows.
///
/// Where `limits_are_named`, those of `robot` count; otherwise those that the axes themselves have.
///
/// # Errors
/// The first thing that is not as it must be.
pub fn preflight<B: Bus>(
    client: &mut Client<B>,
    robot: &Robot,
    limits_are_named: bool,
    settings: &Settings,
    bitrate: Bitrate,
) -> Result<Preflight, WalkError> {
    let mut items = Vec::new();
    let mut found = |what, found| items.push(Item { what, found });
    settings.check()?;
    let quadruped = Quadruped::of(robot)?;
    let axes = axes(&quadruped);
    found(
        "robot",
        format!("four legs of three axes: {}", names(&quadruped)),
    );

    client.check(&axes)?;
    client.listen()?;
    found(
        "axes",
        format!("{JOINTS} answer, each once, in this protocol"),
    );

    for axis in axes {
        let known = client.axes().get(&axis);
        if let Some(fault) = known.and_then(|known| known.fault) {
            return Err(ClientError::Faulted { axis, fault }.into());
        }
    }
    found("faults", String::from("none is latched"));

    let read = client.read_robot(&axes)?;
    let (robot, whose) = if limits_are_named {
        (robot.clone(), "the robot file")
    } else {
        (robot.with_axes_of(&read), "the axes")
    };
    let quadruped = Quadruped::of(&robot)?;
    found("limits", format!("as {whose} say"));

    let here = where_they_are(client, &quadruped)?;
    let (pose, settings) = pose(&quadruped, settings, &here)?;
    found("pose", format!("{pose}, within {TOLERANCE} rad"));

    let whole = try_out(&quadruped, &settings)?;
    drop(whole);
    found(
        "motion",
        String::from("inside reach and limits, with a stop at any time"),
    );

    let budget = Budget::new(&read, &axes, bitrate);
    budget.check()?;
    let load = 1e2 * budget.load();
    let rate = bitrate.bits_per_second();
    found("bus", format!("{load:.0} % of {rate} bit/s at worst"));
    Ok(Preflight {
        items,
        robot,
        settings,
        budget,
    })
}

fn names(quadruped: &Quadruped) -> String {
    let names = quadruped.mounts.iter().map(|mount| mount.leg.name.as_str());
    names.collect::<Vec<_>>().join(", ")
}

fn where_they_are<B: Bus>(
    client: &Client<B>,
    quadruped: &Quadruped,
) -> Result<[f64; JOINTS], WalkError> {
    let mut here = [0.0; JOINTS];
    for (axis, here) in axes(quadruped).into_iter().zip(&mut here) {
        let position = client.axes().get(&axis).and_then(|known| known.position);
        let bus = || client.bus().description();
        let position = position.ok_or_else(|| ClientError::NoAnswer { axis, bus: bus() })?;
        *here = position.radians();
    }
    Ok(here)
}

/// Where the robot is, and how it walks from there.
fn pose(
    quadruped: &Quadruped,
    settings: &Settings,
    here: &[f64; JOINTS],
) -> Result<(&'static str, Settings), WalkError> {
    let start = |begins_standing| {
        let settings = Settings {
            begins_standing,
            ..*settings
        };
        let state = Sequence::new(quadruped.clone(), &settings)?.advance(0.0)?;
        Ok::<_, WalkError>((positions(&state), settings))
    };
    let hanging = [0.0; JOINTS];
    let (sitting, sits) = start(false)?;
    let (standing, stands) = start(true)?;
    let off = |pose: &[f64; JOINTS], joint: usize| (here[joint] - pose[joint]).abs();
    for (pose, name, settings) in [
        (&standing, "it stands", stands),
        (&sitting, "it sits", sits),
        (&hanging, "its legs hang", sits),
    ] {
        if (0..JOINTS).all(|joint| off(pose, joint) <= TOLERANCE) {
            return Ok((name, settings));
        }
    }
    // Told of the pose that it is nearest to.
    let worst = |pose: &[f64; JOINTS]| {
        let joints = (0..JOINTS).map(|joint| (off(pose, joint), joint));
        joints.max_by(|one, other| one.0.total_cmp(&other.0))
    };
    let poses = [&standing, &sitting, &hanging]
        .into_iter()
        .filter_map(worst);
    let nearest = poses.min_by(|one, other| one.0.total_cmp(&other.0));
    let joint = nearest.map_or(0, |(_, joint)| joint);
    Err(WalkError::Pose {
        axis: axes(quadruped)[joint].get(),
        leg: LEG_NAMES[joint / 3],
        position: here[joint],
        hanging: hanging[joint],
        sitting: sitting[joint],
        standing: standing[joint],
        tolerance: TOLERANCE,
    })
}
