//! A seed's robot, and what is to happen to it.

use std::time::Duration;

use canter_shared::limits::{
    DEFAULT_VALUES, FARTHEST_POSITION, LARGEST_ACCELERATION, LARGEST_JERK, LARGEST_VELOCITY,
    LimitValues, Limits, SMALLEST_RATE,
};
use canter_shared::motion::shaping::{ShaperKind, Shaping};
use canter_shared::parameter::Values;
use canter_shared::time::BusTime;
use canter_shared::wire::id::{AxisId, LAST_AXIS};

use super::dice::Dice;
use super::episode::{EPISODE, Options};
use super::fault::FaultKind;
use super::sabotage::{Sabotage, raised};
use crate::bus::Bitrate;
use crate::robot::RobotAxis;
use crate::sim::{Configuration, Disturbance, Rates, Recurring};

/// The most axes that a robot has.
const MOST_AXES: u64 = 12;

/// Time in which the commander does nothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Absence {
    pub(super) from: BusTime,
    pub(super) to: BusTime,
    /// The process ends, and another takes its place; otherwise it only stood still.
    pub(super) killed: bool,
}

/// All that a seed decides before anything happens.
#[derive(Debug)]
pub(super) struct Scenario {
    pub(super) configuration: Configuration,
    /// What the axes are meant to be.
    pub(super) axes: Vec<RobotAxis>,
    pub(super) absences: Vec<Absence>,
    /// What goes wrong at a certain time.
    pub(super) orders: Vec<(BusTime, Disturbance)>,
    pub(super) has_rival: bool,
    pub(super) is_hostile: bool,
}

impl Scenario {
    pub(super) fn draw(seed: u64, options: &Options) -> Self {
        let faults = options.faults;
        let mut dice = Dice::new(seed, "faults");
        // Whether a kind takes part is drawn in any case, so that fewer faults do not change the
        // others.
        let drawn = FaultKind::ALL.map(|kind| dice.percent(50) && faults.has(kind));
        let has = |kind: FaultKind| drawn[kind as usize];
        let mut axes = robot(seed, options.axes);
        let meant = axes.clone();
        if options.sabotage == Some(Sabotage::HigherLimits) {
            for axis in &mut axes {
                axis.values = raised(axis);
            }
        }
        let mut bus = Dice::new(seed, "bus");
        let nodes = axes.len() as u64;
        let configuration = Configuration {
            axes,
            seed,
            bitrate: bitrate(bus.one_of(&[250_000, 500_000, 1_000_000, 1_000_000])),
            crystal_ppm: bus.one_of(&[0, 50, 100, 100]),
            receive_jitter: bus.one_of(&[0, 20_000, 20_000, 200_000]),
            plant: None,
            disturbances: rates(seed, has),
        };
        let mut orders = Vec::new();
        if has(FaultKind::PowerCutWhileSaving) {
            let mut dice = Dice::new(seed, "saving");
            for at in times(&mut dice, Duration::from_secs(4)) {
                let node = dice.between(0, nodes - 1) as usize;
                let disturbance = Disturbance::CutPowerWhileSaving {
                    node,
                    after: dice.between(0, 40) as u32,
                    time: dice.time(Duration::ZERO, Duration::from_millis(300)),
                };
                orders.push((at, disturbance));
            }
        }
        Self {
            configuration,
            axes: meant,
            absences: absences(seed, has),
            orders,
            has_rival: has(FaultKind::Rival),
            is_hostile: has(FaultKind::Hostile),
        }
    }
}

fn bitrate(rate: u32) -> Bitrate {
    Bitrate::from_bits_per_second(rate).unwrap_or_default()
}

fn robot(seed: u64, axes: Option<u8>) -> Vec<RobotAxis> {
    let mut dice = Dice::new(seed, "robot");
    let drawn = dice.between(1, MOST_AXES);
    let count = axes.map_or(drawn, |axes| u64::from(axes).clamp(1, MOST_AXES));
    let mut ids: Vec<u8> = (1..=LAST_AXIS).collect();
    let manner = dice.between(0, 9);
    let shaped = dice.percent(30);
    let mut axes = Vec::new();
    while (axes.len() as u64) < count {
        let place = dice.between(0, ids.len() as u64 - 1) as usize;
        if let Some(id) = AxisId::new(ids.swap_remove(place)) {
            let values = Values::of_limits(id.get(), &limits(&mut dice, manner));
            let shaping = shaping(&mut dice).filter(|_| shaped);
            axes.push(RobotAxis {
                id,
                values: values.shaped(shaping.as_ref()).unwrap_or(values),
            });
        }
    }
    axes
}

fn limits(dice: &mut Dice, manner: u64) -> Limits {
    let mut values = match manner {
        // As they come.
        0..=1 => DEFAULT_VALUES,
        // Anything that is possible.
        2 => LimitValues {
            velocity: dice.decades(SMALLEST_RATE, LARGEST_VELOCITY),
            acceleration: dice.decades(SMALLEST_RATE, LARGEST_ACCELERATION),
            deceleration: dice.decades(SMALLEST_RATE, LARGEST_ACCELERATION),
            jerk: dice.decades(SMALLEST_RATE, LARGEST_JERK),
            ..DEFAULT_VALUES
        },
        // Machines.
        _ => {
            let acceleration = dice.decades(2.0, 5_000.0);
            let deceleration = if dice.percent(50) {
                acceleration
            } else {
                dice.decades(2.0, 5_000.0)
            };
            LimitValues {
                velocity: dice.decades(0.1, 100.0),
                acceleration,
                deceleration,
                jerk: acceleration.max(deceleration) * dice.decades(1.0, 1_000.0),
                ..DEFAULT_VALUES
            }
        }
    };
    let half = dice.decades(1e-3, 100.0);
    // The drive stands at 0: mostly inside, sometimes on the edge, sometimes outside.
    let middle = match dice.between(0, 9) {
        0 => half,
        1 => -half * 1.5,
        _ => dice.real(-half, half),
    };
    if dice.percent(80) {
        values.position_minimum = (middle - half).max(-FARTHEST_POSITION);
        values.position_maximum = (middle + half).min(FARTHEST_POSITION);
    }
    Limits::new(&values).unwrap_or_default()
}

fn shaping(dice: &mut Dice) -> Option<Shaping> {
    let kind = dice.one_of(&[ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Ei]);
    let frequency = dice.decades(6.0, 60.0);
    let damping = dice.real(0.0, 0.3);
    // Some are too slow for the memory that there is; then the axis has none.
    Shaping::new(kind, frequency, damping).ok()
}

/// Some instants, `every` apart on average.
fn times(dice: &mut Dice, every: Duration) -> Vec<BusTime> {
    let mut times = Vec::new();
    let mut at = Duration::ZERO;
    loop {
        at += dice.time(Duration::from_millis(1), every * 2);
        if at >= EPISODE {
            return times;
        }
        times.push(BusTime(at.as_micros() as u64));
    }
}

fn absences(seed: u64, has: impl Fn(FaultKind) -> bool) -> Vec<Absence> {
    let mut absences = Vec::new();
    for (kind, every, longest) in [
        (FaultKind::HostKilled, 6, 2_000),
        (FaultKind::HostStalled, 3, 600),
    ] {
        if !has(kind) {
            continue;
        }
        let mut dice = Dice::new(seed, kind.name());
        for from in times(&mut dice, Duration::from_secs(every)) {
            let lasts = dice.time(Duration::ZERO, Duration::from_millis(longest));
            absences.push(Absence {
                from,
                to: BusTime(from.0 + lasts.as_micros() as u64),
                killed: kind == FaultKind::HostKilled,
            });
        }
    }
    absences.sort_by_key(|absence| absence.from);
    absences
}

fn rates(seed: u64, has: impl Fn(FaultKind) -> bool) -> Rates {
    let mut dice = Dice::new(seed, "rates");
    let mut rate = |kind, most: f64| {
        let drawn = dice.decades(10.0, most) as u32;
        if has(kind) { drawn } else { 0 }
    };
    let corrupted = rate(FaultKind::Corrupted, 50_000.0);
    let misread = rate(FaultKind::Corrupted, 50_000.0);
    let doubled = rate(FaultKind::Doubled, 20_000.0);
    let lost = rate(FaultKind::Lost, 50_000.0);
    let mut recurring = |kind, every: u64, longest: u64| {
        let every = dice.time(
            Duration::from_millis(every / 4),
            Duration::from_millis(every),
        );
        has(kind).then_some(Recurring {
            every,
            longest: Duration::from_millis(longest),
        })
    };
    Rates {
        corrupted,
        misread,
        doubled,
        lost,
        delays: recurring(FaultKind::Delayed, 2_000, 100),
        babbling: recurring(FaultKind::Babbling, 8_000, 60),
        power_cuts: recurring(FaultKind::Reset, 8_000, 500),
        // The commander stands still by itself, so that the others on the bus go on.
        host_stalls: None,
        sync_losses: recurring(FaultKind::SyncLost, 4_000, 2_000),
        drive_troubles: recurring(FaultKind::Drive, 6_000, 300),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soak::fault::Faults;

    #[test]
    fn a_seed_is_a_robot_and_fewer_faults_leave_it_as_it_is() {
        for seed in 0..50 {
            let draw = |faults| {
                let options = Options {
                    faults,
                    ..Options::default()
                };
                Scenario::draw(seed, &options)
            };
            let (all, none) = (draw(Faults::ALL), draw(Faults::NONE));
            assert_eq!(all.configuration.axes, none.configuration.axes);
            assert_eq!(none.configuration.disturbances, Rates::default());
            assert!(none.absences.is_empty() && none.orders.is_empty());
            assert!(!none.has_rival && !none.is_hostile);
        }
    }

    #[test]
    fn robots_are_of_every_kind() {
        let robots: Vec<_> = (0..300).map(|seed| robot(seed, None)).collect();
        for count in 1..=MOST_AXES as usize {
            assert!(robots.iter().any(|axes| axes.len() == count), "{count}");
        }
        let axes = || robots.iter().flatten();
        assert!(axes().any(|axis| axis.values.settings().shaping.is_some()));
        assert!(axes().any(|axis| axis.limits().position_maximum().counts() < 0));
        assert!(axes().any(|axis| axis.limits().velocity().radians() < 1e-3));
    }
}
