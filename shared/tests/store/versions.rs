//! What another firmware has saved, with parameters that this one does not know or takes otherwise.

use super::cut::{Memory, SLOT, START};
use canter_shared::parameter::store::{Loaded, Store};
use canter_shared::parameter::{Parameter, Values};

/// A slot made by hand, from the description in the documents: CRC-32 as zip has it.
fn written(generation: u32, body: &[u8]) -> Memory {
    let mut header = b"cntr\x01\x00\xFF\xFF".to_vec();
    header.extend(generation.to_le_bytes());
    header.extend((body.len() as u32).to_le_bytes());
    let mut check = !0u32;
    for byte in header.iter().chain(body) {
        check ^= u32::from(*byte);
        for _ in 0..8 {
            check = (check >> 1) ^ (0xEDB8_8320 & 0u32.wrapping_sub(check & 1));
        }
    }
    header.extend((!check).to_le_bytes());
    let mut memory = Memory::new();
    let start = START as usize;
    memory.bytes_mut()[start..start + header.len()].copy_from_slice(&header);
    memory.bytes_mut()[start + 32..start + 32 + body.len()].copy_from_slice(body);
    memory
}

fn pair(number: u8, raw: i64) -> [u8; 7] {
    let [a, b, c, d, e, f, ..] = raw.to_le_bytes();
    [number, a, b, c, d, e, f]
}

fn load(axis: u8, pairs: &[[u8; 7]]) -> Loaded<3> {
    let mut body = vec![axis, pairs.len() as u8];
    body.extend(pairs.concat());
    Store::new(written(7, &body), START, SLOT).load()
}

fn only(loaded: Loaded<3>) -> Values {
    let Loaded::Image(image) = loaded else {
        panic!("{loaded:?}");
    };
    assert_eq!(image.len(), 1);
    image[0].values
}

#[test]
fn a_firmware_that_knew_fewer_parameters_leaves_the_others_their_defaults() {
    let velocity = Parameter::VelocityLimit;
    let values = only(load(5, &[pair(velocity.into(), 3_000_000_000)]));
    let expected = Values::defaults(5).with(velocity, 3_000_000_000);
    assert_eq!(values, expected.expect("in range").0);
}

#[test]
fn a_parameter_that_is_not_known_is_passed_over() {
    let jerk = Parameter::JerkLimit;
    let values = only(load(
        5,
        &[pair(200, -1), pair(jerk.into(), 5), pair(255, 1)],
    ));
    assert_eq!(
        values,
        Values::defaults(5).with(jerk, 5).expect("in range").0
    );
}

#[test]
fn a_value_that_is_out_of_range_or_contradicts_leaves_the_default() {
    let defaults = Values::defaults(5);
    let minimum = Parameter::PositionMinimum.into();
    let maximum = Parameter::PositionMaximum.into();
    for pairs in [
        // Out of range, at both ends and with the sign.
        vec![pair(Parameter::VelocityLimit.into(), i64::MAX >> 17)],
        vec![pair(Parameter::VelocityLimit.into(), 0)],
        vec![pair(Parameter::HostTimeout.into(), -1)],
        vec![pair(Parameter::HostReaction.into(), 3)],
    ] {
        assert_eq!(only(load(5, &pairs)), defaults, "{pairs:?}");
    }
    let crossed = only(load(5, &[pair(minimum, 1_000), pair(maximum, -1_000)]));
    let expected = defaults.with(Parameter::PositionMinimum, 1_000);
    assert_eq!(crossed, expected.expect("in range").0);
}

#[test]
fn a_body_that_makes_no_sense_is_lost() {
    let halves: [&[u8]; 4] = [&[5], &[5, 1, 0, 0], &[0, 0], &[5, 0, 5, 0]];
    for body in halves {
        let loaded: Loaded<3> = Store::new(written(7, body), START, SLOT).load();
        assert_eq!(loaded, Loaded::Lost, "{body:?}");
    }
}

#[test]
fn the_newest_counts_across_the_end_of_the_numbers() {
    let body = [5, 0];
    let mut memory = written(u32::MAX, &body);
    let newer = written(0, &[6, 0]);
    let slot = SLOT as usize;
    let start = START as usize;
    let part = newer.bytes()[start..start + slot].to_vec();
    memory.bytes_mut()[start + slot..start + 2 * slot].copy_from_slice(&part);
    let Loaded::Image(image) = Store::new(memory, START, SLOT).load::<3>() else {
        panic!("it is whole");
    };
    assert_eq!(image[0].axis, 6);
}
