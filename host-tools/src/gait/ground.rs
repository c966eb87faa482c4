//! Where the body is on the ground.

use super::blend::Commands;

/// Where the body is on the ground, from where it began.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// In m.
    pub x: f64,
    /// In m.
    pub y: f64,
    /// Turned to the left, in rad.
    pub yaw: f64,
}

/// Steps of the integration, in s. At 10 rad/s the error of one is below 10^-14 of the way.
const LONGEST: f64 = 0.01;

/// Steps at most: the guess of where to step need not be exact in a cycle of many seconds.
const MOST_STEPS: f64 = 200.0;

/// Gauss's points and weights on 0 to 1.
const POINTS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

impl Pose {
    /// A place that the body sees, as a place on the ground.
    pub fn place(&self, seen: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.yaw.sin_cos();
        [
            self.x + cos * seen[0] - sin * seen[1],
            self.y + sin * seen[0] + cos * seen[1],
        ]
    }

    /// Where the body gets to as it is commanded.
    pub(super) fn after(mut self, commands: &Commands, from: f64, to: f64) -> Self {
        let span = to - from;
        if span <= 0.0 {
            return self;
        }
        let steps = (span / LONGEST).ceil().clamp(1.0, MOST_STEPS);
        let step = span / steps;
        for index in 0..steps as usize {
            self.step(commands, from + step * index as f64, step);
        }
        self
    }

    /// Gauss's quadrature of the velocity; the yaw inside a step is a quadrature of its own.
    fn step(&mut self, commands: &Commands, from: f64, step: f64) {
        let turned = |share: f64| -> f64 {
            let part = step * share;
            POINTS
                .iter()
                .map(|(at, weight)| commands.at(from + part * at)[2].value * weight * part)
                .sum()
        };
        for (at, weight) in POINTS {
            let [vx, vy, ..] = commands.at(from + step * at).map(|value| value.value);
            let (sin, cos) = (self.yaw + turned(at)).sin_cos();
            self.x += (cos * vx - sin * vy) * weight * step;
            self.y += (sin * vx + cos * vy) * weight * step;
        }
        self.yaw += turned(1.0);
    }
}
