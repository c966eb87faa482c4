//! Back inside the limits, for a start that is outside them.
//!
//! The rules are those of Ruckig's position interface, so that durations agree with it: too much
//! acceleration is released first, unless the velocity would then pass its limit; too much
//! velocity is slowed down until it passes the limit, with the acceleration that it has then.

use super::unit::{Piece, Pieces, Range, State};

/// Lays what brings `state` back inside the limits into `pieces`, and gives the state after it.
pub(super) fn brake(state: State, range: &Range, pieces: &mut Pieces) -> State {
    let State {
        velocity: v,
        acceleration: a,
        ..
    } = state;
    // What the velocity comes to while the acceleration is released.
    let (released_down, released_up) = (v - a * a / 2.0, v + a * a / 2.0);
    let upward = Brake {
        state,
        range: *range,
    };
    let (brake, sign) = if a > range.rise {
        (upward.less_acceleration(), 1.0)
    } else if a < -range.fall {
        (upward.mirrored().less_acceleration(), -1.0)
    } else if v > range.highest && released_down > range.lowest
        || a > 0.0 && released_up > range.highest
    {
        (upward.less_velocity(), 1.0)
    } else if v < range.lowest && released_up < range.highest
        || a < 0.0 && released_down < range.lowest
    {
        (upward.mirrored().less_velocity(), -1.0)
    } else {
        return state;
    };
    let mut now = state;
    for (duration, jerk) in [(brake.0.max(0.0), -sign), (brake.1.max(0.0), 0.0)] {
        let piece = Piece::new(duration, jerk, now.acceleration);
        pieces.push(piece);
        now = now.after(piece);
    }
    now.acceleration = now.acceleration.min(range.rise).max(-range.fall);
    now
}

/// A start that is too high: how long to lower the acceleration, and how long to hold it then.
struct Brake {
    state: State,
    range: Range,
}

impl Brake {
    fn mirrored(self) -> Self {
        Self {
            state: self.state.mirrored(),
            range: self.range.mirrored(),
        }
    }

    fn less_acceleration(&self) -> (f64, f64) {
        let Range {
            highest,
            lowest,
            rise,
            margin,
            ..
        } = self.range;
        let (v, a) = (self.state.velocity, self.state.acceleration);
        if v + a * a / 2.0 > highest {
            return self.less_velocity();
        }
        let at_limit = v + (a - rise) * (a + rise) / 2.0;
        let hold = if at_limit < lowest {
            ((lowest - at_limit) / rise).min((highest - at_limit) / rise - rise / 2.0 - margin)
        } else {
            0.0
        };
        (a - rise + margin, hold)
    }

    fn less_velocity(&self) -> (f64, f64) {
        let Range {
            highest,
            lowest,
            fall,
            margin,
            ..
        } = self.range;
        let (v, a) = (self.state.velocity, self.state.acceleration);
        let until_highest = a + libm::sqrt((a * a + 2.0 * (v - highest)).max(0.0));
        let until_lowest = a + libm::sqrt((a * a / 2.0 + (v - lowest)).max(0.0));
        let ramp = until_highest.min(until_lowest);
        if a + fall >= ramp {
            return (ramp - margin, 0.0);
        }
        let at_limit = v + (a - fall) * (a + fall) / 2.0;
        let hold = ((at_limit - highest) / fall).min((at_limit - lowest) / fall - fall / 2.0);
        (a + fall - margin, hold)
    }
}
