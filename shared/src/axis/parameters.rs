//! What is set about an axis: read by anybody, written by the session that holds it, saved by the
//! owner of its node.
//!
//! Rare, all of it, so it is kept out of the way of the commands that are not: nothing is inlined.

use super::answer::{Refusal, acknowledgement};
use super::fault::Fault;
use super::{Axis, Outcome, Reply};
use crate::motion::shaping::ShapingError;
use crate::parameter::{Change, Parameter, Settings, Values};
use crate::wire::command::Item;
use crate::wire::id::{AxisId, Function};
use crate::wire::reason::Reason;
use crate::wire::report::Report;

/// A save that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Saving {
    sequence: u8,
    /// Whether the owner is at it.
    begun: bool,
}

impl Axis {
    /// The parameters as they are set now.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Says that what was saved about the axis could not be read: it has its defaults, and must not
    /// move with them as if nothing had happened.
    pub fn lose_parameters(&mut self) {
        self.raise(Fault::ParametersLost);
    }

    /// Anybody may ask, so no session and no number are looked at.
    #[inline(never)]
    pub(super) fn read_parameter(&mut self, number: u8, item: Item) -> Outcome {
        let Ok(parameter) = Parameter::try_from(number) else {
            let refusal = Err((Reason::UnknownParameter, number.into()));
            let answer = acknowledgement(Function::ParameterRead, 0, refusal);
            self.telemetry.answer_reading(answer);
            return Outcome::Rejected(Reason::UnknownParameter);
        };
        let (minimum, maximum) = parameter.range();
        let value = match item {
            Item::Value => self.values.get(parameter),
            Item::Saved => self.saved.get(parameter),
            Item::Minimum => minimum,
            Item::Maximum => maximum,
            Item::Default => parameter.default_raw(self.id.get()),
        };
        self.telemetry.answer_reading(Report::Parameter {
            parameter: number,
            item,
            value,
        });
        Outcome::Accepted
    }

    #[inline(never)]
    pub(super) fn write_parameter(&mut self, number: u8, raw: i64) -> Result<u32, Refusal> {
        let parameter = Parameter::try_from(number)
            .map_err(|_| (Reason::UnknownParameter, u32::from(number)))?;
        if !self.commander.configures() {
            return Err((Reason::Locked, 0));
        }
        if parameter.change() == Change::Disabled {
            self.disabled_now()?;
        }
        // First, because it is quick and the numbers are not.
        self.at_rest_now()?;
        let (values, settings) = self
            .values
            .with_settings(&self.settings, parameter, raw)
            .map_err(|_| (Reason::OutOfRange, number.into()))?;
        // What stands is the one thing that a shaper asks for.
        self.take_values(&values, settings)
            .map_err(|_| (Reason::Moving, 0))?;
        Ok(0)
    }

    #[inline(never)]
    pub(super) fn restore_parameters(&mut self) -> Result<(), Refusal> {
        self.disabled_now()?;
        self.at_rest_now()?;
        let values = Values::defaults(self.id.get());
        self.take_values(&values, values.settings())
            .map_err(|_| (Reason::Moving, 0))
    }

    /// That the axis stands and nothing is about to move it.
    fn at_rest_now(&self) -> Result<(), Refusal> {
        if self.is_moving() {
            return Err((Reason::Moving, 0));
        }
        Ok(())
    }

    /// Takes other values on, at rest. The axis may stand outside of its new travel, as one may that
    /// is enabled there: it can only be moved inside.
    pub(super) fn take_values(
        &mut self,
        values: &Values,
        settings: Settings,
    ) -> Result<(), ShapingError> {
        if settings.shaping != self.settings.shaping {
            // It did not follow what it did not shape.
            self.shaper.reset(self.setpoint.position);
            self.shaper.change(settings.shaping.as_ref())?;
        }
        self.values = *values;
        self.settings = settings;
        Ok(())
    }

    /// That the drive holds no torque.
    fn disabled_now(&self) -> Result<(), Refusal> {
        if self.state.drives() {
            return Err((Reason::NotDisabled, u8::from(self.state).into()));
        }
        Ok(())
    }

    /// Asks the owner to save. The answer comes when that is done; of two the newer counts.
    #[inline(never)]
    pub(super) fn want_save(&mut self, sequence: u8) -> Result<(), Refusal> {
        self.disabled_now()?;
        self.refuse_save((Reason::Overtaken, sequence.into()));
        self.saving = Some(Saving {
            sequence,
            begun: false,
        });
        Ok(())
    }

    /// Whether a save was asked for that nobody is at yet. The owner of a lone axis saves its
    /// [`Self::values`]; for axes of a node it is the node that hands them out.
    pub fn wants_save(&self) -> bool {
        self.saving.is_some_and(|saving| !saving.begun)
    }

    /// The owner begins to save.
    pub fn begin_save(&mut self) {
        if let Some(saving) = &mut self.saving {
            saving.begun = true;
        }
    }

    /// What came of a save: with `kept` these are the values that are saved now.
    pub fn end_save(&mut self, kept: Option<&Values>) {
        if let Some(values) = kept {
            self.saved = *values;
        }
        if self.saving.is_some_and(|saving| saving.begun) {
            self.answer_save(kept.map(|_| 0).ok_or((Reason::SaveFailed, 0)));
        }
    }

    /// A save that was asked for is not going to be.
    pub(crate) fn refuse_save(&mut self, why: Refusal) {
        self.answer_save(Err(why));
    }

    #[inline(never)]
    fn answer_save(&mut self, answer: Result<u32, Refusal>) {
        let Some(Saving { sequence, .. }) = self.saving.take() else {
            return;
        };
        let function = Function::Control;
        if let Some((_, reply)) = &mut self.last_command
            && matches!(*reply, Reply::Saves(awaited) if awaited == sequence)
        {
            *reply = Reply::Given(acknowledgement(function, sequence, answer));
        }
        let _: Outcome = self.answer(function, sequence, answer);
    }

    /// Has another id from now on. Nobody holds the axis, so nobody is left behind with the old id.
    #[inline(never)]
    pub(crate) fn assign(&mut self, id: AxisId) -> Result<(), Refusal> {
        self.disabled_now()?;
        if let Some(holder) = self.session() {
            return Err((Reason::HeldByOther, holder.into()));
        }
        self.id = id;
        // What was answered to the old id is nobody's business under the new one.
        self.last_command = None;
        self.last_trigger = None;
        self.telemetry.rename(id.get());
        Ok(())
    }
}
