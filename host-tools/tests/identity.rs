//! Two nodes that have the same id by mistake, and how that is cured.

use canter::client::{ChipId, Client, ClientError, Goal, MoveRequest, Target};
use canter::robot::RobotAxis;
use canter::sim::{Configuration, SimulatedBus};
use canter_shared::wire::command::ProfileKind;
use canter_shared::wire::id::AxisId;

fn axis(id: u8) -> AxisId {
    AxisId::new(id).expect("1 to 63")
}

/// Axes of nodes of their own, with one client.
fn client(axes: &[u8]) -> Client<SimulatedBus> {
    let axes = axes.iter().map(|id| RobotAxis::new(axis(*id)));
    let configuration = Configuration {
        axes: axes.collect(),
        ..Configuration::default()
    };
    Client::new(SimulatedBus::new(&configuration), 0x1234)
}

fn chips(client: &mut Client<SimulatedBus>, id: u8) -> Vec<ChipId> {
    let nodes = client.scan().expect("the bus works");
    let node = nodes.iter().find(|node| node.axis == axis(id));
    node.map(|node| node.chips()).unwrap_or_default()
}

#[test]
fn one_of_two_nodes_with_one_id_gets_another_and_both_move() {
    let mut client = client(&[5, 5, 7]);
    let both = chips(&mut client, 5);
    assert_eq!(both.len(), 2);
    let doubled = client.check(&[axis(5)]);
    assert!(matches!(doubled, Err(ClientError::Doubled { .. })));

    client
        .assign(both[1], Some(axis(5)), axis(6))
        .expect("6 is free");
    assert_eq!(chips(&mut client, 5), [both[0]]);
    assert_eq!(chips(&mut client, 6), [both[1]]);

    let moved = [axis(5), axis(6)];
    client.check(&moved).expect("each is there once");
    client.hold(&moved).expect("nobody holds them");
    // Two that shared an id may have latched the fault that says so.
    client.clear(&moved).expect("they rest");
    client.enable(&moved).expect("they are well");
    let robot = client.read_robot(&moved).expect("they answer");
    let request = MoveRequest {
        goals: vec![
            Goal {
                axis: axis(5),
                target: Target::Absolute(1.0),
            },
            Goal {
                axis: axis(6),
                target: Target::Absolute(-1.0),
            },
        ],
        profile: ProfileKind::Beta,
        duration: None,
        limits: Default::default(),
        independent: false,
    };
    let arrivals = client.move_together(&robot, &request, |_| {});
    let arrivals = arrivals.expect("both move");
    assert!((arrivals[0].position - 1.0).abs() < 1e-5, "{arrivals:?}");
    assert!((arrivals[1].position + 1.0).abs() < 1e-5, "{arrivals:?}");
    client.release().expect("the bus works");
}

#[test]
fn an_id_that_is_in_use_or_a_chip_that_is_not_there_is_refused() {
    let mut client = client(&[1, 2]);
    let chip = chips(&mut client, 1)[0];
    let taken = client.assign(chip, None, axis(2));
    assert!(matches!(taken, Err(ClientError::IdInUse { .. })));
    let nobody = "00".repeat(12).parse().expect("24 digits");
    let missing = client.assign(nobody, Some(axis(1)), axis(9));
    assert!(matches!(missing, Err(ClientError::NoChip { .. })));
    // Held by somebody: not even by the one who asks.
    client.hold(&[axis(1)]).expect("nobody holds it");
    let held = client.assign(chip, None, axis(9));
    assert!(matches!(held, Err(ClientError::Refused { .. })), "{held:?}");
    client.release().expect("the bus works");
    client.assign(chip, None, axis(9)).expect("now it is free");
}
