//! What is told ahead of a move: the ramps of a trapezoid, the limits of an s-curve.
//!
//! A plain move has no bits left for them, so they travel in frames of their own before it. Each
//! is for the next move of its kind that is accepted, and for nothing else.

use crate::limits::Limits;
use crate::motion::{Profile, Setpoint};
use crate::time::Ticks;
use crate::units::{Acceleration, Jerk, Velocity};
use crate::wire::command::ProfileKind;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Prepared {
    /// How long the next trapezoid accelerates and decelerates.
    pub(super) shape: Option<(Ticks, Ticks)>,
    /// The largest acceleration and deceleration of the next s-curve.
    pub(super) ramps: Option<(Acceleration, Acceleration)>,
    /// The largest velocity and jerk of the next s-curve.
    pub(super) peaks: Option<(Velocity, Jerk)>,
}

impl Prepared {
    /// Takes out what a move of this kind uses up.
    #[inline(never)]
    pub(super) fn take(&mut self, kind: ProfileKind) -> Self {
        match kind {
            ProfileKind::Beta => Self::default(),
            ProfileKind::Trapezoid => Self {
                shape: self.shape.take(),
                ..Self::default()
            },
            ProfileKind::SCurve => Self {
                ramps: self.ramps.take(),
                peaks: self.peaks.take(),
                ..Self::default()
            },
        }
    }

    /// Takes back what a move would have used that was refused, unless something newer is there.
    pub(super) fn give_back(&mut self, unused: Self) {
        self.shape = self.shape.or(unused.shape);
        self.ramps = self.ramps.or(unused.ramps);
        self.peaks = self.peaks.or(unused.peaks);
    }

    /// The profile of a move that is prepared in this way.
    #[inline(never)]
    pub(super) fn profile(&self, kind: ProfileKind) -> Profile {
        match (kind, self.shape) {
            (ProfileKind::Beta, _) => Profile::Beta,
            (ProfileKind::SCurve, _) => Profile::SCurve,
            (ProfileKind::Trapezoid, None) => Profile::Trapezoid,
            (ProfileKind::Trapezoid, Some((acceleration, deceleration))) => {
                Profile::ShapedTrapezoid {
                    acceleration,
                    deceleration,
                }
            }
        }
    }

    /// The limits of such a move from `state`: the axis's own, or what was told where that is
    /// less.
    ///
    /// In mid-move a jerk that is too small to take back the acceleration before the velocity
    /// passes the axis's own limit does not count.
    #[inline(never)]
    pub(super) fn limits(&self, own: &Limits, state: &Setpoint) -> Limits {
        let (acceleration, deceleration) = self
            .ramps
            .unwrap_or((own.acceleration(), own.deceleration()));
        let (velocity, mut jerk) = self.peaks.unwrap_or((own.velocity(), own.jerk()));
        // v + a |a| / (2 j) is where the velocity is once the acceleration is released.
        let a = state.acceleration.counts() as f64;
        let released = state.velocity.counts() as f64 + a * a.abs() / (2.0 * jerk.counts() as f64);
        if released.abs() > own.velocity().counts() as f64 {
            jerk = own.jerk();
        }
        // None of them is zero: such frames are refused.
        own.narrowed(velocity, acceleration, deceleration, jerk)
            .unwrap_or(*own)
    }
}
