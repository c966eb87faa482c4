//! Waiting for reports while the beacon goes out, and questions with their answers.

use super::known::{Answer, KnownAxis, KnownNode};
use super::{Client, ClientError};
use crate::bus::{Bus, Event};
use canter_shared::time::BusTime;
use canter_shared::wire::PROTOCOL_VERSION;
use canter_shared::wire::command::Command;
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;
use std::collections::BTreeMap;

/// A millisecond of bus time.
pub(super) const MILLISECOND: u64 = 1_000;

/// How long an answer may take before the question is asked again: a node answers within its
/// tick, but a serial adapter or a busy host may take tens of milliseconds.
pub(super) const ANSWER_TIME: u64 = 60 * MILLISECOND;

/// How often a question is asked.
pub(super) const ATTEMPTS: u32 = 5;

/// How long axes are listened for: their heartbeats come every 100 ms.
const LISTEN: u64 = 250 * MILLISECOND;

/// What an axis answered to a question.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reply {
    pub axis: AxisId,
    pub reason: Reason,
    pub detail: u32,
}

impl Reply {
    pub(super) fn refusal(self, function: Function) -> ClientError {
        ClientError::Refused {
            axis: self.axis,
            function,
            reason: self.reason,
            detail: self.detail,
        }
    }
}

pub(super) fn after(time: BusTime, microseconds: u64) -> BusTime {
    BusTime(time.0.saturating_add(microseconds))
}

impl<B: Bus> Client<B> {
    /// Listens to the bus until `done` or until `until`; says whether it was `done`.
    pub(super) fn wait(
        &mut self,
        until: BusTime,
        mut done: impl FnMut(&BTreeMap<AxisId, KnownAxis>) -> bool,
    ) -> Result<bool, ClientError> {
        loop {
            if done(&self.axes) {
                return Ok(true);
            }
            if self.is_interrupted() {
                return Err(ClientError::Interrupted);
            }
            let now = self.bus.now();
            if now >= until {
                return Ok(false);
            }
            // Short enough for an interrupt to be noticed at once.
            let mut wake = until.min(after(now, 50 * MILLISECOND));
            if !self.held.is_empty() {
                self.send_beacon()?;
                wake = wake.min(self.beacon.due());
            }
            if let Some(received) = self.bus.receive(wake)? {
                self.learn(received.time, received.event);
            }
        }
    }

    /// Learns what has arrived already: a host that was held up knows as much as one that was not.
    pub(super) fn catch_up(&mut self) -> Result<(), ClientError> {
        let now = self.bus.now();
        while let Some(received) = self.bus.receive(now)? {
            self.learn(received.time, received.event);
            if received.time > now {
                break;
            }
        }
        Ok(())
    }

    /// Whether an axis has answered to a command of this number.
    pub(super) fn has_answered(&self, axis: AxisId, sequence: u8, command: &Command) -> bool {
        answer_of(&self.axes, axis, sequence, command).is_some()
    }

    fn learn(&mut self, now: BusTime, event: Event) {
        match event {
            Event::Frame(frame) => {
                self.frames += 1;
                if let Ok(Some((_, Command::Sync { counter, time }))) = Command::decode(&frame) {
                    self.hear_sync(now, counter, time);
                } else if let Ok(Some((axis, report))) = Report::decode(&frame) {
                    self.axes.entry(axis).or_default().learn(&report, now);
                    if let Report::Identity(part) = report {
                        self.node(axis).learn(part);
                    }
                }
            }
            Event::Error(error) => {
                self.complain(error.to_string());
            }
        }
    }

    pub(super) fn complain(&mut self, words: String) {
        if !self.complaints.contains(&words) {
            self.complaints.push(words);
        }
    }

    fn node(&mut self, axis: AxisId) -> &mut KnownNode {
        let at = match self.nodes.iter().position(|node| node.axis == axis) {
            Some(at) => at,
            None => {
                self.nodes.push(KnownNode::new(axis));
                self.nodes.len() - 1
            }
        };
        &mut self.nodes[at]
    }

    /// Sends a command that nobody answers.
    pub(super) fn tell(&mut self, address: Address, command: Command) -> Result<(), ClientError> {
        let frame = command.encode(address)?;
        self.bus.send(&frame).map_err(ClientError::from)
    }

    /// The next number for a command, the same for all axes of a group.
    pub(super) fn next_sequence(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }

    /// Sends one command to each axis, again where no answer comes, and gives the answers.
    pub(super) fn ask(
        &mut self,
        sequence: u8,
        questions: &[(AxisId, Command)],
    ) -> Result<Vec<Reply>, ClientError> {
        self.ask_again_and_again(sequence, questions, ATTEMPTS)
    }

    /// The same with so many attempts: a node may be given longer for what takes longer.
    pub(super) fn ask_again_and_again(
        &mut self,
        sequence: u8,
        questions: &[(AxisId, Command)],
        attempts: u32,
    ) -> Result<Vec<Reply>, ClientError> {
        for (axis, _) in questions {
            if let Some(known) = self.axes.get_mut(axis) {
                known.answers.clear();
            }
        }
        for _ in 0..attempts {
            for (axis, command) in questions {
                if answer_of(&self.axes, *axis, sequence, command).is_none() {
                    self.tell((*axis).into(), *command)?;
                }
            }
            let until = after(self.bus.now(), ANSWER_TIME);
            let answered = |axes: &BTreeMap<AxisId, KnownAxis>| {
                questions
                    .iter()
                    .all(|(axis, command)| answer_of(axes, *axis, sequence, command).is_some())
            };
            if self.wait(until, answered)? {
                break;
            }
        }
        questions
            .iter()
            .map(|(axis, command)| {
                let answer = answer_of(&self.axes, *axis, sequence, command).ok_or_else(|| {
                    ClientError::NoAnswer {
                        axis: *axis,
                        bus: self.bus.description(),
                    }
                })?;
                Ok(Reply {
                    axis: *axis,
                    reason: answer.reason,
                    detail: answer.detail,
                })
            })
            .collect()
    }

    /// The same where every refusal is an error.
    pub(super) fn demand(
        &mut self,
        sequence: u8,
        questions: &[(AxisId, Command)],
    ) -> Result<(), ClientError> {
        let replies = self.ask(sequence, questions)?;
        Self::all_accepted(replies, questions)
    }

    /// The first refusal as an error.
    pub(super) fn all_accepted(
        replies: Vec<Reply>,
        questions: &[(AxisId, Command)],
    ) -> Result<(), ClientError> {
        for (reply, (_, command)) in replies.into_iter().zip(questions) {
            if reply.reason != Reason::Accepted {
                return Err(reply.refusal(command.function()));
            }
        }
        Ok(())
    }

    /// Listens for a while to everybody; gives the axes that were heard.
    ///
    /// # Errors
    /// The bus failed.
    pub fn listen(&mut self) -> Result<Vec<AxisId>, ClientError> {
        let start = self.bus.now();
        self.wait(after(start, LISTEN), |_| false)?;
        Ok(self
            .axes
            .iter()
            .filter(|(_, known)| known.heard >= start)
            .map(|(axis, _)| *axis)
            .collect())
    }

    /// Listens to everybody until an instant of the bus's own time, and learns at least what has arrived
    /// already: [`Self::axes`] has it.
    ///
    /// # Errors
    /// The bus failed, or the listening was interrupted.
    pub fn listen_until(&mut self, until: BusTime) -> Result<(), ClientError> {
        self.catch_up()?;
        self.wait(until, |_| false)?;
        Ok(())
    }

    /// Asks everybody who they are, and gives those that answered, in the order of their axes.
    ///
    /// # Errors
    /// The bus failed.
    pub fn scan(&mut self) -> Result<Vec<KnownNode>, ClientError> {
        self.nodes.clear();
        self.tell(Address::All, Command::IdentityRequest)?;
        self.wait(after(self.bus.now(), LISTEN), |_| false)?;
        self.nodes.sort_by_key(|node| node.axis);
        Ok(self.nodes.clone())
    }

    /// Makes sure that each of `axes` is there once and speaks this protocol.
    ///
    /// # Errors
    /// The first axis that is missing, doubled, or of another major version.
    pub fn check(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let mut nodes = self.scan()?;
        let missing = |nodes: &[KnownNode], axis: &AxisId| {
            nodes
                .iter()
                .all(|node| node.axis != *axis || node.protocol.is_none())
        };
        // A lost frame must not make an axis missing.
        if axes.iter().any(|axis| missing(&nodes, axis)) {
            nodes = self.scan()?;
        }
        for axis in axes {
            let Some(node) = nodes.iter().find(|node| node.axis == *axis) else {
                return Err(ClientError::NoAnswer {
                    axis: *axis,
                    bus: self.bus.description(),
                });
            };
            if node.is_doubled() {
                return Err(ClientError::Doubled { axis: *axis });
            }
            if let Some(protocol) = node.protocol
                && protocol.major != PROTOCOL_VERSION.major
            {
                return Err(ClientError::Protocol {
                    axis: *axis,
                    theirs: protocol.major,
                    ours: PROTOCOL_VERSION.major,
                });
            }
        }
        Ok(())
    }
}

fn answer_of(
    axes: &BTreeMap<AxisId, KnownAxis>,
    axis: AxisId,
    sequence: u8,
    command: &Command,
) -> Option<Answer> {
    axes.get(&axis)?
        .answers
        .iter()
        .find(|answer| answer.sequence == sequence && answer.function == command.function())
        .copied()
}
