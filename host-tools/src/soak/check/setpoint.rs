//! Limits and continuity of what an axis tells its drive.

use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::units::{Position, Velocity};

use super::{Believe, Finding, Glance, Verdict};
use crate::soak::invariant::Invariant;

/// Counts of 2^-32 turn by which a position may be outside, and counts per second by which a
/// velocity may be over its limit: the margin that plans keep for rounding. 12 nanorad.
const MARGIN: i64 = 8;

/// Counts of 2^-32 turn by which a position may differ from what the velocities between two ticks
/// make of it: both are rounded.
const POSITION_ROUNDING: i64 = 64;

/// Counts per second by which a velocity may differ from what the acceleration limit allows: 1e-6
/// rad/s, which a position rounded to counts cannot show in a tick.
const VELOCITY_ROUNDING: i64 = 684;

/// Behind a shaper a velocity is the mean of some that are kept in 26 bits, of which one is the sign.
const SHORT_BITS: u32 = 25;

/// Nanoseconds between two ticks.
const TICK: u64 = 1_000_000;

/// Nanoseconds by which a tick may come late or early: 200 ppm that a clock makes up for and what
/// its crystal is off make a microsecond, and clocks show whole ones.
const TICK_ROUNDING: u64 = 4_000;

/// Ticks after which a clock that was set has no more effect.
const SETTLED: u8 = 2;

/// The eye on the setpoints of an axis.
#[derive(Debug, Default)]
pub(super) struct Setpoints {
    /// Ticks since the node began, up to [`SETTLED`], and since the axis last stood.
    begun: u8,
    in_motion: u8,
    /// Where the axis may be: in its travel, and from where it was enabled into it.
    reach: Option<(Position, Position)>,
}

impl Setpoints {
    pub(super) fn tick(&mut self, last: &Glance, now: &Glance, believe: &Believe) -> Verdict {
        self.time(last, now)?;
        let led = last.state.drives() && last.state != State::ReadyToSwitchOn;
        let limits = &believe.limits;
        match now.state {
            State::OperationEnabled | State::QuickStopActive | State::FaultReactionActive
                if led =>
            {
                self.limits(now, limits)?;
                follows(last, now, limits)
            }
            state if state.drives() => {
                self.change(now.setpoint.position, limits);
                begins(last, now, led)
            }
            _ => stands(now),
        }
    }

    /// The limits are others from now on. The axis may stand outside of a new travel.
    pub(super) fn change(&mut self, place: Position, limits: &Limits) {
        self.reach = Some((
            limits.position_minimum().min(place),
            limits.position_maximum().max(place),
        ));
    }

    /// Each tick follows the one before, and in motion after a millisecond. A clock that is set
    /// anew, at rest only, leaves ticks out, and has one come late and the next in time again.
    fn time(&mut self, last: &Glance, now: &Glance) -> Verdict {
        let passed = now.time.0.saturating_sub(last.time.0);
        let in_turn = now.tick.0 == last.tick.0.wrapping_add(1);
        // It may have been set, and what waited for its start called off, before a command came that
        // begins with this tick; and without torque nothing moves by the setpoints.
        let stood = last.setpoint.velocity.counts() == 0;
        let still = stood || !now.state.drives();
        self.in_motion = if still {
            0
        } else {
            SETTLED.min(self.in_motion + 1)
        };
        self.begun = SETTLED.min(self.begun + 1);
        // A node that begins runs its first tick at once; a clock is set by less than a tick, or
        // leaves whole ones out.
        let may_pass = match (self.begun, self.in_motion) {
            (SETTLED, SETTLED) => TICK + TICK_ROUNDING,
            _ => 2 * TICK,
        };
        let late = passed > may_pass;
        let early = passed + TICK_ROUNDING < TICK;
        if late || !still && !in_turn || self.in_motion == SETTLED && early {
            return Err(Finding(
                Invariant::Continuity,
                format!(
                    "tick {} comes {:.1} us after tick {}, {}",
                    now.tick.0,
                    passed as f64 / 1e3,
                    last.tick.0,
                    if still { "at rest" } else { "in motion" }
                ),
            ));
        }
        Ok(())
    }

    fn limits(&self, now: &Glance, limits: &Limits) -> Verdict {
        let setpoint = &now.setpoint;
        let strongest = limits.acceleration().max(limits.deceleration());
        let travel = (limits.position_minimum(), limits.position_maximum());
        let (least, most) = self.reach.unwrap_or(travel);
        let beside = Position::from_counts(MARGIN);
        let faster = Velocity::from_counts(MARGIN);
        let broken = if setpoint.velocity.abs() > limits.velocity() + faster {
            format!(
                "the velocity limit {:.9} rad/s",
                limits.velocity().radians()
            )
        } else if setpoint.acceleration.abs() > strongest {
            format!("the acceleration limit {:.6} rad/s^2", strongest.radians())
        } else if !(least - beside..=most + beside).contains(&setpoint.position) {
            format!(
                "the travel from {:.9} to {:.9} rad, of which it may reach {:.9} to {:.9} rad",
                travel.0.radians(),
                travel.1.radians(),
                least.radians(),
                most.radians()
            )
        } else {
            return Ok(());
        };
        Err(Finding(
            Invariant::Limits,
            format!("{} in {}, which breaks {broken}", show(setpoint), now.state),
        ))
    }
}

fn show(setpoint: &Setpoint) -> String {
    format!(
        "{:.9} rad, {:.9} rad/s, {:.6} rad/s^2",
        setpoint.position.radians(),
        setpoint.velocity.radians(),
        setpoint.acceleration.radians()
    )
}

/// Position and velocity follow from those before.
fn follows(last: &Glance, now: &Glance, limits: &Limits) -> Verdict {
    let (before, after) = (&last.setpoint, &now.setpoint);
    let strongest = limits.acceleration().max(limits.deceleration()).counts();
    let (from, to) = (before.velocity.counts(), after.velocity.counts());
    let moved = after.position.counts() - before.position.counts();
    // With an acceleration of at most A, the mean velocity over dt is off the mean of both ends by
    // A dt / 4 at most, so the position by A dt^2 / 4.
    let expected = (from + to) / 2_000;
    let apart = strongest / 4_000_000 + POSITION_ROUNDING;
    let jumps = (moved - expected).abs() > apart;
    let rounding = VELOCITY_ROUNDING + ((from.abs() + to.abs()) >> SHORT_BITS);
    let jerks = (to - from).abs() > strongest / 1_000 + rounding;
    if jumps || jerks {
        return Err(Finding(
            Invariant::Continuity,
            format!(
                "{} in {} after {} in {}: {} counts from where it should be, {apart} are allowed",
                show(after),
                now.state,
                show(before),
                last.state,
                (moved - expected).abs()
            ),
        ));
    }
    Ok(())
}

/// Torque comes on where the drive is, at rest; until the drive follows, so does the setpoint.
fn begins(last: &Glance, now: &Glance, led: bool) -> Verdict {
    let setpoint = &now.setpoint;
    let place = setpoint.position;
    let rests = setpoint.velocity.counts() == 0 && setpoint.acceleration.counts() == 0;
    let at_drive = place == last.drive.position;
    // Once the drive follows, it may stand a little beside the setpoint.
    let stays = last.state.drives() && place == last.setpoint.position;
    let allowed = match now.state {
        State::SwitchedOn | State::OperationEnabled if led => stays,
        State::QuickStopActive | State::FaultReactionActive => at_drive || stays,
        _ => at_drive,
    };
    if rests && allowed {
        return Ok(());
    }
    Err(Finding(
        Invariant::Continuity,
        format!(
            "{} in {} with the drive at {:.9} rad, after {} in {}",
            show(setpoint),
            now.state,
            last.drive.position.radians(),
            show(&last.setpoint),
            last.state
        ),
    ))
}

/// Without torque there is nothing to lead.
fn stands(now: &Glance) -> Verdict {
    let setpoint = &now.setpoint;
    if setpoint.velocity.counts() == 0 && setpoint.acceleration.counts() == 0 {
        return Ok(());
    }
    Err(Finding(
        Invariant::Continuity,
        format!("{} in {}, which has no torque", show(setpoint), now.state),
    ))
}
