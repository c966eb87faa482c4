//! `canter scan`: who is on the bus.

use crate::context::{Context, tell_complaints};
use anyhow::Result;
use canter::client::{ClientError, KnownNode};
use canter_shared::wire::report::Board;
use serde_json::json;

pub fn run(context: &Context) -> Result<()> {
    let mut client = context.client()?;
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
                node.chip().unwrap_or_default(),
                if node.is_doubled() {
                    "  TWO NODES with this id"
                } else {
                    ""
                },
            );
        }
    }
    if nodes.is_empty() {
        let bus = canter::bus::Bus::description(client.bus());
        return Err(ClientError::NobodyThere { bus }.into());
    }
    Ok(())
}

fn dotted(node: &KnownNode) -> String {
    node.firmware
        .map_or_else(String::new, |[major, minor, patch]| {
            format!("{major}.{minor}.{patch}")
        })
}

fn document(node: &KnownNode) -> serde_json::Value {
    json!({
        "axis": node.axis.get(),
        "chip": node.chip(),
        "board": node.board.map(Board::name),
        "firmware": dotted(node),
        "protocol": node.protocol.map(|version| format!("{}.{}", version.major, version.minor)),
        "doubled": node.is_doubled(),
    })
}
