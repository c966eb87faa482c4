//! A node on the simulated bus: the device's own core, a crystal, and a CAN controller.

use std::collections::VecDeque;

use canter_shared::drive::simulated::Simulated;
use canter_shared::node::{AxisSetpoint, Board, Identity, Node};
use canter_shared::time::{BusTime, LocalTime};
use canter_shared::units::Position;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, Function};

use super::clock::{Crystal, TrueTime};
use super::random::SplitMix64;
use crate::robot::RobotAxis;

pub(super) struct Device {
    node: Node<Simulated, 1>,
    crystal: Crystal,
    /// Frames that were received and not yet looked at, in order.
    inbox: VecDeque<(TrueTime, Frame)>,
    /// The one mailbox to send from; what else there is to send waits in the node.
    outgoing: Option<Frame>,
    /// The next tick by the node's clock, and when that is.
    next_tick: (LocalTime, TrueTime),
    synchronised: bool,
}

impl Device {
    pub(super) fn new(axis: &RobotAxis, crystal_ppm: u32, random: &mut SplitMix64) -> Self {
        let mut chip = [0; 12];
        for bytes in chip.chunks_mut(4) {
            bytes.copy_from_slice(&(random.next() as u32).to_le_bytes());
        }
        let crystal = Crystal::new(random, crystal_ppm);
        let mut node = Node::new(Identity {
            chip,
            firmware: crate::version(),
            board: Board::Simulated,
        });
        node.add_axis_with_values(axis.id, &axis.values, Simulated::new(Position::ZERO))
            .expect("a node with room for one axis takes one");
        let due = node.next_tick();
        Self {
            next_tick: (due, crystal.when(due)),
            node,
            crystal,
            inbox: VecDeque::new(),
            outgoing: None,
            synchronised: false,
        }
    }

    /// A frame that its controller will have received at `time`, or right after the one before.
    pub(super) fn deliver(&mut self, time: TrueTime, frame: Frame) {
        let time = self.inbox.back().map_or(time, |last| time.max(last.0));
        self.inbox.push_back((time, frame));
    }

    /// When something happens here next.
    pub(super) fn due(&self) -> TrueTime {
        let frame = self.inbox.front().map(|(time, _)| *time);
        frame.map_or(self.next_tick.1, |time| time.min(self.next_tick.1))
    }

    /// Does the one thing that is due at `now`: a frame before a tick. Gives the tick's setpoint
    /// once the clock has been set: before, the node's ticks are its own and not those of the bus.
    pub(super) fn step(&mut self, now: TrueTime) -> Option<AxisSetpoint> {
        let local = self.crystal.local(now);
        let setpoint = match self.inbox.pop_front_if(|(time, _)| *time <= now) {
            Some((_, frame)) => {
                self.node.handle_frame(local, &frame);
                self.synchronised |= frame.id() == Address::All.frame_id(Function::Sync);
                None
            }
            None => self.node.tick(local).first().copied(),
        };
        self.node.plan();
        // The simulated robot is fresh each time: what it saves, it keeps as long as it lives.
        if let Some(image) = self.node.take_save() {
            self.node.saved(&image, true);
        }
        self.refill(local);
        setpoint.filter(|_| self.synchronised)
    }

    /// The frame that it wants to send.
    pub(super) fn outgoing(&self) -> Option<&Frame> {
        self.outgoing.as_ref()
    }

    /// Its frame has been sent.
    pub(super) fn sent(&mut self, now: TrueTime) {
        self.outgoing = None;
        self.refill(self.crystal.local(now));
    }

    fn refill(&mut self, local: LocalTime) {
        if self.outgoing.is_none() {
            self.outgoing = self.node.poll_transmit(local);
        }
        let due = self.node.next_tick();
        if due != self.next_tick.0 {
            self.next_tick = (due, self.crystal.when(due));
        }
    }

    pub(super) fn bus_time(&self, now: TrueTime) -> BusTime {
        self.node.bus_time(self.crystal.local(now))
    }
}
