//! What is asked of the demonstration, and whether it was kept.

use super::Measurements;

/// A knot every 10 ms for each of 12 axes, with all that goes beside it, leaves most of a bus of
/// 1 Mbit/s to others.
pub(super) const LOAD: f64 = 0.4;

/// Between knots an axis follows a cubic; in rad.
pub(super) const DEVIATION: f64 = 50e-6;

/// In us, with crystals of +-100 ppm and receivers that are late by up to 20 us.
const SKEW: f64 = 20.0;

/// What shafts may be off their setpoints, in rad: what a client grants an axis that has arrived.
const FOLLOWING: f64 = 1e-3;

/// What beta setpoints may be off their curve, in rad.
const DISTANCE: f64 = 2e-6;

/// A promise of the demonstration.
#[derive(Debug, Clone, PartialEq)]
pub struct Promise {
    /// What was measured.
    pub what: &'static str,
    /// How much.
    pub value: f64,
    /// What it is to be at most.
    pub most: f64,
    /// The unit of both.
    pub unit: &'static str,
    /// Digits behind the point when it is shown.
    pub digits: usize,
    /// More about it.
    pub note: &'static str,
}

impl Promise {
    /// A value of it with its unit.
    pub fn shown(&self, value: f64, digits: usize) -> String {
        let space = if self.unit.is_empty() { "" } else { " " };
        format!("{value:.digits$}{space}{}", self.unit)
    }

    /// What is asked, in words.
    pub fn asked(&self) -> String {
        format!("asked: at most {}; {}", self.shown(self.most, 0), self.note)
    }

    /// Whether it was kept.
    pub fn is_kept(&self) -> bool {
        self.value <= self.most
    }
}

/// What is asked, in the order of importance.
pub fn promises(measurements: &Measurements) -> Vec<Promise> {
    let promise = |what, value, most, unit, digits, note| Promise {
        what,
        value,
        most,
        unit,
        digits,
        note,
    };
    let moves = &measurements.moves;
    let mut promises = Vec::new();
    if let Some(walk) = &measurements.walk {
        promises.push(promise(
            "bus load in the trot",
            100.0 * walk.load,
            100.0 * LOAD,
            "%",
            1,
            "of 1 Mbit/s, with feedback of 12 axes",
        ));
        promises.push(promise(
            "trot: setpoints off their ideal curves",
            1e6 * walk.deviation,
            1e6 * DEVIATION,
            "\u{b5}rad",
            1,
            "any joint at any of its 1 kHz ticks",
        ));
    }
    let skews = moves.iter().map(|measured| measured.skew());
    let walk = measurements.walk.iter().map(|walk| walk.skew());
    promises.push(promise(
        "start skew, all axes",
        skews.chain(walk).fold(0.0, f64::max),
        SKEW,
        "\u{b5}s",
        1,
        "in true time, the worst start of all",
    ));
    let apart = moves.iter().filter(|measured| !measured.together).count();
    promises.push(promise(
        "moves whose axes arrive apart",
        apart as f64,
        0.0,
        "",
        0,
        "all axes rest in one and the same tick",
    ));
    let distances = moves.iter().filter_map(|measured| measured.distance);
    promises.push(promise(
        "moves: setpoints off the beta curve",
        1e6 * distances.fold(0.0, f64::max),
        1e6 * DISTANCE,
        "\u{b5}rad",
        4,
        "any axis at any tick",
    ));
    promises.push(promise(
        "peak velocity",
        100.0 * measurements.velocity,
        100.0,
        "%",
        2,
        "of the axis's limit, any setpoint",
    ));
    promises.push(promise(
        "peak acceleration",
        100.0 * measurements.acceleration,
        100.0,
        "%",
        2,
        "of the axis's limit, any setpoint",
    ));
    promises.push(promise(
        "setpoints outside the travel",
        measurements.outside as f64,
        0.0,
        "",
        0,
        "from position_min to position_max of each axis",
    ));
    promises.push(promise(
        "shafts off their setpoints",
        1e3 * measurements.following,
        1e3 * FOLLOWING,
        "mrad",
        2,
        "inertia, friction, encoder; any axis at any tick",
    ));
    promises
}
