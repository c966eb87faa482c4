//! Parameters on their way to the store: who is answered what, and when.

use super::three::Three;
use canter_shared::axis::state::State;
use canter_shared::parameter::Parameter;
use canter_shared::wire::command::{Action, Command, Item};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

fn held() -> Three {
    let mut three = Three::new();
    for id in 1..=3 {
        three.control(id, Action::Hold);
    }
    three.told();
    three
}

fn write(three: &mut Three, id: u8, value: i64) {
    three.sequence += 1;
    let command = Command::ParameterWrite {
        parameter: Parameter::JerkLimit.into(),
        value,
        sequence: three.sequence,
    };
    three.say(super::three::axis(id).into(), command);
    assert_eq!(three.told().len(), 1);
}

/// The value of axis `id` that will be there after a loss of power.
fn saved(three: &mut Three, id: u8) -> i64 {
    let ask = Command::ParameterRead {
        parameter: Parameter::JerkLimit.into(),
        item: Item::Saved,
    };
    three.say(super::three::axis(id).into(), ask);
    let now = three.node.next_tick();
    let mut value = None;
    while let Some(frame) = three.node.poll_transmit(now) {
        if let Ok(Some((_, Report::Parameter { value: read, .. }))) = Report::decode(&frame) {
            value = Some(read);
        }
    }
    value.expect("an answer")
}

fn answer(id: u8, sequence: u8, reason: Reason, detail: u32) -> super::three::Told {
    (id, Function::Control, sequence, reason, detail)
}

#[test]
fn a_save_is_answered_once_it_is_written() {
    let mut three = held();
    write(&mut three, 2, 1_000_000);
    let default = saved(&mut three, 2);
    let sequence = three.control(2, Action::Save);
    assert_eq!(three.told(), []);
    let image = three.node.take_save().expect("something to save");
    assert_eq!(three.node.take_save(), None);
    // All axes, and what was set; a later change is not in it.
    let ids: Vec<u8> = image.iter().map(|stored| stored.axis).collect();
    assert_eq!(ids, [1, 2, 3]);
    assert_eq!(image[1].values.get(Parameter::JerkLimit), 1_000_000);
    // The same command again gets the one answer.
    three.sequence -= 1;
    three.control(2, Action::Save);
    write(&mut three, 2, 2_000_000);
    assert_eq!(saved(&mut three, 2), default);
    three.node.saved(&image, true);
    assert_eq!(three.told(), [answer(2, sequence, Reason::Accepted, 0)]);
    assert_eq!(saved(&mut three, 2), 1_000_000);
    assert_eq!(three.node.take_save(), None);
}

#[test]
fn a_repeated_save_gets_its_answer_again_and_writes_nothing() {
    let mut three = held();
    let sequence = three.control(1, Action::Save);
    let image = three.node.take_save().expect("something to save");
    three.node.saved(&image, true);
    assert_eq!(three.told(), [answer(1, sequence, Reason::Accepted, 0)]);
    three.sequence -= 1;
    three.control(1, Action::Save);
    assert_eq!(three.told(), [answer(1, sequence, Reason::Accepted, 0)]);
    assert!(!three.node.has_save());
}

#[test]
fn a_save_that_fails_is_told_and_what_was_saved_stays() {
    let mut three = held();
    write(&mut three, 1, 1_000_000);
    let default = saved(&mut three, 1);
    let sequence = three.control(1, Action::Save);
    let image = three.node.take_save().expect("something to save");
    three.node.saved(&image, false);
    assert_eq!(three.told(), [answer(1, sequence, Reason::SaveFailed, 0)]);
    assert_eq!(saved(&mut three, 1), default);
}

#[test]
fn one_write_answers_all_who_asked_before_it() {
    let mut three = held();
    let sequences = [1, 2, 3].map(|id| three.control(id, Action::Save));
    let image = three.node.take_save().expect("something to save");
    three.node.saved(&image, true);
    let wanted = [1, 2, 3].map(|id| {
        let sequence = sequences[usize::from(id) - 1];
        answer(id, sequence, Reason::Accepted, 0)
    });
    assert_eq!(three.told(), wanted);
}

#[test]
fn one_who_asks_while_it_is_written_waits_for_the_next() {
    let mut three = held();
    let first = three.control(1, Action::Save);
    let image = three.node.take_save().expect("something to save");
    let second = three.control(2, Action::Save);
    three.node.saved(&image, true);
    assert_eq!(three.told(), [answer(1, first, Reason::Accepted, 0)]);
    let image = three.node.take_save().expect("something to save");
    three.node.saved(&image, true);
    assert_eq!(three.told(), [answer(2, second, Reason::Accepted, 0)]);
}

#[test]
fn of_two_saves_of_one_axis_the_newer_counts() {
    let mut three = held();
    let first = three.control(1, Action::Save);
    let image = three.node.take_save().expect("something to save");
    let second = three.control(1, Action::Save);
    let overtaken = answer(1, first, Reason::Overtaken, second.into());
    assert_eq!(three.told(), [overtaken]);
    three.node.saved(&image, true);
    assert_eq!(three.told(), []);
    let image = three.node.take_save().expect("something to save");
    three.node.saved(&image, true);
    assert_eq!(three.told(), [answer(1, second, Reason::Accepted, 0)]);
}

#[test]
fn nothing_is_saved_while_an_axis_of_the_node_holds_torque() {
    let mut three = held();
    three.control(3, Action::Enable);
    three.run(10);
    three.told();
    let enabled = u8::from(State::OperationEnabled).into();
    for id in [1, 3] {
        let sequence = three.control(id, Action::Save);
        let refused = answer(id, sequence, Reason::NotDisabled, enabled);
        assert_eq!(three.told(), [refused]);
        assert_eq!(three.node.take_save(), None);
    }
    three.control(3, Action::Disable);
    three.run(10);
    three.told();
    // One that is enabled after the question, and before the owner comes to it.
    let sequence = three.control(1, Action::Save);
    three.control(3, Action::Enable);
    three.run(1);
    assert_eq!(three.node.take_save(), None);
    let ready = u8::from(State::ReadyToSwitchOn).into();
    let refused = answer(1, sequence, Reason::NotDisabled, ready);
    assert!(three.told().contains(&refused));
}
