//! What tests break on purpose: a checker that finds nothing has found nothing only if it would.

use canter_shared::limits::{LARGEST_ACCELERATION, LARGEST_VELOCITY, LimitValues, Limits};
use canter_shared::time::BusTime;
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::Address;

use super::actor::{Actor, Heard, Voice};

/// One thing that is broken in the robot or in its wiring, so that an invariant must be violated.
/// Tests ask for it; the command line cannot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sabotage {
    /// The nodes are given rates half as high again as the robot is meant to have.
    HigherLimits,
    /// Setpoints of axes in motion jump by a hundredth of a turn once in a while.
    Jump,
    /// Now and then a tick is left out.
    MissedTick,
    /// Somebody beats for dead hosts where no observer sees it.
    BeatsForTheDead,
    /// A node moves by a command that no observer has seen.
    HiddenMove,
    /// A node that moves does not hear a Stop that its controller has received.
    DeafToStop,
    /// A node forgets its fault by itself.
    ForgottenFault,
    /// An answer is given twice.
    DoubledAnswer,
    /// A node panics.
    Panic,
}

impl Sabotage {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::HigherLimits,
        Self::Jump,
        Self::MissedTick,
        Self::BeatsForTheDead,
        Self::HiddenMove,
        Self::DeafToStop,
        Self::ForgottenFault,
        Self::DoubledAnswer,
        Self::Panic,
    ];
}

/// The same travel with rates half as high again, or as high as can be.
pub(super) fn raised(limits: &Limits) -> Limits {
    let more = |value: f64, most: f64| (value * 1.5).min(most);
    let values = LimitValues {
        velocity: more(limits.velocity().radians(), LARGEST_VELOCITY),
        acceleration: more(limits.acceleration().radians(), LARGEST_ACCELERATION),
        deceleration: more(limits.deceleration().radians(), LARGEST_ACCELERATION),
        jerk: limits.jerk().radians(),
        position_minimum: limits.position_minimum().radians(),
        position_maximum: limits.position_maximum().radians(),
    };
    Limits::new(&values).unwrap_or(*limits)
}

/// Beats for every session that holds an axis, dead or alive.
#[derive(Debug, Default)]
pub(super) struct Ghost {
    due: BusTime,
}

impl Actor for Ghost {
    fn voice(&self) -> Voice {
        Voice::Stranger
    }

    fn due(&self) -> BusTime {
        self.due
    }

    fn act(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        self.due = BusTime(now.0 + 50_000);
        for session in heard.sessions() {
            let beat = Command::HostHeartbeat { session };
            out.extend(beat.encode(Address::All));
        }
    }
}
