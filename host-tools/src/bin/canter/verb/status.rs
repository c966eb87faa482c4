//! `canter status`: the state of every axis that is heard.

use crate::context::{Context, tell_complaints};
use anyhow::Result;
use canter::bus::Bus;
use canter::client::{Client, ClientError, KnownAxis};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::id::AxisId;
use serde_json::json;

pub fn run(context: &Context) -> Result<()> {
    let mut client = context.client()?;
    let heard = client.listen()?;
    tell_complaints(&mut client);
    print(context, &client, &heard);
    if heard.is_empty() {
        let bus = client.bus().description();
        return Err(ClientError::NobodyThere { bus }.into());
    }
    Ok(())
}

/// Prints what is known of `axes`.
pub fn print(context: &Context, client: &Client<Box<dyn Bus>>, axes: &[AxisId]) {
    let known: Vec<_> = axes
        .iter()
        .filter_map(|axis| Some((*axis, client.axes().get(axis)?)))
        .collect();
    let documents: Vec<_> = known
        .iter()
        .map(|(axis, known)| document(*axis, known))
        .collect();
    context.print_json(&json!({ "axes": documents }));
    if context.json {
        return;
    }
    println!("{HEAD}");
    for (axis, known) in known {
        println!("{}", row(axis, known, state(known)));
    }
}

/// What stands over the rows.
pub const HEAD: &str = "axis  state                  position rad  velocity rad/s  held by  fault";

/// What is known of an axis, in a row, with words for its state.
pub fn row(axis: AxisId, known: &KnownAxis, state: &str) -> String {
    let fault = known.fault.map_or(String::new(), |fault| {
        format!("{}: {}; {}", fault.name(), fault.cause(), fault.cure())
    });
    format!(
        "{axis:>4}  {state:<21}  {:>12.6}  {:>14.6}  {:<7}  {fault}",
        known.position.map_or(f64::NAN, Position::radians),
        known.velocity.map_or(f64::NAN, Velocity::radians),
        holder(known),
    )
}

/// An axis's state, by CiA 402's name.
pub fn state(known: &KnownAxis) -> &'static str {
    known.state.map_or("unknown", State::name)
}

/// Which session holds an axis.
pub fn holder(known: &KnownAxis) -> String {
    match known.session {
        None | Some(0) => String::from("nobody"),
        Some(session) => format!("{session:#06x}"),
    }
}

/// What is known of an axis, for other programs.
pub fn document(axis: AxisId, known: &KnownAxis) -> serde_json::Value {
    json!({
        "axis": axis.get(),
        "state": known.state.map(State::name),
        "fault": known.fault.map(Fault::name),
        "position": known.position.map(Position::radians),
        "velocity": known.velocity.map(Velocity::radians),
        "moving": known.moving,
        "session": known.session.filter(|session| *session != 0),
        "bus_off": known.counters.bus_off,
        "error_frames": known.counters.error_frames,
        "lost": known.counters.lost,
        "rejected": known.counters.rejected,
    })
}
