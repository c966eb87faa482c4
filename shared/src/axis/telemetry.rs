//! What an axis has to say and when: answers at once, feedback and heartbeat at their rates.

use crate::parameter::Settings;
use crate::time::{BusTime, Tick};
use crate::wire::report::Report;
use heapless::Deque;

/// Ticks by which the axes' periods are shifted against each other, times the axis id, so that
/// they do not all speak at once.
const STAGGER: u64 = 7;

/// Answers that may wait: commands that arrive between two chances to send. One more is dropped,
/// and its host asks again.
const WAITING: usize = 8;

/// How many of them may be about parameters: whoever reads them all must not keep the answers to
/// commands from being given.
const READINGS: usize = WAITING / 2;

/// Counters of one axis's bus, which wrap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Times that the node was off the bus.
    pub bus_off: u8,
    /// Error frames seen.
    pub error_frames: u8,
    /// Receptions lost.
    pub lost: u8,
    /// Commands rejected.
    pub rejected: u8,
}

/// The outgoing side of an axis.
#[derive(Debug, Clone)]
pub(super) struct Telemetry {
    answers: Deque<Report, WAITING>,
    /// Of these only the newest counts, and no flood of answers may crowd them out.
    fault: Option<Report>,
    started: Option<Report>,
    stagger: u64,
    feedback_due: bool,
    heartbeat_due: bool,
}

/// What is to be sent next.
pub(super) enum Due {
    Report(Report),
    Feedback,
    Heartbeat,
}

impl Telemetry {
    pub(super) fn new(axis: u8) -> Self {
        Self {
            answers: Deque::new(),
            fault: None,
            started: None,
            stagger: STAGGER * u64::from(axis),
            feedback_due: false,
            heartbeat_due: true,
        }
    }

    /// Queues an answer; `false` where there was no room.
    pub(super) fn answer(&mut self, report: Report) -> bool {
        self.answers.push_back(report).is_ok()
    }

    /// Queues the answer to one who reads parameters, where few answers wait.
    pub(super) fn answer_reading(&mut self, report: Report) {
        if self.answers.len() < READINGS {
            self.answer(report);
        }
    }

    /// Speaks as another axis from now on.
    pub(super) fn rename(&mut self, axis: u8) {
        self.stagger = STAGGER * u64::from(axis);
        self.hasten();
    }

    /// Asks for feedback and heartbeat now: something changed that a host waits for.
    pub(super) fn hasten(&mut self) {
        self.feedback_due = true;
        self.heartbeat_due = true;
    }

    pub(super) fn tick(&mut self, tick: Tick, settings: &Settings) {
        // In 32 bits, which the processor divides by itself; once in 49 days a period is cut short.
        let shifted = tick.0.wrapping_add(self.stagger) as u32;
        self.feedback_due |= shifted.is_multiple_of(settings.feedback_period.0);
        self.heartbeat_due |= shifted.is_multiple_of(settings.heartbeat_period.0);
    }

    pub(super) fn next(&mut self) -> Option<Due> {
        // Looked at before it is taken: taking what is not there copies it all the same.
        let report = if self.fault.is_some() {
            self.fault.take()
        } else if !self.answers.is_empty() {
            self.answers.pop_front()
        } else if self.started.is_some() {
            self.started.take()
        } else {
            None
        };
        if let Some(report) = report {
            return Some(Due::Report(report));
        }
        if core::mem::take(&mut self.feedback_due) {
            return Some(Due::Feedback);
        }
        core::mem::take(&mut self.heartbeat_due).then_some(Due::Heartbeat)
    }

    pub(super) fn started(&mut self, sequence: u8, time: BusTime) {
        self.started = Some(Report::Started { sequence, time });
    }

    pub(super) fn fault(&mut self, fault: u8, time: BusTime) {
        self.fault = Some(Report::Fault { fault, time });
    }
}
