//! The demonstration's report.
//!
//! | file | what it holds |
//! |---|---|
//! | `walk` | the robot from the side, its feet, its joints |
//! | `moves` | the synchronised moves, their skew, the stop |
//! | `bus` | what the bus carried |
//! | `rows` | everything in words |

mod bus;
mod moves;
mod rows;
mod walk;

use super::{Measurements, Performance, promises, scene};
use crate::leg::LegError;
use crate::plot::report::{Headline, Report};
use crate::robot::Robot;
use canter_shared::wire::id::AxisId;
pub use rows::rows;

/// The page that shows a performance.
///
/// # Errors
/// Joint angles that the robot's legs cannot have.
pub fn page(
    performance: &Performance,
    measurements: &Measurements,
    robot: &Robot,
) -> Result<Report, LegError> {
    let count = performance.axes.len();
    let (walks, walked) = match performance.walk {
        Some(_) => (", walked at a trot", "walked at a trot, "),
        None => ("", ""),
    };
    let mut report = Report {
        title: format!("canter: {count} axes on one CAN bus, moved together{walks}"),
        lead: format!(
            "{count} simulated servo axes on one bus of 1 Mbit/s, each a node of its own with a crystal of \
             its own and a motor with inertia and friction behind it: scanned, enabled, moved together, \
             {walked}stopped in mid-move, disabled. The nodes run the firmware's own core."
        ),
        footer: format!(
            "Made by canter {} with `canter demo --seed {}`; the same seed gives the same bytes. \
             setpoints.csv has every setpoint of every axis, bus.log every frame.",
            env!("CARGO_PKG_VERSION"),
            performance.seed
        ),
        ..Report::default()
    };
    for promise in promises(measurements) {
        report.headlines.push(Headline {
            what: promise.what.to_owned(),
            value: promise.shown(promise.value, promise.digits),
            asked: promise.asked(),
            kept: promise.is_kept(),
        });
    }
    if let Some(walk) = &performance.walk {
        let section = walk::section(performance, walk, robot)?;
        report.sections.push(section);
        report.style = scene::STYLE;
        report.script = Some(scene::SCRIPT);
    }
    report
        .sections
        .extend(moves::section(performance, measurements, robot));
    report.sections.push(bus::section(performance));
    for row in rows(measurements) {
        report.add(row.0, row.1, row.2);
    }
    Ok(report)
}

/// The name of the group that an axis is drawn with: three of them, in their order.
fn group(axes: &[AxisId], index: usize) -> String {
    let first = index - index % 3;
    let last = (first + 2).min(axes.len().saturating_sub(1));
    match (axes.get(first), axes.get(last)) {
        (Some(first), Some(last)) if first != last => format!("axes {first} to {last}"),
        (Some(only), _) => format!("axis {only}"),
        _ => String::new(),
    }
}
