//! The drive that the parameters choose, behind a node.

use super::bench::{settings, texts, turns};
use canter_shared::drive::link::DriveLink;
use canter_shared::drive::settings::DriveKind;
use canter_shared::drive::{Condition, Drive, DriveCommand};
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::parameter::{Parameter, Values};
use canter_shared::time::Tick;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::AxisId;

const IDENTITY: Identity = Identity {
    chip: [1; 12],
    firmware: [0, 1, 0],
    board: Board::Simulated,
};

fn axis(id: u8) -> AxisId {
    AxisId::new(id).expect("1 to 63")
}

/// Three axes with drives of this kind.
fn node(kind: DriveKind) -> Node<DriveLink, 3> {
    let mut node = Node::new(IDENTITY);
    for id in 1..=3 {
        let raw = u8::from(kind).into();
        let values = Values::of_limits(id, &Limits::default());
        let (values, _) = values.with(Parameter::DriveKind, raw).expect("it fits");
        let link = DriveLink::new(&values.drive());
        node.add_axis_with_values(axis(id), &values, link)
            .expect("room");
    }
    node
}

/// What a node sends to its drives at each of the next ticks.
fn ticks(node: &mut Node<DriveLink, 3>, count: u32) -> Vec<Vec<String>> {
    let tick = |_| {
        let now = node.next_tick();
        node.tick(now);
        while node.poll_transmit(now).is_some() {}
        let sent: Vec<_> = std::iter::from_fn(|| node.poll_drive_transmit()).collect();
        texts(&sent)
    };
    (0..count).map(tick).collect()
}

#[test]
fn the_first_words_are_those_of_the_kind() {
    let sent = |kind| ticks(&mut node(kind), 2).concat();
    assert_eq!(sent(DriveKind::Simulated), [""; 0]);
    assert_eq!(sent(DriveKind::Odrive), [""; 0]);
    let exit = |id: u8| format!("{id:03X}#FFFFFFFFFFFFFFFD");
    assert_eq!(sent(DriveKind::Mit), [exit(3), exit(2), exit(1)]);
    let first = &sent(DriveKind::Cia402)[..2];
    assert_eq!(first, ["000#8003", "603#2B40600000000000"]);
}

#[test]
fn one_sync_follows_the_setpoints_of_all_the_lowest_id_last() {
    let mut node = node(DriveKind::Cia402);
    for _ in 0..40 {
        let now = node.next_tick();
        node.tick(now);
        let sent: Vec<_> = std::iter::from_fn(|| node.poll_drive_transmit()).collect();
        for frame in sent.iter().filter(|frame| frame.id() >> 4 == 0x60) {
            let mut answer = [0; 8];
            answer[..4].copy_from_slice(&frame.data()[..4]);
            answer[0] = 0x60;
            let answer = canter_shared::wire::frame::Frame::new(frame.id() - 0x80, &answer);
            node.handle_drive_frame(&answer.expect("a frame"));
        }
        for id in 1..=3u16 {
            let place = canter_shared::wire::frame::Frame::new(0x180 + id, &[0x50, 2, 0, 0, 0, 0]);
            node.handle_drive_frame(&place.expect("a frame"));
        }
    }
    for sent in ticks(&mut node, 5) {
        let wanted = [
            "203#000000000000",
            "202#000000000000",
            "201#000000000000",
            "080#",
        ];
        assert_eq!(sent, wanted);
    }
}

/// Sets a parameter of axis 2, and whatever that takes before.
fn set(node: &mut Node<DriveLink, 3>, sequence: u8, parameter: Parameter, value: i64) {
    let session = 9;
    let control = |action, sequence| Command::Control {
        action,
        sequence,
        session,
    };
    let write = Command::ParameterWrite {
        parameter: parameter.into(),
        value,
        sequence: sequence + 2,
    };
    for command in [
        control(Action::Hold, sequence),
        control(Action::Configure, sequence + 1),
        write,
    ] {
        let frame = command.encode(axis(2).into()).expect("it fits");
        node.handle_frame(node.next_tick(), &frame);
    }
}

#[test]
fn a_kind_that_is_set_while_the_node_runs_holds_at_once() {
    let mut node = node(DriveKind::Simulated);
    assert_eq!(ticks(&mut node, 5).concat(), [""; 0]);
    set(&mut node, 1, Parameter::DriveKind, 2);
    let sent = ticks(&mut node, 3).concat();
    assert_eq!(sent, ["002#FFFFFFFFFFFFFFFD"]);
}

#[test]
fn a_link_begins_anew_where_a_parameter_changes_and_not_where_it_is_set_to_what_it_is() {
    let mut node = node(DriveKind::Mit);
    // Told to hold no torque, and again after ten ticks.
    assert_eq!(ticks(&mut node, 2).concat().len(), 3);
    for (sequence, gear, sent) in [(1, 1_000_000_000, 0), (11, 2_000_000_000, 1)] {
        set(&mut node, sequence, Parameter::GearRatio, gear);
        assert_eq!(ticks(&mut node, 2).concat().len(), sent, "{gear}");
    }
}

#[test]
fn what_was_heard_is_forgotten_with_the_drive() {
    let with = |changes: &[_]| settings(DriveKind::Odrive, 2, changes);
    let mut link = DriveLink::new(&with(&[]));
    let hear = |link: &mut DriveLink| {
        let turn = 1f32.to_le_bytes();
        let estimates = [turn, [0; 4]].concat();
        for (id, data) in [(0x41, &[0, 0, 0, 0, 1, 0, 0, 0][..]), (0x49, &estimates)] {
            let frame = canter_shared::wire::frame::Frame::new(id, data).expect("a frame");
            assert!(link.receive(&frame));
        }
        link.command(Tick(0), DriveCommand::default());
        assert_eq!(link.report().condition, Condition::Disabled);
        turns(link.report().position)
    };
    assert_eq!(hear(&mut link), 1.0);
    link.configure(|| with(&[(Parameter::GearRatio, 2.0)]));
    assert_eq!(link.report().condition, Condition::Lost);
    assert_eq!(hear(&mut link), 0.5);
}
