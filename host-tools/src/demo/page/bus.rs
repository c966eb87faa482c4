//! What the bus carried.

use super::super::Performance;
use super::super::measure::{Kind, Window, windows};
use super::super::promise::LOAD;
use crate::plot::report::{Figure, Section};
use crate::plot::{Axis, Chart, Series};
use canter_shared::time::BusTime;

/// How long a part of the chart is, in us.
const PART: u64 = 50_000;

/// The part of the page about the bus.
pub fn section(performance: &Performance) -> Section {
    let end = performance
        .frames
        .last()
        .map_or(BusTime(0), |last| last.end.bus_time());
    let over_all = chart(performance, "Bus load over everything", BusTime(0), end);
    let mut figures = vec![Figure::chart(
        over_all,
        "The scan, three moves and what is between them; the plateau is the walk; then the stop.",
    )];
    if let Some(walk) = &performance.walk {
        let (first, last) = walk.led();
        let walking = chart(
            performance,
            "Bus load in the trot",
            first.time(),
            last.time(),
        );
        figures.push(Figure::chart(
            walking,
            "For each axis a knot every 10 ms and its feedback every 20 ms.",
        ));
    }
    Section {
        title: "The bus".to_owned(),
        text: format!(
            "Bits as they are on the wire, stuff bits and the space between frames counted: {} frames, \
             each of at most 8 bytes, in parts of {} ms.",
            performance.frames.len(),
            PART / 1_000
        ),
        figures,
        ..Section::default()
    }
}

fn chart(performance: &Performance, title: &str, from: BusTime, to: BusTime) -> Chart {
    let parts = to.0.saturating_sub(from.0) / PART;
    let windows = windows(&performance.frames, from, to, parts as usize);
    let mut chart = Chart::new(
        title,
        Axis::new("bus time", "s"),
        Axis::new("bus load", "%"),
    );
    let mut add = |name: &str, share: &dyn Fn(&Window) -> f64| {
        let points = windows
            .iter()
            .map(|window| (window.middle, 100.0 * share(window)));
        chart.series.push(Series::line(name, points.collect()));
    };
    add("all", &Window::share);
    for kind in Kind::ALL {
        add(kind.name(), &|window| window.shares[kind as usize]);
    }
    let value = 100.0 * LOAD;
    chart.add_level("asked for in the trot: at most this", value);
    chart
}
