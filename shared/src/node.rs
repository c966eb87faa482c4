//! One device on the bus: a clock that SYNC disciplines, an identity, and some axes with drives.
//!
//! A firmware image or a host process owns a node and only wires it to its peripherals:
//!
//! ```text
//! a frame arrived        handle_frame(now, &frame), plan, then drain poll_transmit
//! at next_tick()         tick(now) -> setpoints, plan, then drain poll_drive_transmit and poll_transmit
//! a drive said something handle_drive_frame(&frame)
//! the bus had an error   count(event)
//! take_save() gives      write the image to the store, then saved(&image, ...)
//! ```
//!
//! Frames and ticks are quick; planning is not. An owner that does one thing at a time calls
//! [`Node::plan`]. One whose ticks must not wait has a task of lower priority that calls
//! [`Node::take_plan`], [`Plan::work`] outside of the node's lock, and [`Node::commit`].
//!
//! Ticks are whole milliseconds of bus time, so the ticks of all nodes on a bus coincide, and a
//! tick that runs late still gives the setpoint of its own instant. A tick is run [`TICK_LEAD`] before
//! its instant, so that what it hands over leaves for the drives around it.
//!
//! | file | what it holds |
//! |---|---|
//! | `assign` | an axis gets another id, by the chip's |
//! | `bus_off` | when a controller that went off its bus may come back |
//! | `drives` | the bus of the drives |
//! | `restart` | why a node had to begin anew |
//! | `save` | parameters on their way to the store |

mod assign;
pub mod bus_off;
mod drives;
pub mod restart;
mod save;

use crate::axis::state::State;
use crate::axis::supervision::sender_of;
use crate::axis::{Axis, FinishedPlan, Outcome, Plan};
use crate::drive::Drive;
use crate::limits::Limits;
use crate::motion::Setpoint;
use crate::motion::shaping::{Shaping, ShapingError};
use crate::parameter::Values;
use crate::time::bus_clock::{BusClock, Discipline};
use crate::time::{BusTime, LocalTime, Tick, Ticks};
use crate::wire::PROTOCOL_VERSION;
use crate::wire::command::{Action, Command};
use crate::wire::frame::Frame;
use crate::wire::id::{Address, AxisId};
pub use crate::wire::report::Board;
use crate::wire::report::{IdentityPart, Report};
use core::cell::Cell;
use core::fmt;
use heapless::Vec;

/// How long before its instant a tick is run, in microseconds.
///
/// Frames of one bus leave one after the other. Of the setpoints of three drives on a bus of 1 Mbit/s the
/// first leaves once they are worked out, 30 us after the tick begins, the third when the two before are
/// through: 30 + 2 * 135 bits = 300 us. With half of that as lead all three leave within 150 us of the instant
/// that they are for, and a single one 120 us before it.
pub const TICK_LEAD: u64 = (30 + 2 * 135) / 2;

/// Who a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identity {
    /// The chip's own 96-bit id.
    pub chip: [u8; 12],
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// What the node runs on.
    pub board: Board,
}

/// The setpoint of one axis at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisSetpoint {
    /// Which axis.
    pub axis: AxisId,
    /// Which tick.
    pub tick: Tick,
    /// The axis's state at that tick.
    pub state: State,
    /// What it is to do.
    pub setpoint: Setpoint,
}

/// Something that happened on the bus and is not a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BusEvent {
    /// The controller went off the bus.
    BusOff,
    /// An error frame was seen.
    ErrorFrame,
    /// A frame was received but could not be kept.
    LostReception,
}

/// Why an axis could not be added to a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeError {
    /// The node has no room for one more.
    Full {
        /// The axes that a node of this kind can hold.
        capacity: usize,
    },
    /// The node has an axis of this id already.
    Doubled {
        /// The id.
        axis: AxisId,
    },
}

impl fmt::Display for NodeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Full { capacity } => write!(formatter, "a node holds at most {capacity} axes"),
            Self::Doubled { axis } => write!(formatter, "axis {axis} is named twice"),
        }
    }
}

impl core::error::Error for NodeError {}

#[derive(Debug)]
struct Slot<D> {
    axis: Axis,
    drive: D,
    /// The next part of the identity to send, [`IdentityPart::COUNT`] where none is asked for.
    identity: u8,
}

/// A node with up to `AXES` axes, each with a drive `D`.
#[derive(Debug)]
pub struct Node<D, const AXES: usize> {
    identity: Identity,
    clock: BusClock,
    next: Option<Tick>,
    /// When that is to be, once it has been asked for: it is asked far more often than it changes.
    due: Cell<Option<LocalTime>>,
    /// When the last tick ran.
    ticked: LocalTime,
    slots: Vec<Slot<D>, AXES>,
    setpoints: Vec<AxisSetpoint, AXES>,
    /// The place of the axis whose plan was taken last.
    planned: usize,
    assignment: assign::Assignment,
}

impl<D: Drive, const AXES: usize> Node<D, AXES> {
    /// A node without axes.
    pub fn new(identity: Identity) -> Self {
        Self {
            identity,
            clock: BusClock::new(),
            next: None,
            due: Cell::new(None),
            ticked: LocalTime(0),
            slots: Vec::new(),
            setpoints: Vec::new(),
            planned: 0,
            assignment: assign::Assignment::default(),
        }
    }

    /// Adds an axis with these limits and the other parameters' defaults: see [`Axis::new`].
    ///
    /// # Errors
    /// No room, or an axis of that id already.
    pub fn add_axis(&mut self, axis: AxisId, limits: Limits, drive: D) -> Result<(), NodeError> {
        self.add_axis_with_values(axis, &Values::of_limits(axis.get(), &limits), drive)
    }

    /// Adds an axis with these parameters.
    ///
    /// # Errors
    /// No room, or an axis of that id already.
    pub fn add_axis_with_values(
        &mut self,
        axis: AxisId,
        values: &Values,
        drive: D,
    ) -> Result<(), NodeError> {
        if self.has_axis(axis) {
            return Err(NodeError::Doubled { axis });
        }
        let slot = Slot {
            axis: Axis::with_values(axis, values),
            drive,
            identity: IdentityPart::COUNT,
        };
        let full = NodeError::Full { capacity: AXES };
        self.slots.push(slot).map_err(|_| full)
    }

    /// Shapes the setpoints of an axis for a mode of its machine: see [`Axis::shape`]. An axis that
    /// the node does not have is passed over.
    ///
    /// # Errors
    /// The axis moves.
    pub fn shape(&mut self, axis: AxisId, shaping: Option<&Shaping>) -> Result<(), ShapingError> {
        let mut slots = self.slots.iter_mut();
        match slots.find(|slot| slot.axis.id() == axis) {
            Some(slot) => slot.axis.shape(shaping),
            None => Ok(()),
        }
    }

    fn has_axis(&self, axis: AxisId) -> bool {
        self.slots.iter().any(|slot| slot.axis.id() == axis)
    }

    /// The axes of the node.
    pub fn axes(&self) -> impl Iterator<Item = &Axis> {
        self.slots.iter().map(|slot| &slot.axis)
    }

    /// Bus time at a local time, as well as the node knows it.
    pub fn bus_time(&self, now: LocalTime) -> BusTime {
        self.clock.bus_time(now)
    }

    /// When to call [`Self::tick`] next. It moves with the bus clock: ask again after each frame.
    pub fn next_tick(&self) -> LocalTime {
        if let Some(due) = self.due.get() {
            return due;
        }
        let due = self.next.map_or(LocalTime(0), |tick| self.due_of(tick));
        self.due.set(Some(due));
        due
    }

    /// When a tick is to be run.
    fn due_of(&self, tick: Tick) -> LocalTime {
        // Before the first tick it wraps, and the clock reckons with differences that do as well.
        let time = tick.time().0.wrapping_sub(TICK_LEAD);
        self.clock.local_time(BusTime(time))
    }

    /// The instant that a tick which is run at `now` is for, where it is on time.
    fn instant_of(&self, now: LocalTime) -> BusTime {
        BusTime(self.clock.bus_time(now).0.wrapping_add(TICK_LEAD))
    }

    /// Takes a frame that arrived at `now`. The node must not be given what it sends itself: what
    /// comes in the name of one of its axes is from another node with that id.
    pub fn handle_frame(&mut self, now: LocalTime, frame: &Frame) {
        if let Some(sender) = sender_of(frame) {
            let mut slots = self.slots.iter_mut();
            if let Some(slot) = slots.find(|slot| slot.axis.id() == sender) {
                slot.axis.hear_double();
            }
            return;
        }
        let Ok(Some((address, command))) = Command::decode(frame) else {
            return;
        };
        if let Command::Sync { counter, time } = command {
            self.synchronise(now, counter, time);
            return;
        }
        if let Command::Assign(part) = command {
            self.assign(part);
            return;
        }
        let bus_time = self.clock.bus_time(now);
        for slot in &mut self.slots {
            if !address.includes(slot.axis.id()) {
                continue;
            }
            if matches!(command, Command::IdentityRequest) {
                slot.identity = 0;
                continue;
            }
            // The answer is in the axis's queue, or will be; the node has nothing to add to it.
            let changes_drive = drives::changes_drive(&command, slot.axis.values());
            let outcome = slot.axis.handle_command(bus_time, frame, command);
            if outcome == Outcome::Accepted && changes_drive {
                slot.drive.configure(|| slot.axis.values().drive());
            }
            if address != Address::All {
                break;
            }
        }
        if let Command::Control {
            action: Action::Save,
            ..
        } = command
        {
            self.refuse_saves_while_driving();
        }
    }

    fn synchronise(&mut self, now: LocalTime, counter: u8, sent: BusTime) {
        let due = self.next_tick();
        let at_rest = self.slots.iter().all(|slot| !slot.axis.is_moving());
        let discipline = self.clock.synchronise(now, counter, sent, at_rest);
        if discipline == Discipline::Stepped && self.next.is_some() {
            // A frame may have waited while ticks went on: those are not run again, else a busy node that
            // is set again and again would never get on.
            let next = self.instant_of(now.max(self.ticked)).next_tick();
            // However often the clock is set, the tick comes no later than it would have.
            let next = if self.due_of(next) > due {
                Tick(next.0.saturating_sub(1))
            } else {
                next
            };
            self.next = Some(next);
            for slot in &mut self.slots {
                slot.axis.rebase(Tick(next.0.saturating_sub(1)));
            }
        }
        self.due.set(None);
    }

    /// Runs the tick that is due: once for each time that [`Self::next_tick`] has come.
    pub fn tick(&mut self, now: LocalTime) -> &[AxisSetpoint] {
        self.ticked = now;
        let bus_time = self.instant_of(now);
        // Only the first one is worked out: a division of 64 bits is not for every tick.
        let tick = self
            .next
            .unwrap_or_else(|| Tick(bus_time.next_tick().0.saturating_sub(1)));
        self.next = Some(Tick(tick.0.saturating_add(1)));
        self.due.set(None);
        self.setpoints.clear();
        for Slot { axis, drive, .. } in &mut self.slots {
            axis.handle_drive(drive.report());
            let setpoint = axis.tick(tick, bus_time);
            drive.command(tick, axis.drive_command());
            // As many places as axes: there is always room.
            let _ = self.setpoints.push(AxisSetpoint {
                axis: axis.id(),
                tick,
                state: axis.state(),
                setpoint,
            });
        }
        &self.setpoints
    }

    /// Whether [`Self::take_plan`] would give something.
    pub fn has_plan(&self) -> bool {
        self.slots.iter().any(|slot| slot.axis.has_plan())
    }

    /// The next change of motion that is to be worked out: stops first, then the axes in turn.
    /// `lead` says how many ticks may pass until it is committed.
    #[inline(never)]
    pub fn take_plan(&mut self, lead: Ticks) -> Option<Plan> {
        let stop = self
            .slots
            .iter()
            .position(|slot| slot.axis.has_stop_to_plan());
        let axes = self.slots.len();
        // From the one after the last on, so that a flood at one axis does not starve the others.
        let mut in_turn = (1..=axes).map(|step| (self.planned + step) % axes);
        let waits = |place: &usize| {
            let slot = self.slots.get(*place);
            slot.is_some_and(|slot| slot.axis.has_plan())
        };
        let place = stop.or_else(|| in_turn.find(waits))?;
        self.planned = place;
        self.slots.get_mut(place)?.axis.take_plan(lead)
    }

    /// Takes what came of a plan; the answer to its command is then waiting, or it is to be planned
    /// again.
    pub fn commit(&mut self, finished: &FinishedPlan) {
        let axis = finished.axis();
        let mut slots = self.slots.iter_mut();
        if let Some(slot) = slots.find(|slot| slot.axis.id() == axis) {
            let _: Outcome = slot.axis.commit(finished);
        }
    }

    /// Works out and commits everything that waits, before anything else happens.
    pub fn plan(&mut self) {
        for slot in &mut self.slots {
            while slot.axis.plan().is_some() {}
        }
    }

    /// How long the oldest stop that was decided has not been planned: an owner whose planner
    /// does not get on must not go on as if nothing were wrong.
    pub fn stop_overdue(&self) -> Ticks {
        let slots = self.slots.iter();
        let overdue = slots.map(|slot| slot.axis.stop_overdue());
        overdue.max().unwrap_or_default()
    }

    /// The next frame to send, until there is none.
    pub fn poll_transmit(&mut self, _now: LocalTime) -> Option<Frame> {
        self.slots.iter_mut().find_map(|slot| {
            slot.axis.poll_transmit().or_else(|| {
                let part = match slot.identity {
                    0 => IdentityPart::Version {
                        protocol: PROTOCOL_VERSION,
                        board: self.identity.board.into(),
                        firmware: self.identity.firmware,
                    },
                    1 => IdentityPart::ChipFirst(half(&self.identity.chip, 0)),
                    2 => IdentityPart::ChipLast(half(&self.identity.chip, 6)),
                    _ => return None,
                };
                slot.identity += 1;
                Some(Report::Identity(part).encode(slot.axis.id()))
            })
        })
    }

    /// Counts something that happened on the bus; the heartbeats of all axes tell it. Off the bus
    /// is a fault of each axis too.
    pub fn count(&mut self, event: BusEvent) {
        for slot in &mut self.slots {
            if event == BusEvent::BusOff {
                slot.axis.lose_bus();
            }
            let counters = slot.axis.counters_mut();
            let counter = match event {
                BusEvent::BusOff => &mut counters.bus_off,
                BusEvent::ErrorFrame => &mut counters.error_frames,
                BusEvent::LostReception => &mut counters.lost,
            };
            *counter = counter.wrapping_add(1);
        }
    }
}

/// Six bytes of a chip id from `start` on.
fn half(chip: &[u8; 12], start: usize) -> [u8; 6] {
    let mut half = [0; 6];
    for (byte, from) in half.iter_mut().zip(chip.iter().skip(start)) {
        *byte = *from;
    }
    half
}
