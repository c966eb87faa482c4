//! A beta move laid over others: how long it must last for their sum to keep the limits.
//!
//! Each beta move is monotone in position between its ends, in velocity between its ends and its
//! middle, and in acceleration between its ends and u = 1/4, 1/2 and 3/4. So over a window of
//! ticks its least and greatest values are those at the window's edges and at such a point inside.
//! The sums of these bounds bound the sum of the moves: a window that keeps the limits with them
//! keeps the limits at every tick.

use super::beta::{Beta, Contribution};
use crate::limits::Limits;
use crate::time::{LONGEST_MOVE, Tick, Ticks};
use crate::units::Position;

/// Windows over what is left of all moves: more find a shorter duration, and cost more.
const WINDOWS: u64 = 24;

/// How many times the asked duration is tried, in eighths: 1, 1.25, 1.5, 2 and 3.
const STRETCHES: [u64; 5] = [8, 10, 12, 16, 24];

/// The least and greatest values over a window.
#[derive(Clone, Copy, Default)]
struct Bounds {
    least: Contribution,
    greatest: Contribution,
}

impl Bounds {
    fn of(beta: &Beta, from: Tick, to: Tick) -> Self {
        let first = beta.contribution(from);
        let mut bounds = Self {
            least: first,
            greatest: first,
        };
        bounds.include(beta.contribution(to));
        let quarter = u64::from(beta.duration().0) / 4;
        for part in 1..=3 {
            // The true place of the peak, part * N / 4, lies between these two ticks.
            let near = beta.start().0.saturating_add(part * quarter);
            if from.0 <= near.saturating_add(part) && near <= to.0 {
                bounds.include_peak(beta, part);
            }
        }
        bounds
    }

    fn include(&mut self, value: Contribution) {
        let pick = |chosen: &mut Contribution, better: fn(i64, i64) -> i64| {
            chosen.position = better(chosen.position, value.position);
            chosen.velocity = better(chosen.velocity, value.velocity);
            chosen.acceleration = better(chosen.acceleration, value.acceleration);
        };
        pick(&mut self.least, i64::min);
        pick(&mut self.greatest, i64::max);
    }

    /// Widens the bounds by the velocity's peak in the middle, or by one of the acceleration's.
    fn include_peak(&mut self, beta: &Beta, part: u64) {
        let sign = beta.range().counts().signum();
        let mut value = self.least;
        match part {
            1 => value.acceleration = sign * beta.peak_acceleration().counts(),
            2 => value.velocity = sign * beta.peak_velocity().counts(),
            _ => value.acceleration = -sign * beta.peak_acceleration().counts(),
        }
        self.include(value);
    }

    fn add(&mut self, other: Self) {
        for (sum, part) in [
            (&mut self.least, other.least),
            (&mut self.greatest, other.greatest),
        ] {
            sum.position = sum.position.saturating_add(part.position);
            sum.velocity = sum.velocity.saturating_add(part.velocity);
            sum.acceleration = sum.acceleration.saturating_add(part.acceleration);
        }
    }

    fn inside(&self, rest: i64, limits: &Limits) -> bool {
        let within = |least: i64, greatest: i64, limit: i64| -limit <= least && greatest <= limit;
        let place = |offset: i64| Position::from_counts(rest.saturating_add(offset));
        within(
            self.least.velocity,
            self.greatest.velocity,
            limits.velocity().counts(),
        ) && within(
            self.least.acceleration,
            self.greatest.acceleration,
            limits.slower_acceleration().counts(),
        ) && limits.allow(place(self.least.position))
            && limits.allow(place(self.greatest.position))
    }
}

/// The beta move by `range` from `start` that lasts as asked, or the least of a few stretches of
/// that, such that its sum with `under_way` over the base at `rest` keeps the limits.
///
/// `None` where none of the durations tried does.
pub(crate) fn overlay(
    rest: i64,
    under_way: &[Beta],
    start: Tick,
    range: Position,
    asked: Ticks,
    limits: &Limits,
) -> Option<Beta> {
    let asked = asked.max(Beta::shortest(range, limits)?);
    STRETCHES.into_iter().find_map(|eighths| {
        let duration = (u64::from(asked.0) * eighths).div_ceil(8);
        if duration > u64::from(LONGEST_MOVE.0) {
            return None;
        }
        let added = Beta::new(start, range, Ticks(duration as u32));
        keeps(rest, under_way, &added, limits).then_some(added)
    })
}

fn keeps(rest: i64, under_way: &[Beta], added: &Beta, limits: &Limits) -> bool {
    let from = added.start();
    let end = under_way.iter().map(Beta::end).fold(added.end(), Tick::max);
    let length = end.0.saturating_sub(from.0);
    let windows = WINDOWS.min(length.max(1));
    (0..windows).all(|window| {
        let edge = |index: u64| Tick(from.0 + length * index / windows);
        let (from, to) = (edge(window), edge(window + 1));
        let mut sum = Bounds::of(added, from, to);
        for beta in under_way {
            sum.add(Bounds::of(beta, from, to));
        }
        sum.inside(rest, limits)
    })
}
