//! A script that leads one node through everything that moves an axis, the same on host and
//! device, and digests of all that comes of it.

use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::motion::shaping::{ShaperKind, Shaping};
use canter_shared::node::{AxisSetpoint, Board, Identity, Node};
use canter_shared::time::{BusTime, LocalTime, Ticks};
use canter_shared::units::{Acceleration, Jerk, Position, Velocity};
use canter_shared::wire::command::{Action, Command, ProfileKind, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

/// How many ticks the script lasts.
pub const TICKS: u32 = 30_000;

/// Axes of the node.
pub const AXES: usize = 3;

const SESSION: Session = 0x5C21;

/// What came of the script.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outcome {
    /// FNV-1a over axis, tick, state, position, velocity and acceleration of every setpoint.
    pub setpoints: u64,
    /// FNV-1a over every frame that the node sent.
    pub frames: u64,
    /// Setpoints that differ in position from the axis's one before: a script that moves nothing
    /// would have a digest too.
    pub moved: u32,
    /// Commands that were accepted.
    pub accepted: u32,
    /// Commands that were refused.
    pub refused: u32,
    /// Moves that were asked for while the one before was under way.
    pub retargets: u32,
}

/// Plays the script.
pub fn play() -> Outcome {
    let mut player = Player::new();
    let mut outcome = Outcome {
        setpoints: FNV_BASIS,
        frames: FNV_BASIS,
        moved: 0,
        accepted: 0,
        refused: 0,
        retargets: 0,
    };
    let mut last = [Position::ZERO; AXES];
    for _ in 0..TICKS {
        let now = player.node.next_tick();
        player.say_what_is_due(now);
        for (setpoint, last) in player.node.tick(now).iter().zip(&mut last) {
            outcome.add(setpoint, last);
        }
        player.node.plan();
        while let Some(frame) = player.node.poll_transmit(now) {
            outcome.hear(&frame);
        }
    }
    outcome.retargets = player.retargets;
    outcome
}

const FNV_BASIS: u64 = 0xCBF2_9CE4_8422_2325;

fn fnv(digest: &mut u64, bytes: &[u8]) {
    for byte in bytes {
        *digest = (*digest ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
    }
}

impl Outcome {
    fn add(&mut self, axis: &AxisSetpoint, last: &mut Position) {
        let digest = &mut self.setpoints;
        fnv(digest, &[axis.axis.get(), axis.state.into()]);
        fnv(digest, &axis.tick.0.to_le_bytes());
        fnv(digest, &axis.setpoint.position.counts().to_le_bytes());
        fnv(digest, &axis.setpoint.velocity.counts().to_le_bytes());
        fnv(digest, &axis.setpoint.acceleration.counts().to_le_bytes());
        self.moved += u32::from(*last != axis.setpoint.position);
        *last = axis.setpoint.position;
    }

    fn hear(&mut self, frame: &Frame) {
        fnv(&mut self.frames, &frame.id().to_le_bytes());
        fnv(&mut self.frames, frame.data());
        if let Ok(Some((_, Report::Acknowledgement { reason, .. }))) = Report::decode(frame) {
            let accepted = u32::from(reason == Reason::Accepted);
            self.accepted += accepted;
            self.refused += 1 - accepted;
        }
    }
}

struct Player {
    node: Node<Simulated, AXES>,
    random: u64,
    tick: u32,
    sequence: u8,
    retargets: u32,
    /// For each axis the tick of the script at which its next command is due, and at which its
    /// last move ends.
    due: [u32; AXES],
    busy: [u32; AXES],
}

impl Player {
    fn new() -> Self {
        let mut node = Node::new(Identity {
            chip: *b"the scenario",
            firmware: [0, 0, 0],
            board: Board::Simulated,
        });
        for axis in axes() {
            let added = node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO));
            assert!(added.is_ok(), "the node has room for its axes");
        }
        // The second one carries something that swings.
        let shaping = Shaping::new(ShaperKind::Zvd, 11.0, 0.03).ok();
        let shaped = AxisId::new(2).map(|axis| node.shape(axis, shaping.as_ref()));
        assert!(shaping.is_some() && shaped == Some(Ok(())), "it rests");
        Self {
            node,
            random: 0x9E37_79B9_7F4A_7C15,
            tick: 0,
            sequence: 0,
            retargets: 0,
            due: [20; AXES],
            busy: [0; AXES],
        }
    }

    fn say_what_is_due(&mut self, now: LocalTime) {
        let tick = self.tick;
        self.tick += 1;
        if tick.is_multiple_of(20) {
            // The commander's crystal is 60 ppm faster, and its words are late by up to 0.4 ms.
            let sent = 1_000_000 + now.0 + now.0 * 6 / 100_000;
            let late = self.below(400);
            let sync = Command::Sync {
                counter: (tick / 20) as u8,
                time: BusTime(sent.saturating_sub(late)),
            };
            self.say(now, Address::All, sync);
        }
        if tick.is_multiple_of(50) {
            self.say(
                now,
                Address::All,
                Command::HostHeartbeat { session: SESSION },
            );
        }
        // Some ticks in, and again after each emergency stop: take the axes and enable them.
        match tick % 5_000 {
            3 => self.control(now, Action::Clear),
            4 => self.control(now, Action::Hold),
            5 => self.control(now, Action::Clear),
            6 => self.control(now, Action::Enable),
            4_900 => self.say(now, Address::All, Command::EmergencyStop),
            20..4_900 => self.move_who_is_due(now, tick),
            _ => {}
        }
    }

    fn move_who_is_due(&mut self, now: LocalTime, tick: u32) {
        for (index, axis) in axes().enumerate() {
            let (Some(due), Some(busy)) =
                (self.due.get(index).copied(), self.busy.get(index).copied())
            else {
                continue;
            };
            if tick < due {
                continue;
            }
            let duration = 150 + self.below(800) as u32;
            // A range that the default limits allow in that time, most of the time.
            let range = (self.below(1 << 32) as i64 - (1 << 31)) * i64::from(duration) / 800;
            let stop = self.below(16) == 0;
            if stop {
                let sequence = self.next_sequence();
                self.say(now, axis.into(), Command::Stop { sequence });
            } else {
                self.move_axis(now, axis, Position::from_counts(range), Ticks(duration));
                self.retargets += u32::from(tick < busy);
            }
            // Half of the time the next command comes before this move has ended.
            let pause = self.below(2 * u64::from(duration)) as u32;
            self.set(index, tick + 1 + pause, tick + duration);
        }
    }

    fn move_axis(&mut self, now: LocalTime, axis: AxisId, target: Position, duration: Ticks) {
        let profile = match self.below(6) {
            0 | 1 => ProfileKind::Trapezoid,
            2 | 3 => ProfileKind::SCurve,
            _ => ProfileKind::Beta,
        };
        if profile == ProfileKind::Trapezoid && self.below(2) == 0 {
            let shape = Command::TrapezoidShape {
                acceleration: Ticks(duration.0 / 2),
                deceleration: Ticks(duration.0 / 3),
                sequence: self.next_sequence(),
            };
            self.say(now, axis.into(), shape);
        }
        if profile == ProfileKind::SCurve && self.below(2) == 0 {
            // Down to a quarter of the axis's own.
            let limit = |own: i64, sixteenths: u64| own / 16 * (4 + sixteenths as i64);
            let own = Limits::default();
            let ramps = Command::RampLimits {
                acceleration: Acceleration::from_counts(limit(
                    own.acceleration().counts(),
                    self.below(13),
                )),
                deceleration: Acceleration::from_counts(limit(
                    own.deceleration().counts(),
                    self.below(13),
                )),
                sequence: self.next_sequence(),
            };
            self.say(now, axis.into(), ramps);
            let peaks = Command::PeakLimits {
                velocity: Velocity::from_counts(limit(own.velocity().counts(), self.below(13))),
                jerk: Jerk::from_counts(limit(own.jerk().counts(), self.below(13))),
                sequence: self.next_sequence(),
            };
            self.say(now, axis.into(), peaks);
        }
        let staged = self.below(4) == 0;
        let sequence = self.next_sequence();
        let command = Command::Move {
            profile,
            staged,
            target,
            duration,
            sequence,
        };
        self.say(now, axis.into(), command);
        if staged {
            let trigger = Command::Trigger {
                group: sequence,
                session: SESSION,
                start: self.node.bus_time(now).next_tick().after(Ticks(7)),
            };
            self.say(now, Address::All, trigger);
        }
    }

    fn set(&mut self, index: usize, due: u32, busy: u32) {
        if let (Some(next), Some(end)) = (self.due.get_mut(index), self.busy.get_mut(index)) {
            (*next, *end) = (due, busy);
        }
    }

    fn control(&mut self, now: LocalTime, action: Action) {
        for axis in axes() {
            let sequence = self.next_sequence();
            let command = Command::Control {
                action,
                sequence,
                session: SESSION,
            };
            self.say(now, axis.into(), command);
        }
    }

    fn say(&mut self, now: LocalTime, address: Address, command: Command) {
        if let Ok(frame) = command.encode(address) {
            self.node.handle_frame(now, &frame);
            self.node.plan();
        }
    }

    fn next_sequence(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }

    /// A number below `bound`, by xorshift.
    fn below(&mut self, bound: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) % bound
    }
}

fn axes() -> impl Iterator<Item = AxisId> {
    (1..=AXES as u8).filter_map(AxisId::new)
}
