//! A model of a CANopen servo drive (CiA 301, CiA 402). Sources: see `canter_shared::drive::cia402`.

mod dictionary;

use super::shaft::Shaft;
use super::{Make, Model, Seen, frame};
use canter_shared::wire::frame::Frame;
use dictionary::Dictionary;
use std::collections::VecDeque;

/// Increments in a turn, which canter takes by default.
const INCREMENTS: f64 = 65_536.0;

/// EMCY codes: the supply is too low; the node's heartbeat or SYNC is missing.
const UNDERVOLTAGE: u16 = 0x3220;
const STARVED: u16 = 0x8130;

/// What network management allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Network {
    PreOperational,
    Operational,
    Stopped,
}

/// The drive's state machine, by the statusword's bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    SwitchOnDisabled = 0x40,
    Ready = 0x21,
    SwitchedOn = 0x23,
    Enabled = 0x27,
    Fault = 0x08,
}

/// One drive.
#[derive(Debug)]
pub struct Cia402Model {
    node: u16,
    watchdog: u32,
    shaft: Shaft,
    network: Network,
    state: State,
    objects: Dictionary,
    controlword: u16,
    /// Controlword and target of the last RPDO, taken at the next SYNC.
    pending: Option<(u16, i32)>,
    target: i32,
    /// What the target goes on by in a tick, as from the last one to this.
    step: f64,
    since_sync: u32,
    ticks: u32,
    out: VecDeque<Frame>,
}

impl Cia402Model {
    /// One at rest at `turns`.
    pub fn new(make: &Make, node: u8, turns: f64) -> Self {
        let mut model = Self {
            node: node.into(),
            watchdog: make.watchdog.unwrap_or(0),
            shaft: Shaft::new(turns),
            network: Network::PreOperational,
            state: State::SwitchOnDisabled,
            objects: Dictionary::new(node),
            controlword: 0,
            pending: None,
            target: 0,
            step: 0.0,
            since_sync: 0,
            ticks: 0,
            out: VecDeque::new(),
        };
        model.restart();
        if make.starts_enabled {
            model.state = State::Enabled;
            model.network = Network::Operational;
            model.target = model.increments();
            model.objects.write(0x6060, 0, 1, 8).expect("it is there");
        }
        model
    }

    fn increments(&self) -> i32 {
        (self.shaft.position * INCREMENTS).round() as i32
    }

    fn complain(&mut self, code: u16) {
        let [low, high] = code.to_le_bytes();
        let id = 0x080 + self.node;
        self.out
            .push_back(frame(id, &[low, high, 1, 0, 0, 0, 0, 0]));
    }

    fn fault(&mut self, code: u16) {
        if self.state != State::Fault {
            self.state = State::Fault;
            self.complain(code);
        }
    }

    fn manage(&mut self, order: u8) {
        match order {
            0x01 => self.network = Network::Operational,
            0x02 => self.network = Network::Stopped,
            0x80 => {
                self.network = Network::PreOperational;
                // As object 6007 says by default: no network, no torque.
                self.drop_out();
            }
            0x81 | 0x82 => self.restart(),
            _ => {}
        }
        self.since_sync = 0;
    }

    fn serve(&mut self, data: &[u8]) {
        let Ok([command, low, high, sub, a, b, c, d]) = <[u8; 8]>::try_from(data) else {
            return;
        };
        let index = u16::from_le_bytes([low, high]);
        let bytes = match command {
            0x23 | 0x27 | 0x2B | 0x2F => 4 - (command >> 2 & 3),
            _ => 0,
        };
        let value = u32::from_le_bytes([a, b, c, d]);
        let outcome = match bytes {
            // Only writes are served here.
            0 => Err(0x0504_0001),
            bytes => self.objects.write(index, sub, bytes, value),
        };
        let (answer, [e, f, g, h]) = match outcome {
            Ok(()) => (0x60, [0; 4]),
            Err(code) => (0x80, code.to_le_bytes()),
        };
        if outcome.is_ok() && index == 0x6040 {
            self.take_control(value as u16);
        }
        let id = 0x580 + self.node;
        self.out
            .push_back(frame(id, &[answer, low, high, sub, e, f, g, h]));
    }

    /// CiA 402-2, the state machine's transitions; one step for each controlword.
    fn take_control(&mut self, word: u16) {
        let reset = word & 0x80 != 0 && self.controlword & 0x80 == 0;
        self.controlword = word;
        if self.state == State::Fault {
            if reset {
                self.state = State::SwitchOnDisabled;
                self.complain(0);
            }
            return;
        }
        self.state = match (word & 0x0F, self.state) {
            (low, _) if low & 0x02 == 0 => State::SwitchOnDisabled,
            // Quick stop: in this model without a ramp.
            (low, _) if low & 0x04 == 0 => State::SwitchOnDisabled,
            (0x06 | 0x0E, _) => State::Ready,
            (0x07 | 0x0F, State::Ready) => State::SwitchedOn,
            (0x0F, State::SwitchedOn) if self.objects.is_synchronous() => State::Enabled,
            (0x07, State::Enabled) => State::SwitchedOn,
            (_, state) => state,
        };
    }

    fn synchronise(&mut self) {
        self.since_sync = 0;
        if self.network != Network::Operational {
            return;
        }
        if let Some((control, target)) = self.pending.take() {
            let moved = f64::from(target) - f64::from(self.target);
            self.step = moved / f64::from(self.objects.period());
            self.target = target;
            self.take_control(control);
        }
        if self.objects.tells_at_sync() {
            let follows = if self.state == State::Enabled {
                0x1000
            } else {
                0
            };
            let [a, b] = (self.state as u16 | 0x0210 | follows).to_le_bytes();
            let [c, d, e, f] = self.increments().to_le_bytes();
            self.out
                .push_back(frame(0x180 + self.node, &[a, b, c, d, e, f]));
        }
    }
}

impl Model for Cia402Model {
    fn receive(&mut self, frame: &Frame) {
        let (id, data) = (frame.id(), frame.data());
        if id == 0 {
            if let &[order, node] = data
                && (node == 0 || u16::from(node) == self.node)
            {
                self.manage(order);
            }
        } else if id == 0x080 {
            self.synchronise();
        } else if id == 0x600 + self.node && self.network != Network::Stopped {
            self.serve(data);
        } else if id == 0x200 + self.node
            && self.network == Network::Operational
            && self.objects.listens_at_sync() == Some(data.len())
            // The shaft needs no torque offset to follow.
            && let &[a, b, c, d, e, f, ..] = data
        {
            let target = i32::from_le_bytes([c, d, e, f]);
            self.pending = Some((u16::from_le_bytes([a, b]), target));
        }
    }

    fn tick(&mut self) {
        self.ticks += 1;
        self.since_sync += 1;
        let starves = self.watchdog > 0 && self.since_sync > self.watchdog;
        if starves && self.network == Network::Operational {
            self.fault(STARVED);
        }
        if self.state == State::Enabled {
            let speed = 1e3 * self.step / INCREMENTS;
            self.shaft
                .follow(f64::from(self.target) / INCREMENTS, speed);
        } else {
            self.shaft.coast();
        }
        if let Some(period) = self.objects.heartbeat_period()
            && self.ticks.is_multiple_of(period)
        {
            let state = match self.network {
                Network::Stopped => 0x04,
                Network::Operational => 0x05,
                Network::PreOperational => 0x7F,
            };
            self.out.push_back(frame(0x700 + self.node, &[state]));
        }
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        self.out.pop_front()
    }

    fn fail(&mut self) {
        self.fault(UNDERVOLTAGE);
    }

    fn drop_out(&mut self) {
        if self.state != State::Fault {
            self.state = State::SwitchOnDisabled;
        }
    }

    fn restart(&mut self) {
        self.state = State::SwitchOnDisabled;
        self.network = Network::PreOperational;
        self.objects = Dictionary::new(self.node as u8);
        self.controlword = 0;
        self.pending = None;
        self.out.clear();
        // Boot-up.
        self.out.push_back(frame(0x700 + self.node, &[0]));
    }

    fn seen(&self) -> Seen {
        Seen {
            enabled: self.state == State::Enabled,
            faulted: self.state == State::Fault,
            position: self.shaft.position,
            target: f64::from(self.target) / INCREMENTS,
        }
    }
}
