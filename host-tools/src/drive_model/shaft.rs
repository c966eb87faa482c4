//! What a model's motor moves: a shaft that follows a position loop, or a torque, or coasts.

/// One tick, in s.
const TICK: f64 = 1e-3;

/// What a position loop adds to the velocity for an error, in 1/s.
const GAIN: f64 = 100.0;

/// What a coasting shaft keeps of its speed in a tick.
const KEPT: f64 = 0.98;

/// Steps of a tick in which a torque is integrated.
const STEPS: u32 = 10;

/// A shaft, in turns and turns/s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shaft {
    pub(super) position: f64,
    pub(super) velocity: f64,
}

impl Shaft {
    pub(super) fn new(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
        }
    }

    /// A tick of a position loop with feed-forward of the velocity.
    pub(super) fn follow(&mut self, target: f64, velocity: f64) {
        self.velocity = velocity + GAIN * (target - self.position);
        self.position += self.velocity * TICK;
    }

    /// A tick under an acceleration that depends on place and speed, in turns/s^2.
    pub(super) fn push(&mut self, acceleration: impl Fn(f64, f64) -> f64) {
        let step = TICK / f64::from(STEPS);
        for _ in 0..STEPS {
            self.velocity += acceleration(self.position, self.velocity) * step;
            self.position += self.velocity * step;
        }
    }

    /// A tick without torque.
    pub(super) fn coast(&mut self) {
        self.velocity *= KEPT;
        self.position += self.velocity * TICK;
    }
}
