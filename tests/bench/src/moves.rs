//! The moves that everybody has to calculate: random ones, the same at each run.

/// A move to rest at a target; in memory as the C++ side reads it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Move {
    /// Where it starts.
    pub position: f64,
    /// How fast.
    pub velocity: f64,
    /// And with what acceleration.
    pub acceleration: f64,
    /// Where it comes to rest.
    pub target: f64,
    /// The largest velocity, either way.
    pub velocity_limit: f64,
    /// The largest acceleration, either way.
    pub acceleration_limit: f64,
    /// The largest jerk, either way.
    pub jerk_limit: f64,
}

/// Numbers without pattern from a seed: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
pub struct Random(pub u64);

impl Random {
    /// From 0 to just below 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between two numbers, evenly.
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// Between two positive numbers, evenly over their magnitudes.
    pub fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        self.between(least.ln(), most.ln()).exp()
    }
}

/// Moves from rest, over ranges from those that never reach a limit to long cruises.
pub fn from_rest(count: usize, seed: u64) -> Vec<Move> {
    let mut random = Random(seed);
    let mut moves = Vec::with_capacity(count);
    for _ in 0..count {
        let position = random.between(-10.0, 10.0);
        let way = random.magnitude(1e-3, 100.0);
        let forward = random.between(-1.0, 1.0) < 0.0;
        moves.push(Move {
            position,
            velocity: 0.0,
            acceleration: 0.0,
            target: if forward {
                position + way
            } else {
                position - way
            },
            velocity_limit: random.magnitude(0.5, 20.0),
            acceleration_limit: random.magnitude(1.0, 400.0),
            jerk_limit: random.magnitude(10.0, 40_000.0),
        });
    }
    moves
}

/// Changes of target in mid-move: from any velocity and acceleration within the limits.
pub fn retargets(count: usize, seed: u64) -> Vec<Move> {
    let mut random = Random(!seed);
    let mut moves = from_rest(count, seed);
    for one in &mut moves {
        one.velocity = one.velocity_limit * random.between(-1.0, 1.0);
        one.acceleration = one.acceleration_limit * random.between(-1.0, 1.0);
    }
    moves
}
