//! Random numbers that are the same for ever.

/// SplitMix64: a state of 64 bits, period 2^64.
///
/// After Sebastiano Vigna's public domain `splitmix64.c`
/// (<https://prng.di.unimi.it/splitmix64.c>); G. Steele, D. Lea, C. Flood: Fast Splittable
/// Pseudorandom Number Generators, OOPSLA 2014. It is our own rather than a crate's because a
/// crate may change its numbers between versions, and then a seed would no longer mean the same.
#[derive(Debug, Clone)]
pub(crate) struct SplitMix64(u64);

impl SplitMix64 {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 to `greatest`, both included. The multiplication favours some values by one in
    /// 2^64 / `greatest`, which no simulation can see.
    pub(crate) fn up_to(&mut self, greatest: u64) -> u64 {
        ((u128::from(self.next()) * (u128::from(greatest) + 1)) >> 64) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_published_source() {
        let mut random = SplitMix64::new(1_234_567);
        let first: Vec<u64> = (0..5).map(|_| random.next()).collect();
        assert_eq!(
            first,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423,
                4_593_380_528_125_082_431,
                16_408_922_859_458_223_821,
            ]
        );
    }

    #[test]
    fn both_ends_of_a_range_are_reached_and_never_left() {
        let mut random = SplitMix64::new(0);
        let mut seen = [false; 4];
        for _ in 0..1_000 {
            seen[random.up_to(3) as usize] = true;
        }
        assert_eq!(seen, [true; 4]);
        assert_eq!(random.up_to(0), 0);
    }
}
