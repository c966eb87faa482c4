//! What is worth to be known about the drives before they move: how fine they resolve, and how full they
//! make their bus.

use canter_shared::drive::settings::{DriveKind, DriveSettings};
use canter_shared::parameter::Values;
use canter_shared::units::COUNTS_PER_TURN;
use canter_shared::wire::id::AxisId;

/// A drives' bus above this is too full for what else has to pass.
const FULL: f64 = 0.85;

/// What a bus of 1 Mbit/s carries in a second.
const BITRATE: f64 = 1e6;

/// Bits of a frame with an 11-bit id and so many bytes, with all the stuff bits that there can be and the
/// space behind it: 135 for 8 bytes.
const fn bits(bytes: u32) -> u32 {
    let stuffed = 34 + 8 * bytes;
    stuffed + (stuffed - 1) / 4 + 13
}

/// Words for a person, one line each.
pub fn advice(axes: &[(AxisId, Values)]) -> Vec<String> {
    let drives: Vec<_> = axes
        .iter()
        .map(|(axis, values)| (*axis, values.drive(), farthest(values)))
        .collect();
    let resolution = drives
        .iter()
        .filter(|(_, drive, _)| drive.kind == DriveKind::Odrive)
        .map(|(axis, drive, turns)| (resolution(*turns) / gear(drive), *axis, *turns))
        .max_by(|(one, ..), (other, ..)| one.total_cmp(other));
    let mut words = Vec::new();
    if let Some((step, axis, turns)) = resolution {
        words.push(format!(
            "an ODrive takes positions as f32: at the end of axis {axis}'s travel, {turns:.0} turns of its \
             drive, a step is {:.1} microturns of the axis; a shorter travel is finer",
            step * 1e6
        ));
    }
    let settings: Vec<_> = drives.iter().map(|(_, drive, _)| *drive).collect();
    let load = load(&settings);
    if load > 0.0 {
        let hint = if load > FULL {
            ": too full, so set drive.period of each axis higher, or give some drives another bus"
        } else {
            ""
        };
        words.push(format!(
            "the drives' bus is full to {:.0} % at most, at 1 Mbit/s{hint}",
            100.0 * load
        ));
    }
    words
}

fn gear(drive: &DriveSettings) -> f64 {
    drive.gear as f64 / 1e9
}

/// The farthest that the drive's shaft is from its zero, in turns.
fn farthest(values: &Values) -> f64 {
    let (limits, drive) = (values.settings().limits, values.drive());
    let ends = [limits.position_minimum(), limits.position_maximum()];
    let turns = ends.map(|end| (end - drive.offset).counts() as f64 / COUNTS_PER_TURN as f64);
    turns[0].abs().max(turns[1].abs()) * gear(&drive)
}

/// A step of an f32 at so many turns.
fn resolution(turns: f64) -> f64 {
    let turns = turns as f32;
    f64::from(turns.next_up()) - f64::from(turns)
}

/// The part of the bus that setpoints and what the drives say take, at most.
fn load(drives: &[DriveSettings]) -> f64 {
    let mut per_second = 0.0;
    // One SYNC for all, as often as the quickest wants it.
    let mut syncs: f64 = 0.0;
    for drive in drives {
        let rate = 1e3 / f64::from(drive.period.0);
        per_second += match drive.kind {
            DriveKind::Simulated => 0.0,
            // By default it tells its place 100 times in a second, and its state ten times.
            DriveKind::Odrive => (rate + 110.0) * f64::from(bits(8)),
            DriveKind::Mit => 2.0 * rate * f64::from(bits(8)),
            DriveKind::Cia402 => {
                syncs = syncs.max(rate);
                let setpoint = if drive.rated_torque > 0.0 { 8 } else { 6 };
                // Its place at each SYNC, its state ten times in a second.
                rate * f64::from(bits(setpoint) + bits(6)) + 10.0 * f64::from(bits(1))
            }
        };
    }
    (per_second + syncs * f64::from(bits(0))) / BITRATE
}

#[cfg(test)]
mod tests {
    use super::*;
    use canter_shared::parameter::Parameter;

    fn axes(count: u8, changes: &[(Parameter, f64)]) -> Vec<(AxisId, Values)> {
        let axis = |id| {
            let mut values = Values::defaults(id);
            for (parameter, value) in changes {
                let raw = parameter.nearest(*value).expect("in range");
                values = values.with(*parameter, raw).expect("it fits").0;
            }
            (AxisId::new(id).expect("1 to 63"), values)
        };
        (1..=count).map(axis).collect()
    }

    #[test]
    fn frames_have_the_bits_of_the_standard() {
        assert_eq!((bits(8), bits(6), bits(0)), (135, 115, 55));
    }

    #[test]
    fn an_odrive_says_how_coarse_it_is_far_out() {
        let odrive = (Parameter::DriveKind, 1.0);
        let words = advice(&axes(2, &[odrive]));
        // 1000 turns lie between 512 and 1024: a step is 2^-14 turn.
        assert!(
            words[0].contains("1000 turns") && words[0].contains("61.0 microturns"),
            "{words:?}"
        );
        let near = [
            (Parameter::PositionMaximum, 6.0),
            (Parameter::PositionMinimum, -6.0),
            odrive,
        ];
        assert!(advice(&axes(2, &near))[0].contains(" 0.1 microturns"));
    }

    #[test]
    fn a_bus_that_is_too_full_is_told() {
        let mit = (Parameter::DriveKind, 2.0);
        let words = |count, changes: &[_]| advice(&axes(count, changes)).concat();
        let three = words(3, &[mit]);
        assert!(
            three.contains("81 %") && !three.contains("too full"),
            "{three}"
        );
        assert!(words(4, &[mit]).contains("108 %") && words(4, &[mit]).contains("drive.period"));
        assert!(words(4, &[mit, (Parameter::DrivePeriod, 0.002)]).contains("54 %"));
        // 3 * 2 * 115 + 55 bits in a millisecond, and the heartbeats.
        assert!(words(3, &[(Parameter::DriveKind, 3.0)]).contains("75 %"));
        // With a torque offset 3 * (135 + 115) + 55.
        let torque = [(Parameter::DriveKind, 3.0), (Parameter::RatedTorque, 2.0)];
        assert!(words(3, &torque).contains("81 %"));
        assert_eq!(words(12, &[]), "");
    }
}
