//! Taking axes and giving them back; enabling, disabling, clearing, stopping.

use super::link::{MILLISECOND, after};
use super::{Client, ClientError};
use crate::bus::Bus;
use canter_shared::axis::state::State;
use canter_shared::wire::command::{Action, Command};
use canter_shared::wire::id::{Address, AxisId};
use std::collections::BTreeMap;

/// How long an axis may take to enable: the node gives its drive 1 s.
const ENABLE_TIME: u64 = 1_500 * MILLISECOND;

/// How long a released axis may take to say so in its heartbeat.
const RELEASE_TIME: u64 = 120 * MILLISECOND;

/// How long an axis may take to come to rest: a stop from full speed takes far less unless the
/// deceleration limit is very low.
const REST_TIME: u64 = 30_000 * MILLISECOND;

impl<B: Bus> Client<B> {
    /// Takes `axes` for this session, and sets their clocks.
    ///
    /// # Errors
    /// An axis that does not answer or that another session holds; none is held then.
    pub fn hold(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        let taken = self.control(Action::Hold, sequence, axes);
        // Those that said yes are this session's, whatever the others said.
        self.held = axes.to_vec();
        if let Err(error) = taken {
            // The first error is the one to tell.
            let _ = self.release();
            return Err(error);
        }
        self.settle_clocks()
    }

    /// Gives all axes back; they stay as they are and hold their position.
    ///
    /// # Errors
    /// The bus failed. An axis that does not answer loses its session by its own time-out.
    pub fn release(&mut self) -> Result<(), ClientError> {
        let axes = std::mem::take(&mut self.held);
        let sequence = self.next_sequence();
        let session = self.session;
        for axis in axes.iter().copied() {
            let release = Command::Control {
                action: Action::Release,
                sequence,
                session,
            };
            // One by one: an axis that is not ours refuses, and that is as good.
            match self.ask(sequence, &[(axis, release)]) {
                Ok(_) | Err(ClientError::NoAnswer { .. } | ClientError::Interrupted) => {}
                Err(error) => return Err(error),
            }
        }
        // Their next heartbeats say it too, so that what is known of them is not out of date.
        let until = after(self.bus.now(), RELEASE_TIME);
        self.wait(until, |known| {
            axes.iter().all(|axis| {
                known
                    .get(axis)
                    .is_none_or(|known| known.session != Some(session))
            })
        })?;
        Ok(())
    }

    pub(super) fn control(
        &mut self,
        action: Action,
        sequence: u8,
        axes: &[AxisId],
    ) -> Result<(), ClientError> {
        let session = self.session;
        let questions: Vec<_> = axes
            .iter()
            .map(|axis| {
                let command = Command::Control {
                    action,
                    sequence,
                    session,
                };
                (*axis, command)
            })
            .collect();
        self.demand(sequence, &questions)
    }

    /// Enables `axes`, which this session holds, and waits until they are.
    ///
    /// # Errors
    /// A latched fault, or a drive that does not enable.
    pub fn enable(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        self.control(Action::Enable, sequence, axes)?;
        self.wait_for_state(axes, State::OperationEnabled, "enable", ENABLE_TIME)
    }

    /// Stops and disables `axes`, which this session holds, and waits until they are.
    ///
    /// # Errors
    /// An axis that does not come to rest.
    pub fn disable(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        self.control(Action::Disable, sequence, axes)?;
        let until = after(self.bus.now(), REST_TIME);
        let off = |state: Option<State>| state.is_some_and(|state| !state.drives());
        self.wait(until, |known| {
            axes.iter()
                .all(|axis| known.get(axis).is_some_and(|known| off(known.state)))
        })?;
        match axes
            .iter()
            .find(|axis| !off(self.axes.get(axis).and_then(|known| known.state)))
        {
            Some(axis) => Err(too_slow(*axis, "disable", REST_TIME)),
            None => Ok(()),
        }
    }

    /// Forgets the latched faults of `axes`, which this session holds; they stay disabled.
    ///
    /// # Errors
    /// An axis that still moves.
    pub fn clear(&mut self, axes: &[AxisId]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        self.control(Action::Clear, sequence, axes)?;
        self.wait_for_state_unless(axes, State::Fault)
    }

    fn wait_for_state_unless(&mut self, axes: &[AxisId], state: State) -> Result<(), ClientError> {
        let until = after(self.bus.now(), ENABLE_TIME);
        let left = self.wait(until, |known| {
            axes.iter().all(|axis| {
                known.get(axis).is_some_and(|known| {
                    known.state.is_some_and(|now| now != state) && known.fault.is_none()
                })
            })
        })?;
        match axes.first() {
            Some(axis) if !left => Err(too_slow(*axis, "clear its fault", ENABLE_TIME)),
            _ => Ok(()),
        }
    }

    fn wait_for_state(
        &mut self,
        axes: &[AxisId],
        state: State,
        what: &'static str,
        time: u64,
    ) -> Result<(), ClientError> {
        let until = after(self.bus.now(), time);
        self.wait(until, |known| {
            axes.iter().all(|axis| {
                known
                    .get(axis)
                    .is_some_and(|known| known.state == Some(state) || known.fault.is_some())
            })
        })?;
        for axis in axes {
            let known = self.axes.get(axis);
            if let Some(fault) = known.and_then(|known| known.fault) {
                return Err(ClientError::Faulted { axis: *axis, fault });
            }
            if known.and_then(|known| known.state) != Some(state) {
                return Err(too_slow(*axis, what, time));
            }
        }
        Ok(())
    }

    /// Stops axes, whoever holds them, and waits until they rest; gives where each rests, in rad. All of
    /// them are told at once, before any answer is waited for.
    ///
    /// # Errors
    /// An axis that does not answer or does not come to rest; the others rest then.
    pub fn stop(&mut self, axes: &[AxisId]) -> Result<BTreeMap<AxisId, f64>, ClientError> {
        let sequence = self.next_sequence();
        let questions: Vec<_> = axes
            .iter()
            .map(|axis| (*axis, Command::Stop { sequence }))
            .collect();
        if let Err(error) = self.demand(sequence, &questions) {
            // One that does not answer keeps nobody from waiting for the others.
            let answered =
                |(axis, command): &&(AxisId, Command)| self.has_answered(*axis, sequence, command);
            let there = questions.iter().filter(answered).map(|(axis, _)| *axis);
            self.wait_for_rest(&there.collect::<Vec<_>>())?;
            return Err(error);
        }
        self.wait_for_rest(axes)
    }

    /// Sends an emergency stop to all axes or to some, and waits until those heard of rest.
    ///
    /// # Errors
    /// The bus failed, or an axis does not come to rest.
    pub fn emergency_stop(&mut self, axes: Option<&[AxisId]>) -> Result<(), ClientError> {
        let addresses: Vec<Address> = match axes {
            None => vec![Address::All],
            Some(axes) => axes.iter().map(|axis| Address::Axis(*axis)).collect(),
        };
        // Three times: nothing is acknowledged here, and one frame may be lost.
        for _ in 0..3 {
            for address in &addresses {
                self.tell(*address, Command::EmergencyStop)?;
            }
            self.wait(after(self.bus.now(), 2 * MILLISECOND), |_| false)?;
        }
        let heard = self.listen()?;
        let stopped: Vec<AxisId> = match axes {
            None => heard,
            Some(axes) => axes.to_vec(),
        };
        for axis in &stopped {
            if !self.axes.contains_key(axis) {
                let bus = self.bus.description();
                return Err(ClientError::NoAnswer { axis: *axis, bus });
            }
        }
        self.wait_for_rest(&stopped).map(|_| ())
    }

    /// Waits until fresh feedback of every axis says that it rests.
    pub(super) fn wait_for_rest(
        &mut self,
        axes: &[AxisId],
    ) -> Result<BTreeMap<AxisId, f64>, ClientError> {
        let seen: Vec<u64> = axes
            .iter()
            .map(|axis| self.axes.get(axis).map_or(0, |known| known.feedbacks))
            .collect();
        let until = after(self.bus.now(), REST_TIME);
        self.wait(until, |known| {
            axes.iter().zip(&seen).all(|(axis, seen)| {
                known
                    .get(axis)
                    .is_some_and(|known| known.feedbacks > *seen && known.moving == Some(false))
            })
        })?;
        axes.iter()
            .map(|axis| {
                let known = self.axes.get(axis);
                match known.and_then(|known| known.position.filter(|_| known.moving == Some(false)))
                {
                    Some(position) => Ok((*axis, position.radians())),
                    None => Err(too_slow(*axis, "come to rest", REST_TIME)),
                }
            })
            .collect()
    }
}

fn too_slow(axis: AxisId, what: &'static str, microseconds: u64) -> ClientError {
    ClientError::TooSlow {
        axis,
        what,
        seconds: microseconds as f64 / 1e6,
    }
}
