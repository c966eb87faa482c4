//! Traces of nodes, and what must hold for every tick of them.

use std::collections::BTreeMap;
use std::path::Path;

use canter_shared::limits::Limits;
use canter_shared::motion::beta::exact;

/// One row: an axis at a tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Bus time in whole milliseconds.
    pub tick: u64,
    /// The state's name.
    pub state: String,
    /// In rad.
    pub position: f64,
    /// In rad/s.
    pub velocity: f64,
    /// In rad/s^2.
    pub acceleration: f64,
}

/// The rows of each axis, in order.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// By axis.
    pub axes: BTreeMap<u8, Vec<Row>>,
}

/// A stretch of motion of one axis: from the last row at rest to the first one at rest again.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<'a> {
    /// The rows, both ends included.
    pub rows: &'a [Row],
}

/// States without torque, or just before it: the setpoint follows the drive, not the drive it.
const TORQUE_OFF: [&str; 4] = [
    "not ready to switch on",
    "switch on disabled",
    "ready to switch on",
    "switched on",
];

/// A beta move fitted to a stretch: how well the curve through its ends describes it.
#[derive(Debug, Clone, Copy)]
pub struct Fit {
    /// When the move left, in microseconds of bus time, fitted with the duration held.
    pub start_us: f64,
    /// The last tick at rest that fits best.
    pub start: u64,
    /// The duration in ticks.
    pub duration: u64,
    /// The largest distance from the curve, in rad.
    pub error: f64,
}

impl Trace {
    /// Reads a trace; a line that is still being written is left out.
    ///
    /// # Panics
    /// When the file or a whole line of it is not as it should be.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("the trace can be read");
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        let header = lines.next();
        assert_eq!(header, Some("t,axis,state,position,velocity,acceleration"));
        let mut trace = Self::default();
        for line in lines {
            let cells: Vec<&str> = line.split(',').collect();
            let [t, axis, state, position, velocity, acceleration] = cells[..] else {
                panic!("not six cells: {line}");
            };
            let number = |cell: &str| cell.parse::<f64>().expect("a number");
            let row = Row {
                tick: (number(t) * 1e3).round() as u64,
                state: state.to_owned(),
                position: number(position),
                velocity: number(velocity),
                acceleration: number(acceleration),
            };
            let axis = axis.parse().expect("an axis");
            trace.axes.entry(axis).or_default().push(row);
        }
        trace
    }

    /// The rows of an axis.
    ///
    /// # Panics
    /// When there is none.
    #[track_caller]
    pub fn axis(&self, axis: u8) -> &[Row] {
        self.axes.get(&axis).expect("the trace has this axis")
    }

    /// Whether any axis has moved.
    pub fn moved(&self) -> bool {
        self.axes.values().any(|rows| {
            rows.windows(2)
                .any(|pair| pair[0].position != pair[1].position)
        })
    }

    /// Holds every tick of every axis to the promise: inside the limits, without a jump of
    /// position, velocity or acceleration (which may change by `jerk` rad/s^3).
    ///
    /// # Panics
    /// At the first tick that breaks it.
    #[track_caller]
    pub fn keeps(&self, limits: &Limits, jerk: f64) {
        let velocity = limits.velocity().radians();
        let acceleration = limits.slower_acceleration().radians();
        for (axis, rows) in &self.axes {
            for row in rows {
                assert!(
                    row.velocity.abs() <= velocity * (1.0 + 1e-9),
                    "axis {axis}: {row:?}"
                );
                assert!(
                    row.acceleration.abs() <= acceleration * (1.0 + 1e-9),
                    "axis {axis}: {row:?}"
                );
            }
            for pair in rows.windows(2) {
                let [before, now] = pair else { continue };
                // The clock may be set while the axis is at rest, and only then; a move may begin with
                // the first tick after that.
                let rested = before.velocity == 0.0;
                let moving = !rested || now.velocity != 0.0;
                assert!(
                    rested || now.tick == before.tick + 1,
                    "axis {axis}: {pair:?}"
                );
                let seconds = 1e-3;
                let moved = now.position - before.position;
                let mean = (now.velocity + before.velocity) / 2.0;
                // The trapezium rule's error is jerk * T^3 / 12.
                let slack = 1e-8 + jerk * 1e-9 / 12.0;
                if moving {
                    assert!(
                        (moved - mean * seconds).abs() <= slack,
                        "axis {axis}: {pair:?}"
                    );
                } else if !TORQUE_OFF.contains(&now.state.as_str()) {
                    assert!(moved == 0.0, "axis {axis}: {pair:?}");
                }
                let change = now.velocity - before.velocity;
                let mean = (now.acceleration + before.acceleration) / 2.0;
                let slack = 1e-6 + jerk * 1e-6 / 2.0;
                assert!(
                    !moving || (change - mean * seconds).abs() <= slack,
                    "axis {axis}: {pair:?}"
                );
                let change = (now.acceleration - before.acceleration).abs();
                assert!(change <= jerk * 1e-3 + 1e-3, "axis {axis}: {pair:?}");
            }
        }
    }

    /// The stretches of motion of an axis, in order.
    pub fn stretches(&self, axis: u8) -> Vec<Stretch<'_>> {
        let rows = self.axis(axis);
        let changes = |index: usize| rows[index].position != rows[index - 1].position;
        let mut stretches = Vec::new();
        let mut index = 1;
        while index < rows.len() {
            if !changes(index) {
                index += 1;
                continue;
            }
            let first = index - 1;
            let mut last = index;
            // Near its ends a curve may stay on one count for some ticks.
            while (last + 1..rows.len().min(last + 10)).any(changes) {
                last += 1;
            }
            stretches.push(Stretch {
                rows: &rows[first..=last],
            });
            index = last + 1;
        }
        stretches
    }
}

impl Stretch<'_> {
    /// Where it begins and where it ends, in rad.
    pub fn ends(&self) -> (f64, f64) {
        match self.rows {
            [first, .., last] => (first.position, last.position),
            _ => (0.0, 0.0),
        }
    }

    /// Fits a beta move of `duration` ticks.
    ///
    /// The first and last steps of a curve are below a count, so the stretch may be some ticks
    /// shorter than the move.
    ///
    /// # Panics
    /// When the stretch has no motion.
    pub fn fit(&self, duration: u64) -> Fit {
        let (from, to) = self.ends();
        let [first, .., last] = self.rows else {
            panic!("no motion");
        };
        let earliest = last.tick.saturating_sub(duration);
        let range = to - from;
        let offset =
            |row: &Row, start: f64| 2.0 * (row.tick as f64 - start) / duration as f64 - 1.0;
        let error = |start: u64| {
            self.rows
                .iter()
                .map(|row| {
                    let unit = exact::shape(offset(row, start as f64)).value;
                    (row.position - from - range * unit).abs()
                })
                .fold(0.0, f64::max)
        };
        let start = (earliest.min(first.tick)..=first.tick)
            .min_by(|a, b| error(*a).total_cmp(&error(*b)))
            .expect("at least one candidate");
        // One Newton step of least squares in the start time: p = F(t - s), dp/ds = -F'.
        let (mut slopes, mut products) = (0.0, 0.0);
        for row in self.rows {
            let unit = exact::shape(offset(row, start as f64));
            let slope = -range * unit.first * 2.0 / duration as f64;
            slopes += slope * slope;
            products += slope * (row.position - from - range * unit.value);
        }
        Fit {
            start_us: (start as f64 + products / slopes) * 1e3,
            start,
            duration,
            error: error(start),
        }
    }
}
