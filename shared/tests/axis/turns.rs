//! Three axes and one planner: whose plan is made first.

use super::bench::{SESSION, turns};
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::Ticks;
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, Command, ProfileKind};
use canter_shared::wire::id::{Address, AxisId};

const LEAD: Ticks = Ticks(1);

struct Three {
    node: Node<Simulated, 3>,
    sequence: u8,
}

fn axes() -> impl Iterator<Item = AxisId> {
    (1..=3).filter_map(AxisId::new)
}

impl Three {
    /// Held, enabled and at rest.
    fn new() -> Self {
        let mut node = Node::new(Identity {
            chip: [0; 12],
            firmware: [0; 3],
            board: Board::Simulated,
        });
        for axis in axes() {
            node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO))
                .expect("there is room");
        }
        let mut three = Self { node, sequence: 0 };
        three.run(5);
        for action in [Action::Hold, Action::Enable] {
            for axis in axes() {
                three.control(axis, action);
            }
        }
        three.run(10);
        three
    }

    /// Some ticks; nobody plans.
    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            let now = self.node.next_tick();
            self.node.tick(now);
        }
    }

    fn say(&mut self, address: Address, command: Command) {
        let now = self.node.next_tick();
        let frame = command.encode(address).expect("every field fits");
        self.node.handle_frame(now, &frame);
    }

    fn control(&mut self, axis: AxisId, action: Action) {
        self.sequence += 1;
        let sequence = self.sequence;
        let command = Command::Control {
            action,
            sequence,
            session: SESSION,
        };
        self.say(axis.into(), command);
    }

    fn go(&mut self, axis: u8) {
        self.sequence += 1;
        let command = Command::Move {
            profile: ProfileKind::Beta,
            staged: false,
            target: turns(1.0),
            duration: Ticks(1_000),
            sequence: self.sequence,
        };
        let axis = AxisId::new(axis).expect("an axis");
        self.say(axis.into(), command);
    }

    /// Whose plan is next; it is made.
    fn next(&mut self) -> Option<u8> {
        let had = self.node.has_plan();
        let plan = self.node.take_plan(LEAD);
        assert_eq!(plan.is_some(), had);
        let plan = plan?;
        let axis = plan.axis().get();
        self.node.commit(&plan.work());
        Some(axis)
    }
}

#[test]
fn the_axes_are_planned_for_in_turn() {
    let mut three = Three::new();
    for axis in [3, 1, 2] {
        three.go(axis);
    }
    let order: Vec<_> = core::iter::from_fn(|| three.next()).collect();
    assert_eq!(order, [2, 3, 1]);
}

#[test]
fn a_flood_at_one_axis_does_not_starve_the_others() {
    let mut three = Three::new();
    three.go(2);
    three.go(3);
    let mut order = Vec::new();
    for _ in 0..4 {
        three.go(1);
        order.extend(three.next());
    }
    assert_eq!(order, [2, 3, 1, 1]);
}

#[test]
fn stops_are_planned_before_moves() {
    let mut three = Three::new();
    three.go(3);
    assert_eq!(three.next(), Some(3));
    three.run(100);
    for axis in [1, 2] {
        three.go(axis);
    }
    let third = AxisId::new(3).expect("an axis");
    three.say(third.into(), Command::Stop { sequence: 0 });
    let order: Vec<_> = core::iter::from_fn(|| three.next()).collect();
    assert_eq!(order, [3, 1, 2]);
}

#[test]
fn a_plan_that_somebody_works_on_is_not_given_again_and_the_others_are() {
    let mut three = Three::new();
    for axis in [1, 2] {
        three.go(axis);
    }
    let first = three.node.take_plan(LEAD).expect("two wait");
    let second = three.node.take_plan(LEAD).expect("one waits");
    assert_ne!(first.axis(), second.axis());
    assert!(three.node.take_plan(LEAD).is_none());
    three.node.commit(&second.work());
    three.node.commit(&first.work());
    assert!(three.node.axes().filter(|axis| axis.is_moving()).count() == 2);
    assert!(!three.node.has_plan());
}

#[test]
fn a_stop_that_nobody_plans_is_told() {
    let mut three = Three::new();
    for axis in [1, 2, 3] {
        three.go(axis);
    }
    three.node.plan();
    three.run(100);
    assert_eq!(three.node.stop_overdue(), Ticks(0));
    three.say(Address::All, Command::EmergencyStop);
    three.run(30);
    assert_eq!(three.node.stop_overdue(), Ticks(30));
    three.node.plan();
    assert_eq!(three.node.stop_overdue(), Ticks(0));
}

/// A planner that was lost with its plan: the node gives the plan again when it is overdue.
#[test]
fn a_plan_that_does_not_come_back_is_given_again() {
    let mut three = Three::new();
    three.go(2);
    let lost = three.node.take_plan(LEAD).expect("one waits");
    three.run(1);
    assert!(!three.node.has_plan());
    three.run(1);
    assert_eq!(three.next(), Some(2));
    three.run(100);
    assert!(three.node.axes().any(|axis| axis.is_moving()));
    // It does come back, long after: nobody wants it any more.
    three.node.commit(&lost.work());
    three.run(1_000);
    let now = three.node.next_tick();
    let places: Vec<_> = three
        .node
        .tick(now)
        .iter()
        .map(|at| at.setpoint.position)
        .collect();
    assert_eq!(places, [Position::ZERO, turns(1.0), Position::ZERO]);
}
