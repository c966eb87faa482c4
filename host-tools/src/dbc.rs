//! The protocol for other people: canter.dbc for their tools, and the documents' tables to read.
//!
//! All of it is made from [`LAYOUTS`], so it cannot tell another story than the codec. A test
//! compares the files of the repository with what is made here.
//!
//! | file | what it holds |
//! |---|---|
//! | `meaning` | what each frame, field and value is called and means |
//! | `markdown` | the tables of `docs/protocol.md` and `docs/faults.md` |

pub mod markdown;
mod meaning;

use canter_shared::wire::PROTOCOL_VERSION;
use canter_shared::wire::id::{Address, AxisId, Function, LAST_AXIS};
use canter_shared::wire::layout::{Addressing, Choices, Field, LAYOUTS, Layout, Sender};

/// The whole of canter.dbc.
///
/// Tools such as `cantools decode` look a frame up by its whole id and know of no mask for the
/// axis. So each frame stands here once for every address that it may carry.
pub fn generate() -> String {
    let frames: Vec<_> = LAYOUTS
        .iter()
        .flat_map(|layout| addresses(layout.addressing).map(move |to| (layout, to)))
        .collect();
    let each = |part: fn(&Layout, Address) -> String| -> String {
        let parts = frames
            .iter()
            .map(|(layout, address)| part(layout, *address));
        parts.collect()
    };
    let messages = each(message);
    let comments = each(comment);
    let values = each(values);
    let (major, minor) = (PROTOCOL_VERSION.major, PROTOCOL_VERSION.minor);
    format!(
        "VERSION \"{major}.{minor}\"\n\nNS_ :\n\nBS_:\n\nBU_: Host Node\n\n\
         {messages}\
         CM_ \"canter's protocol {major}.{minor}. Made by canter from its table of frames. \
         id = function << 6 | axis; axis 0 is all.\";\n\
         CM_ BU_ Host \"Whoever commands axes.\";\n\
         CM_ BU_ Node \"Whatever has axes.\";\n\
         {comments}\n{values}"
    )
}

/// The addresses that a frame may carry, in the order of their ids.
pub fn addresses(addressing: Addressing) -> impl Iterator<Item = Address> {
    let (all, axes) = match addressing {
        Addressing::All => (true, false),
        Addressing::One => (false, true),
        Addressing::Any => (true, true),
    };
    let last = if axes { LAST_AXIS } else { 0 };
    let axes = (1..=last).filter_map(AxisId::new).map(Address::Axis);
    all.then_some(Address::All).into_iter().chain(axes)
}

/// The names of a field's values: number and name.
pub(crate) fn choices(choices: Choices) -> Vec<(u8, String)> {
    meaning::names(choices)
}

/// The name of a frame, such as `MoveBeta_7` or `EmergencyStop_all`.
pub fn message_name(function: Function, address: Address) -> String {
    match address {
        Address::All => format!("{function:?}_all"),
        Address::Axis(axis) => format!("{function:?}_{axis}"),
    }
}

fn message(layout: &Layout, address: Address) -> String {
    let (sender, receiver) = match layout.sender {
        Sender::Host => ("Host", "Node"),
        Sender::Node => ("Node", "Host"),
    };
    let id = address.frame_id(layout.function);
    let name = message_name(layout.function, address);
    let head = format!("BO_ {id} {name}: {} {sender}\n", layout.length);
    let signals = layout
        .fields
        .iter()
        .map(|field| signal(layout, field, receiver));
    format!("{head}{}\n", signals.collect::<String>())
}

fn signal(layout: &Layout, field: &Field, receiver: &str) -> String {
    let multiplexer = match field.part {
        Some(part) => format!(" m{part}"),
        // The first field tells the parts apart where there are any.
        None if layout.fields.iter().any(|other| other.part.is_some()) => " M".to_owned(),
        None => String::new(),
    };
    let sign = if field.signed { '-' } else { '+' };
    let (least, greatest) = field.range();
    // Rust prints the shortest decimal that reads back as the same number.
    format!(
        " SG_ {}{multiplexer} : {}|{}@1{sign} ({},0) [{}|{}] \"{}\" {receiver}\n",
        field.name,
        field.start,
        field.bits,
        field.factor,
        least as f64 * field.factor,
        greatest as f64 * field.factor,
        field.unit,
    )
}

fn comment(layout: &Layout, address: Address) -> String {
    let id = address.frame_id(layout.function);
    format!("CM_ BO_ {id} \"{}.\";\n", meaning::of(layout.function))
}

fn values(layout: &Layout, address: Address) -> String {
    let id = address.frame_id(layout.function);
    let named = |field: &&Field| field.choices != Choices::None;
    let lines = layout.fields.iter().filter(named).map(|field| {
        let names = meaning::names(field.choices);
        let names = names
            .iter()
            .map(|(number, name)| format!("{number} \"{name}\" "));
        format!("VAL_ {id} {} {};\n", field.name, names.collect::<String>())
    });
    lines.collect()
}
