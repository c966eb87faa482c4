//! What the parameters make of the travel, and which of them contradict each other.

use canter_shared::parameter::{Parameter, ParameterError, Values};
use std::f64::consts::TAU;

#[track_caller]
fn with(values: &Values, changes: &[(Parameter, f64)]) -> Values {
    let set = |values: Values, (parameter, value): &(Parameter, f64)| {
        let raw = parameter.nearest(*value).expect("in range");
        let (changed, settings) = values.with(*parameter, raw).expect("it fits");
        // The quick way is no other way.
        let quick = values.with_settings(&values.settings(), *parameter, raw);
        assert_eq!(quick, Ok((changed, settings)));
        changed
    };
    changes.iter().fold(*values, set)
}

fn travel(values: &Values) -> (f64, f64) {
    let limits = values.settings().limits;
    (
        limits.position_minimum().radians(),
        limits.position_maximum().radians(),
    )
}

const MIT: (Parameter, f64) = (Parameter::DriveKind, 2.0);
const CIA402: (Parameter, f64) = (Parameter::DriveKind, 3.0);

#[test]
fn the_travel_is_what_the_drive_can_be_told() {
    let values = Values::defaults(4);
    let everywhere = travel(&values);
    assert!(everywhere.1 > 6_000.0);
    assert_eq!(
        travel(&with(&values, &[(Parameter::DriveKind, 1.0)])),
        everywhere
    );

    // 12.5 rad, of which the last 1 / 8192 is left free.
    let end = 12.5 * (1.0 - 1.0 / 8_192.0);
    let near = |values: &Values, least: f64, greatest: f64| {
        let (from, to) = travel(values);
        assert!(
            (from - least).abs() < 1e-8 && (to - greatest).abs() < 1e-8,
            "{from} {to}"
        );
    };
    let mit = with(&values, &[MIT]);
    near(&mit, -end, end);
    near(
        &with(&mit, &[(Parameter::GearRatio, 5.0)]),
        -end / 5.0,
        end / 5.0,
    );
    near(
        &with(&mit, &[(Parameter::DriveOffset, 2.0)]),
        2.0 - end,
        2.0 + end,
    );
    near(&with(&mit, &[(Parameter::PositionMaximum, 1.0)]), -end, 1.0);
    near(
        &with(&mit, &[(Parameter::MitModel, 6.0)]),
        -95.5 / 12.5 * end,
        95.5 / 12.5 * end,
    );
    let custom = [(Parameter::MitPosition, 25.0), (Parameter::MitModel, 0.0)];
    near(&with(&mit, &custom), -2.0 * end, 2.0 * end);

    // 2^31 increments of 2^26: 32 turns.
    let fine = [(Parameter::DriveIncrements, 67_108_864.0), CIA402];
    let end = 32.0 * TAU * (1.0 - 1.0 / 8_192.0);
    let (from, to) = travel(&with(&values, &fine));
    assert!(
        (from + end).abs() < 1e-6 && (to - end).abs() < 1e-6,
        "{from} {to}"
    );
}

#[test]
fn what_leaves_no_travel_is_refused_and_changes_nothing() {
    let far = with(
        &Values::defaults(4),
        &[
            (Parameter::PositionMaximum, 120.0),
            (Parameter::PositionMinimum, 90.0),
        ],
    );
    assert_eq!(
        far.with(Parameter::DriveKind, 2),
        Err(ParameterError::Contradiction {
            parameter: Parameter::DriveKind,
            other: Parameter::PositionMinimum,
        })
    );
    let near = with(&far, &[(Parameter::DriveOffset, 100.0), MIT]);
    assert_eq!(
        near.with(Parameter::DriveOffset, 0),
        Err(ParameterError::Contradiction {
            parameter: Parameter::DriveOffset,
            other: Parameter::PositionMinimum,
        })
    );
}

#[test]
fn an_id_that_the_drive_cannot_have_is_refused() {
    for (kind, node, fits) in [
        (0, 0, true),
        (0, 127, true),
        (1, 0, true),
        (1, 63, true),
        (1, 64, false),
        (2, 0, false),
        (2, 127, true),
        (3, 0, false),
        (3, 127, true),
    ] {
        let values = with(&Values::defaults(4), &[(Parameter::DriveNode, node as f64)]);
        let refused = Err(ParameterError::Contradiction {
            parameter: Parameter::DriveKind,
            other: Parameter::DriveNode,
        });
        let got = values.with(Parameter::DriveKind, kind);
        assert_eq!(got == refused, !fits, "{kind} {node}: {got:?}");
        let values = with(&Values::defaults(4), &[(Parameter::DriveKind, kind as f64)]);
        assert_eq!(
            values.with(Parameter::DriveNode, node).is_ok(),
            fits,
            "{kind} {node}"
        );
    }
    // What it is told and what it answers must be told apart.
    let mit = with(&Values::defaults(4), &[MIT]);
    assert!(mit.with(Parameter::MitMaster, 4).is_err());
    assert!(
        with(&mit, &[(Parameter::MitMaster, 5.0)])
            .with(Parameter::DriveNode, 5)
            .is_err()
    );
}
