//! Setpoints as CSV, for everybody's own plots.

use std::fmt;
use std::io::{self, Write};

use canter_shared::motion::Setpoint;
use canter_shared::node::AxisSetpoint;
use canter_shared::time::{TICKS_PER_SECOND, Tick};

/// A tick as seconds of bus time, to the millisecond.
pub(crate) struct Seconds(pub Tick);

impl fmt::Display for Seconds {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, rest) = (self.0.0 / TICKS_PER_SECOND, self.0.0 % TICKS_PER_SECOND);
        write!(formatter, "{seconds}.{rest:03}")
    }
}

/// A setpoint as `position,velocity,acceleration` in rad and its rates.
pub(crate) struct Rates(pub Setpoint);

impl fmt::Display for Rates {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let position = self.0.position.radians();
        let velocity = self.0.velocity.radians();
        let acceleration = self.0.acceleration.radians();
        write!(formatter, "{position},{velocity},{acceleration}")
    }
}

/// Writes `t,axis,position,velocity,acceleration`: s of bus time, rad, rad/s, rad/s^2.
///
/// Numbers have all the digits that they need to be read back exactly.
#[derive(Debug)]
pub struct SetpointsCsv<W> {
    out: W,
}

impl<W: Write> SetpointsCsv<W> {
    /// Begins with the header. Rows are many and short: hand over a [`std::io::BufWriter`].
    ///
    /// # Errors
    /// What `out` says.
    pub fn new(mut out: W) -> io::Result<Self> {
        writeln!(out, "t,axis,position,velocity,acceleration")?;
        Ok(Self { out })
    }

    /// Adds one row.
    ///
    /// # Errors
    /// What the file says.
    pub fn write(&mut self, row: &AxisSetpoint) -> io::Result<()> {
        writeln!(
            self.out,
            "{},{},{}",
            Seconds(row.tick),
            row.axis,
            Rates(row.setpoint)
        )
    }

    /// Ends the file and gives it back.
    ///
    /// # Errors
    /// What the file says to the rows that it had not taken yet.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use canter_shared::axis::state::State;
    use canter_shared::units::{Acceleration, Position, Velocity};
    use canter_shared::wire::id::AxisId;

    #[test]
    fn rows_are_read_back_exactly() {
        let row = AxisSetpoint {
            axis: AxisId::new(12).expect("in range"),
            tick: Tick(61_007),
            state: State::OperationEnabled,
            setpoint: Setpoint {
                position: Position::from_counts(1),
                velocity: Velocity::from_counts(-(1 << 40) + 12_345),
                acceleration: Acceleration::from_counts(0),
            },
        };
        let mut csv = SetpointsCsv::new(Vec::new()).expect("a vector takes everything");
        csv.write(&row).expect("a vector takes everything");
        let bytes = csv.finish().expect("a vector takes everything");
        let text = String::from_utf8(bytes).expect("ASCII");
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("t,axis,position,velocity,acceleration"));
        let fields: Vec<&str> = lines.next().expect("one row").split(',').collect();
        assert_eq!(fields[..2], ["61.007", "12"]);
        let numbers: Vec<f64> = fields[2..]
            .iter()
            .map(|field| field.parse().expect("a number"))
            .collect();
        let Setpoint {
            position,
            velocity,
            acceleration,
        } = row.setpoint;
        assert_eq!(
            numbers,
            [
                position.radians(),
                velocity.radians(),
                acceleration.radians()
            ]
        );
        assert_eq!(lines.next(), None);
    }
}
