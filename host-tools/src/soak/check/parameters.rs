//! What an axis is set to: as its holder wrote it, and after a loss of power as it was saved.

use canter_shared::axis::fault::Fault;
use canter_shared::limits::Limits;
use canter_shared::parameter::{Parameter, Values};
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Report;

use super::{Finding, Glance, Verdict};
use crate::soak::invariant::Invariant;

/// The eye on the parameters of an axis. What was saved outlives its node.
#[derive(Debug)]
pub(super) struct Parameters {
    /// The values that hold.
    values: Values,
    /// What was asked for since the last tick.
    written: Vec<(Parameter, i64)>,
    restored: bool,
    /// Whether its holder has ever said that it changes parameters, since it has its power.
    configured: bool,
    /// What the axis has as long as nothing is saved.
    factory: Values,
    /// Whether something is saved for certain, and whether a first save may be torn.
    is_saved: bool,
    is_torn: bool,
    /// What the node's flash may hold: what was saved last, and what may have been saved since.
    kept: Vec<Values>,
    /// The number of the save that has no answer yet, and what it may be saving.
    saving: Option<u8>,
    /// Whether a save may still be going on: one that seems to be refused may be a repetition of one
    /// that is not.
    may_be_saving: bool,
    saves: Vec<Values>,
}

impl Parameters {
    /// Of an axis that comes with these.
    pub(super) fn new(values: &Values) -> Self {
        Self {
            values: *values,
            written: Vec::new(),
            restored: false,
            configured: false,
            factory: *values,
            is_saved: false,
            is_torn: false,
            kept: vec![*values],
            saving: None,
            may_be_saving: false,
            saves: Vec::new(),
        }
    }

    /// The values that hold.
    pub(super) fn values(&self) -> &Values {
        &self.values
    }

    /// The node has lost its power.
    pub(super) fn power_off(&mut self) {
        self.written.clear();
        self.configured = false;
        self.restored = false;
        self.saving = None;
        self.may_be_saving = false;
        self.saves.clear();
    }

    /// The axis got a command from who may.
    pub(super) fn command(&mut self, axis: u8, command: &Command) {
        if let Command::Control { sequence, .. } = command {
            // An answer to that number is no more about the save.
            self.saving = self.saving.filter(|saving| saving != sequence);
        }
        match *command {
            Command::ParameterWrite {
                parameter, value, ..
            } if self.configured => {
                let parameter = Parameter::try_from(parameter).ok();
                self.written.extend(parameter.map(|it| (it, value)));
            }
            Command::Control {
                action: Action::Configure,
                ..
            } => self.configured = true,
            Command::Control {
                action: Action::Restore,
                ..
            } => self.restored = true,
            Command::Control {
                action: Action::Save,
                sequence,
                ..
            } => {
                self.saving = Some(sequence);
                if !self.may_be_saving {
                    self.saves.clear();
                }
                self.may_be_saving = true;
                self.may_save(axis);
                self.is_torn |= !self.is_saved;
                return;
            }
            _ => return,
        }
        // A save that waits for another takes what it finds when it begins.
        if self.may_be_saving {
            self.may_save(axis);
        }
    }

    /// What holds now may be saved: what the last tick showed, with what was written since, as far
    /// as it was accepted.
    fn may_save(&mut self, axis: u8) {
        let begin = self.saves.len();
        let mut values = self.values;
        self.saves.push(values);
        if self.restored {
            values = Values::defaults(axis);
            self.saves.push(values);
        }
        for (parameter, raw) in &self.written {
            if let Ok((changed, _)) = values.with(*parameter, *raw) {
                values = changed;
                self.saves.push(values);
            }
        }
        self.kept.extend_from_slice(&self.saves[begin..]);
    }

    /// The axis said something.
    pub(super) fn report(&mut self, report: &Report) {
        let Report::Acknowledgement {
            function: Function::Control,
            reason,
            sequence,
            ..
        } = *report
        else {
            return;
        };
        if self.saving != Some(sequence) {
            return;
        }
        self.saving = None;
        // One that is refused may have been half way to the flash.
        if reason == Reason::Accepted {
            self.kept = std::mem::take(&mut self.saves);
            self.may_be_saving = false;
            (self.is_saved, self.is_torn) = (true, false);
        }
    }

    /// What the axis says that it is set to; says whether that has changed.
    pub(super) fn tick(
        &mut self,
        axis: u8,
        last: Option<&Glance>,
        now: &Glance,
        claimed: (&Values, &Limits),
    ) -> Result<bool, Finding> {
        let (values, limits) = claimed;
        let changed = *values != self.values;
        match last {
            None => self.begins(values, now)?,
            Some(last) if changed => self.changes(axis, values, last, now)?,
            Some(_) => {}
        }
        self.restored = false;
        self.written.clear();
        if !changed && last.is_some() {
            return Ok(false);
        }
        self.values = *values;
        if self.may_be_saving {
            // It may have been written right before the save began.
            self.saves.push(*values);
            self.kept.push(*values);
        }
        if *limits != values.settings().limits {
            return Err(Finding(
                Invariant::Parameters,
                format!("the limits are {limits:?}, but the parameters say otherwise"),
            ));
        }
        Ok(true)
    }

    /// A node that begins has what was saved, all of it.
    fn begins(&mut self, values: &Values, now: &Glance) -> Verdict {
        let lost = now.fault == Some(Fault::ParametersLost);
        if self.kept.contains(values) && !lost {
            // What else may have been saved is not; a save that was the first has left a trace.
            self.is_saved |= *values != self.factory;
            self.kept.clear();
            self.kept.push(*values);
            return Ok(());
        }
        // A first save that was torn in its last word looks like one that has gone bad.
        if lost && self.is_torn && *values == self.factory {
            return Ok(());
        }
        let lost = match now.fault {
            Some(fault) => format!(" and fault {fault:?}"),
            None => String::new(),
        };
        Err(Finding(
            Invariant::Parameters,
            format!(
                "begins with what was not saved{lost}: {}",
                differences(values, &self.kept)
            ),
        ))
    }

    fn changes(&self, axis: u8, values: &Values, last: &Glance, now: &Glance) -> Verdict {
        // Where torque was taken away meanwhile, the motion ended with it.
        let moved = last.setpoint.velocity.counts() != 0 && now.state.drives();
        for parameter in Parameter::ALL {
            let raw = values.get(parameter);
            let default = self.restored && raw == parameter.default_raw(axis);
            let known = raw == self.values.get(parameter)
                || default
                || self.written.contains(&(parameter, raw));
            let words = if !known {
                "which nobody who may has written"
            } else if moved {
                "in motion"
            } else {
                continue;
            };
            return Err(Finding(
                Invariant::Parameters,
                format!(
                    "{} became {}, {words}",
                    parameter.entry().name,
                    parameter.in_unit(raw)
                ),
            ));
        }
        Ok(())
    }
}

/// In which parameters `values` are not as any of `others`.
fn differences(values: &Values, others: &[Values]) -> String {
    let differs = |parameter: &Parameter| {
        let mut others = others.iter();
        others.all(|other| other.get(*parameter) != values.get(*parameter))
    };
    let names: Vec<&str> = Parameter::ALL
        .into_iter()
        .filter(differs)
        .map(|parameter| parameter.entry().name)
        .collect();
    if names.is_empty() {
        format!("a mixture of {} sets of parameters", others.len())
    } else {
        format!("{} as never saved", names.join(", "))
    }
}
