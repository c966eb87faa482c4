//! A whole walk offline: start, cycles, stop; its peaks.

use super::body::Body;
use super::error::GaitError;
use super::pattern::{Gait, LEG_NAMES, LEGS};
use super::planner::{Planner, State};
use super::quadruped::Quadruped;
use crate::notation::Range;

/// Rows that a walk may make at most.
const MOST_ROWS: usize = 1_000_000;

/// For so many cycles and s a robot walks before its cycles are steady.
const CYCLES_TO_STEADY: f64 = 3.0;
const SECONDS_TO_STEADY: f64 = 1.0;

/// Which walk is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// The gait; none to stand.
    pub gait: Option<Gait>,
    /// What the body does.
    pub body: Body,
    /// For how many cycles it walks, from 1 to 1000, before it stops.
    pub cycles: u32,
    /// The time from row to row, in s, from 10^-6 to 1.
    pub step: f64,
    /// One cycle of a walk without end instead, from a touch-down of the front left foot.
    pub steady: bool,
}

/// What one axis comes to in a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPeaks {
    /// Which.
    pub axis: u8,
    /// Its leg.
    pub leg: &'static str,
    /// The least and the greatest position, in rad.
    pub position: [f64; 2],
    /// The greatest rate, in rad/s.
    pub velocity: f64,
    /// The greatest acceleration, in rad/s^2.
    pub acceleration: f64,
    /// The rate as a share of what the axis may do.
    pub velocity_share: f64,
    /// The acceleration as a share of the lesser of the limits up and down.
    pub acceleration_share: f64,
}

/// What a walk comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Peaks {
    /// How long it lasts, in s.
    pub duration: f64,
    /// Rows of the walk.
    pub rows: usize,
    /// Each axis.
    pub axes: Vec<AxisPeaks>,
    /// How high each foot comes above the ground, in m.
    pub clearance: [f64; LEGS],
}

/// A walk, which gives the same rows as often as it is asked.
#[derive(Debug, Clone)]
pub struct Course {
    quadruped: Quadruped,
    request: Request,
}

impl Course {
    /// A walk of a robot.
    ///
    /// # Errors
    /// The field that is out of its range, standing that is to go somewhere, too many rows.
    pub fn new(quadruped: Quadruped, request: &Request) -> Result<Self, GaitError> {
        let Request {
            gait,
            body,
            cycles,
            step,
            steady,
        } = request;
        body.check()?;
        let count = |field, value: f64, unit, least, most, cure| {
            Range {
                field,
                unit,
                least,
                most,
                cure,
            }
            .check(value)
        };
        count(
            "the time from row to row",
            *step,
            "s",
            1e-6,
            1.0,
            "a usual one is 0.001",
        )?;
        count(
            "the number of cycles",
            f64::from(*cycles),
            "cycles",
            1.0,
            1e3,
            "a usual one is 4",
        )?;
        let seconds = match gait {
            Some(gait) => {
                gait.check()?;
                let blend = gait.period.max(1.0);
                if *steady {
                    gait.period
                } else {
                    f64::from(*cycles) * gait.period + 3.0 * blend
                }
            }
            None if *steady || *body != body.at_rest() => return Err(GaitError::Standing),
            None => 1.0,
        };
        let rows = seconds / step;
        if rows > MOST_ROWS as f64 {
            return Err(GaitError::Rows {
                rows,
                most: MOST_ROWS,
            });
        }
        Ok(Self {
            quadruped,
            request: *request,
        })
    }

    /// The robot.
    pub fn quadruped(&self) -> &Quadruped {
        &self.quadruped
    }

    /// How long a cycle lasts, in s; none where the robot stands.
    pub fn period(&self) -> Option<f64> {
        self.request.gait.map(|gait| gait.period)
    }

    /// The rows, from time 0 on. The first error is the last row.
    ///
    /// # Errors
    /// A foot that its leg does not reach before the first row.
    pub fn rows(&self) -> Result<impl Iterator<Item = Result<State, GaitError>>, GaitError> {
        let Request {
            gait,
            body,
            cycles,
            step,
            steady,
        } = self.request;
        let mut planner = Planner::new(self.quadruped.clone(), Body::standing(body.height))?;
        planner.command(&body)?;
        let (mut start, mut stop, mut end) = (0.0, 0.0, f64::INFINITY);
        if let Some(gait) = gait {
            planner.walk(&gait)?;
            stop = f64::from(cycles) * gait.period;
            if steady {
                planner.advance(CYCLES_TO_STEADY * gait.period + SECONDS_TO_STEADY)?;
                start = planner.touch_down(0).unwrap_or(planner.time());
                (stop, end) = (f64::INFINITY, gait.period);
            }
        }
        let mut index = 0u32;
        let mut is_over = false;
        Ok(std::iter::from_fn(move || {
            if is_over {
                return None;
            }
            let mut time = f64::from(index) * step;
            index += 1;
            // What rounding makes of a whole number of steps is that number.
            if time > end - 1e-6 * step {
                (time, is_over) = (end, true);
            }
            let state = (|| {
                if time >= stop {
                    planner.advance(start + stop)?;
                    planner.stop();
                    stop = f64::INFINITY;
                }
                planner.advance(start + time)
            })();
            let is_done = stop == f64::INFINITY && planner.is_standing() && planner.is_settled();
            is_over = is_over || state.is_err() || is_done;
            Some(state.map(|state| State { time, ..state }))
        }))
    }

    /// What the walk comes to, whatever the limits.
    ///
    /// # Errors
    /// A foot that its leg does not reach.
    pub fn peaks(&self) -> Result<Peaks, GaitError> {
        Ok(self.measure()?.0)
    }

    /// What the walk comes to, within the limits of every axis.
    ///
    /// # Errors
    /// A foot that its leg does not reach; the axis that is furthest beyond a limit of its own.
    pub fn peaks_within_limits(&self) -> Result<Peaks, GaitError> {
        match self.measure()? {
            (_, Some((_, worst))) => Err(worst),
            (peaks, None) => Ok(peaks),
        }
    }

    fn measure(&self) -> Result<(Peaks, Option<(f64, GaitError)>), GaitError> {
        let mounts = &self.quadruped.mounts;
        let mut worst: Option<(f64, GaitError)> = None;
        let mut peaks = Peaks {
            duration: 0.0,
            rows: 0,
            axes: Vec::new(),
            clearance: [0.0; LEGS],
        };
        for (mount, leg) in mounts.iter().zip(LEG_NAMES) {
            peaks
                .axes
                .extend(mount.leg.axes.iter().map(|axis| AxisPeaks {
                    axis: axis.get(),
                    leg,
                    position: [f64::INFINITY, f64::NEG_INFINITY],
                    velocity: 0.0,
                    acceleration: 0.0,
                    velocity_share: 0.0,
                    acceleration_share: 0.0,
                }));
        }
        for state in self.rows()? {
            let state = state?;
            peaks.duration = state.time;
            peaks.rows += 1;
            for (index, axis) in peaks.axes.iter_mut().enumerate() {
                let (leg, joint) = (index / 3, index % 3);
                let joints = &state.joints[leg];
                let [position, velocity, acceleration] = [
                    joints.position[joint],
                    joints.velocity[joint],
                    joints.acceleration[joint],
                ];
                let limits = &mounts[leg].limits[joint];
                axis.position = [
                    axis.position[0].min(position),
                    axis.position[1].max(position),
                ];
                axis.velocity = axis.velocity.max(velocity.abs());
                axis.acceleration = axis.acceleration.max(acceleration.abs());
                let [least, most] = [limits.position_minimum(), limits.position_maximum()]
                    .map(|place| place.radians());
                let fastest = limits.velocity().radians();
                let hardest = limits.slower_acceleration().radians();
                axis.velocity_share = axis.velocity / fastest;
                axis.acceleration_share = axis.acceleration / hardest;
                let half = 0.5 * (most - least);
                let end = if position < least { least } else { most };
                for (share, what, value, limit, unit) in [
                    (
                        1.0 + (position - most).max(least - position) / half,
                        "a position",
                        position,
                        end,
                        "rad",
                    ),
                    (
                        velocity.abs() / fastest,
                        "a velocity",
                        velocity.abs(),
                        fastest,
                        "rad/s",
                    ),
                    (
                        acceleration.abs() / hardest,
                        "an acceleration",
                        acceleration.abs(),
                        hardest,
                        "rad/s^2",
                    ),
                ] {
                    if share > 1.0 && worst.as_ref().is_none_or(|(most, _)| share > *most) {
                        let (axis, leg, time) = (axis.axis, axis.leg, state.time);
                        worst = Some((
                            share,
                            GaitError::Limit {
                                axis,
                                leg,
                                what,
                                value,
                                limit,
                                unit,
                                time,
                            },
                        ));
                    }
                }
            }
            for (highest, place) in peaks.clearance.iter_mut().zip(state.places) {
                *highest = highest.max(place[2]);
            }
        }
        Ok((peaks, worst))
    }
}
