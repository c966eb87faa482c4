//! Parameters: read by anybody; written, restored and saved by who holds the axes.

use super::link::{ANSWER_TIME, ATTEMPTS, after};
use super::{Client, ClientError};
use crate::bus::Bus;
use crate::robot::{Robot, RobotAxis};
use canter_shared::parameter::{Change as When, Parameter, ParameterError, Values};
use canter_shared::wire::command::{Action, Command, Item};
use canter_shared::wire::id::{AxisId, Function};
use canter_shared::wire::reason::Reason;

/// Questions that one axis is asked at a time: as many answers as it keeps room for.
const AT_A_TIME: usize = 4;

/// How often a save is asked about: 50 x 60 ms, time for a slow disk.
const SAVE_ATTEMPTS: u32 = 50;

/// What there is to know about a parameter of an axis, in raw values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading {
    /// Its value now.
    pub value: i64,
    /// The value that it will have after a loss of power.
    pub saved: i64,
    /// The least value that the node accepts.
    pub minimum: i64,
    /// The greatest value that the node accepts.
    pub maximum: i64,
    /// The value that it has until it is changed.
    pub default: i64,
}

/// A value that is to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    /// To which axis.
    pub axis: AxisId,
    /// Which parameter.
    pub parameter: Parameter,
    /// The raw value.
    pub raw: i64,
}

type Question = (AxisId, Parameter, Item);

impl<B: Bus> Client<B> {
    /// Asks each question; `None` is the answer of a node that does not know the parameter.
    fn ask_values(&mut self, questions: &[Question]) -> Result<Vec<Option<i64>>, ClientError> {
        for (axis, ..) in questions {
            let known = self.axes.entry(*axis).or_default();
            known.parameters.clear();
            known.answers.clear();
        }
        let mut answers: Vec<Option<Option<i64>>> = vec![None; questions.len()];
        let mut attempts = 0;
        while attempts < ATTEMPTS {
            let mut asked: Vec<usize> = Vec::new();
            for (place, (axis, parameter, item)) in questions.iter().enumerate() {
                let of_axis = |other: &&usize| questions[**other].0 == *axis;
                if answers[place].is_some() || asked.iter().filter(of_axis).count() >= AT_A_TIME {
                    continue;
                }
                asked.push(place);
                let question = Command::ParameterRead {
                    parameter: (*parameter).into(),
                    item: *item,
                };
                self.tell((*axis).into(), question)?;
            }
            if asked.is_empty() {
                break;
            }
            let until = after(self.bus.now(), ANSWER_TIME);
            let mut missing = asked.len();
            self.wait(until, |axes| {
                for place in &asked {
                    let (axis, parameter, item) = questions[*place];
                    let number = u8::from(parameter);
                    let Some(known) = axes.get(&axis).filter(|_| answers[*place].is_none()) else {
                        continue;
                    };
                    let value = known.parameters.get(&(number, item.into()));
                    let is_unknown = known.answers.iter().any(|answer| {
                        answer.function == Function::ParameterRead
                            && answer.reason == Reason::UnknownParameter
                            && answer.detail == u32::from(number)
                    });
                    if value.is_some() || is_unknown {
                        answers[*place] = Some(value.copied());
                        missing -= 1;
                    }
                }
                missing == 0
            })?;
            // Only what brings nothing at all is a failure.
            attempts = if missing < asked.len() {
                0
            } else {
                attempts + 1
            };
        }
        let bus = self.bus.description();
        let answered = answers.into_iter().zip(questions);
        answered
            .map(|(answer, (axis, ..))| {
                answer.ok_or_else(|| ClientError::NoAnswer {
                    axis: *axis,
                    bus: bus.clone(),
                })
            })
            .collect()
    }

    /// Reads parameters of an axis; those that the node does not know are left out.
    ///
    /// # Errors
    /// The axis does not answer.
    pub fn read_parameters(
        &mut self,
        axis: AxisId,
        parameters: &[Parameter],
    ) -> Result<Vec<(Parameter, Reading)>, ClientError> {
        let questions: Vec<Question> = parameters
            .iter()
            .flat_map(|parameter| Item::ALL.map(|item| (axis, *parameter, item)))
            .collect();
        let answers = self.ask_values(&questions)?;
        let readings = parameters.iter().zip(answers.chunks(Item::ALL.len()));
        Ok(readings
            .filter_map(|(parameter, answers)| match *answers {
                [
                    Some(value),
                    Some(saved),
                    Some(minimum),
                    Some(maximum),
                    Some(default),
                ] => {
                    let reading = Reading {
                        value,
                        saved,
                        minimum,
                        maximum,
                        default,
                    };
                    Some((*parameter, reading))
                }
                _ => None,
            })
            .collect())
    }

    /// The values of all parameters that an axis knows.
    ///
    /// # Errors
    /// The axis does not answer.
    pub fn read_values(&mut self, axis: AxisId) -> Result<Vec<(Parameter, i64)>, ClientError> {
        let questions = Parameter::ALL.map(|parameter| (axis, parameter, Item::Value));
        let answers = self.ask_values(&questions)?;
        let values = Parameter::ALL.into_iter().zip(answers);
        Ok(values
            .filter_map(|(parameter, raw)| Some((parameter, raw?)))
            .collect())
    }

    /// The robot that these axes are by their own limits, and how often they report; what a node does
    /// not know is the default.
    ///
    /// # Errors
    /// An axis that does not answer.
    pub fn read_robot(&mut self, axes: &[AxisId]) -> Result<Robot, ClientError> {
        const WANTED: [Parameter; 8] = [
            Parameter::VelocityLimit,
            Parameter::AccelerationLimit,
            Parameter::DecelerationLimit,
            Parameter::JerkLimit,
            Parameter::PositionMinimum,
            Parameter::PositionMaximum,
            Parameter::FeedbackPeriod,
            Parameter::HeartbeatPeriod,
        ];
        let questions: Vec<Question> = axes
            .iter()
            .flat_map(|axis| WANTED.map(|parameter| (*axis, parameter, Item::Value)))
            .collect();
        let answers = self.ask_values(&questions)?;
        let robot = axes.iter().zip(answers.chunks(WANTED.len()));
        let robot = robot.map(|(axis, answers)| {
            let known = WANTED.into_iter().zip(answers);
            let known = known.filter_map(|(parameter, raw)| Some((parameter, (*raw)?)));
            RobotAxis {
                id: *axis,
                values: together(*axis, known),
            }
        });
        Ok(Robot::of(robot.collect()))
    }

    /// Checks all of `changes` against what the axes are and have, and writes those that differ from
    /// it; the axes are held by this session. Where one is refused after all, what was written
    /// before it is written back.
    ///
    /// # Errors
    /// The first value that cannot be; nothing has changed then.
    pub fn write_parameters(&mut self, changes: &[Change]) -> Result<(), ClientError> {
        let mut axes: Vec<AxisId> = Vec::new();
        for change in changes {
            if !axes.contains(&change.axis) {
                axes.push(change.axis);
            }
        }
        let mut writes = Vec::new();
        for axis in axes {
            let values = together(axis, self.read_values(axis)?.into_iter());
            let wanted = changes.iter().filter(|change| change.axis == axis);
            let wanted = wanted.map(|change| (change.parameter, change.raw));
            let order = in_order(&values, wanted.collect())
                .map_err(|source| ClientError::Parameter { axis, source })?;
            for (parameter, raw) in order {
                self.may_change(axis, parameter)?;
                writes.push((axis, parameter, raw, values.get(parameter)));
            }
        }
        let mut axes: Vec<_> = writes.iter().map(|(axis, ..)| *axis).collect();
        axes.dedup();
        let sequence = self.next_sequence();
        self.control(Action::Configure, sequence, &axes)?;
        for (place, (axis, parameter, raw, _)) in writes.iter().enumerate() {
            if let Err(error) = self.write_one(*axis, *parameter, *raw) {
                for (axis, parameter, _, before) in writes[..place].iter().rev() {
                    // The first error is the one to tell.
                    let _ = self.write_one(*axis, *parameter, *before);
                }
                return Err(error);
            }
        }
        Ok(())
    }

    fn may_change(&self, axis: AxisId, parameter: Parameter) -> Result<(), ClientError> {
        let state = self.axes.get(&axis).and_then(|known| known.state);
        match (parameter.entry().change, state) {
            (When::Disabled, Some(state)) if state.drives() => Err(ClientError::ChangesDisabled {
                axis,
                parameter,
                state,
            }),
            _ => Ok(()),
        }
    }

    fn write_one(
        &mut self,
        axis: AxisId,
        parameter: Parameter,
        raw: i64,
    ) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        let command = Command::ParameterWrite {
            parameter: parameter.into(),
            value: raw,
            sequence,
        };
        self.demand(sequence, &[(axis, command)])
    }

    /// Has the nodes of `axes`, which this session holds, keep their parameters and ids.
    ///
    /// # Errors
    /// An axis of a node that is enabled, or a node that could not write.
    pub fn save_parameters(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        let session = self.session;
        let save = Command::Control {
            action: Action::Save,
            sequence,
            session,
        };
        let questions: Vec<_> = axes.iter().map(|axis| (*axis, save)).collect();
        let replies = self.ask_again_and_again(sequence, &questions, SAVE_ATTEMPTS)?;
        Self::all_accepted(replies, &questions)
    }

    /// Sets the parameters of `axes`, which this session holds, to their defaults.
    ///
    /// # Errors
    /// An axis that is enabled.
    pub fn restore_parameters(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        self.control(Action::Restore, sequence, axes)
    }
}

/// Values that were read one by one, put together. What does not fit is left at its default: it is
/// of a node with other ranges.
fn together(axis: AxisId, read: impl Iterator<Item = (Parameter, i64)>) -> Values {
    read.fold(Values::defaults(axis.get()), |values, (parameter, raw)| {
        values
            .with(parameter, raw)
            .map_or(values, |(changed, _)| changed)
    })
}

/// Those of `wanted` that differ from `values`, in an order in which none contradicts another on the
/// way: what fits goes first, as long as something does.
fn in_order(
    values: &Values,
    mut wanted: Vec<(Parameter, i64)>,
) -> Result<Vec<(Parameter, i64)>, ParameterError> {
    let mut values = *values;
    let mut order = Vec::new();
    wanted.retain(|(parameter, raw)| values.get(*parameter) != *raw);
    while let Some(first) = wanted.first() {
        let fits = |(parameter, raw): &(Parameter, i64)| values.with(*parameter, *raw).is_ok();
        let place = wanted.iter().position(fits).unwrap_or(0);
        let (parameter, raw) = *wanted.get(place).unwrap_or(first);
        values = values.with(parameter, raw)?.0;
        order.push(wanted.remove(place));
    }
    Ok(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_travel_moves_over_its_old_end_whichever_way() {
        let (minimum, maximum) = (Parameter::PositionMinimum, Parameter::PositionMaximum);
        let axis = AxisId::new(1).expect("in range");
        for (old, new) in [((100, 200), (-200, -100)), ((-200, -100), (100, 200))] {
            let values = together(axis, [(minimum, old.0), (maximum, old.1)].into_iter());
            assert_eq!((values.get(minimum), values.get(maximum)), old);
            for wanted in [
                vec![(minimum, new.0), (maximum, new.1)],
                vec![(maximum, new.1), (minimum, new.0)],
            ] {
                let order = in_order(&values, wanted).expect("there is a way");
                let mut now = values;
                for (parameter, raw) in order {
                    now = now.with(parameter, raw).expect("fits on the way").0;
                }
                assert_eq!((now.get(minimum), now.get(maximum)), new);
            }
        }
    }

    #[test]
    fn what_contradicts_is_named_and_what_is_the_same_is_left_out() {
        let values = Values::defaults(1);
        let crossed = vec![
            (Parameter::PositionMaximum, -5),
            (Parameter::PositionMinimum, 5),
        ];
        let error = in_order(&values, crossed).expect_err("it cannot be");
        assert!(error.to_string().contains("limits.position_m"), "{error}");
        let same = vec![(Parameter::JerkLimit, values.get(Parameter::JerkLimit))];
        assert_eq!(in_order(&values, same), Ok(vec![]));
    }

    /// A shaper whose kind, frequency and damping all change, so that some orders are not possible.
    #[test]
    fn a_shaper_changes_over_whatever_fits() {
        let set = |kind, frequency: i64, damping: i64| {
            [
                (Parameter::ShaperKind, kind),
                (Parameter::ShaperFrequency, frequency * 100_000),
                (Parameter::ShaperDamping, damping * 10_000_000),
            ]
        };
        let axis = AxisId::new(1).expect("in range");
        let all = [set(1, 27, 0), set(2, 200, 20), set(3, 60, 1), set(0, 1, 0)];
        for from in all {
            let values = together(axis, from.into_iter());
            for to in all {
                for rotation in 0..3 {
                    let mut wanted = to.to_vec();
                    wanted.rotate_left(rotation);
                    assert!(in_order(&values, wanted).is_ok(), "{from:?} {to:?}");
                }
            }
        }
    }
}
