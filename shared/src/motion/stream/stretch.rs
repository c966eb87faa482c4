//! The knots that a stream holds, in as few bytes as hold them: 24 each.

use core::num::NonZeroU8;

/// A knot in counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) position: i64,
    pub(super) velocity: i64,
    pub(super) acceleration: Option<i64>,
}

/// Bits for the number of periods, up to [`super::LONGEST_GAP`].
const PERIODS: u32 = 7;
const _: () = assert!((super::LONGEST_GAP as u64) < 1 << PERIODS);

/// Set where the acceleration is known.
const KNOWN: i64 = 1 << PERIODS;

/// Bits below the acceleration, which is below 2^50 counts/s^2 as every limit is.
const BELOW: u32 = PERIODS + 1;

/// From the knot before it to one that was taken on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stretch {
    position: i64,
    velocity: i64,
    /// From the top: the acceleration, whether it is known, the number of periods.
    rest: i64,
}

impl Stretch {
    /// To a knot that keeps the limits, in up to [`super::LONGEST_GAP`] periods.
    pub(super) fn new(to: &Place, periods: u8) -> Self {
        let acceleration = match to.acceleration {
            Some(acceleration) => acceleration << BELOW | KNOWN,
            None => 0,
        };
        Self {
            position: to.position,
            velocity: to.velocity,
            rest: acceleration | i64::from(periods),
        }
    }

    /// Where it leads.
    pub(super) fn to(&self) -> Place {
        Place {
            position: self.position,
            velocity: self.velocity,
            acceleration: (self.rest & KNOWN != 0).then_some(self.rest >> BELOW),
        }
    }

    /// How long it lasts, with a period of so many ticks.
    pub(super) fn ticks(&self, period: NonZeroU8) -> u16 {
        let periods = (self.rest & (KNOWN - 1)) as u16;
        periods * u16::from(period.get())
    }
}

#[cfg(test)]
mod tests {
    use super::super::LONGEST_GAP;
    use super::*;
    use proptest::prelude::*;

    const STRONGEST: i64 = 1 << 50;

    proptest! {
        #[test]
        fn what_is_held_is_what_was_taken_on(
            position: i64,
            velocity: i64,
            acceleration in proptest::option::of(-STRONGEST..=STRONGEST),
            periods in 1..=LONGEST_GAP,
            period in 1u8..,
        ) {
            let to = Place { position, velocity, acceleration };
            let stretch = Stretch::new(&to, periods);
            prop_assert_eq!(stretch.to(), to);
            let period = NonZeroU8::new(period).expect("not zero");
            prop_assert_eq!(stretch.ticks(period), u16::from(periods) * u16::from(period.get()));
        }
    }

    #[test]
    fn a_knot_takes_24_bytes() {
        assert_eq!(size_of::<Stretch>(), 24);
    }
}
