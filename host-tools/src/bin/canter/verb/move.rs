//! `canter move`: several axes, together.

use crate::arguments::Move;
use crate::commander;
use crate::context::Context;
use anyhow::{Result, bail};
use canter::client::{Arrival, MoveRequest, Overrides, Progress};
use canter_shared::wire::id::AxisId;
use serde_json::json;
use std::io::{IsTerminal, Write};

pub fn run(context: &Context, arguments: &Move) -> Result<()> {
    let request = request(arguments)?;
    let axes: Vec<AxisId> = request.goals.iter().map(|goal| goal.axis).collect();
    let mut client = commander::client(context, &axes)?;
    let arrivals = commander::while_held(&mut client, &axes, |client| {
        commander::enable(context, client, &axes, arguments.enable)?;
        let robot = commander::robot(context, client, &axes)?;
        let bar = Bar::new();
        let arrivals = client.move_together(&robot, &request, |progress| bar.show(progress));
        bar.end();
        Ok(arrivals?)
    })?;
    print(context, &arrivals);
    Ok(())
}

fn request(arguments: &Move) -> Result<MoveRequest> {
    let goals: Vec<_> = arguments
        .goals
        .iter()
        .flat_map(|goal| goal.goals(arguments.relative))
        .collect();
    for (index, goal) in goals.iter().enumerate() {
        if goals[..index].iter().any(|other| other.axis == goal.axis) {
            bail!(
                "axis {} is named twice: give each axis one position",
                goal.axis
            );
        }
    }
    Ok(MoveRequest {
        goals,
        profile: arguments.profile.into(),
        duration: arguments.duration,
        limits: Overrides {
            velocity: arguments.vmax,
            acceleration: arguments.amax,
            deceleration: arguments.dmax.or(arguments.amax),
            jerk: arguments.jmax,
        },
        independent: arguments.independent,
    })
}

fn print(context: &Context, arrivals: &[Arrival]) {
    for arrival in arrivals.iter().filter(|arrival| !arrival.arrived) {
        eprintln!(
            "note: axis {} was led to its target, and its drive rests {:.4} rad from there: stiffer gains \
             would hold it nearer",
            arrival.axis,
            (arrival.position - arrival.target).abs(),
        );
    }
    let documents: Vec<_> = arrivals
        .iter()
        .map(|arrival| {
            json!({
                "axis": arrival.axis.get(),
                "target": arrival.target,
                "position": arrival.position,
                "arrived": arrival.arrived,
                "duration": arrival.duration.seconds(),
                "start_us": arrival.start.0,
                "skew_us": arrival.skew_microseconds,
            })
        })
        .collect();
    context.print_json(&json!({ "axes": documents }));
    if context.json {
        return;
    }
    println!("axis    target rad  position rad  duration s  start skew us");
    for arrival in arrivals {
        println!(
            "{:>4}  {:>12.6}  {:>12.6}  {:>10.3}  {:>13}",
            arrival.axis,
            arrival.target,
            arrival.position,
            arrival.duration.seconds(),
            arrival.skew_microseconds,
        );
    }
}

/// A bar on stderr, where that is a terminal.
struct Bar {
    shown: bool,
}

impl Bar {
    fn new() -> Self {
        Self {
            shown: std::io::stderr().is_terminal(),
        }
    }

    fn show(&self, progress: Progress) {
        if !self.shown {
            return;
        }
        const WIDTH: usize = 40;
        let part = (progress.elapsed / progress.duration).clamp(0.0, 1.0);
        let full = (part * WIDTH as f64) as usize;
        eprint!(
            "\r[{:<WIDTH$}] {:>5.2} of {:.2} s",
            "=".repeat(full),
            progress.elapsed.clamp(0.0, progress.duration),
            progress.duration
        );
        // A bar that cannot be drawn is no reason to stop axes.
        let _ = std::io::stderr().flush();
    }

    fn end(&self) {
        if self.shown {
            eprintln!();
        }
    }
}
