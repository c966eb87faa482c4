//! Who may have an axis moved, enabled and cleared, and what a latched fault forbids.

use canter_shared::axis::state::State;
use canter_shared::drive::Condition;

use super::believed::Believed;
use super::{Finding, Glance, Verdict};
use crate::soak::invariant::Invariant;

/// Ticks that a drive may take to let go.
const LETTING_GO: u8 = 3;

/// The eye on what an axis does of itself.
#[derive(Debug, Default)]
pub(super) struct Authority {
    /// Ticks since the axis has told its drive to let go, up to [`LETTING_GO`].
    let_go: u8,
}

impl Authority {
    pub(super) fn tick(
        &mut self,
        last: Option<&Glance>,
        now: &Glance,
        believed: &mut Believed,
    ) -> Verdict {
        self.fault(last, now, believed)?;
        self.torque(last, now, believed)?;
        self.motion(last, now, believed)
    }

    /// A fault is latched until it is cleared, and then the axis is disabled.
    fn fault(&mut self, last: Option<&Glance>, now: &Glance, believed: &Believed) -> Verdict {
        let asked = believed.asked();
        let latch = |words: String| Err(Finding(Invariant::Latch, words));
        let faulted = matches!(now.state, State::Fault | State::FaultReactionActive);
        if faulted != now.fault.is_some() {
            return latch(format!("{} with fault {:?}", now.state, now.fault));
        }
        if asked.emergency_stop && now.fault.is_none() && !asked.clear {
            return latch(format!("{} after an emergency stop", now.state));
        }
        let Some((last, before)) = last.and_then(|last| Some((last, last.fault?))) else {
            return Ok(());
        };
        let kept = now.fault == Some(before);
        if !kept && !asked.clear {
            return latch(format!(
                "fault {before:?} became {:?}, and nobody who may has cleared it",
                now.fault
            ));
        }
        // What is being brought to rest is not cleared.
        if !kept && last.state == State::FaultReactionActive {
            return latch(format!("fault {before:?} was cleared in {}", last.state));
        }
        Ok(())
    }

    /// Torque comes on when the holder asks for it, and goes with the state.
    fn torque(&mut self, last: Option<&Glance>, now: &Glance, believed: &mut Believed) -> Verdict {
        let drives = now.state.drives();
        let drove = last.is_some_and(|last| last.state.drives());
        if drives && !drove && !believed.enable {
            return Err(Finding(
                Invariant::Latch,
                format!("{}, though nobody who may has enabled the axis", now.state),
            ));
        }
        if drives && !drove || now.fault.is_some() {
            believed.enable = false;
        }
        self.let_go = if drives {
            0
        } else {
            LETTING_GO.min(self.let_go + 1)
        };
        if self.let_go == LETTING_GO && now.drive.condition == Condition::Enabled {
            return Err(Finding(
                Invariant::Latch,
                format!("the drive holds torque in {}", now.state),
            ));
        }
        Ok(())
    }

    /// An enabled axis moves as its holder commanded; otherwise it only comes to rest.
    fn motion(&mut self, last: Option<&Glance>, now: &Glance, believed: &mut Believed) -> Verdict {
        let moves = now.setpoint.velocity.counts() != 0
            || last.is_some_and(|last| {
                last.state == State::OperationEnabled
                    && last.setpoint.position != now.setpoint.position
            });
        if now.state == State::OperationEnabled && moves {
            let silence = believed.silence(now.time);
            let words = if !believed.motion {
                Some("without a command to move".to_owned())
            } else if now.session.is_none() {
                Some("and nobody holds it".to_owned())
            } else if silence > believed.longest_silence() {
                Some(format!(
                    "and its session has been silent for {:.1} ms",
                    silence as f64 / 1e6
                ))
            } else {
                None
            };
            if let Some(words) = words {
                return Err(Finding(
                    Invariant::Commander,
                    format!("the axis moves {words}"),
                ));
            }
        }
        // What was commanded is over, unless more came since the tick before.
        if now.rests() {
            believed.motion = false;
        }
        Ok(())
    }
}
