//! The synchronised moves: their curves, their skew, the stop.

use super::super::measure::shares;
use super::super::{Measurements, MoveMeasurement, Performance, Sample};
use super::group;
use crate::plot::report::{Figure, Section};
use crate::plot::{Axis, Chart, Series};
use crate::robot::Robot;
use canter_shared::time::{Tick, Ticks};
use canter_shared::wire::id::AxisId;

/// What is shown before a move and after it.
const AROUND: u64 = 15;

/// From dot to dot, in ticks.
const DOTS: usize = 10;

/// The skews of so many moves are shown to all, those of the others to who asks.
const SHOWN: usize = 2;

/// What a chart shows of a sample.
type Value = fn(&Sample) -> f64;

/// The part of the page about moves; none where nothing moved.
pub fn section(
    performance: &Performance,
    measurements: &Measurements,
    robot: &Robot,
) -> Option<Section> {
    let first = measurements.moves.first()?;
    let pictured = Pictured::new(performance, first);
    let mut figures = vec![
        Figure::chart(
            pictured.progress(),
            "Every axis has another way to go. All lines lie on each other: the axes leave together and \
             arrive in one tick.",
        ),
        Figure::chart(
            pictured.positions(),
            "Lines: the setpoints of each tick. Dots: where the shafts really were.",
        ),
        Figure::chart(
            pictured.rates(robot, true),
            "One curve for all, scaled by the way: who goes farthest is the fastest.",
        ),
        Figure::chart(
            pictured.rates(robot, false),
            "Who goes farthest comes up to the limit and not beyond. A beta S-curve has no jump in its \
             acceleration.",
        ),
        Figure::chart(
            pictured.following(),
            "What the motors' inertia and friction leave to be caught up.",
        ),
        Figure::chart(
            stop(performance, robot),
            "In the middle of another move all axes are told to stop, and come to rest inside all limits.",
        ),
    ];
    let walk = measurements.walk.iter();
    let walk = walk.map(|walk| skew("Start skew of the walk".to_owned(), &walk.skews));
    let mut skews = measurements
        .moves
        .iter()
        .enumerate()
        .map(|(index, measured)| {
            let title = format!("Start skew of move {}: {}", index + 1, measured.title);
            skew(title, &measured.skews)
        });
    figures.extend(skews.by_ref().take(SHOWN));
    figures.extend(walk);
    let folded = (
        "The start skew of the other moves".to_owned(),
        skews.collect(),
    );
    Some(Section {
        title: "Moved together".to_owned(),
        text: format!(
            "{} axes are sent to {} places: each move is checked and staged by every node, then one \
             broadcast frame names the millisecond to start at. The curves are those of the first move.",
            performance.axes.len(),
            performance.axes.len()
        ),
        figures,
        folded: vec![folded],
    })
}

fn skew(title: String, skews: &[(AxisId, f64)]) -> Figure {
    let mut chart = Chart::new(
        title,
        Axis::new("axis", ""),
        Axis::new("late by", "\u{b5}s"),
    );
    let bars = skews
        .iter()
        .map(|(axis, late)| (f64::from(axis.get()), *late));
    chart.series.push(Series::bars("start", bars.collect()));
    Figure::chart(
        chart,
        "How much later than the first one each axis handed over its first setpoint, in true time.",
    )
}

fn seconds(tick: Tick, from: Tick) -> f64 {
    (tick.0 as f64 - from.0 as f64) / 1e3
}

/// One move, to draw.
struct Pictured<'a> {
    performance: &'a Performance,
    measured: &'a MoveMeasurement,
    /// The first and the last tick to show.
    ends: (Tick, Tick),
}

impl<'a> Pictured<'a> {
    fn new(performance: &'a Performance, measured: &'a MoveMeasurement) -> Self {
        let end = measured
            .start
            .after(Ticks((1e3 * measured.duration).round() as u32));
        Self {
            performance,
            measured,
            ends: (Tick(measured.start.0 - AROUND), Tick(end.0 + AROUND)),
        }
    }

    fn axes(&self) -> impl Iterator<Item = (usize, &'a [Sample])> {
        let (from, to) = self.ends;
        let samples = &self.performance.samples;
        let axes = self.performance.axes.iter().enumerate();
        axes.map(move |(index, axis)| (index, samples.between(*axis, from, to)))
    }

    fn chart(&self, title: &str, y: Axis) -> Chart {
        Chart::new(title, Axis::new("since the start", "s"), y)
    }

    /// A line for each axis, drawn with its group.
    fn lines(&self, chart: &mut Chart, value: Value) {
        for (index, samples) in self.axes() {
            let points = samples
                .iter()
                .map(|sample| (self.time(sample), value(sample)));
            let name = group(&self.performance.axes, index);
            chart.series.push(Series::line(name, points.collect()));
        }
    }

    fn time(&self, sample: &Sample) -> f64 {
        seconds(sample.setpoint.tick, self.measured.start)
    }

    /// How much of its way each axis has gone.
    fn progress(&self) -> Chart {
        let mut chart = self.chart(
            "Share of its way that each axis has gone",
            Axis::new("gone", "% of the way"),
        );
        for (_, samples) in self.axes() {
            let [first, last] = [samples.first(), samples.last()].map(|end| end.map(position));
            let (Some(from), Some(to)) = (first, last) else {
                continue;
            };
            if from == to {
                continue;
            }
            let share = |sample: &Sample| 100.0 * (position(sample) - from) / (to - from);
            let points = samples
                .iter()
                .map(|sample| (self.time(sample), share(sample)));
            chart.series.push(Series::line("axis", points.collect()));
        }
        chart
    }

    fn positions(&self) -> Chart {
        let mut chart = self.chart(
            "Positions: setpoints and measured",
            Axis::new("position", "rad"),
        );
        self.lines(&mut chart, position);
        for (_, samples) in self.axes() {
            let dots = samples.iter().step_by(DOTS);
            let dots = dots.map(|sample| (self.time(sample), sample.measured.radians()));
            chart.series.push(Series::dots("measured", dots.collect()));
        }
        chart
    }

    /// Velocities, or accelerations, with the limit that is the same for all axes.
    fn rates(&self, robot: &Robot, velocity: bool) -> Chart {
        let limits = self.performance.axes.iter().map(|axis| robot.limits(*axis));
        let (title, name, unit, value, limit): (_, _, _, Value, _) = if velocity {
            let limits = limits.map(|limits| limits.velocity().radians());
            let least = limits.fold(f64::INFINITY, f64::min);
            let value: Value = |sample| sample.setpoint.setpoint.velocity.radians();
            ("Velocities", "velocity", "rad/s", value, least)
        } else {
            let limits = limits.map(|limits| limits.slower_acceleration().radians());
            let least = limits.fold(f64::INFINITY, f64::min);
            let value: Value = |sample| sample.setpoint.setpoint.acceleration.radians();
            ("Accelerations", "acceleration", "rad/s\u{b2}", value, least)
        };
        let mut chart = self.chart(title, Axis::new(name, unit));
        self.lines(&mut chart, value);
        chart.add_limit("limit", limit);
        chart
    }

    fn following(&self) -> Chart {
        let mut chart = self.chart("Measured less setpoint", Axis::new("ahead by", "\u{b5}rad"));
        self.lines(&mut chart, |sample| 1e6 * sample.error());
        chart
    }
}

fn position(sample: &Sample) -> f64 {
    sample.setpoint.setpoint.position.radians()
}

/// The move that was stopped: velocities as parts of the limit.
fn stop(performance: &Performance, robot: &Robot) -> Chart {
    let (stop, rest) = performance.stopped;
    let from = Tick(stop.0.saturating_sub(400));
    let mut chart = Chart::new(
        "Stopped in mid-move",
        Axis::new("since the stop", "s"),
        Axis::new("speed", "% of the limit"),
    );
    for (index, axis) in performance.axes.iter().enumerate() {
        let samples = performance.samples.between(*axis, from, rest);
        let points = samples.iter().map(|sample| {
            let [velocity, _] = shares(sample, robot);
            (seconds(sample.setpoint.tick, stop), 100.0 * velocity)
        });
        let name = group(&performance.axes, index);
        chart.series.push(Series::line(name, points.collect()));
    }
    chart.series.push(Series::line(
        "the stop is on the bus",
        vec![(0.0, 0.0), (0.0, 100.0)],
    ));
    chart
}
