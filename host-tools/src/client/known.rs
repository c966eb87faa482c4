//! What is known of axes and nodes from what they report.

use canter_shared::axis::Counters;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::parameter::Parameter;
use canter_shared::time::BusTime;
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::ProtocolVersion;
use canter_shared::wire::command::{Item, Session};
use canter_shared::wire::id::{AxisId, Function};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::{Board, IdentityPart, Report};
use std::collections::BTreeMap;

use super::assign::ChipId;
use super::link::MILLISECOND;

/// An answer that an axis gave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Answer {
    pub sequence: u8,
    pub function: Function,
    pub reason: Reason,
    pub detail: u32,
}

/// What is known of an axis; `None` where nothing was heard yet.
#[derive(Debug, Clone, Default)]
pub struct KnownAxis {
    /// Its state.
    pub state: Option<State>,
    /// Its latched fault.
    pub fault: Option<Fault>,
    /// Where the drive is.
    pub position: Option<Position>,
    /// How fast the drive is.
    pub velocity: Option<Velocity>,
    /// Whether its setpoint moves, or will.
    pub moving: Option<bool>,
    /// Whether its setpoint rests at the target of its last move, or at the end of its last stream.
    pub target_reached: bool,
    /// Which session holds it, 0 for none; `None` before its first heartbeat.
    pub session: Option<Session>,
    /// Its counters.
    pub counters: Counters,
    /// When it was last heard.
    pub heard: BusTime,
    pub(super) answers: Vec<Answer>,
    /// What it said about its parameters, raw, by number and by what was asked.
    pub(super) parameters: BTreeMap<(u8, u8), i64>,
    /// The last move that it reported to have begun.
    pub(super) started: Option<(u8, BusTime)>,
    /// Feedback frames heard: tells a fresh one from an old one.
    pub(super) feedbacks: u64,
}

/// Silence of a stream's axis after which it counts as lost: together with a stop, within the 250 ms after
/// which the axes miss their host.
const STREAM_SILENCE: u64 = 120 * MILLISECOND;

/// The same where nobody asked the axis how often it reports, which is every 20 ms as a rule. Its heartbeat
/// comes every 200 ms at the least, so one of them may be lost.
const UNKNOWN_SILENCE: u64 = 500 * MILLISECOND;

/// Reports that may be missing in a row, of an axis that seldom reports.
const REPORTS: u64 = 3;

impl KnownAxis {
    /// Silence after which it counts as lost while a stream leads it, in microseconds.
    pub(super) fn silence(&self) -> u64 {
        let period = (Parameter::FeedbackPeriod.into(), Item::Value.into());
        match self.parameters.get(&period) {
            Some(ticks) => STREAM_SILENCE.max(REPORTS * ticks.unsigned_abs() * MILLISECOND),
            None => UNKNOWN_SILENCE,
        }
    }

    /// Whether it has been silent for so long at `now`, in the bus's own time, that it counts as gone: for 0.5 s.
    pub fn is_silent(&self, now: BusTime) -> bool {
        now.0.saturating_sub(self.heard.0) > UNKNOWN_SILENCE
    }

    pub(super) fn learn(&mut self, report: &Report, now: BusTime) {
        self.heard = now;
        match *report {
            Report::Acknowledgement {
                sequence,
                function,
                reason,
                detail,
            } => {
                // Only answers to questions under way are ever looked for: a few suffice.
                if self.answers.len() >= 32 {
                    self.answers.remove(0);
                }
                self.answers.push(Answer {
                    sequence,
                    function,
                    reason,
                    detail,
                });
            }
            Report::Started { sequence, time } => {
                self.started = Some((sequence, time));
                // The last feedback may be from before: a node that was held up takes a trigger
                // just before its start.
                self.moving = Some(true);
            }
            Report::Fault { fault, .. } => self.fault = Fault::try_from(fault).ok(),
            Report::Feedback {
                position,
                velocity,
                state,
                moving,
                target_reached,
            } => {
                self.position = Some(position);
                self.velocity = Some(velocity);
                self.state = State::try_from(state).ok();
                self.moving = Some(moving);
                self.target_reached = target_reached;
                self.feedbacks += 1;
            }
            Report::Heartbeat {
                state,
                fault,
                session,
                bus_off,
                error_frames,
                lost,
                rejected,
            } => {
                self.state = State::try_from(state).ok();
                self.fault = Fault::try_from(fault).ok();
                self.session = Some(session);
                self.counters = Counters {
                    bus_off,
                    error_frames,
                    lost,
                    rejected,
                };
            }
            Report::Parameter {
                parameter,
                item,
                value,
            } => {
                self.parameters.insert((parameter, item.into()), value);
            }
            Report::Identity(_) => {}
        }
    }
}

/// A node as it answered to a scan: one axis of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KnownNode {
    /// The axis that answered.
    pub axis: AxisId,
    /// The protocol that it speaks.
    pub protocol: Option<ProtocolVersion>,
    /// What it runs on.
    pub board: Option<Board>,
    /// Its firmware: major, minor, patch.
    pub firmware: Option<[u8; 3]>,
    /// The halves of the chip's id that were heard; more than one of a half are two nodes.
    chips: [Vec<[u8; 6]>; 2],
}

impl KnownNode {
    pub(super) fn new(axis: AxisId) -> Self {
        Self {
            axis,
            protocol: None,
            board: None,
            firmware: None,
            chips: [Vec::new(), Vec::new()],
        }
    }

    pub(super) fn learn(&mut self, part: IdentityPart) {
        match part {
            IdentityPart::Version {
                protocol,
                board,
                firmware,
            } => {
                self.protocol = Some(protocol);
                self.board = Board::try_from(board).ok();
                self.firmware = Some(firmware);
            }
            IdentityPart::ChipFirst(half) => add(&mut self.chips[0], half),
            IdentityPart::ChipLast(half) => add(&mut self.chips[1], half),
        }
    }

    /// The chip's id in hexadecimal, where it was heard whole.
    pub fn chip(&self) -> Option<String> {
        self.chips().first().map(ChipId::to_string)
    }

    /// The ids of the chips that answered, several where they share an axis id by mistake: halves
    /// belong together in the order in which they came.
    pub fn chips(&self) -> Vec<ChipId> {
        let [first, last] = &self.chips;
        let count = if first.is_empty() || last.is_empty() {
            0
        } else {
            first.len().max(last.len())
        };
        let halves = first.iter().cycle().zip(last.iter().cycle());
        halves
            .take(count)
            .map(|(first, last)| ChipId {
                first: *first,
                last: *last,
            })
            .collect()
    }

    /// Whether more than one node answered with this axis id.
    pub fn is_doubled(&self) -> bool {
        self.chips.iter().any(|halves| halves.len() > 1)
    }
}

/// Halves that are kept of one axis id: who listens for days to forged ones runs out of no memory.
const MOST_HALVES: usize = 64;

fn add(halves: &mut Vec<[u8; 6]>, half: [u8; 6]) {
    if halves.len() < MOST_HALVES && !halves.contains(&half) {
        halves.push(half);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_has_started_moves_until_a_later_feedback_says_that_it_rests() {
        let mut known = KnownAxis::default();
        let rests = Report::Feedback {
            position: Position::ZERO,
            velocity: Velocity::ZERO,
            state: State::OperationEnabled.into(),
            moving: false,
            target_reached: true,
        };
        let started = Report::Started {
            sequence: 1,
            time: BusTime(1),
        };
        for (report, moving) in [(rests, false), (started, true), (rests, false)] {
            known.learn(&report, BusTime(0));
            assert_eq!(known.moving, Some(moving));
        }
    }

    #[test]
    fn forged_chips_are_told_and_not_all_kept() {
        let mut node = KnownNode::new(AxisId::new(1).expect("1 to 63"));
        for number in 0..1_000u16 {
            let [low, high] = number.to_le_bytes();
            node.learn(IdentityPart::ChipFirst([low, high, 0, 0, 0, 0]));
            node.learn(IdentityPart::ChipLast([low, high, 0, 0, 0, 0]));
        }
        assert!(node.is_doubled());
        assert_eq!(node.chips().len(), MOST_HALVES);
    }
}
