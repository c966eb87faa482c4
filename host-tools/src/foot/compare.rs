//! The presets side by side.

use super::cycle::{Cycle, CycleRequest, Phase};
use super::error::FootError;
use super::preset::Preset;
use crate::leg::FootMotion;
use crate::plot::{Axis, Chart, PlotError, Series, stack};

/// How many places of each phase are looked at for the peaks.
const PLACES: u32 = 4_000;
/// How many points of each phase a picture has.
const POINTS: u32 = 400;

/// One preset.
#[derive(Debug, Clone)]
pub struct Row {
    /// The cycle.
    pub cycle: Cycle,
    /// The largest speed as seen from the hip, in m/s.
    pub peak_velocity: f64,
    /// The largest acceleration within the phases, in m/s^2; a jump of velocity has none.
    pub peak_acceleration: f64,
    /// How far above the ground the swing comes, in m.
    pub clearance: f64,
    /// How fast the foot goes over the ground at touch-down or lift-off, the faster of both, in m/s.
    pub ground_speed: f64,
    /// The larger jump of velocity between the phases, in m/s.
    pub velocity_jump: f64,
    /// The larger jump of acceleration between the phases, in m/s^2.
    pub acceleration_jump: f64,
}

/// Every preset for one request, in the order of [`Preset::ALL`].
///
/// Peaks and clearance are those at 4001 places of each phase.
///
/// # Errors
/// Those of [`Cycle::new`].
pub fn compare(request: &CycleRequest) -> Result<Vec<Row>, FootError> {
    let rows = Preset::ALL.into_iter();
    rows.map(|preset| row(Cycle::new(preset, request)?, request))
        .collect()
}

fn row(cycle: Cycle, request: &CycleRequest) -> Result<Row, FootError> {
    let size = |vector: [f64; 3]| vector[0].hypot(vector[1]).hypot(vector[2]);
    let difference =
        |one: [f64; 3], other: [f64; 3]| size([0, 1, 2].map(|index| one[index] - other[index]));
    let mut row = Row {
        cycle,
        peak_velocity: 0.0,
        peak_acceleration: 0.0,
        clearance: 0.0,
        ground_speed: 0.0,
        velocity_jump: 0.0,
        acceleration_jump: 0.0,
    };
    for phase in [Phase::Stance, Phase::Swing] {
        for (_, motion) in places(&row.cycle, phase, PLACES) {
            row.peak_velocity = row.peak_velocity.max(size(motion.velocity));
            row.peak_acceleration = row.peak_acceleration.max(size(motion.acceleration));
            if phase == Phase::Swing {
                row.clearance = row.clearance.max(motion.position[2] + request.height);
            }
        }
    }
    let start = |phase| row.cycle.during(phase, 0.0);
    let end = |phase| row.cycle.during(phase, row.cycle.duration(phase));
    let ground = [-request.speed, 0.0, 0.0];
    let (lift_off, touch_down) = (start(Phase::Swing), end(Phase::Swing));
    row.ground_speed =
        difference(lift_off.velocity, ground).max(difference(touch_down.velocity, ground));
    let seams = [
        (end(Phase::Stance), lift_off),
        (touch_down, start(Phase::Stance)),
    ];
    let over = |value: fn(&FootMotion) -> [f64; 3]| {
        let jumps = seams
            .iter()
            .map(|(one, other)| difference(value(one), value(other)));
        jumps.fold(0.0, f64::max)
    };
    let velocity_jump = over(|motion| motion.velocity);
    let acceleration_jump = over(|motion| motion.acceleration);
    row.velocity_jump = without_rounding(velocity_jump, row.peak_velocity);
    row.acceleration_jump = without_rounding(acceleration_jump, row.peak_acceleration);
    row.ground_speed = without_rounding(row.ground_speed, row.peak_velocity);
    Ok(row)
}

/// A difference that is nothing but rounding of numbers of this size is none.
fn without_rounding(difference: f64, size: f64) -> f64 {
    if difference <= 1e-12 * size {
        0.0
    } else {
        difference
    }
}

/// Evenly over one phase, with its ends: times from the start of the cycle, in s.
fn places(cycle: &Cycle, phase: Phase, count: u32) -> impl Iterator<Item = (f64, FootMotion)> + '_ {
    let duration = cycle.duration(phase);
    let start = match phase {
        Phase::Stance => 0.0,
        Phase::Swing => cycle.duration(Phase::Stance),
    };
    (0..=count).map(move |at| {
        let elapsed = duration * f64::from(at) / f64::from(count);
        (start + elapsed, cycle.during(phase, elapsed))
    })
}

/// The cycles as SVG: the way of the foot, and x, z, their velocities and accelerations over time.
///
/// # Errors
/// A number that has no place in a picture.
pub fn picture<'a>(cycles: impl IntoIterator<Item = &'a Cycle>) -> Result<String, PlotError> {
    type View = fn(f64, &FootMotion) -> (f64, f64);
    let time = || Axis::new("time", "s");
    let mut charts = Vec::new();
    let mut views: Vec<View> = Vec::new();
    let mut add = |title: &str, x: Axis, y: Axis, view: View| {
        charts.push(Chart::new(format!("foot: {title}"), x, y));
        views.push(view);
    };
    add(
        "the way, as seen from the hip",
        Axis::new("x", "m"),
        Axis::new("z", "m"),
        |_, motion| (motion.position[0], motion.position[2]),
    );
    add(
        "velocity in x",
        time(),
        Axis::new("velocity", "m/s"),
        |t, motion| (t, motion.velocity[0]),
    );
    add(
        "velocity in z",
        time(),
        Axis::new("velocity", "m/s"),
        |t, motion| (t, motion.velocity[2]),
    );
    add(
        "acceleration in x",
        time(),
        Axis::new("acceleration", "m/s²"),
        |t, motion| (t, motion.acceleration[0]),
    );
    add(
        "acceleration in z",
        time(),
        Axis::new("acceleration", "m/s²"),
        |t, motion| (t, motion.acceleration[2]),
    );
    for cycle in cycles {
        let phases = [Phase::Stance, Phase::Swing].into_iter();
        let drawn: Vec<(f64, FootMotion)> = phases
            .flat_map(|phase| places(cycle, phase, POINTS))
            .collect();
        for (chart, view) in charts.iter_mut().zip(&views) {
            let points = drawn.iter().map(|(time, motion)| view(*time, motion));
            chart
                .series
                .push(Series::line(cycle.preset().name(), points.collect()));
        }
    }
    stack(&charts)
}
