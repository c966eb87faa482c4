//! The demonstration's report.

use super::measure::grid;
use super::{Measurements, Performance};
use crate::plot::report::Report;
use crate::plot::{Axis, Chart, Series};
use crate::robot::Robot;
use canter_shared::motion::Setpoint;
use canter_shared::wire::id::AxisId;
use std::collections::BTreeMap;

/// The page that shows a performance.
pub fn page(performance: &Performance, measurements: &Measurements, robot: &Robot) -> Report {
    let mut report = Report {
        title: String::from("canter: demonstration"),
        lead: format!(
            "{} simulated axes on one CAN bus of 1 Mbit/s, each a node of its own with a crystal \
             of its own: scanned, enabled, moved together, stopped in mid-move, disabled.",
            performance.axes.len()
        ),
        ..Report::default()
    };
    for row in rows(measurements) {
        report.add(row.0, row.1, row.2);
    }
    report.charts = charts(performance, robot);
    for (number, measured) in measurements.moves.iter().enumerate() {
        let title = format!("Start skew of move {}: {}", number + 1, measured.title);
        let mut chart = Chart::new(title, Axis::new("axis", ""), Axis::new("late by", "us"));
        let bars = measured.skews.iter();
        let bars = bars
            .map(|(axis, late)| (f64::from(axis.get()), *late))
            .collect();
        chart.series.push(Series::bars("start", bars));
        report.charts.push(chart);
    }
    report
}

/// What was measured, in words: what, how much, and what to compare it with.
pub fn rows(measurements: &Measurements) -> Vec<(String, String, String)> {
    let mut rows = Vec::new();
    let mut row = |what: String, value: String, note: &str| {
        rows.push((what, value, note.to_owned()));
    };
    for measured in &measurements.moves {
        let title = measured.title;
        row(
            format!("{title}: duration"),
            format!("{:.3} s", measured.duration),
            if measured.together {
                "all axes arrive in one tick"
            } else {
                "the axes do not arrive in one tick"
            },
        );
        row(
            format!("{title}: start skew"),
            format!("{:.1} us", measured.skew()),
            "true time, over all axes",
        );
        if let Some(distance) = measured.distance {
            row(
                format!("{title}: distance from the curve"),
                format!("{distance:.1e} rad"),
                "at most 2e-6 rad at any tick",
            );
        }
    }
    row(
        String::from("peak velocity"),
        format!("{:.2} % of the limit", 100.0 * measurements.velocity),
        "never above 100 %",
    );
    row(
        String::from("peak acceleration"),
        format!("{:.2} % of the limit", 100.0 * measurements.acceleration),
        "never above 100 %",
    );
    row(
        String::from("stop in mid-move: time to rest"),
        format!("{:.3} s", measurements.stopping),
        "inside the limits, jerk too",
    );
    row(
        String::from("bus load"),
        format!("{:.1} %", 100.0 * measurements.load),
        "feedback, heartbeats, SYNC and commands",
    );
    row(
        String::from("frames, setpoints"),
        format!("{}, {}", measurements.frames, measurements.setpoints),
        "",
    );
    rows
}

type Quantity = fn(&Setpoint) -> f64;

fn charts(performance: &Performance, robot: &Robot) -> Vec<Chart> {
    let grid = grid(&performance.record);
    let quantities: [(&str, &str, &str, Quantity); 3] = [
        ("Position", "position", "rad", |now| now.position.radians()),
        ("Velocity", "velocity", "rad/s", |now| {
            now.velocity.radians()
        }),
        ("Acceleration", "acceleration", "rad/s²", |now| {
            now.acceleration.radians()
        }),
    ];
    let limits = performance.axes.first().map(|axis| robot.limits(*axis));
    quantities
        .into_iter()
        .map(|(title, name, unit, value)| {
            let mut lines: BTreeMap<AxisId, Vec<(f64, f64)>> = BTreeMap::new();
            for ((tick, axis), (_, setpoint)) in &grid {
                let point = (tick.0 as f64 / 1e3, value(&setpoint.setpoint));
                lines.entry(*axis).or_default().push(point);
            }
            let mut chart = Chart::new(title, Axis::new("bus time", "s"), Axis::new(name, unit));
            for (axis, points) in lines {
                chart
                    .series
                    .push(Series::line(format!("axis {axis}"), points));
            }
            // All axes of the default robot have the same limits; the first one's stand for them.
            if let Some(limits) = limits {
                let limit = match name {
                    "velocity" => Some(limits.velocity().radians()),
                    "acceleration" => Some(limits.slower_acceleration().radians()),
                    _ => None,
                };
                if let Some(limit) = limit {
                    chart.add_limit("limit", limit);
                    chart.add_limit("limit", -limit);
                }
            }
            chart
        })
        .collect()
}
