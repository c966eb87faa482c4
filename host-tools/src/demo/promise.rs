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
        let space = if self.unit.is_empty() { "" } else { "\u{a0}" };
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
            "any joint at any of its ticks, 1000 in a second",
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

#[cfg(test)]
mod tests {
    use super::super::{MoveMeasurement, WalkMeasurement};
    use super::*;
    use canter_shared::time::Tick;
    use canter_shared::wire::id::AxisId;

    fn good() -> Measurements {
        let axis = AxisId::new(1).expect("in range");
        Measurements {
            moves: vec![MoveMeasurement {
                title: "a move",
                start: Tick(0),
                duration: 1.0,
                skews: vec![(axis, 5.0)],
                distance: Some(1e-9),
                together: true,
            }],
            walk: Some(WalkMeasurement {
                duration: 8.0,
                walking: 5.0,
                distance: 2.0,
                turned: 0.5,
                load: 0.25,
                peak_load: 0.3,
                deviation: 3e-5,
                following: 5e-5,
                shares: [0.3, 0.9],
                skews: vec![(axis, 4.0)],
                missing: 0,
            }),
            velocity: 1.0,
            acceleration: 1.0,
            outside: 0,
            following: 1e-4,
            stopping: 0.1,
            load: 0.2,
            frames: 10,
            setpoints: 10,
        }
    }

    /// A thing that goes wrong, and the promise that it breaks.
    type Harm = (&'static str, fn(&mut Measurements, &mut WalkMeasurement));

    #[test]
    fn each_promise_can_be_broken_alone() {
        let harms: [Harm; 10] = [
            ("bus load in the trot", |_, walk| walk.load = 0.401),
            ("trot: setpoints off their ideal curves", |_, walk| {
                walk.deviation = 50.1e-6;
            }),
            ("start skew, all axes", |all, _| {
                all.moves[0].skews[0].1 = 20.1
            }),
            ("start skew, all axes", |_, walk| {
                walk.skews[0].1 = f64::INFINITY
            }),
            ("moves whose axes arrive apart", |all, _| {
                all.moves[0].together = false;
            }),
            ("moves: setpoints off the beta curve", |all, _| {
                all.moves[0].distance = Some(2.1e-6);
            }),
            ("peak velocity", |all, _| all.velocity = 1.0 + 1e-12),
            ("peak acceleration", |all, _| all.acceleration = f64::NAN),
            ("setpoints outside the travel", |all, _| all.outside = 1),
            ("shafts off their setpoints", |all, _| {
                all.following = 1.1e-3
            }),
        ];
        assert!(promises(&good()).iter().all(Promise::is_kept));
        for (what, harm) in harms {
            let mut measured = good();
            let mut walk = measured.walk.take().expect("it walked");
            harm(&mut measured, &mut walk);
            measured.walk = Some(walk);
            let promises = promises(&measured);
            let broken = promises.iter().filter(|promise| !promise.is_kept());
            let broken: Vec<&str> = broken.map(|promise| promise.what).collect();
            assert_eq!(broken, [what]);
        }
    }
}
