//! The streams among the random frames.

use super::bench::turns;
use super::random::{Run, Step, Target, ahead};
use canter_shared::time::Tick;
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Command, wire_position, wire_velocity};
use proptest::prelude::*;
use std::f64::consts::TAU;

#[derive(Debug, Clone)]
pub enum StreamStep {
    /// A stream of this period from a good host, with its first knots.
    Good(u8, u8, f64),
    /// So many ticks ahead, with this period, under this number, and how far the command's goes on.
    Begin(i64, u8, u8, u8),
    /// So many knots one after the other: how far the number goes on each time, the acceleration
    /// and the bend as parts of what is allowed, and the ticks between.
    Knots(u8, u8, f64, f64, u64),
    /// A place and a velocity as parts of what is allowed, and a number.
    Wild(f64, f64, u8),
}

/// The next knot mostly; the last one again, or some were lost.
fn knots_ahead() -> impl Strategy<Value = u8> {
    prop_oneof![12 => Just(1u8), 1 => Just(0u8), 2 => 2u8..4, 1 => 0u8..64]
}

pub fn stream() -> impl Strategy<Value = StreamStep> {
    prop_oneof![
        2 => (-2i64..40, any::<u8>(), 0u8..64, ahead())
            .prop_map(|(start, period, number, n)| StreamStep::Begin(start, period, number, n)),
        4 => (1u8..30, 0u8..64, -1.0..1.0f64)
            .prop_map(|(period, number, a)| StreamStep::Good(period, number, a)),
        16 => (1u8..12, knots_ahead(), -1.0..1.0f64, -0.5..0.5f64, 0u64..40)
            .prop_map(|(count, ahead, a, b, ticks)| StreamStep::Knots(count, ahead, a, b, ticks)),
        2 => (-0.1..1.1f64, -1.1..1.1f64, 0u8..64)
            .prop_map(|(place, rate, n)| StreamStep::Wild(place, rate, n)),
    ]
}

/// The last knot of a stream as its host believes it to be.
#[derive(Debug, Clone, Copy, Default)]
pub struct LastKnot {
    number: u8,
    period: u8,
    position: Position,
    /// rad/s.
    velocity: f64,
}

impl Run {
    pub fn stream(&mut self, step: StreamStep) {
        match step {
            StreamStep::Good(period, number, acceleration) => {
                self.take(Step::Recover);
                for _ in 0..500 {
                    if self.bench.axis.is_moving() {
                        self.run(1);
                    }
                }
                self.stream(StreamStep::Begin(2, period, number, 1));
                self.stream(StreamStep::Knots(3, 1, acceleration, 0.0, 0));
            }
            StreamStep::Begin(start, period, number, ahead) => {
                let sequence = self.number(ahead);
                self.knot = LastKnot {
                    number,
                    period,
                    position: self.bench.setpoint.position,
                    velocity: 0.0,
                };
                self.send(Command::StreamBegin {
                    start: Tick(self.bench.tick.saturating_add_signed(start)),
                    period,
                    number,
                    sequence,
                });
            }
            StreamStep::Knots(count, ahead, acceleration, bend, ticks) => {
                for _ in 0..count {
                    self.next_knot(ahead, acceleration, bend);
                    self.run(ticks);
                }
            }
            StreamStep::Wild(place, rate, number) => {
                let position = self.target(Target::Inside(place));
                let fastest = self.bench.axis.limits().velocity().radians();
                self.send_knot(position, rate * fastest, number);
            }
        }
    }

    fn send_knot(&mut self, position: Position, velocity: f64, number: u8) {
        // What the wire can carry.
        let velocity = Velocity::from_radians(velocity.clamp(-3_000.0, 3_000.0));
        let velocity = wire_velocity(velocity.expect("in range"));
        let position = wire_position(position);
        let taken = self.knots;
        self.send(Command::Knot {
            position,
            velocity,
            number,
        });
        if self.knots > taken {
            self.knot = LastKnot {
                number,
                position,
                velocity: velocity.radians(),
                ..self.knot
            };
        }
    }

    /// A knot that goes on from the last one.
    fn next_knot(&mut self, ahead: u8, acceleration: f64, bend: f64) {
        let limits = self.bench.axis.limits();
        let strength = limits.slower_acceleration().radians();
        let fastest = limits.velocity().radians();
        let seconds = f64::from(ahead) * f64::from(self.knot.period) / 1e3;
        let before = self.knot.velocity;
        let velocity = before + acceleration * strength * seconds;
        let velocity = velocity.clamp(-0.95 * fastest, 0.95 * fastest);
        let bend = bend * strength * seconds * seconds / 12.0;
        let way = (before + velocity) / 2.0 * seconds + bend;
        let position = self.knot.position + turns(way / TAU);
        let position = position.max(turns(-1_023.9)).min(turns(1_023.9));
        self.send_knot(position, velocity, (self.knot.number + ahead) % 64);
    }
}
