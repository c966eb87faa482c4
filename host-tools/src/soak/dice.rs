//! Chance, from the seed: the numbers of the simulator's generator in the shapes that are needed.

use std::time::Duration;

use crate::sim::random::SplitMix64;

/// A stream of chance. Streams of different names are independent of each other, so that one draw
/// more in one of them does not change the others.
#[derive(Debug, Clone)]
pub(super) struct Dice(SplitMix64);

impl Dice {
    /// The stream called `name` of a seed.
    pub(super) fn new(seed: u64, name: &str) -> Self {
        // FNV-1a: any mixing of the name will do.
        let hash = name.bytes().fold(0xCBF2_9CE4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
        });
        let mut first = SplitMix64::new(seed);
        Self(SplitMix64::new(first.next() ^ hash))
    }

    pub(super) fn bits(&mut self) -> u64 {
        self.0.next()
    }

    /// From `least` to `greatest`, both included.
    pub(super) fn between(&mut self, least: u64, greatest: u64) -> u64 {
        least + self.0.up_to(greatest - least)
    }

    /// Whether something happens that does so `of_a_hundred` times.
    pub(super) fn percent(&mut self, of_a_hundred: u64) -> bool {
        self.0.up_to(99) < of_a_hundred
    }

    /// From `least` up to `greatest`.
    pub(super) fn real(&mut self, least: f64, greatest: f64) -> f64 {
        // 53 bits, all that an f64 holds.
        let unit = (self.0.next() >> 11) as f64 / (1_u64 << 53) as f64;
        least + (greatest - least) * unit
    }

    /// From `least` up to `greatest`, each decade as likely as another.
    ///
    /// By halving rather than by `exp`, whose last bit differs between machines.
    pub(super) fn decades(&mut self, least: f64, greatest: f64) -> f64 {
        let mut value = least;
        let mut steps = 0;
        while value * 2.0 <= greatest {
            value *= 2.0;
            steps += 1;
        }
        let octave = self.0.up_to(steps);
        let from = least * (1_u64 << octave) as f64;
        self.real(from, (from * 2.0).min(greatest))
    }

    /// One of `choices`, which must not be empty.
    pub(super) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.up_to(choices.len() as u64 - 1) as usize]
    }

    /// A duration in whole microseconds.
    pub(super) fn time(&mut self, least: Duration, greatest: Duration) -> Duration {
        let micros = |time: Duration| time.as_micros() as u64;
        Duration::from_micros(self.between(micros(least), micros(greatest)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_seed_gives_the_same_numbers_and_names_differ() {
        let numbers = |seed, name| {
            let mut dice = Dice::new(seed, name);
            [(); 4].map(|()| dice.bits())
        };
        assert_eq!(numbers(1, "robot"), numbers(1, "robot"));
        assert_ne!(numbers(1, "robot"), numbers(1, "hostile"));
        assert_ne!(numbers(1, "robot"), numbers(2, "robot"));
    }

    #[test]
    fn decades_reach_their_ends_and_stay_inside() {
        let mut dice = Dice::new(1, "decades");
        let values = [(); 20_000].map(|()| dice.decades(1e-4, 1e4));
        assert!(values.iter().all(|value| (1e-4..=1e4).contains(value)));
        assert!(values.iter().any(|value| *value < 2e-4));
        assert!(values.iter().any(|value| *value > 5e3));
    }
}
