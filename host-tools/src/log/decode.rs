//! What the frames of a log say, by the table of frames.

use std::fmt;

use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, Function, split};
use canter_shared::wire::layout::{Choices, Field, Layout, Sender};

use crate::dbc::{choices, message_name};

/// The most decimals that a text shows.
const MOST_DECIMALS: u32 = 9;

/// The value of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number in its unit: rad, rad/s, rad/s^2, rad/s^3 or s; whole where the unit is empty.
    Number {
        /// How much.
        value: f64,
        /// Of what.
        unit: &'static str,
        /// Decimals that tell two neighbouring values apart.
        decimals: usize,
    },
    /// The name of a value, such as a state's.
    Name(String),
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number {
                value,
                unit,
                decimals,
            } => {
                write!(formatter, "{value:.decimals$}")?;
                let space = if unit.is_empty() { "" } else { " " };
                write!(formatter, "{space}{unit}")
            }
            Self::Name(name) => formatter.write_str(name),
        }
    }
}

/// A frame of canter's protocol, taken apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// What it is for.
    pub function: Function,
    /// Whom it is for, or which axis it is from.
    pub address: Address,
    /// Who sends such frames.
    pub sender: Sender,
    /// Each field's name and value, in the order of their bits.
    pub fields: Vec<(&'static str, Value)>,
}

impl fmt::Display for Decoded {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&message_name(self.function, self.address))?;
        for (name, value) in &self.fields {
            write!(formatter, " {name}={value}")?;
        }
        Ok(())
    }
}

/// Takes a frame apart; `None` where it is none of canter's: another identifier, or another length than the
/// table's.
pub fn decode(frame: &Frame) -> Option<Decoded> {
    let (function, address) = split(frame.id())?;
    let layout = Layout::of(function)?;
    if frame.data().len() != usize::from(layout.length) {
        return None;
    }
    let word = frame.word();
    // The first field says which parts are there, where a frame has several.
    let part = layout.fields.first().map(|first| first.get(word));
    let fields = layout.fields.iter().filter(|field| {
        let wanted = field.part.map(i64::from);
        wanted.is_none() || wanted == part
    });
    Some(Decoded {
        function,
        address,
        sender: layout.sender,
        fields: fields
            .map(|field| (field.name, value(field, word)))
            .collect(),
    })
}

fn value(field: &Field, word: u64) -> Value {
    let raw = field.get(word);
    if field.choices != Choices::None {
        let names = choices(field.choices);
        let name = names
            .into_iter()
            .find(|(number, _)| i64::from(*number) == raw);
        return Value::Name(name.map_or_else(|| format!("unknown {raw}"), |(_, name)| name));
    }
    // Turns are the wire's; whoever reads has rad.
    let (scale, unit) = match field.unit {
        "turn" => (core::f64::consts::TAU, "rad"),
        "turn/s" => (core::f64::consts::TAU, "rad/s"),
        "turn/s^2" => (core::f64::consts::TAU, "rad/s^2"),
        "turn/s^3" => (core::f64::consts::TAU, "rad/s^3"),
        unit => (1.0, unit),
    };
    let step = field.factor * scale;
    let decimals = (0..MOST_DECIMALS).find(|decimals| step * 10f64.powi(*decimals as i32) > 0.999);
    Value::Number {
        value: raw as f64 * step,
        unit,
        decimals: decimals.unwrap_or(MOST_DECIMALS) as usize,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use canter_shared::units::Position;
    use canter_shared::wire::command::{AssignPart, Command};
    use canter_shared::wire::id::AxisId;

    fn words(address: Address, command: Command) -> String {
        let frame = command.encode(address).expect("every field fits");
        decode(&frame).expect("one of ours").to_string()
    }

    #[test]
    fn frames_are_told_in_units_and_names() {
        let axis = Address::Axis(AxisId::new(7).expect("1 to 63"));
        let target = Position::from_radians(-1.5).expect("in range");
        let hold = Command::Control {
            action: canter_shared::wire::command::Action::Hold,
            sequence: 3,
            session: 0x1234,
        };
        assert_eq!(
            words(axis, hold),
            "Control_7 action=hold sequence=3 session=4660"
        );
        let beta = Frame::new(0x207, &[0, 0, 0x20, 0, 0xA0, 0x0F, 0, 3]).expect("a frame");
        assert_eq!(
            decode(&beta).expect("a move").to_string(),
            "MoveBeta_7 target=1.5707963 rad duration=1.000 s sequence=3"
        );
        let knot = Command::Knot {
            position: target,
            velocity: canter_shared::units::Velocity::ZERO,
            number: 5,
        };
        let knot = words(axis, knot);
        assert!(
            knot.starts_with("Knot_7 position=-1.5000003 rad "),
            "{knot}"
        );
        assert_eq!(
            words(Address::All, Command::EmergencyStop),
            "EmergencyStop_all"
        );
        // Only the part that is there.
        let assign = words(
            Address::All,
            Command::Assign(AssignPart::ChipFirst([1, 0, 0, 0, 0, 0])),
        );
        assert_eq!(assign, "Assign_all part=0 chip_first=1");
    }

    #[test]
    fn what_is_not_ours_is_left_alone() {
        let frame = |id, data: &[u8]| Frame::new(id, data).expect("a frame");
        // A move of seven bytes, and a function that nobody has.
        assert_eq!(decode(&frame(0x207, &[0; 7])), None);
        let unused = (0..32).find(|function| Function::try_from(*function).is_err());
        let unused = u16::from(unused.expect("28 of 32 are taken"));
        assert_eq!(decode(&frame(unused << 6 | 1, &[0; 8])), None);
    }

    #[test]
    fn a_name_that_is_not_known_is_a_number() {
        let frame = Frame::new(0x1 << 6, &[]).expect("a frame");
        assert_eq!(decode(&frame), None, "a SYNC without its time");
        let heard = Frame::new(0x10 << 6 | 1, &[1, 8, 0xFE, 0, 0, 0, 0]).expect("a frame");
        let told = decode(&heard).expect("an acknowledgement").to_string();
        assert!(told.contains("reason=unknown 254"), "{told}");
    }
}
