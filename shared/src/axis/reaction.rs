//! How an axis comes to rest when something has gone wrong.
//!
//! The first fault is latched, and its reaction begins in the same tick. What goes wrong after that
//! would hide the cause, so it is not latched; but where it asks for a harder reaction, that one
//! takes over: a quick stop from a controlled stop, and from both of them to take torque away.

use super::Axis;
use super::fault::Fault;
use super::state::State;
use crate::motion::Setpoint;
use crate::parameter::{Parameter, Reaction, Reactions};
use crate::wire::reason::Reason;

/// How a motion is brought to rest; the harder the greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stopping {
    /// As quickly as the limits allow, jerk among them.
    Controlled,
    /// With the deceleration limit at once.
    Quick,
}

impl Fault {
    /// How the axis comes to rest, where this is how it is set.
    pub(super) fn reaction_of(self, reactions: &Reactions) -> Reaction {
        match self.reaction() {
            Some(Parameter::HostReaction) => reactions.host,
            // A stream that has run dry brakes by itself, as hard as a quick stop.
            Some(Parameter::StreamReaction) => reactions.stream.max(Reaction::QuickStop),
            Some(Parameter::FollowingReaction) => reactions.following,
            Some(Parameter::BusReaction) => reactions.bus,
            // A drive that no longer follows cannot be led to rest.
            _ if self.is_of_drive() => Reaction::Disable,
            _ => Reaction::ControlledStop,
        }
    }
}

impl Axis {
    /// Something has gone wrong: latches the fault unless there is one, and brings the axis to rest.
    #[inline(never)]
    pub(crate) fn raise(&mut self, fault: Fault) {
        let reaction = fault.reaction_of(&self.settings.reactions);
        let first = self.fault.is_none();
        if first {
            self.latch(fault);
        }
        if self.state.drives() {
            // With a fault latched, the reaction to it is under way.
            if first || reaction > self.reaction {
                self.react(reaction);
            }
        } else if first {
            self.end_in_fault();
        }
    }

    /// Keeps the fault, the first one only, and forgets all that was to come.
    fn latch(&mut self, fault: Fault) {
        self.fault = Some(fault);
        self.request = None;
        self.forget_prepared();
        // Those that were only to be checked, too.
        self.call_off_moves((Reason::FaultLatched, u8::from(fault).into()));
        // No answer from before the fault is true any more.
        self.last_command = None;
        self.telemetry.fault(fault.into(), self.handed_over);
    }

    fn react(&mut self, reaction: Reaction) {
        let stopping = match reaction {
            Reaction::ControlledStop => Stopping::Controlled,
            Reaction::QuickStop => Stopping::Quick,
            Reaction::Disable => return self.end_in_fault(),
        };
        self.reaction = reaction;
        self.enter(State::FaultReactionActive);
        self.want_stop(stopping);
    }

    /// Takes torque away where the axis is.
    fn end_in_fault(&mut self) {
        self.freeze();
        self.enter(State::Fault);
    }

    /// Ends all motion where the setpoint is; nothing follows setpoints any more.
    pub(super) fn freeze(&mut self) {
        self.planning.clear();
        self.stand(self.setpoint.position);
        self.departure = None;
        self.setpoint = Setpoint {
            position: self.setpoint.position,
            ..Setpoint::default()
        };
    }

    /// Ends a motion that has come to its end, at that end.
    pub(super) fn rest(&mut self) {
        self.setpoint = self.course.at(self.tick);
        self.freeze();
    }
}
