//! What an axis watches at every tick: its host, its drive, and the others on the bus.

use super::Axis;
use super::answer::Refusal;
use super::fault::Fault;
use super::prepared::Prepared;
use super::state::State;
use crate::drive::{Condition, DriveReport};
use crate::units::{Position, Velocity};
use crate::wire::frame::Frame;
use crate::wire::id::{AXIS_BITS, AxisId, LAST_AXIS};
use crate::wire::layout::{LAYOUTS, POSITION_SHIFT, Sender, VELOCITY_SHIFT, feedback};
use crate::wire::reason::Reason;

/// The farthest place that Feedback can carry to both sides: 1024 turns minus a step of the wire.
pub(super) const FARTHEST: Position =
    Position::from_counts(feedback::POSITION.range().1 << POSITION_SHIFT);

/// The greatest speed that Feedback can carry: 512 turn/s minus a step of the wire.
const FASTEST: Velocity = Velocity::from_counts(feedback::VELOCITY.range().1 << VELOCITY_SHIFT);

/// One bit for each function that only nodes send.
const REPORTS: u32 = {
    let (mut reports, mut index) = (0, 0);
    while index < LAYOUTS.len() {
        if matches!(LAYOUTS[index].sender, Sender::Node) {
            reports |= 1 << LAYOUTS[index].function as u8;
        }
        index += 1;
    }
    reports
};

/// The axis that a frame is from; `None` where it is none that a node sends.
///
/// Asked about every frame on the bus, before anything else: only the id is looked at.
#[inline(never)]
pub(crate) fn sender_of(frame: &Frame) -> Option<AxisId> {
    let function = frame.id() >> AXIS_BITS;
    // Five bits, as an id of eleven has.
    let is_report = REPORTS >> (function & 31) & 1 != 0;
    AxisId::new(frame.id() as u8 & LAST_AXIS).filter(|_| is_report)
}

impl Axis {
    /// Once a tick, before its setpoint: the host, the drive, then the state machine.
    pub(super) fn supervise(&mut self) {
        if self
            .commander
            .is_silent(self.tick, self.settings.host_timeout)
        {
            self.lose_commander();
            if self.state.drives() {
                self.raise(Fault::HostTimeout);
            }
        }
        self.watch_drive();
        self.watch_stream();
        self.advance();
    }

    /// Takes notice of a report that came from the bus, in the name of this axis: a node does not
    /// hear itself, so another one has the same id.
    pub(crate) fn hear_double(&mut self) {
        self.raise(Fault::DuplicateAxis);
    }

    /// Takes notice that the node's controller went off the bus. What was commanded meanwhile is
    /// not known, so nothing goes on once it is back.
    pub fn lose_bus(&mut self) {
        self.raise(Fault::BusOff);
    }

    fn watch_drive(&mut self) {
        let follows = self.state.drives() && self.state != State::ReadyToSwitchOn;
        if self.state.drives() && self.watch_condition() {
            return;
        }
        let Some(report) = self
            .drive
            .filter(|report| report.condition != Condition::Lost)
        else {
            return;
        };
        if !self.carries(&report) {
            self.raise(Fault::FeedbackRange);
        } else if follows {
            self.watch_following(&report);
        }
    }

    /// Whether the drive has dropped out while it should follow. Then it cannot be led any more:
    /// whatever the axis was about to do ends here.
    fn watch_condition(&mut self) -> bool {
        // A drive that has not enabled yet is waited for.
        let enabling = matches!(self.state, State::ReadyToSwitchOn | State::SwitchedOn);
        let fault = match self.condition() {
            Some(Condition::Enabled) => return false,
            Some(Condition::Disabled) if enabling => return false,
            None | Some(Condition::Lost) => Fault::DriveLost,
            Some(Condition::Disabled) => Fault::DriveFault,
            Some(Condition::Faulted(trouble)) => trouble.into(),
        };
        self.raise(fault);
        true
    }

    /// Whether the drive is where, and as fast as, the protocol can tell. No other place must
    /// become a setpoint.
    ///
    /// An axis may be set to be faster than Feedback can tell; its speed is watched by its own limit.
    pub(super) fn carries(&self, report: &DriveReport) -> bool {
        let fits = (-FASTEST..=FASTEST).contains(&report.velocity);
        (-FARTHEST..=FARTHEST).contains(&report.position)
            && (fits || self.settings.limits.velocity() > FASTEST)
    }

    /// Holds the drive's report against the last setpoint, which is what the drive has been told
    /// when it reports: a fast axis goes on by a degree in a tick.
    ///
    /// Outside of the travel the drive may be where its setpoint is, which never goes farther out:
    /// an axis that is enabled outside may come back.
    fn watch_following(&mut self, report: &DriveReport) {
        let settings = &self.settings;
        if settings
            .overspeed
            .is_some_and(|fastest| report.velocity.abs() > fastest)
        {
            self.raise(Fault::Overspeed);
            return;
        }
        let setpoint = self.setpoint.position;
        // Both are within what Feedback can carry, or nearly: no difference of them wraps.
        let away = report.position.counts().wrapping_sub(setpoint.counts());
        let is_over = |most: &Position| away.unsigned_abs() > most.counts().unsigned_abs();
        let Some(most) = settings.following_error.filter(is_over) else {
            self.astray = 0;
            return;
        };
        // Who is near the setpoint is not farther outside, so this is looked at only here.
        let least = settings.limits.position_minimum().min(setpoint);
        let greatest = settings.limits.position_maximum().max(setpoint);
        let outside = (least - report.position).max(report.position - greatest);
        self.astray = self.astray.saturating_add(1);
        if outside > most {
            self.raise(Fault::OutsideTravel);
        } else if u32::from(self.astray) > settings.following_time.0 {
            self.raise(Fault::FollowingError);
        }
    }

    /// Forgets the session and all that only it could have meant.
    pub(super) fn lose_commander(&mut self) {
        self.commander.release();
        self.forget_moves((Reason::NotHeld, 0));
        self.last_command = None;
        // What it asked for last, nobody wants any more.
        self.request = None;
    }

    /// Forgets what was prepared for later; `why` is the answer to what is still being checked.
    pub(super) fn forget_moves(&mut self, why: Refusal) {
        self.call_off_stages(why);
        self.course.call_off_stream();
        self.forget_prepared();
    }

    pub(super) fn forget_prepared(&mut self) {
        self.staged = None;
        self.prepared = Prepared::default();
    }
}
