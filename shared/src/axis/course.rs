//! The motion under way, and the one that takes over from it.
//!
//! A motion is planned for a tick that is still to come, the splice: up to there the one under way
//! goes on, from there the other. At the splice both are in the same place at the same velocity.

use super::Departure;
use super::reaction::Stopping;
use crate::motion::{Motion, Setpoint};
use crate::time::Tick;
use crate::units::Position;

/// What takes over, and when.
#[derive(Debug, Clone, Copy)]
struct Next {
    splice: Tick,
    /// How it brings the axis to rest; `None` where it leads to a target.
    stops: Option<Stopping>,
    departure: Option<Departure>,
}

/// Two motions that are used by turns: taking over copies nothing, since it happens in a tick.
#[derive(Debug, Clone)]
pub(super) struct Course {
    first: Motion,
    second: Motion,
    turned: bool,
    next: Option<Next>,
}

impl Course {
    pub(super) fn at_rest(position: Position) -> Self {
        Self {
            first: Motion::at_rest(position),
            second: Motion::at_rest(position),
            turned: false,
            next: None,
        }
    }

    /// The motion under way.
    pub(super) fn motion(&self) -> &Motion {
        if self.turned {
            &self.second
        } else {
            &self.first
        }
    }

    fn motion_mut(&mut self) -> &mut Motion {
        if self.turned {
            &mut self.second
        } else {
            &mut self.first
        }
    }

    fn idle_mut(&mut self) -> &mut Motion {
        if self.turned {
            &mut self.first
        } else {
            &mut self.second
        }
    }

    /// The motion that waits for its splice, and that tick.
    pub(super) fn next(&self) -> Option<(&Motion, Tick)> {
        let idle = if self.turned {
            &self.first
        } else {
            &self.second
        };
        self.next.map(|next| (idle, next.splice))
    }

    /// Whether a stop that is at least as hard waits for its splice.
    pub(super) fn is_about_to_stop(&self, stopping: Stopping) -> bool {
        self.next.is_some_and(|next| next.stops >= Some(stopping))
    }

    /// Whether the setpoint changes after `tick`, or will.
    pub(super) fn is_moving(&self, tick: Tick) -> bool {
        let next = self.next();
        moves(self.motion(), tick) || next.is_some_and(|(motion, _)| moves(motion, tick))
    }

    pub(super) fn at(&self, tick: Tick) -> Setpoint {
        self.motion().at(tick)
    }

    /// Forgets what has ended by `tick`, and says whether that was the end of all motion.
    #[inline(never)] // Its two callers would double an image's share of it.
    pub(super) fn fold(&mut self, tick: Tick) -> bool {
        let motion = self.motion_mut();
        let moved = motion.end().is_some();
        motion.fold(tick);
        moved && motion.end().is_none()
    }

    /// Ends everything at `position`.
    pub(super) fn rest(&mut self, position: Position) {
        self.next = None;
        *self.motion_mut() = Motion::at_rest(position);
    }

    /// Ends what has ended whatever the tick; only where nothing moves.
    pub(super) fn settle(&mut self) {
        self.next = None;
        self.fold(Tick(u64::MAX));
    }

    /// Has `motion` take over at `splice`, in place of another that waits for that.
    pub(super) fn splice(
        &mut self,
        splice: Tick,
        motion: &Motion,
        stops: Option<Stopping>,
        departure: Option<Departure>,
    ) {
        self.idle_mut().clone_from(motion);
        self.next = Some(Next {
            splice,
            stops,
            departure,
        });
    }

    /// Calls off what waits for its splice, unless it is a stop.
    pub(super) fn call_off_move(&mut self) {
        self.next = self.next.filter(|next| next.stops.is_some());
    }

    /// Goes on to `tick`: where the other motion takes over, gives the departure that it brings.
    pub(super) fn advance(&mut self, tick: Tick) -> Option<Option<Departure>> {
        let next = self.next.take_if(|next| next.splice <= tick)?;
        self.turned = !self.turned;
        Some(next.departure)
    }
}

/// Asked in many places: a copy in each would be a kilobyte of flash.
#[inline(never)]
fn moves(motion: &Motion, tick: Tick) -> bool {
    motion.is_moving(tick)
}
