//! A client that reads, writes and saves parameters of the simulated robot.

use canter::client::{Change, Client, ClientError};
use canter::robot::Robot;
use canter::sim::{Configuration, SimulatedBus};
use canter_shared::parameter::Parameter;
use canter_shared::wire::id::AxisId;
use canter_shared::wire::reason::Reason;

fn axes(ids: &[u8]) -> Vec<AxisId> {
    ids.iter().copied().filter_map(AxisId::new).collect()
}

fn held(ids: &[u8]) -> Client<SimulatedBus> {
    let configuration = Configuration::of(&Robot::default());
    let mut client = Client::new(SimulatedBus::new(&configuration), 0x1234);
    client.hold(&axes(ids)).expect("nobody holds them");
    client
}

fn change(id: u8, parameter: Parameter, raw: i64) -> Change {
    Change {
        axis: axes(&[id])[0],
        parameter,
        raw,
    }
}

fn value(client: &mut Client<SimulatedBus>, id: u8, parameter: Parameter) -> i64 {
    let read = client.read_parameters(axes(&[id])[0], &[parameter]);
    read.expect("it answers")[0].1.value
}

#[test]
fn what_is_written_is_read_and_saved() {
    let mut client = held(&[2]);
    let jerk = Parameter::JerkLimit;
    client
        .write_parameters(&[change(2, jerk, 5_000_000)])
        .expect("in range");
    let read = |client: &mut Client<_>| {
        let read = client.read_parameters(axes(&[2])[0], &[jerk]);
        read.expect("it answers")[0].1
    };
    let before = read(&mut client);
    assert_eq!(before.value, 5_000_000);
    assert_eq!(before.saved, before.default);
    client.save_parameters(&axes(&[2])).expect("it is disabled");
    assert_eq!(read(&mut client).saved, 5_000_000);
    client.restore_parameters(&axes(&[2])).expect("disabled");
    let after = read(&mut client);
    assert_eq!((after.value, after.saved), (after.default, 5_000_000));
    // Another axis is as it was.
    let other = value(&mut client, 3, jerk);
    assert_eq!(other, after.default);
}

#[test]
fn a_moves_limits_are_the_nodes_own() {
    let mut client = held(&[1, 2]);
    client
        .write_parameters(&[change(1, Parameter::VelocityLimit, 500_000_000)])
        .expect("in range");
    let robot = client.read_robot(&axes(&[1, 2])).expect("they answer");
    let velocity = |id: u8| robot.limits(axes(&[id])[0]).velocity().radians();
    assert!((velocity(1) - 0.5).abs() < 1e-8);
    assert!((velocity(2) - 20.0).abs() < 1e-8);
}

/// The second axis is another's: what the first one took is taken back.
#[test]
fn a_refusal_on_the_way_changes_nothing_in_the_end() {
    let mut client = held(&[1]);
    let jerk = Parameter::JerkLimit;
    let before = value(&mut client, 1, jerk);
    let changes = [change(1, jerk, 1_000_000), change(2, jerk, 1_000_000)];
    let error = client
        .write_parameters(&changes)
        .expect_err("2 is not held");
    assert!(
        matches!(error, ClientError::Refused { axis, reason: Reason::NotHeld, .. } if axis.get() == 2),
        "{error}"
    );
    assert_eq!(value(&mut client, 1, jerk), before);
}

#[test]
fn what_changes_while_disabled_is_refused_while_enabled() {
    let mut client = held(&[1]);
    client.enable(&axes(&[1])).expect("it is well");
    let changes = [
        change(1, Parameter::JerkLimit, 1_000_000),
        change(1, Parameter::DriveNode, 9),
    ];
    let error = client
        .write_parameters(&changes)
        .expect_err("it is enabled");
    assert!(
        matches!(error, ClientError::ChangesDisabled { .. }),
        "{error}"
    );
    assert!(error.to_string().contains("canter disable 1"), "{error}");
    assert_ne!(value(&mut client, 1, Parameter::JerkLimit), 1_000_000);
    let error = client.save_parameters(&axes(&[1])).expect_err("enabled");
    let words = "only while the axis is disabled";
    assert!(error.to_string().contains(words), "{error}");
}
