//! Who holds the axis, and how it is given back.

use super::bench::{AXIS, Bench, OTHER, SESSION};
use canter_shared::axis::Outcome;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::wire::command::{Action, Command, Session};
use canter_shared::wire::id::Address;
use canter_shared::wire::reason::Reason;

fn by(session: Session, sequence: u8, action: Action) -> Command {
    Command::Control {
        action,
        sequence,
        session,
    }
}

#[test]
fn without_a_hold_there_is_no_motion() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    let not_held = Outcome::Rejected(Reason::NotHeld);
    assert_eq!(bench.control(Action::Enable), not_held);
    assert_eq!(bench.go(1.0, 1_000), not_held);
    bench.stays(100);
}

#[test]
fn session_zero_is_nobody() {
    let mut bench = Bench::new(Limits::default(), 0.0);
    bench.run(5);
    assert_eq!(
        bench.send(by(0, 1, Action::Hold)),
        Outcome::Rejected(Reason::BadValue)
    );
    assert_eq!(bench.axis.session(), None);
}

#[test]
fn a_second_session_is_told_who_holds_the_axis() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let actions = [
        Action::Hold,
        Action::Release,
        Action::Enable,
        Action::Disable,
        Action::Clear,
    ];
    for (action, number) in actions.into_iter().zip(3..) {
        assert_eq!(
            bench.send(by(OTHER, number, action)),
            Outcome::Rejected(Reason::HeldByOther),
            "{action:?}"
        );
        let answer = bench.answer();
        assert_eq!(answer.detail, SESSION.into());
        assert_eq!(answer.sequence, number);
    }
    bench.run(5);
    assert_eq!(bench.axis.session(), Some(SESSION));
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    // Its numbers have used up none of the holder's.
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
}

#[test]
fn anybody_may_stop() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(5.0, 4_000), Outcome::Accepted);
    bench.run(2_000);
    let stop = Command::Stop { sequence: 200 };
    for address in [Address::All, Address::Axis(AXIS)] {
        let frame = stop.encode(address).expect("fits");
        assert_eq!(bench.handle(&frame), Outcome::Accepted);
        assert_eq!(bench.answer().sequence, 200);
    }
    bench.ticks_to_rest(150);
    bench.stays(1_000);
}

#[test]
fn a_moving_axis_is_not_released() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    for _ in 0..2 {
        assert_eq!(
            bench.control(Action::Release),
            Outcome::Rejected(Reason::Moving)
        );
        assert_eq!(bench.axis.session(), Some(SESSION));
        bench.run(500);
    }
    bench.run(10);
    assert_eq!(bench.control(Action::Release), Outcome::Accepted);
    assert_eq!(bench.axis.session(), None);
}

/// Or nobody would watch over it when it leaves.
#[test]
fn an_axis_with_a_start_ahead_of_it_is_not_released() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.trigger(group, 10_000), Outcome::Accepted);
    bench.run(5_000);
    assert_eq!(
        bench.control(Action::Release),
        Outcome::Rejected(Reason::Moving)
    );
}

#[test]
fn after_a_release_the_axis_holds_its_place_for_the_next_session() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    assert_eq!(bench.go(1.0, 1_000), Outcome::Accepted);
    bench.run(1_000);
    assert_eq!(bench.control(Action::Release), Outcome::Accepted);
    bench.beats = false;
    bench.stays(5_000);
    assert_eq!(bench.axis.state(), State::OperationEnabled);
    assert_eq!(bench.axis.fault(), None);
    assert_eq!(bench.go(2.0, 1_000), Outcome::Rejected(Reason::NotHeld));
    assert_eq!(bench.send(by(OTHER, 77, Action::Hold)), Outcome::Accepted);
    assert_eq!(bench.axis.session(), Some(OTHER));
    bench.sequence = 77;
    assert_eq!(bench.go(2.0, 1_000), Outcome::Accepted);
    bench.run(100);
    assert!(bench.velocity() > 0.0);
}

#[test]
fn what_is_staged_does_not_outlive_a_release() {
    let mut bench = Bench::enabled(Limits::default(), 0.0);
    let group = bench.stage(1.0, 1_000);
    assert_eq!(bench.control(Action::Release), Outcome::Accepted);
    assert_eq!(bench.control(Action::Hold), Outcome::Accepted);
    assert_eq!(bench.trigger(group, 5), Outcome::Ignored);
    bench.stays(2_000);
}
