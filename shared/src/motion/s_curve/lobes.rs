//! The shape of a motion: a peak and a trough of the acceleration, in unit-jerk time.

use super::unit::{Piece, Pieces};

/// A motion upwards: the acceleration's peak and trough, and what is held for how long.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lobes {
    pub peak: f64,
    pub peak_hold: f64,
    /// Between peak and trough, at this velocity.
    pub cruise: f64,
    pub cruise_velocity: f64,
    /// The magnitude of the trough.
    pub trough: f64,
    pub trough_hold: f64,
}

impl Lobes {
    /// Lays it from an acceleration of `a0`; `sign` is -1 where everything is upside down.
    pub fn lay(&self, a0: f64, sign: f64, pieces: &mut Pieces) {
        let Self { peak, trough, .. } = *self;
        // Times the sign, for next to nothing.
        let turned = |value: f64| {
            if sign.is_sign_negative() {
                -value
            } else {
                value
            }
        };
        let mut push = |duration, jerk: f64, from: f64| {
            pieces.push(Piece::new(duration, turned(jerk), turned(from)));
        };
        push(peak - a0, 1.0, a0);
        push(self.peak_hold, 0.0, peak);
        if self.cruise > 0.0 {
            push(peak, -1.0, peak);
            pieces.push(Piece::cruise(self.cruise, turned(self.cruise_velocity)));
            pieces.push(Piece::new(trough, -sign, 0.0));
        } else {
            push(peak + trough, -1.0, peak);
        }
        let mut push = |duration, jerk: f64| {
            pieces.push(Piece::new(duration, turned(jerk), turned(-trough)));
        };
        push(self.trough_hold, 0.0);
        push(trough, 1.0);
    }

    /// How long it lasts from an acceleration of `a0`.
    pub fn duration(&self, a0: f64) -> f64 {
        (self.peak - a0)
            + self.peak_hold
            + self.peak
            + self.cruise
            + self.trough
            + self.trough_hold
            + self.trough
    }
}

/// How long it takes to change the velocity by `change`, zero or more, between two states without
/// acceleration.
pub(super) fn change_time(change: f64, limit: f64) -> f64 {
    if change >= limit * limit {
        limit + change / limit
    } else {
        2.0 * libm::sqrt(change.max(0.0))
    }
}

/// The peak of acceleration of such a change, and how long it is held.
pub(super) fn change_peak(change: f64, limit: f64) -> (f64, f64) {
    let over = change - limit * limit;
    if over >= 0.0 {
        (limit, over / limit)
    } else {
        (libm::sqrt(change.max(0.0)), 0.0)
    }
}

/// h(w) = w t(w) / 2, where t(w) is the time of a change of velocity by w, and its derivatives:
/// the way of a stop from w.
pub(super) struct Triangle {
    pub area: f64,
    pub slope: f64,
    pub curvature: f64,
}

impl Triangle {
    pub fn new(change: f64, limit: f64) -> Self {
        let change = change.max(0.0);
        if change >= limit * limit {
            Self {
                area: change / 2.0 * (limit + change / limit),
                slope: limit / 2.0 + change / limit,
                curvature: 1.0 / limit,
            }
        } else {
            let peak = libm::sqrt(change);
            Self {
                area: change * peak,
                slope: 1.5 * peak,
                curvature: if peak > 0.0 { 0.75 / peak } else { 0.0 },
            }
        }
    }
}
