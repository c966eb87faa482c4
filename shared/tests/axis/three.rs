//! A node of three axes on a bench, and what it says.

use super::bench::SESSION;
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::units::Position;
use canter_shared::wire::command::{Action, AssignPart, Command};
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

pub const CHIP: [u8; 12] = *b"first chip 1";
pub const FIRST: [u8; 6] = *b"first ";
pub const LAST: [u8; 6] = *b"chip 1";

pub fn axis(id: u8) -> AxisId {
    AxisId::new(id).expect("1 to 63")
}

/// An acknowledgement: of which axis, to what, number, reason, detail.
pub type Told = (u8, Function, u8, Reason, u32);

/// Axes 1 to 3, disabled and held by nobody.
pub struct Three {
    pub node: Node<Simulated, 3>,
    pub sequence: u8,
}

impl Three {
    pub fn new() -> Self {
        let mut node = Node::new(Identity {
            chip: CHIP,
            firmware: [0; 3],
            board: Board::Simulated,
        });
        for id in 1..=3 {
            node.add_axis(axis(id), Limits::default(), Simulated::new(Position::ZERO))
                .expect("there is room");
        }
        let mut three = Self { node, sequence: 0 };
        three.run(5);
        three.told();
        three
    }

    pub fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            let now = self.node.next_tick();
            self.node.tick(now);
            self.node.plan();
        }
    }

    pub fn say(&mut self, address: Address, command: Command) {
        let now = self.node.next_tick();
        let frame = command.encode(address).expect("every field fits");
        self.node.handle_frame(now, &frame);
        self.node.plan();
    }

    /// A control command under the next number, which it gives.
    pub fn control(&mut self, id: u8, action: Action) -> u8 {
        self.sequence += 1;
        let command = Command::Control {
            action,
            sequence: self.sequence,
            session: SESSION,
        };
        self.say(axis(id).into(), command);
        self.sequence
    }

    pub fn assign(&mut self, part: AssignPart) {
        self.say(Address::All, Command::Assign(part));
    }

    /// All three parts.
    pub fn give(&mut self, first: [u8; 6], last: [u8; 6], from: u8, to: u8, sequence: u8) {
        self.assign(AssignPart::ChipFirst(first));
        self.assign(AssignPart::ChipLast(last));
        self.assign(AssignPart::Axis {
            axis: from,
            new_axis: to,
            sequence,
        });
    }

    /// What it says that answers something.
    pub fn told(&mut self) -> Vec<Told> {
        let mut told = Vec::new();
        let now = self.node.next_tick();
        while let Some(frame) = self.node.poll_transmit(now) {
            if let Ok(Some((axis, report))) = Report::decode(&frame)
                && let Report::Acknowledgement {
                    sequence,
                    function,
                    reason,
                    detail,
                } = report
            {
                told.push((axis.get(), function, sequence, reason, detail));
            }
        }
        told
    }

    pub fn ids(&self) -> Vec<u8> {
        self.node.axes().map(|axis| axis.id().get()).collect()
    }
}
