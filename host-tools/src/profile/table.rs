//! At which times a curve is looked at, and what is seen.

use super::error::PlanError;
use canter_shared::motion::trajectory::{Sample, Trajectory};

/// Rows that a step may make at most.
pub const MOST_ROWS: usize = 10_000_000;

/// Without a step named, a move is cut into this many.
pub const USUAL_STEPS: f64 = 1_000.0;

/// One row: a time, and the motion there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Seconds, counted as the caller does.
    pub time: f64,
    /// What the curve does then.
    pub sample: Sample,
}

/// The head of the rows as CSV.
pub const HEADER: &str = "t,position,velocity,acceleration,jerk";

impl Row {
    /// The row as CSV; every number reads back exactly.
    pub fn csv(&self) -> String {
        let Sample {
            position,
            velocity,
            acceleration,
            jerk,
        } = self.sample;
        [self.time, position, velocity, acceleration, jerk]
            .map(number)
            .join(",")
    }
}

/// A number in the fewest digits that read back exactly.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        // Minus zero is nothing that anybody asked for.
        "0".to_owned()
    } else if (1e-5..1e16).contains(&size) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// The rows from the start, at `start` seconds, to the end by a step, of which the last may be
/// shorter: the last row is the end exactly. Without a step it is a thousandth of the duration.
///
/// # Errors
/// More than [`MOST_ROWS`].
pub fn steps<T: Trajectory>(
    trajectory: &T,
    start: f64,
    step: Option<f64>,
) -> Result<impl Iterator<Item = Row>, PlanError> {
    let duration = trajectory.duration();
    let step = step.unwrap_or(duration / USUAL_STEPS);
    // What rounding makes of a whole number of steps is that number.
    let count = if duration > 0.0 {
        (duration / step - 1e-9).ceil().max(1.0)
    } else {
        0.0
    };
    if count >= MOST_ROWS as f64 {
        return Err(PlanError::TooManyRows {
            step,
            duration,
            rows: count + 1.0,
            most: MOST_ROWS,
        });
    }
    // A step of 0.05 s is a twentieth of a second: dividing by 20 gives the times that people write.
    let each = (1.0 / step).round();
    let is_part = each >= 1.0 && (1.0 / each) == step;
    let inner = (0..count as usize).map(move |index| {
        let index = index as f64;
        if is_part { index / each } else { index * step }
    });
    Ok(inner.chain([duration]).map(move |elapsed| Row {
        time: start + elapsed,
        sample: trajectory.at(elapsed),
    }))
}

/// The row at a time, counted as the start is: before the start and after the end too.
pub fn at<T: Trajectory>(trajectory: &T, start: f64, time: f64) -> Row {
    let duration = trajectory.duration();
    // The end, as it is printed, is the end, whatever the difference rounds to.
    let elapsed = if time == start + duration {
        duration
    } else {
        time - start
    };
    Row {
        time,
        sample: trajectory.at(elapsed),
    }
}

/// A line of a list of times that is none: its number, from 1, and what it says.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: `{text}` is no time: write one finite number of seconds in each line")]
pub struct TimeError {
    /// Which line, from 1.
    pub line: usize,
    /// What it says.
    pub text: String,
}

/// Times, one in each line; lines with nothing in them are passed over.
///
/// # Errors
/// The first line that is no finite number.
pub fn parse_times(text: &str) -> Result<Vec<f64>, TimeError> {
    let lines = text.lines().map(str::trim).enumerate();
    lines
        .filter(|(_, line)| !line.is_empty())
        .map(|(index, line)| match line.parse::<f64>() {
            Ok(time) if time.is_finite() => Ok(time),
            _ => Err(TimeError {
                line: index + 1,
                text: line.to_owned(),
            }),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use canter_shared::motion::beta::exact::Profile;

    fn times(duration: f64, start: f64, step: Option<f64>) -> Vec<f64> {
        let profile = Profile::lasting(0.0, 1.0, duration).expect("a move");
        let rows = steps(&profile, start, step).expect("few rows");
        rows.map(|row| row.time).collect()
    }

    #[test]
    fn steps_end_with_the_end() {
        assert_eq!(times(1.0, 0.0, Some(0.25)), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(times(1.0, 2.0, Some(0.4)), [2.0, 2.4, 2.8, 3.0]);
        assert_eq!(times(0.2, 0.0, Some(0.05)), [0.0, 0.05, 0.1, 0.15, 0.2]);
        assert_eq!(times(1.0, 0.0, Some(9.0)), [0.0, 1.0]);
        // 0.3 / 0.1 is a little less than 3, and 0.7 / 0.1 a little more than 7.
        assert_eq!(times(0.3, 0.0, Some(0.1)).len(), 4);
        assert_eq!(times(0.7, 0.0, Some(0.1)).len(), 8);
        assert_eq!(times(3.0, 0.0, None).len(), 1_001);
        let profile = Profile::lasting(0.0, 1.0, 1.0).expect("a move");
        let many = steps(&profile, 0.0, Some(1e-8)).err().expect("too many");
        assert!(many.to_string().contains("--dt"), "{many}");
    }

    #[test]
    fn numbers_read_back() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.1, "0.1"),
            (-1e-5, "-0.00001"),
            (1e-6, "1e-6"),
            (1e16, "1e16"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
        ] {
            assert_eq!(number(value), text);
            assert_eq!(text.parse(), Ok(value));
        }
    }

    #[test]
    fn times_are_one_a_line() {
        assert_eq!(parse_times("1\n\n -2.5 \n1e3"), Ok(vec![1.0, -2.5, 1e3]));
        for (bad, line) in [("1\nx", 2), ("nan", 1), ("0\n\ninf", 3), ("1,2", 1)] {
            assert_eq!(parse_times(bad).expect_err(bad).line, line);
        }
    }
}
