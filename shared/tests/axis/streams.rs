//! A host that streams knots to the axis on the bench.

use super::bench::Bench;
use canter_shared::axis::Outcome;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::time::Tick;
use canter_shared::units::{COUNTS_PER_TURN, Position, Velocity};
use canter_shared::wire::command::{Command, wire_position, wire_velocity};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

/// Ticks from knot to knot.
pub const PERIOD: u8 = 20;

/// A quintic from rest to rest over `way` turns in `duration` seconds: turns and turns/s.
pub fn quintic(way: f64, duration: f64, seconds: f64) -> (f64, f64) {
    let u = (seconds / duration).clamp(0.0, 1.0);
    let position = way * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
    let rate = 30.0 * u * u * (1.0 - u) * (1.0 - u);
    (position, way * rate / duration)
}

/// A velocity in turns/s.
pub fn rate(turns: f64) -> Velocity {
    Velocity::from_counts((turns * COUNTS_PER_TURN as f64) as i64)
}

/// A knot as the wire carries it, in turns and turns/s.
pub fn knot(number: u8, position: f64, velocity: f64) -> Command {
    let position = Position::from_counts((position * COUNTS_PER_TURN as f64) as i64);
    Command::Knot {
        position: wire_position(position),
        velocity: wire_velocity(rate(velocity)),
        number: number % 64,
    }
}

impl Bench {
    /// A stream that begins so many ticks after the last one, under the next number.
    pub fn begin(&mut self, ahead: u64, period: u8, number: u8) -> Outcome {
        let sequence = self.next();
        self.send(Command::StreamBegin {
            start: Tick(self.tick + ahead),
            period,
            number,
            sequence,
        })
    }

    /// The answers to knots so far: number, reason, detail.
    pub fn knot_answers(&self) -> Vec<(u8, Reason, u32)> {
        let answer = |report: &Report| match *report {
            Report::Acknowledgement {
                sequence,
                function: Function::Knot,
                reason,
                detail,
            } => Some((sequence, reason, detail)),
            _ => None,
        };
        self.reports.iter().filter_map(answer).collect()
    }

    /// Enabled at 0, and so many ticks into a stream along `quintic`(way, duration), five knots
    /// ahead; gives the last knot's number.
    pub fn streaming(limits: Limits, way: f64, duration: f64, ticks: u64) -> (Self, u8) {
        let mut bench = Self::enabled(limits, 0.0);
        let number = bench.stream_on(way, duration, ticks);
        (bench, number)
    }

    /// The same from an axis that rests at 0.
    pub fn stream_on(&mut self, way: f64, duration: f64, ticks: u64) -> u8 {
        assert_eq!(self.begin(1, PERIOD, 0), Outcome::Accepted);
        let mut number = 0;
        let all = (duration * 1e3) as u64 / u64::from(PERIOD);
        for tick in 0..ticks {
            let ahead = 5 + tick / u64::from(PERIOD);
            while u64::from(number) < ahead.min(all) {
                number += 1;
                let seconds = f64::from(number) * f64::from(PERIOD) / 1e3;
                let (position, velocity) = quintic(way, duration, seconds);
                let outcome = self.send(knot(number, position, velocity));
                assert_eq!(outcome, Outcome::Accepted, "{number}");
            }
            self.step();
        }
        number
    }

    /// One tick, whose velocity must be what the positions show.
    pub fn step_evenly(&mut self) {
        let last = self.setpoint;
        self.step();
        evenly(last, self.setpoint, self.axis.limits());
    }
}

/// The way between two ticks is that of their mean velocity: nothing jumps.
#[track_caller]
pub fn evenly(last: Setpoint, now: Setpoint, limits: &Limits) {
    let strongest = limits.acceleration().max(limits.deceleration()).radians();
    let moved = (now.position - last.position).radians();
    let mean = (now.velocity.radians() + last.velocity.radians()) / 2e3;
    // Between two ticks the acceleration may turn from one limit to the other.
    let slack = 4e-9 + strongest * 1e-6 / 4.0;
    assert!((moved - mean).abs() <= slack, "{last:?} {now:?}");
}
