//! Limits and continuity of what an axis tells its drive.

use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::units::Position;

use super::{Believe, Finding, Glance, Verdict};
use crate::soak::invariant::Invariant;

/// Counts of 2^-32 turn by which a position may differ from what the velocities between two ticks
/// make of it: both are rounded.
const POSITION_ROUNDING: i64 = 64;

/// Counts per second by which a velocity may differ from what the acceleration limit allows: 1e-6
/// rad/s, which a position rounded to counts cannot show in a tick.
const VELOCITY_ROUNDING: i64 = 684;

/// Nanoseconds between two ticks.
const TICK: u64 = 1_000_000;

/// Nanoseconds by which a tick may come late or early: 200 ppm that a clock makes up for and what
/// its crystal is off make a microsecond, and clocks show whole ones.
const TICK_ROUNDING: u64 = 4_000;

/// The eye on the setpoints of an axis.
#[derive(Debug, Default)]
pub(super) struct Setpoints;

impl Setpoints {
    pub(super) fn tick(&mut self, last: &Glance, now: &Glance, believe: &Believe) -> Verdict {
        self.time(last, now)?;
        let led = last.state.drives() && last.state != State::ReadyToSwitchOn;
        match now.state {
            State::OperationEnabled | State::QuickStopActive | State::FaultReactionActive
                if led =>
            {
                limits(last, now, &believe.limits)?;
                follows(last, now, &believe.limits)
            }
            state if state.drives() => begins(last, now, led),
            _ => stands(now),
        }
    }

    /// Each tick follows the one before, and in motion after a millisecond; a clock that is set
    /// anew leaves ticks out at rest only.
    fn time(&mut self, last: &Glance, now: &Glance) -> Verdict {
        let passed = now.time.0.saturating_sub(last.time.0);
        let in_turn = now.tick.0 == last.tick.0.wrapping_add(1);
        let stays = last.setpoint.velocity.counts() == 0
            && now.setpoint.velocity.counts() == 0
            && (now.setpoint.position == last.setpoint.position || !now.state.drives());
        // It may have been set before a command came that begins with this tick.
        let still = last.rests() || stays;
        let late = passed > TICK + TICK_ROUNDING;
        let early = passed + TICK_ROUNDING < TICK;
        if late || !still && (early || !in_turn) {
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
}

fn outside(position: Position, limits: &Limits) -> Position {
    (limits.position_minimum() - position)
        .max(position - limits.position_maximum())
        .max(Position::ZERO)
}

fn show(setpoint: &Setpoint) -> String {
    format!(
        "{:.9} rad, {:.9} rad/s, {:.6} rad/s^2",
        setpoint.position.radians(),
        setpoint.velocity.radians(),
        setpoint.acceleration.radians()
    )
}

fn limits(last: &Glance, now: &Glance, limits: &Limits) -> Verdict {
    let (before, after) = (&last.setpoint, &now.setpoint);
    let strongest = limits.acceleration().max(limits.deceleration());
    let broken = if after.velocity.abs() > limits.velocity() {
        format!(
            "the velocity limit {:.9} rad/s",
            limits.velocity().radians()
        )
    } else if after.acceleration.abs() > strongest {
        format!("the acceleration limit {:.6} rad/s^2", strongest.radians())
    } else if outside(after.position, limits) > outside(before.position, limits) {
        format!(
            "the travel from {:.9} to {:.9} rad",
            limits.position_minimum().radians(),
            limits.position_maximum().radians()
        )
    } else {
        return Ok(());
    };
    Err(Finding(
        Invariant::Limits,
        format!("{} in {}, which breaks {broken}", show(after), now.state),
    ))
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
    let jerks = (to - from).abs() > strongest / 1_000 + VELOCITY_ROUNDING;
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
