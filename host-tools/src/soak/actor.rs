//! Who speaks on the bus. All hear what is on it; none sees into a node.
//!
//! They speak in raw frames rather than through [`crate::client`], which is too orderly.
//!
//! | file | what it holds |
//! |---|---|
//! | `commander` | the host that the robot belongs to |
//! | `streaming` | the streams that it feeds |
//! | `choice` | moves, targets and parameters to choose from |
//! | `rival` | a second host |
//! | `hostile` | a device that sends what it should not |

mod choice;
mod commander;
mod hostile;
mod rival;
mod streaming;

use canter_shared::limits::Limits;
use canter_shared::time::BusTime;
use canter_shared::units::Position;
use canter_shared::wire::command::{Command, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, Function, LAST_AXIS};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

pub(super) use commander::Commander;
pub(super) use hostile::Hostile;
pub(super) use rival::Rival;

/// Frames that are remembered, to be sent again by who should not.
const REMEMBERED: usize = 64;

/// By whose controller a frame goes out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Voice {
    Host,
    Stranger,
}

/// Somebody who sends frames.
pub(super) trait Actor {
    /// Whose controller it has.
    fn voice(&self) -> Voice;

    /// When it acts next.
    fn due(&self) -> BusTime;

    /// Acts, and says when it will again by [`Self::due`].
    fn act(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>);
}

/// What is known of an axis from what it says.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Known {
    /// State, fault and session as they are on the wire.
    state: u8,
    fault: u8,
    session: Session,
    moving: bool,
    position: Position,
    /// The number of its last command, by its last refusal of a stale one.
    number: Option<u8>,
}

/// What was heard on the bus so far.
#[derive(Debug)]
pub(super) struct Heard {
    axes: [Option<Known>; LAST_AXIS as usize + 1],
    recent: Vec<Frame>,
    next: usize,
}

impl Default for Heard {
    fn default() -> Self {
        Self {
            axes: [None; LAST_AXIS as usize + 1],
            recent: Vec::with_capacity(REMEMBERED),
            next: 0,
        }
    }
}

impl Heard {
    fn axis(&self, axis: AxisId) -> Option<&Known> {
        self.axes[usize::from(axis.get())].as_ref()
    }

    /// The sessions that hold axes; one that holds several comes as often.
    pub(super) fn sessions(&self) -> impl Iterator<Item = Session> {
        let held = self.axes.iter().flatten().map(|known| known.session);
        held.filter(|session| *session != 0)
    }

    /// A frame was on the bus.
    pub(super) fn hear(&mut self, frame: &Frame) {
        if self.recent.len() < REMEMBERED {
            self.recent.push(*frame);
        } else {
            self.recent[self.next] = *frame;
            self.next = (self.next + 1) % REMEMBERED;
        }
        let Ok(Some((axis, report))) = Report::decode(frame) else {
            return;
        };
        let known = self.axes[usize::from(axis.get())].get_or_insert_default();
        match report {
            Report::Heartbeat {
                state,
                fault,
                session,
                ..
            } => {
                (known.state, known.fault, known.session) = (state, fault, session);
            }
            Report::Feedback {
                position,
                state,
                moving,
                ..
            } => {
                (known.position, known.state, known.moving) = (position, state, moving);
            }
            Report::Acknowledgement {
                function,
                reason: Reason::StaleSequence,
                detail,
                ..
            } if function != Function::Trigger => known.number = Some(detail as u8),
            _ => {}
        }
    }
}

/// An axis as those know it who have read its data sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheet {
    pub(super) id: AxisId,
    pub(super) limits: Limits,
}

/// Sends a command; one whose values do not fit was never meant.
fn say(out: &mut Vec<Frame>, address: impl Into<Address>, command: Command) {
    if let Ok(frame) = command.encode(address.into()) {
        out.push(frame);
    }
}

fn after(now: BusTime, microseconds: u64) -> BusTime {
    BusTime(now.0 + microseconds)
}
