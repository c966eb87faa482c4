//! `canter scan`: who is on the bus, and other ids for them.

use crate::arguments::{Assignment, Scan};
use crate::context::{Context, tell_complaints};
use anyhow::Result;
use canter::bus::Bus;
use canter::client::{Client, ClientError, KnownNode};
use canter_shared::wire::id::AxisId;
use canter_shared::wire::report::Board;
use serde_json::json;

pub fn run(context: &Context, arguments: &Scan) -> Result<()> {
    let mut client = context.client()?;
    if let Some(Assignment { chip, old, new }) = arguments.assign {
        client.assign(chip, old, new)?;
        if arguments.save {
            save(&mut client, new)?;
        }
    }
    let nodes = client.scan()?;
    tell_complaints(&mut client);
    let documents: Vec<_> = nodes.iter().map(document).collect();
    context.print_json(&json!({ "nodes": documents }));
    if !context.json {
        println!("axis  board          firmware  protocol  chip");
        for node in &nodes {
            println!(
                "{:>4}  {:<13}  {:<8}  {:<8}  {}{}",
                node.axis,
                node.board.map_or("unknown", Board::name),
                dotted(node),
                node.protocol.map_or_else(String::new, |version| format!(
                    "{}.{}",
                    version.major, version.minor
                )),
                chips(node).join(" "),
                if node.is_doubled() {
                    "  TWO NODES with this id"
                } else {
                    ""
                },
            );
        }
    }
    if nodes.is_empty() {
        let bus = client.bus().description();
        return Err(ClientError::NobodyThere { bus }.into());
    }
    Ok(())
}

/// The id is part of what is saved, and saving is for who holds the axis.
fn save(client: &mut Client<Box<dyn Bus>>, axis: AxisId) -> Result<()> {
    client.hold(&[axis])?;
    let saved = client.save_parameters(&[axis]);
    let released = client.release();
    saved?;
    Ok(released?)
}

fn dotted(node: &KnownNode) -> String {
    node.firmware
        .map_or_else(String::new, |[major, minor, patch]| {
            format!("{major}.{minor}.{patch}")
        })
}

fn chips(node: &KnownNode) -> Vec<String> {
    node.chips().iter().map(ToString::to_string).collect()
}

fn document(node: &KnownNode) -> serde_json::Value {
    json!({
        "axis": node.axis.get(),
        "chip": node.chip(),
        "chips": chips(node),
        "board": node.board.map(Board::name),
        "firmware": dotted(node),
        "protocol": node.protocol.map(|version| format!("{}.{}", version.major, version.minor)),
        "doubled": node.is_doubled(),
    })
}
