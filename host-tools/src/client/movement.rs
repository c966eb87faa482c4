//! Moves of several axes that leave and arrive together.
//!
//! Every axis is staged first, which checks its target and duration against its limits; only when
//! all have accepted does one trigger name the tick at which all leave. So a move that any axis
//! refuses moves nothing.

use super::link::{MILLISECOND, Reply, after};
use super::plan::Planned;
use super::request::{MoveRequest, Overrides};
use super::{Client, ClientError};
use crate::bus::Bus;
use crate::robot::Robot;
use canter_shared::limits::Limits;
use canter_shared::motion::trapezoid::Trapezoid;
use canter_shared::time::{BusTime, Ticks};
use canter_shared::units::Position;
use canter_shared::wire::command::{Command, ProfileKind};
use canter_shared::wire::id::{Address, AxisId, Function};
use canter_shared::wire::layout::POSITION_STEP;
use canter_shared::wire::reason::Reason;

/// Between the trigger and the start: time for the trigger to be sent three times and to get
/// through a serial adapter and a host that is busy for a while.
const LEAD: u64 = 100 * MILLISECOND;

/// Between the repetitions of the trigger.
const TRIGGER_PERIOD: u64 = 10 * MILLISECOND;

/// How much later than planned a move may end until it counts as lost, besides twice its duration:
/// a node whose clock cannot keep up, an emulated one say, is slow but not wrong.
const GRACE: u64 = 1_000 * MILLISECOND;

/// Silence after which an axis counts as lost: its feedback comes every 20 ms.
const SILENCE: u64 = 500 * MILLISECOND;

/// How long drives may take to settle at their targets before their positions are told as they are.
const SETTLE: u64 = 200 * MILLISECOND;

/// How far a drive may stay off its target at rest and still count as arrived, in rad.
const NEAR: f64 = 1e-3;

/// How a move came out for one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Which axis.
    pub axis: AxisId,
    /// Where it was sent, in rad, as the wire carries it.
    pub target: f64,
    /// Where the drive is, in rad.
    pub position: f64,
    /// Whether the drive is at its target too, within 1 mrad: its load may hold it off.
    pub arrived: bool,
    /// How long its move lasts.
    pub duration: Ticks,
    /// The start that the axis measured: when it handed over the setpoint of the start tick,
    /// with [`canter_shared::node::TICK_LEAD`] counted in.
    pub start: BusTime,
    /// How much later it measured its start than the earliest axis of the move.
    pub skew_microseconds: u64,
}

/// How far a move is, told again and again while it is under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Seconds since the start; negative before it.
    pub elapsed: f64,
    /// Seconds from start to rest.
    pub duration: f64,
}

impl<B: Bus> Client<B> {
    /// Moves axes that this session holds, together, and waits until all rest.
    ///
    /// # Errors
    /// A request that limits or axes refuse: nothing moves. A fault, a stop by somebody else, a
    /// lost axis or an interrupt on the way: all axes of the move are stopped.
    pub fn move_together(
        &mut self,
        robot: &Robot,
        request: &MoveRequest,
        progress: impl FnMut(Progress),
    ) -> Result<Vec<Arrival>, ClientError> {
        let mut plan = self.plan(robot, request)?;
        let group = self.stage(&mut plan, request)?;
        let axes: Vec<AxisId> = plan.iter().map(|planned| planned.axis).collect();
        let result = self.run(&plan, group, progress);
        if result.is_err() {
            // Whatever went wrong: the others must not go on alone. The flag is taken back, or
            // the stop itself would be interrupted.
            self.interrupt
                .store(false, std::sync::atomic::Ordering::Relaxed);
            let _ = self.stop(&axes);
        }
        result
    }

    /// Stages every axis under one number, which is the group's name for the trigger.
    fn stage(&mut self, plan: &mut [Planned], request: &MoveRequest) -> Result<u8, ClientError> {
        // An axis may find that its own range is a step longer: then the move is that much slower.
        for _ in 0..3 {
            match request.profile {
                ProfileKind::Beta => {}
                ProfileKind::Trapezoid => self.send_shapes(plan)?,
                ProfileKind::SCurve if request.limits == Overrides::default() => {}
                ProfileKind::SCurve => self.send_limits(plan)?,
            }
            let sequence = self.next_sequence();
            let questions: Vec<_> = plan
                .iter()
                .map(|planned| {
                    let command = Command::Move {
                        profile: request.profile,
                        staged: true,
                        target: planned.target,
                        duration: planned.duration,
                        sequence,
                    };
                    (planned.axis, command)
                })
                .collect();
            let function = match request.profile {
                ProfileKind::Beta => Function::StageBeta,
                ProfileKind::Trapezoid => Function::StageTrapezoid,
                ProfileKind::SCurve => Function::StageSCurve,
            };
            let mut least = Ticks(0);
            for reply in self.ask(sequence, &questions)? {
                match reply.reason {
                    Reason::Accepted => {}
                    Reason::TooFast if request.duration.is_none() => {
                        least = least.max(Ticks(reply.detail));
                    }
                    _ => return Err(reply.refusal(function)),
                }
            }
            if least == Ticks(0) {
                return Ok(sequence);
            }
            for planned in plan.iter_mut() {
                planned.duration = planned.duration.max(Ticks(least.0 + 1));
            }
        }
        Err(match plan.first() {
            Some(planned) => ClientError::TooLong { axis: planned.axis },
            None => ClientError::NoGoals,
        })
    }

    /// Tells each axis the ramps of its trapezoid, so that it keeps the limits of this move and
    /// not only its own.
    fn send_shapes(&mut self, plan: &[Planned]) -> Result<(), ClientError> {
        let sequence = self.next_sequence();
        let mut questions = Vec::new();
        for planned in plan {
            let shape = Trapezoid::within(planned.range, planned.duration, &planned.limits)
                .ok_or(ClientError::TooLong { axis: planned.axis })?;
            let command = Command::TrapezoidShape {
                acceleration: shape.acceleration(),
                deceleration: shape.deceleration(),
                sequence,
            };
            questions.push((planned.axis, command));
        }
        self.demand(sequence, &questions)
    }

    /// Tells each axis the limits of its s-curve.
    fn send_limits(&mut self, plan: &[Planned]) -> Result<(), ClientError> {
        let frames: [fn(&Limits, u8) -> Command; 2] = [
            |limits, sequence| Command::RampLimits {
                acceleration: limits.acceleration(),
                deceleration: limits.deceleration(),
                sequence,
            },
            |limits, sequence| Command::PeakLimits {
                velocity: limits.velocity(),
                jerk: limits.jerk(),
                sequence,
            },
        ];
        for frame in frames {
            let sequence = self.next_sequence();
            let questions: Vec<_> = plan
                .iter()
                .map(|planned| (planned.axis, frame(&planned.limits, sequence)))
                .collect();
            self.demand(sequence, &questions)?;
        }
        Ok(())
    }

    fn run(
        &mut self,
        plan: &[Planned],
        group: u8,
        mut progress: impl FnMut(Progress),
    ) -> Result<Vec<Arrival>, ClientError> {
        for planned in plan {
            if let Some(known) = self.axes.get_mut(&planned.axis) {
                known.started = None;
                known.moving = Some(true);
            }
        }
        // Bus time names the start; what is waited for goes by the bus's own clock.
        let (now, bus_time) = (self.bus.now(), self.bus_time());
        let start = after(bus_time, LEAD).next_tick();
        let left = after(now, start.time().0 - bus_time.0);
        for _ in 0..3 {
            let trigger = Command::Trigger {
                group,
                session: self.session,
                start,
            };
            self.tell(Address::All, trigger)?;
            self.wait(after(self.bus.now(), TRIGGER_PERIOD), |_| false)?;
        }
        let longest = plan
            .iter()
            .map(|planned| planned.duration)
            .max()
            .unwrap_or_default();
        let end = after(left, u64::from(longest.0) * MILLISECOND);
        let slack = 2 * u64::from(longest.0) * MILLISECOND;
        let deadline = after(end, GRACE + slack);
        loop {
            let now = self.bus.now();
            progress(Progress {
                elapsed: now.0.wrapping_sub(left.0) as i64 as f64 / 1e6,
                duration: longest.seconds(),
            });
            let next = after(now, 50 * MILLISECOND).min(deadline);
            let over = self.wait(next, |known| {
                plan.iter().all(|planned| {
                    known.get(&planned.axis).is_some_and(|known| {
                        known.started.is_some_and(|(sequence, _)| sequence == group)
                            && known.moving == Some(false)
                    })
                }) || plan.iter().any(|planned| {
                    known
                        .get(&planned.axis)
                        .is_some_and(|known| known.fault.is_some())
                })
            })?;
            self.look_for_trouble(plan, group)?;
            if over {
                break;
            }
            if self.bus.now() >= deadline {
                return Err(self.lost(plan, group));
            }
        }
        self.settle(plan.iter().map(|planned| (planned.axis, planned.target)))?;
        self.arrivals(plan)
    }

    /// A fault or a refused trigger on any axis of the move.
    fn look_for_trouble(&self, plan: &[Planned], group: u8) -> Result<(), ClientError> {
        let now = self.bus.now();
        for planned in plan {
            let axis = planned.axis;
            let Some(known) = self.axes.get(&axis) else {
                continue;
            };
            if now > after(known.heard, SILENCE) {
                let bus = self.bus.description();
                return Err(ClientError::NoAnswer { axis, bus });
            }
            if let Some(fault) = known.fault {
                return Err(ClientError::Faulted { axis, fault });
            }
            let refused = known.answers.iter().find(|answer| {
                answer.sequence == group
                    && answer.function == Function::Trigger
                    && answer.reason != Reason::Accepted
            });
            if let Some(refused) = refused {
                let reply = Reply {
                    axis,
                    reason: refused.reason,
                    detail: refused.detail,
                };
                return Err(reply.refusal(refused.function));
            }
        }
        Ok(())
    }

    /// The axis for whose sake a move was given up.
    fn lost(&self, plan: &[Planned], group: u8) -> ClientError {
        let late = plan.iter().find(|planned| {
            self.axes.get(&planned.axis).is_none_or(|known| {
                known.moving != Some(false)
                    || known.started.is_none_or(|(sequence, _)| sequence != group)
            })
        });
        let Some(planned) = late.or(plan.first()) else {
            return ClientError::NoGoals;
        };
        ClientError::TooSlow {
            axis: planned.axis,
            what: "start and finish its move",
            seconds: plan
                .iter()
                .map(|planned| planned.duration.seconds())
                .fold(0.0, f64::max),
        }
    }

    /// Waits a little until the drives, which follow behind, are where their setpoints are.
    pub(super) fn settle(
        &mut self,
        targets: impl Iterator<Item = (AxisId, Position)> + Clone,
    ) -> Result<(), ClientError> {
        let until = after(self.bus.now(), SETTLE);
        self.wait(until, |known| {
            targets.clone().all(|(axis, target)| {
                known
                    .get(&axis)
                    .and_then(|known| known.position)
                    .is_some_and(|position| (position - target).abs() <= POSITION_STEP)
            })
        })?;
        Ok(())
    }

    /// Where an axis rests, now that its setpoint does.
    ///
    /// # Errors
    /// It was stopped before it got to `target`.
    pub(super) fn rests_at(&self, axis: AxisId, target: Position) -> Result<Position, ClientError> {
        let known = self.axes.get(&axis);
        let position = known.and_then(|known| known.position).unwrap_or_default();
        if known.is_some_and(|known| known.target_reached) {
            return Ok(position);
        }
        Err(ClientError::StoppedShort {
            axis,
            position: position.radians(),
            target: target.radians(),
        })
    }

    fn arrivals(&self, plan: &[Planned]) -> Result<Vec<Arrival>, ClientError> {
        let start_of = |axis: &AxisId| {
            self.axes
                .get(axis)
                .and_then(|known| known.started)
                .map_or(BusTime(0), |(_, time)| time)
        };
        let earliest = plan
            .iter()
            .map(|planned| start_of(&planned.axis))
            .min()
            .unwrap_or_default();
        plan.iter()
            .map(|planned| {
                let position = self.rests_at(planned.axis, planned.target)?;
                let start = start_of(&planned.axis);
                Ok(Arrival {
                    axis: planned.axis,
                    target: planned.target.radians(),
                    position: position.radians(),
                    arrived: (position - planned.target).abs().radians() <= NEAR,
                    duration: planned.duration,
                    start,
                    skew_microseconds: start.0 - earliest.0,
                })
            })
            .collect()
    }
}
