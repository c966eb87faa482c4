//! What tests break on purpose: a checker that finds nothing has found nothing only if it would.

use std::time::Duration;

use canter_shared::parameter::{Parameter, Values};
use canter_shared::time::BusTime;
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::Address;

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

use super::actor::{Actor, Heard, Voice};
use crate::robot::RobotAxis;
use crate::sim::{Disturbance, SimulatedBus, SimulatedFlash};

/// One thing that is broken in the robot or in its wiring, so that an invariant must be violated.
/// Tests ask for it; the command line cannot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sabotage {
    /// The nodes have limits half as high again as they say.
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
    /// Nodes lose a word of their flash while they have no power.
    WornFlash,
    /// A parameter of a node that begins is one that was never saved.
    TornParameters,
    /// An answer is given twice.
    DoubledAnswer,
    /// A node panics.
    Panic,
}

impl Sabotage {
    /// Every kind.
    pub const ALL: [Self; 11] = [
        Self::HigherLimits,
        Self::Jump,
        Self::MissedTick,
        Self::BeatsForTheDead,
        Self::HiddenMove,
        Self::DeafToStop,
        Self::ForgottenFault,
        Self::WornFlash,
        Self::TornParameters,
        Self::DoubledAnswer,
        Self::Panic,
    ];
}

/// The parameters that are raised.
const RATES: [Parameter; 3] = [
    Parameter::VelocityLimit,
    Parameter::AccelerationLimit,
    Parameter::DecelerationLimit,
];

/// The values of an axis with rates half as high again, or as high as can be.
pub(super) fn raised(axis: &RobotAxis) -> Values {
    RATES.into_iter().fold(axis.values, |values, rate| {
        let most = rate.entry().maximum;
        let raw = (values.get(rate) / 2 * 3).min(most);
        values.with(rate, raw).map_or(values, |(raised, _)| raised)
    })
}

/// The values as such an axis shows them: what is raised as it was meant to be.
pub(super) fn lowered(values: &Values, axis: &RobotAxis) -> Values {
    let raised = raised(axis);
    RATES.into_iter().fold(*values, |values, rate| {
        if values.get(rate) != raised.get(rate) {
            return values;
        }
        let meant = axis.values.get(rate);
        values
            .with(rate, meant)
            .map_or(values, |(lowered, _)| lowered)
    })
}

/// The first node loses its power, and a word of each page of its flash with it.
pub(super) fn wear_out(bus: &mut SimulatedBus) {
    let node = 0;
    let time = Duration::ZERO;
    bus.disturb(Disturbance::CutPower { node, time });
    let Some(flash) = bus.flash_mut(node) else {
        return;
    };
    for page in (0..flash.capacity()).step_by(SimulatedFlash::ERASE_SIZE) {
        // Zeros can be written over anything.
        let written = flash.write(page as u32, &[0; SimulatedFlash::WRITE_SIZE]);
        debug_assert!(written.is_ok(), "{written:?}");
    }
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
