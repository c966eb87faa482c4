//! Numbers to bits and back: `code = (x + end) * (2^bits - 1) / (2 * end)`, truncated, big-endian.
//!
//! ```text
//! byte    0        1       2        3                4        5         6               7
//!         p[15:8]  p[7:0]  v[11:4]  v[3:0] kp[11:8]  kp[7:0]  kd[11:4]  kd[3:0] t[11:8]  t[7:0]
//! ```

use super::MitRanges;

/// The greatest stiffness, in Nm/rad; the least is 0.
pub const KP_RANGE: f32 = 500.0;
/// The greatest damping, in Nm s/rad; the least is 0.
pub const KD_RANGE: f32 = 5.0;

/// The payload that has a drive enter its mode, as a little-endian word: seven bytes of 0xFF, then 0xFC.
pub const ENTER: u64 = special(0xFC);
/// The payload that has it leave its mode.
pub const EXIT: u64 = special(0xFD);
/// The payload that makes where it is its zero; canter never sends it.
pub const ZERO: u64 = special(0xFE);

/// Seven bytes of 0xFF are a special frame, whatever follows.
const MARK: u64 = u64::MAX >> 8;

const fn special(code: u8) -> u64 {
    MARK | (code as u64) << 56
}

/// What a drive is told: `torque + kp * (position - its own) + kd * (velocity - its own)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Setpoint {
    /// In rad.
    pub position: f32,
    /// In rad/s.
    pub velocity: f32,
    /// In Nm/rad.
    pub kp: f32,
    /// In Nm s/rad.
    pub kd: f32,
    /// In Nm.
    pub torque: f32,
}

/// The code of `x` between `least` and `least + span`; what is outside gets the code of the nearer end, and
/// what is no number the least.
fn code(x: f32, least: f32, span: f32, bits: u32) -> u64 {
    let most = ((1u32 << bits) - 1) as f32;
    // What fits 16 bits needs no conversion to 64, which takes a processor with an f32 unit longer.
    u64::from(((x - least) * most / span).clamp(0.0, most) as u32)
}

/// The number of a code between `-end` and `end`.
pub fn unpack(code: u32, end: f32, bits: u32) -> f32 {
    let most = ((1u32 << bits) - 1) as f32;
    code as f32 * (2.0 * end) / most - end
}

/// A setpoint as a payload, as a little-endian word. It is never that of a special frame.
pub fn pack(ranges: &MitRanges, setpoint: &Setpoint) -> u64 {
    let both = |x, end: f32, bits| code(x, -end, 2.0 * end, bits);
    let position = both(setpoint.position, ranges.position, 16);
    let velocity = both(setpoint.velocity, ranges.velocity, 12);
    let kp = code(setpoint.kp, 0.0, KP_RANGE, 12);
    let kd = code(setpoint.kd, 0.0, KD_RANGE, 12);
    let torque = both(setpoint.torque, ranges.torque, 12);
    let word = position << 48 | velocity << 36 | kp << 24 | kd << 12 | torque;
    let word = word.swap_bytes();
    if word & MARK == MARK {
        // Every field is at its end: the lowest bit of the stiffness is the one that nobody misses.
        word & !(1 << 32)
    } else {
        word
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::mit::{MODELS, preset};
    use proptest::prelude::*;

    const AK80_9: MitRanges = MitRanges {
        position: 12.5,
        velocity: 50.0,
        torque: 18.0,
    };

    #[test]
    fn special_frames_are_as_the_manual_says() {
        for (word, last) in [(ENTER, 0xFC), (EXIT, 0xFD), (ZERO, 0xFE)] {
            let wanted = [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, last];
            assert_eq!(word.to_le_bytes(), wanted);
        }
    }

    /// By hand from the layout: 32767, 2047 of 4095 in the middle; 1 rad is 35389.
    #[test]
    fn a_setpoint_is_packed_as_the_layout_says() {
        let rest = Setpoint::default();
        let middle = [0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF];
        assert_eq!(pack(&AK80_9, &rest).to_le_bytes(), middle);
        let setpoint = Setpoint {
            position: 1.0,   // 13.5 * 65535 / 25 = 35388.9: 0x8A3C
            velocity: -10.0, // 40 * 4095 / 100 = 1638: 0x666
            kp: 100.0,       // 100 * 4095 / 500 = 819: 0x333
            kd: 1.0,         // 4095 / 5 = 819: 0x333
            torque: 3.0,     // 21 * 4095 / 36 = 2388.75: 0x954
        };
        let wanted = [0x8A, 0x3C, 0x66, 0x63, 0x33, 0x33, 0x39, 0x54];
        assert_eq!(pack(&AK80_9, &setpoint).to_le_bytes(), wanted);
    }

    #[test]
    fn both_ends_and_nonsense_have_codes() {
        for (x, wanted) in [
            (12.5, 65_535),
            (-12.5, 0),
            (1e9, 65_535),
            (-1e9, 0),
            (f32::INFINITY, 65_535),
            (f32::NAN, 0),
        ] {
            assert_eq!(code(x, -12.5, 25.0, 16), wanted, "{x}");
        }
        assert_eq!(unpack(0, 12.5, 16), -12.5);
        assert_eq!(unpack(65_535, 12.5, 16), 12.5);
    }

    #[test]
    fn the_frames_that_would_be_special_are_not() {
        let all = Setpoint {
            position: 12.5,
            velocity: 50.0,
            kp: 500.0,
            kd: 5.0,
            torque: 18.0,
        };
        for steps in 0..=300u16 {
            let torque = 18.0 - f32::from(steps) * 36.0 / 4095.0;
            let word = pack(&AK80_9, &Setpoint { torque, ..all });
            assert_ne!(word & MARK, MARK, "{torque}");
            // Only the stiffness gave way, by one step.
            assert_eq!(word | 1 << 32, word | MARK & word | 1 << 32);
            let bytes = word.to_le_bytes();
            assert_eq!((bytes[0], bytes[1], bytes[2]), (0xFF, 0xFF, 0xFF));
        }
    }

    fn any_number() -> impl Strategy<Value = f32> {
        prop_oneof![any::<u32>().prop_map(f32::from_bits), -600.0..600.0f32]
    }

    proptest! {
        #[test]
        fn no_setpoint_of_any_model_is_a_special_frame(
            model in 1..MODELS.len(),
            numbers: [bool; 5],
            others in prop::array::uniform5(any_number()),
        ) {
            let ranges = preset(model).expect("a preset");
            let ends = [ranges.position, ranges.velocity, KP_RANGE, KD_RANGE, ranges.torque];
            // The ends more often than chance would have them.
            let mut value = [0.0; 5];
            for place in 0..5 {
                value[place] = if numbers[place] { ends[place] } else { others[place] };
            }
            let [position, velocity, kp, kd, torque] = value;
            let word = pack(&ranges, &Setpoint { position, velocity, kp, kd, torque });
            prop_assert_ne!(word & MARK, MARK);
        }

        #[test]
        fn what_is_packed_comes_back_within_a_step(position in -12.5..12.5f32, velocity in -50.0..50.0f32) {
            let setpoint = Setpoint { position, velocity, ..Setpoint::default() };
            let bytes = pack(&AK80_9, &setpoint).to_le_bytes();
            let code = u32::from(u16::from_be_bytes([bytes[0], bytes[1]]));
            let back = unpack(code, 12.5, 16);
            prop_assert!(back <= position + 1e-5 && position - back <= 25.0 / 65535.0 + 1e-5);
            let code = u32::from(bytes[2]) << 4 | u32::from(bytes[3] >> 4);
            let back = unpack(code, 50.0, 12);
            prop_assert!(back <= velocity + 1e-4 && velocity - back <= 100.0 / 4095.0 + 1e-4);
        }
    }
}
