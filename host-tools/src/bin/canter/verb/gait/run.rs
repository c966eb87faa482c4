//! A walk on the robot, and what is printed of it.

use super::keys::{HELP, Keys};
use super::lines::Lines;
use super::pilot::{Pilot, Source};
use super::signals::Signals;
use super::{NoOffsets, body, numbers};
use crate::arguments::GaitRun;
use crate::commander;
use crate::context::{Context, on_signal_do, tell_complaints};
use anyhow::Result;
use canter::gait::{GaitError, Quadruped};
use canter::walk::joints::axes;
use canter::walk::{Budget, Order, Preflight, Settings, Walked, preflight, walk};
use serde_json::{Value, json};
use std::io::IsTerminal;

pub fn run(context: &Context, arguments: &GaitRun) -> Result<()> {
    let settings = arguments.settings().ok_or(NoOffsets)?;
    settings.check()?;
    let span = span(arguments, &settings)?;
    let axes = axes(&Quadruped::of(&context.robot)?);
    let bitrate = arguments.bitrate.unwrap_or(context.bitrate());
    let mut client = context.deaf_client(bitrate)?;
    let signals = Signals::new(client.interrupt());
    let raised = signals.clone();
    on_signal_do(move || raised.raise())?;
    let is_terminal = std::io::stdin().is_terminal();
    // Virtual time waits for a line, unless a person looks on.
    let lines = match &arguments.orders {
        Some(name) => {
            let waits = context.is_simulated() && !is_terminal;
            Some(Lines::open(name, waits, signals.clone())?)
        }
        None => None,
    };

    let looked = preflight(
        &mut client,
        &context.robot,
        context.robot_is_named,
        &settings,
        bitrate,
    );
    tell_complaints(&mut client);
    let looked = looked?;
    for item in &looked.items {
        eprintln!("{:>8}: {}", item.what, item.found);
    }
    let mut refused = 0;
    let walked = commander::while_held(&mut client, &axes, |client| {
        commander::enable(context, client, &axes, arguments.enable)?;
        let source = match lines {
            Some(lines) => Source::Lines(lines),
            None if is_terminal => {
                eprintln!("{HELP}");
                Source::Keys(Keys::new(signals.clone())?)
            }
            None => Source::Nobody,
        };
        let is_paced = context.is_simulated() && is_terminal;
        let mut pilot = Pilot::new(source, signals, &looked.settings, span, is_paced);
        let walked = walk(client, &looked.robot, &looked.settings, &mut pilot);
        refused = pilot.refused;
        Ok(walked?)
    })?;
    tell(context, arguments, &looked, &walked, refused)
}

/// For how long it walks, in s.
fn span(arguments: &GaitRun, settings: &Settings) -> Result<Option<f64>, GaitError> {
    match (arguments.cycles, settings.gait) {
        (None, _) => Ok(arguments.duration),
        (Some(cycles), Some(gait)) => Ok(Some(f64::from(cycles) * gait.period)),
        (Some(_), None) => Err(GaitError::Standing),
    }
}

fn tell(
    context: &Context,
    arguments: &GaitRun,
    looked: &Preflight,
    walked: &Walked,
    refused: u32,
) -> Result<()> {
    let deviation = walked.replay.deviation()?;
    let name = arguments.options.name.name();
    // A whole number of ms, as knots have.
    let duration = (1e3 * walked.replay.duration).round() / 1e3;
    let budget = &looked.budget;
    if context.json {
        let axes = walked.ends.iter().map(|end| {
            json!({
                "axis": end.axis.get(),
                "position": end.position,
                "start_us": end.start.0,
                "leaves_us": end.leaves.time().0,
                "skew_us": end.skew_microseconds,
                "missing_knots": end.missing,
            })
        });
        let preflight = looked.items.iter();
        let preflight = preflight.map(|item| json!({"what": item.what, "found": item.found}));
        context.print_json(&json!({
            "gait": name,
            "duration": duration,
            "cycles": arguments.cycles,
            "orders": walked.replay.orders.iter().map(taken).collect::<Value>(),
            "refused": refused,
            "deviation": deviation,
            "axes": axes.collect::<Value>(),
            "budget": document(budget),
            "preflight": preflight.collect::<Value>(),
        }));
        return Ok(());
    }
    println!("gait done: {name} in {duration:.3} s");
    println!("axis  position rad  start skew us  missing knots");
    for end in &walked.ends {
        println!(
            "{:>4}  {:>12.6}  {:>13}  {:>13}",
            end.axis, end.position, end.skew_microseconds, end.missing,
        );
    }
    println!(
        "setpoints within {:.0} microrad of the motion; {:.0} % of {} bit/s at worst",
        1e6 * deviation,
        1e2 * budget.load(),
        budget.bitrate.bits_per_second(),
    );
    Ok(())
}

/// An order that was taken, and when in s of the motion.
fn taken((time, order): &(f64, Order)) -> Value {
    match order {
        Order::Body(asked) => json!({"time": time, "order": "body", "body": body(asked)}),
        Order::Gait(gait) => json!({"time": time, "order": "gait", "pattern": numbers(gait)}),
        Order::Stand => json!({"time": time, "order": "stand"}),
        Order::Stop => json!({"time": time, "order": "stop"}),
    }
}

fn document(budget: &Budget) -> Value {
    let shares = budget.shares.iter().map(|share| {
        json!({"what": share.what, "frames": share.frames, "bits": share.bits, "rate": share.rate()})
    });
    json!({
        "bitrate": budget.bitrate.bits_per_second(),
        "rate": budget.rate(),
        "load": budget.load(),
        "shares": shares.collect::<Value>(),
    })
}
