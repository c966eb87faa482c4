//! An axis gets another id, by the chip's.

use super::three::{CHIP, FIRST, LAST, Three, Told, axis};
use canter_shared::axis::state::State;
use canter_shared::wire::command::{Action, AssignPart, Command};
use canter_shared::wire::id::{Address, Function};
use canter_shared::wire::reason::Reason;
use proptest::prelude::*;

fn answer(id: u8, sequence: u8, reason: Reason, detail: u32) -> Told {
    (id, Function::Assign, sequence, reason, detail)
}

#[test]
fn the_axis_has_its_new_id_at_once_and_answers_from_it() {
    let mut three = Three::new();
    three.give(FIRST, LAST, 2, 40, 7);
    assert_eq!(three.told(), [answer(40, 7, Reason::Accepted, 0)]);
    assert_eq!(three.ids(), [1, 40, 3]);
    // The old id is nobody's any more; the new one is obeyed.
    three.control(2, Action::Hold);
    assert_eq!(three.told(), []);
    let sequence = three.control(40, Action::Hold);
    let hold = (40, Function::Control, sequence, Reason::Accepted, 0);
    assert_eq!(three.told(), [hold]);
}

#[test]
fn it_is_part_of_what_is_saved() {
    let mut three = Three::new();
    three.give(FIRST, LAST, 1, 63, 1);
    three.control(63, Action::Hold);
    three.control(63, Action::Save);
    let image = three.node.take_save().expect("something to save");
    let ids: Vec<u8> = image.iter().map(|stored| stored.axis).collect();
    assert_eq!(ids, [63, 2, 3]);
}

#[test]
fn a_repetition_gets_the_same_answer() {
    let mut three = Three::new();
    for _ in 0..2 {
        three.give(FIRST, LAST, 1, 9, 5);
        assert_eq!(three.told(), [answer(9, 5, Reason::Accepted, 0)]);
        assert_eq!(three.ids(), [9, 2, 3]);
    }
    // Under another number it is a new one, and there is no axis 1 any more.
    three.give(FIRST, LAST, 1, 9, 6);
    assert_eq!(three.told(), [answer(9, 6, Reason::IdTaken, 1)]);
}

#[test]
fn what_cannot_be_is_refused_from_the_old_id() {
    let mut three = Three::new();
    for (from, to, expected) in [
        (2, 0, answer(2, 1, Reason::BadValue, 0)),
        (2, 64, answer(2, 1, Reason::BadValue, 0)),
        (2, 3, answer(2, 1, Reason::IdTaken, 3)),
        // Not from an id that may be another node's.
        (17, 18, answer(1, 1, Reason::IdTaken, 17)),
    ] {
        three.give(FIRST, LAST, from, to, 1);
        assert_eq!(three.told(), [expected]);
        assert_eq!(three.ids(), [1, 2, 3]);
    }
    // Its own id is not taken by another.
    three.give(FIRST, LAST, 2, 2, 1);
    assert_eq!(three.told(), [answer(2, 1, Reason::Accepted, 0)]);
}

#[test]
fn an_axis_that_is_held_or_holds_torque_keeps_its_id() {
    let mut three = Three::new();
    three.control(1, Action::Hold);
    three.told();
    three.give(FIRST, LAST, 1, 9, 1);
    let session = super::bench::SESSION.into();
    assert_eq!(three.told(), [answer(1, 1, Reason::HeldByOther, session)]);
    three.control(1, Action::Enable);
    three.run(10);
    three.told();
    three.give(FIRST, LAST, 1, 9, 2);
    let state = u8::from(State::OperationEnabled).into();
    assert_eq!(three.told(), [answer(1, 2, Reason::NotDisabled, state)]);
    assert_eq!(three.ids(), [1, 2, 3]);
}

/// Two nodes with one id latch a fault, and this is its cure.
#[test]
fn a_fault_is_no_hindrance() {
    let mut three = Three::new();
    three.say(Address::All, Command::EmergencyStop);
    three.run(5);
    three.told();
    three.give(FIRST, LAST, 1, 9, 1);
    assert_eq!(three.told(), [answer(9, 1, Reason::Accepted, 0)]);
}

#[test]
fn another_chip_is_not_meant() {
    let mut three = Three::new();
    for (first, last) in [(*b"second", LAST), (FIRST, *b"chip 2"), (LAST, FIRST)] {
        three.give(first, last, 1, 9, 1);
        assert_eq!(three.told(), []);
    }
    assert_eq!(three.ids(), [1, 2, 3]);
}

/// The halves of two chips that agree in one half must not be put together.
#[test]
fn a_part_of_another_assignment_between_calls_it_off() {
    let change = AssignPart::Axis {
        axis: 1,
        new_axis: 9,
        sequence: 1,
    };
    let first = AssignPart::ChipFirst(FIRST);
    let last = AssignPart::ChipLast(LAST);
    let other_first = AssignPart::ChipFirst(*b"second");
    let other_last = AssignPart::ChipLast(*b"chip 2");
    for parts in [
        &[first, other_last, last, change][..],
        &[first, other_first, last, change],
        &[first, last, other_first, change],
        &[first, last, other_last, change],
        &[last, first, change],
        &[first, change],
        &[change],
    ] {
        let mut three = Three::new();
        for part in parts {
            three.assign(*part);
        }
        assert_eq!(
            (three.told(), three.ids()),
            (vec![], vec![1, 2, 3]),
            "{parts:?}"
        );
    }
    // Other frames between do not matter.
    let mut three = Three::new();
    three.assign(first);
    three.control(2, Action::Hold);
    three.assign(last);
    three.say(Address::All, Command::IdentityRequest);
    three.assign(change);
    assert_eq!(three.ids(), [9, 2, 3]);
}

proptest! {
    /// Whatever parts arrive, ids stay valid and each once, and torque and sessions are respected.
    #[test]
    fn ids_stay_valid_and_different(
        parts in prop::collection::vec((0u8..8, any::<u8>(), any::<u8>(), 0u8..4), 1..80),
    ) {
        let mut three = Three::new();
        let held = three.ids()[2];
        three.control(held, Action::Hold);
        for (kind, from, to, sequence) in parts {
            let part = match kind {
                0 => AssignPart::ChipFirst([from; 6]),
                1..=3 => AssignPart::ChipFirst(FIRST),
                4 => AssignPart::ChipLast(LAST),
                _ => AssignPart::Axis { axis: from % 5, new_axis: to % 70, sequence },
            };
            if kind == 4 {
                three.assign(AssignPart::ChipFirst(FIRST));
            }
            three.assign(part);
            let ids = three.ids();
            prop_assert!(ids.iter().all(|id| (1..=63).contains(id)), "{:?}", ids);
            prop_assert!(ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0], "{:?}", ids);
            prop_assert_eq!(ids[2], held);
            three.told();
        }
    }
}

#[test]
fn the_chip_is_the_one_that_a_scan_tells() {
    let mut three = Three::new();
    three.say(axis(1).into(), Command::IdentityRequest);
    let now = three.node.next_tick();
    let mut chip = Vec::new();
    while let Some(frame) = three.node.poll_transmit(now) {
        use canter_shared::wire::report::{IdentityPart, Report};
        match Report::decode(&frame) {
            Ok(Some((_, Report::Identity(IdentityPart::ChipFirst(half)))))
            | Ok(Some((_, Report::Identity(IdentityPart::ChipLast(half))))) => chip.extend(half),
            _ => {}
        }
    }
    assert_eq!(chip, CHIP);
}
