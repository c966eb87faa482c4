//! The walk: the robot from the side, its feet, its joints.

use super::super::Walk;
use super::super::measure::shares;
use super::super::posture::{Posture, postures};
use super::super::promise::DEVIATION;
use super::super::{Performance, Sample, scene};
use crate::gait::{LEG_NAMES, LEGS};
use crate::leg::{Leg, LegError};
use crate::plot::report::{Figure, Picture, Section};
use crate::plot::{Axis, Chart, Series, Timeline};
use crate::robot::Robot;
use crate::walk::Phase;
use canter_shared::time::Tick;

/// Joints of a leg.
const JOINTS: usize = 3;

/// What the joints of a leg are called, in their order.
const fn joint_names(leg: &Leg) -> [&'static str; JOINTS] {
    match leg {
        Leg::FiveBar(_) => ["front motor", "rear motor", "abduction"],
        Leg::Serial(_) => ["thigh", "knee", "abduction"],
    }
}

/// From dot to dot, in ticks.
const DOTS: usize = 20;

/// What is the worst is shown for stretches of so many ticks.
const STRETCH: usize = 40;

/// Of the joints so many ticks are shown, from the middle of the walk.
const CLOSE: usize = 1_000;

/// The part of the page about the walk.
///
/// # Errors
/// Joint angles that the robot's legs cannot have.
pub fn section(performance: &Performance, walk: &Walk, robot: &Robot) -> Result<Section, LegError> {
    let postures = postures(performance, walk)?;
    let mut figures = vec![
        Figure {
            picture: Picture::Markup {
                title: "The robot from its right side, by its measured joint angles".to_owned(),
                html: scene::markup(walk, &postures),
            },
            note: "To scale: marks on the ground are 100 mm apart. The nearer legs are thick. \
                   A foot is filled while it is to be on the ground."
                .to_owned(),
            wide: true,
        },
        Figure::new(
            Picture::Timeline(feet_on_ground(&postures)),
            "Bars: the foot is on the ground. In a trot the diagonal pairs take turns.",
        ),
        Figure::chart(
            foot_paths(&postures),
            "One cycle of each foot, measured, as the body sees it: to the left are the rear feet.",
        ),
        Figure::chart(
            from_above(&postures),
            "By the measured angles of the legs that are on the ground. Half way it turns.",
        ),
        Figure::chart(
            deviations(performance, walk),
            "The worst of 12 joints, in 40 ticks. The nodes make 1 kHz setpoints of knots that are 10 ms apart; \
             inertia, friction and the encoder keep the shafts from them.",
        ),
        Figure::chart(
            limits(performance, walk, robot),
            "The axis that is nearest to its limit, in 40 ticks.",
        ),
    ];
    let joints = |leg: usize| {
        let charts = (0..JOINTS).map(move |joint| joint_chart(performance, walk, leg, joint));
        charts.map(|chart| {
            Figure::chart(
                chart,
                "Line: setpoints of 1 kHz. Dots: where the shaft really was.",
            )
        })
    };
    figures.extend(joints(0));
    let others = (1..LEGS).flat_map(joints).collect();
    Ok(Section {
        title: "Walked at a trot".to_owned(),
        text: "Up from its seat, a trot of 2.5 Hz at 0.5 m/s with a turn on the way, last steps, down \
               again. The host streams knots, 10 ms apart; each node makes its own setpoints of them."
            .to_owned(),
        figures,
        folded: vec![("The joints of the other legs".to_owned(), others)],
    })
}

fn time_axis() -> Axis {
    Axis::new("time of the walk", "s")
}

fn feet_on_ground(postures: &[Posture]) -> Timeline {
    let row = |leg: usize| {
        let mut spans: Vec<(f64, f64)> = Vec::new();
        let mut was_on = false;
        for posture in postures {
            match spans.last_mut() {
                Some(span) if posture.grounded[leg] && was_on => span.1 = posture.time,
                _ if posture.grounded[leg] => spans.push((posture.time, posture.time)),
                _ => {}
            }
            was_on = posture.grounded[leg];
        }
        (LEG_NAMES[leg].to_owned(), spans)
    };
    Timeline {
        title: "Which foot is on the ground".to_owned(),
        x: time_axis(),
        rows: (0..LEGS).map(row).collect(),
    }
}

/// The feet from a touch-down to the next one, before the turn.
fn foot_paths(postures: &[Posture]) -> Chart {
    let mut chart = Chart::new(
        "Paths of the feet",
        Axis::new("forward", "mm"),
        Axis::new("up", "mm"),
    );
    chart.to_scale = true;
    let comes_down = |leg: usize| {
        move |index: &usize| {
            let (before, now) = (&postures[index - 1], &postures[*index]);
            now.phase == Phase::Walking && now.grounded[leg] && !before.grounded[leg]
        }
    };
    for (leg, name) in LEG_NAMES.into_iter().enumerate() {
        let mut landings = (1..postures.len()).filter(comes_down(leg)).skip(3);
        if let (Some(from), Some(to)) = (landings.next(), landings.next()) {
            let cycle = postures[from..=to].iter();
            let points = cycle.map(|posture| {
                let [x, _, z] = posture.feet[leg];
                (1e3 * x, 1e3 * (z + posture.height))
            });
            chart.series.push(Series::line(name, points.collect()));
        }
    }
    chart
}

/// The body's way, and the places where feet came down.
fn from_above(postures: &[Posture]) -> Chart {
    let mut chart = Chart::new(
        "The way, seen from above",
        Axis::new("forward", "m"),
        Axis::new("to the left", "m"),
    );
    chart.to_scale = true;
    let body = postures
        .iter()
        .map(|posture| (posture.pose.x, posture.pose.y));
    chart
        .series
        .push(Series::line("the body's middle", body.collect()));
    let mut steps = Vec::new();
    let mut before = [false; LEGS];
    for posture in postures {
        for leg in (0..LEGS).filter(|leg| posture.grounded[*leg] && !before[*leg]) {
            let [x, y, _] = posture.feet[leg];
            let [x, y] = posture.pose.place([x, y]);
            steps.push((x, y));
        }
        before = posture.grounded;
    }
    chart
        .series
        .push(Series::dots("where feet came down", steps));
    chart
}

/// The largest of what a joint did and should have done, over all joints and some ticks.
fn worst_line(
    performance: &Performance,
    walk: &Walk,
    name: &str,
    value: &dyn Fn(&Sample, f64) -> f64,
) -> Series {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (leg, joint) in (0..LEGS).flat_map(|leg| (0..JOINTS).map(move |joint| (leg, joint))) {
        let pairs = walk.against_ideal(performance, leg, joint).enumerate();
        for (tick, (sample, ideal)) in pairs {
            let stretch = tick / STRETCH;
            if stretch == points.len() {
                points.push((tick as f64 / 1e3, 0.0));
            }
            let largest = &mut points[stretch].1;
            *largest = largest.max(value(sample, ideal));
        }
    }
    Series::line(name, points)
}

fn deviations(performance: &Performance, walk: &Walk) -> Chart {
    let title = "Off the curve, and off the setpoints";
    let mut chart = Chart::new(title, time_axis(), Axis::new("largest", "\u{b5}rad"));
    let setpoint = |sample: &Sample, ideal: f64| {
        1e6 * (sample.setpoint.setpoint.position.radians() - ideal).abs()
    };
    let shaft = |sample: &Sample, _| 1e6 * sample.error().abs();
    let mut add = |name, value: &dyn Fn(&Sample, f64) -> f64| {
        chart
            .series
            .push(worst_line(performance, walk, name, value));
    };
    add("setpoints off the gait's own curves", &setpoint);
    add("shafts off the setpoints", &shaft);
    chart.add_level("asked of the setpoints: at most this", 1e6 * DEVIATION);
    chart
}

fn limits(performance: &Performance, walk: &Walk, robot: &Robot) -> Chart {
    let title = "Velocity and acceleration in the walk";
    let mut chart = Chart::new(title, time_axis(), Axis::new("largest", "% of the limit"));
    for (index, name) in ["velocity", "acceleration"].into_iter().enumerate() {
        let share = |sample: &Sample, _| 100.0 * shares(sample, robot)[index];
        chart
            .series
            .push(worst_line(performance, walk, name, &share));
    }
    chart.add_level("limit", 100.0);
    chart
}

fn joint_chart(performance: &Performance, walk: &Walk, leg: usize, joint: usize) -> Chart {
    let (first, last) = walk.led();
    let middle = (first.0 + last.0) / 2;
    let close = CLOSE as u64;
    let (from, to) = (Tick(middle.saturating_sub(close)), Tick(middle));
    let mount = &walk.quadruped.mounts[leg];
    let axis = mount.leg.axes[joint];
    let samples = performance.samples.between(axis, from, to);
    let time = |sample: &Sample| (sample.setpoint.tick.0 as f64 - walk.start.0 as f64) / 1e3;
    let title = format!(
        "{}, {} (axis {axis})",
        LEG_NAMES[leg],
        joint_names(&mount.leg.kinematics)[joint]
    );
    let mut chart = Chart::new(title, time_axis(), Axis::new("position", "rad"));
    let line = samples.iter().map(|sample| {
        let setpoint = &sample.setpoint.setpoint;
        (time(sample), setpoint.position.radians())
    });
    chart.series.push(Series::line("setpoint", line.collect()));
    let dots = samples.iter().step_by(DOTS);
    let dots = dots.map(|sample| (time(sample), sample.measured.radians()));
    chart.series.push(Series::dots("measured", dots.collect()));
    chart
}
