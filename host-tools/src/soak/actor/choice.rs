//! Moves, targets and parameters to choose from: mostly sensible, sometimes not.

use std::f64::consts::TAU;

use canter_shared::parameter::Parameter;
use canter_shared::time::Ticks;
use canter_shared::units::{Acceleration, Jerk, Position, Velocity};
use canter_shared::wire::command::{Action, Command, ProfileKind};

use super::Sheet;
use crate::soak::dice::Dice;

/// The farthest that a command can name, less a little, in rad.
const FARTHEST: f64 = 1_023.9 * TAU;

pub(super) fn profile(dice: &mut Dice) -> ProfileKind {
    dice.one_of(&[
        ProfileKind::Beta,
        ProfileKind::Trapezoid,
        ProfileKind::SCurve,
    ])
}

/// Some distance in rad that `sheet`'s axis can go in `seconds`, or not quite.
pub(super) fn distance(dice: &mut Dice, sheet: &Sheet, seconds: f64) -> f64 {
    let limits = &sheet.limits;
    // Smooth profiles have peaks of about 2 d/T, 7 d/T^2 and 60 d/T^3.
    let reach = (limits.velocity().radians() * seconds / 2.0)
        .min(limits.slower_acceleration().radians() * seconds * seconds / 7.0)
        .min(limits.jerk().radians() * seconds * seconds * seconds / 60.0);
    let part = dice.real(0.05, 1.2);
    if dice.percent(50) {
        reach * part
    } else {
        -reach * part
    }
}

/// A place and the time to get there.
pub(super) fn goal(dice: &mut Dice, sheet: &Sheet, from: Position) -> (Position, Ticks) {
    let limits = &sheet.limits;
    let seconds = dice.decades(0.02, 2.0);
    let (least, most) = (
        limits.position_minimum().radians(),
        limits.position_maximum().radians(),
    );
    let target = match dice.between(0, 19) {
        // Anywhere at all.
        0 => dice.real(-FARTHEST, FARTHEST),
        1 => least,
        2 => most,
        3 => dice.real(least, most),
        _ => (from.radians() + distance(dice, sheet, seconds)).clamp(least, most),
    };
    let duration = match dice.between(0, 19) {
        0 => dice.between(0, 100),
        1 => dice.between(0, 4_000_000),
        _ => (seconds * 1_000.0) as u64,
    };
    let target = Position::from_radians(target.clamp(-FARTHEST, FARTHEST)).unwrap_or_default();
    (target, Ticks(duration as u32))
}

/// What is told ahead of a move.
pub(super) fn preparation(dice: &mut Dice, sheet: &Sheet, sequence: u8) -> Command {
    let limits = &sheet.limits;
    let mut part = |most: f64| most * dice.real(0.1, 1.5);
    let (strong, fast, jerky) = (
        part(limits.slower_acceleration().radians()),
        part(limits.velocity().radians()),
        part(limits.jerk().radians()),
    );
    match dice.between(0, 2) {
        0 => Command::TrapezoidShape {
            acceleration: Ticks(dice.between(1, 300) as u32),
            deceleration: Ticks(dice.between(1, 300) as u32),
            sequence,
        },
        1 => Command::RampLimits {
            acceleration: Acceleration::from_radians(strong).unwrap_or_default(),
            deceleration: Acceleration::from_radians(strong).unwrap_or_default(),
            sequence,
        },
        _ => Command::PeakLimits {
            velocity: Velocity::from_radians(fast).unwrap_or_default(),
            jerk: Jerk::from_radians(jerky).unwrap_or_default(),
            sequence,
        },
    }
}

/// A parameter and a raw value, mostly one that is in range and not far from its default.
pub(super) fn parameter(dice: &mut Dice, axis: u8) -> (Parameter, i64) {
    let parameter = dice.one_of(&Parameter::ALL);
    let entry = parameter.entry();
    let (least, most) = (entry.minimum, entry.maximum);
    let default = parameter.default_raw(axis);
    let raw = match dice.between(0, 9) {
        0 => least,
        1 => most,
        2 => dice.bits() as i64 >> 16,
        3 => default,
        _ => (default as f64 * dice.decades(0.05, 20.0)) as i64,
    };
    if dice.percent(95) {
        (parameter, raw.clamp(least, most))
    } else {
        (parameter, raw)
    }
}

pub(super) fn action(dice: &mut Dice) -> Action {
    dice.one_of(&Action::ALL)
}
