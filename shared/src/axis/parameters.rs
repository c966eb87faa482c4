//! What is set about an axis: read by anybody, written by the session that holds it.

use super::answer::Refusal;
use super::{Axis, Outcome};
use crate::parameter::Parameter;
use crate::wire::command::Item;
use crate::wire::reason::Reason;

impl Axis {
    pub(super) fn read_parameter(&mut self, _parameter: u8, _item: Item) -> Outcome {
        Outcome::Ignored
    }

    pub(super) fn write_parameter(&mut self, parameter: u8, raw: i64) -> Result<u32, Refusal> {
        let number = u32::from(parameter);
        let unknown = (Reason::UnknownParameter, number);
        let parameter = Parameter::try_from(parameter).map_err(|_| unknown)?;
        if self.is_moving() {
            return Err((Reason::Moving, 0));
        }
        let out_of_range = |_| (Reason::OutOfRange, number);
        let (values, mut settings) = self.values.with(parameter, raw).map_err(out_of_range)?;
        if parameter > Parameter::PositionMaximum {
            // The limits that the axis was made with are not among its values.
            let fastest = settings.limits.velocity();
            settings.limits = self.settings.limits;
            let own = settings.limits.velocity();
            settings.overspeed = settings.overspeed.map(|most| most - fastest + own);
        }
        self.values = values;
        self.settings = settings;
        Ok(0)
    }

    pub(super) fn save_parameters(&mut self) -> Result<u32, Refusal> {
        Err((Reason::BadValue, 0))
    }

    pub(super) fn restore_parameters(&mut self) -> Result<u32, Refusal> {
        Err((Reason::BadValue, 0))
    }
}
