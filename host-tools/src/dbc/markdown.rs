//! The tables of the documents.

use super::meaning;
use canter_shared::axis::fault::Fault;
use canter_shared::parameter::{Change, Default, Kind, Parameter};
use canter_shared::wire::layout::{Addressing, Choices, Field, LAYOUTS, Layout, Sender};
use canter_shared::wire::reason::Reason;

/// A table; a cell that is empty stays empty.
fn table<const COLUMNS: usize>(
    head: [&str; COLUMNS],
    rows: impl IntoIterator<Item = [String; COLUMNS]>,
) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head = line(&head.map(str::to_owned));
    let rule = format!("|{}\n", "---|".repeat(COLUMNS));
    let rows = rows.into_iter().map(|row| line(&row));
    format!("{head}{rule}{}", rows.collect::<String>())
}

/// All frames in one table, then the fields of each kind of payload, then the named values.
pub fn frames() -> String {
    let overview = table(
        ["function", "frame", "id in hex", "from", "bytes", "what"],
        LAYOUTS.iter().map(|layout| {
            [
                u8::from(layout.function).to_string(),
                format!("{:?}", layout.function),
                ids(layout),
                sender(layout.sender).to_owned(),
                layout.length.to_string(),
                meaning::of(layout.function).to_owned(),
            ]
        }),
    );
    let mut text = overview;
    let mut rest = LAYOUTS.as_slice();
    while let Some(first) = rest.first() {
        let same = rest
            .iter()
            .take_while(|layout| layout.fields == first.fields);
        let (group, others) = rest.split_at(same.count());
        rest = others;
        if !first.fields.is_empty() {
            let names = group.iter().map(|layout| format!("{:?}", layout.function));
            let names = names.collect::<Vec<_>>().join(", ");
            text.push_str(&format!("\n**{names}**\n\n{}", fields(first)));
        }
    }
    for (title, choices) in [
        ("Actions", Choices::Action),
        ("States", Choices::State),
        ("Items", Choices::Item),
        ("Boards", Choices::Board),
    ] {
        let names = meaning::names(choices).into_iter();
        let names = table(
            ["number", "name"],
            names.map(|(number, name)| [number.to_string(), name]),
        );
        text.push_str(&format!("\n**{title}**\n\n{names}"));
    }
    text
}

fn sender(sender: Sender) -> &'static str {
    match sender {
        Sender::Host => "host",
        Sender::Node => "node",
    }
}

fn ids(layout: &Layout) -> String {
    let first = u16::from(u8::from(layout.function)) << 6;
    match layout.addressing {
        Addressing::All => format!("{first:03X}"),
        Addressing::One => format!("{first:03X} + axis"),
        Addressing::Any => format!("{first:03X} (all) or {first:03X} + axis"),
    }
}

fn fields(layout: &Layout) -> String {
    let row = |field: &Field| {
        let name = match field.part {
            Some(part) => format!("{} (part {part})", field.name),
            None => field.name.to_owned(),
        };
        let last = field.start + field.bits - 1;
        let bits = if field.bits == 1 {
            last.to_string()
        } else {
            format!("{}-{last}", field.start)
        };
        let meaning = meaning::of_field(layout.function, field.name).unwrap_or_default();
        [
            name,
            bits,
            if field.signed { "signed" } else { "unsigned" }.to_owned(),
            factor(field.factor),
            field.unit.to_owned(),
            meaning.to_owned(),
        ]
    };
    table(
        ["field", "bits", "type", "factor", "unit", "what"],
        layout.fields.iter().map(row),
    )
}

/// The factor as the power that it is.
fn factor(factor: f64) -> String {
    let exponent = factor.log2();
    if factor == 1.0 {
        "1".to_owned()
    } else if exponent == exponent.round() {
        format!("2^{exponent}")
    } else {
        factor.to_string()
    }
}

/// The reasons of acknowledgements.
pub fn reasons() -> String {
    table(
        ["number", "reason", "what it means", "what to do", "detail"],
        Reason::ALL.map(|reason| {
            [
                u8::from(reason).to_string(),
                meaning::snake_case(&format!("{reason:?}")),
                reason.meaning().to_owned(),
                reason.cure().to_owned(),
                meaning::detail(reason).to_owned(),
            ]
        }),
    )
}

/// The parameters of an axis.
pub fn parameters() -> String {
    let row = |parameter: Parameter| {
        let entry = parameter.entry();
        let (steps, values) = match entry.kind {
            Kind::Number { per_unit } => {
                let value = |raw| parameter.in_unit(raw).to_string();
                let default = match entry.default {
                    Default::Raw(raw) => value(raw),
                    Default::AxisId => "the axis's id".to_owned(),
                };
                let steps = match per_unit {
                    1 => "1".to_owned(),
                    _ => format!("10^-{}", per_unit.ilog10()),
                };
                (steps, [value(entry.minimum), value(entry.maximum), default])
            }
            Kind::Choice(names) => {
                let default = names.get(parameter.default_raw(0) as usize);
                let default = default.copied().unwrap_or_default();
                let names = names.iter().enumerate();
                let names = names.map(|(raw, name)| format!("{raw} {name}"));
                let names = names.collect::<Vec<_>>().join(", ");
                ("1".to_owned(), [names, String::new(), default.to_owned()])
            }
        };
        let [minimum, maximum, default] = values;
        [
            u8::from(parameter).to_string(),
            entry.name.to_owned(),
            entry.unit.to_owned(),
            steps,
            minimum,
            maximum,
            default,
            match entry.change {
                Change::AtRest => "at rest".to_owned(),
                Change::Disabled => "disabled".to_owned(),
            },
            entry.meaning.to_owned(),
        ]
    };
    table(
        [
            "number",
            "parameter",
            "unit",
            "step",
            "from",
            "to",
            "default",
            "changes",
            "what",
        ],
        Parameter::ALL.map(row),
    )
}

/// The faults of an axis.
pub fn faults() -> String {
    table(
        ["number", "fault", "cause", "cure", "reaction"],
        Fault::ALL.map(|fault| {
            [
                u8::from(fault).to_string(),
                fault.name().to_owned(),
                fault.cause().to_owned(),
                fault.cure().to_owned(),
                fault
                    .reaction()
                    .map_or(String::new(), |parameter| parameter.entry().name.to_owned()),
            ]
        }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_is_written_as_what_it_is() {
        assert_eq!(factor(1.0), "1");
        assert_eq!(factor(1.0 / f64::from(1 << 23)), "2^-23");
        assert_eq!(factor(1e-6), "0.000001");
    }

    #[test]
    fn no_cell_breaks_its_table() {
        for (text, columns) in [(reasons(), 5), (faults(), 5), (parameters(), 9)] {
            for line in text.lines() {
                assert_eq!(line.matches('|').count(), columns + 1, "{line}");
            }
        }
    }
}
