//! The figures, held to 200 us to either side of the tick's instant.
//!
//! A frame of 8 bytes is 111 to 135 bits long, so of three at 1 Mbit/s the third begins 222 to 270 us after the
//! first: a tick runs ahead of its instant by as much as has the three leave around it.

use canter_shared::drive::settings::DriveKind;
use canter_tests::measurement;

use super::rig::{AXES, HANDING_OVER, LEAD, Rig, Sent, Setup};

/// In nanoseconds: how far from its tick's instant a setpoint leaves, and when it is to be through.
const LEAVES: i64 = 200_000;
const THROUGH: i64 = (1_000_000 - LEAD) as i64;

/// How full the bus may be.
const FULL: f64 = 0.85;

/// Nanoseconds of a bit.
const BIT: i64 = 1_000;

/// Buses whose drives begin their milliseconds at other times, and the moves on each.
const BUSES: u64 = 20;
const MOVES: u64 = 4;

/// Three drives that begin their milliseconds while no setpoint is on the bus.
fn apart(kind: DriveKind) -> Setup {
    Setup {
        kind,
        estimates: 1,
        phases: [450_000, 580_000, 710_000],
        fast: [0; AXES],
        reaction: 20_000,
        ids: [1, 2, 3],
        rated_torque: 0.0,
    }
}

/// The same with crystals of +-100 ppm that began at any time.
fn anyhow(setup: Setup, bus: u64) -> Setup {
    let mut setup = setup;
    for at in 0..AXES {
        // A golden ratio in 64 bits: its multiples lie everywhere.
        let number = (bus * AXES as u64 + at as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        setup.phases[at] = (number >> 20) % 1_000_000;
        setup.fast[at] = ((number >> 40) % 201) as i64 - 100;
    }
    setup
}

/// What was measured of the setpoints that left first, second and third.
struct Times {
    name: String,
    starts: [Vec<i64>; AXES],
    ends: [Vec<i64>; AXES],
    load: f64,
}

impl Times {
    fn of(name: &str, setups: impl IntoIterator<Item = Setup>) -> Self {
        let mut times = Self {
            name: name.to_owned(),
            starts: Default::default(),
            ends: Default::default(),
            load: 0.0,
        };
        for setup in setups {
            let mut rig = Rig::new(&setup);
            rig.enable();
            let before = rig.load();
            rig.keep_moving(MOVES);
            times.load = times.load.max(rig.load().since(before).share());
            assert_eq!(rig.clashes(), 0, "{setup:?}");
            // All axes moved at nearly every tick, and each had its setpoint at every one.
            assert!(
                rig.moving * 100 >= rig.ticks * AXES as u64 * 99,
                "{setup:?}"
            );
            let whole = rig.sent.len() as u64 / AXES as u64;
            assert!(whole >= rig.ticks - 1, "{whole} of {}", rig.ticks);
            for tick in rig.sent.chunks_exact(AXES) {
                times.add(tick);
            }
        }
        times
    }

    fn add(&mut self, tick: &[Sent]) {
        let mut axes: Vec<_> = tick.iter().map(|sent| sent.axis).collect();
        axes.sort_unstable();
        assert_eq!(axes, [0, 1, 2], "{tick:?}");
        for (place, sent) in tick.iter().enumerate() {
            self.starts[place].push(sent.start);
            self.ends[place].push(sent.end);
        }
    }

    /// Prints it, with what misses its bound; gives the earliest and the largest starts.
    fn tell(&self) -> [(i64, i64); AXES] {
        let starts = ranges(&self.starts);
        let missed = if starts.iter().all(|start| in_time(*start)) {
            ""
        } else {
            ", missed"
        };
        let name = &self.name;
        let largest = |ranges: [(i64, i64); AXES]| ranges.map(|range| range.1 as f64);
        let ends = ranges(&self.ends);
        for (what, value, bound) in [
            (
                "leave, earliest",
                words(starts.map(|start| start.0 as f64)),
                "+-200 us".to_owned(),
            ),
            (
                "leave, largest",
                words(largest(starts)),
                format!("+-200 us{missed}"),
            ),
            ("leave, mean", words(means(&self.starts)), "-".to_owned()),
            (
                "through, largest",
                words(largest(ends)),
                format!("<= {} us", THROUGH / 1_000),
            ),
            ("through, mean", words(means(&self.ends)), "-".to_owned()),
        ] {
            let what = format!("{name}: setpoints 1, 2, 3 {what}");
            measurement("fast", &what, &value, &bound);
        }
        let load = format!("{:.1} %", 100.0 * self.load);
        measurement("fast", &format!("{name}: load"), &load, "< 85 %");
        assert!(self.load < FULL, "{name}: {load}");
        assert!(ends.iter().all(|end| end.1 <= THROUGH), "{name}: {ends:?}");
        starts
    }

    /// All leave in time, each as soon as the frames of `bits` at most before it let it, after one of `before`
    /// bits that was on the bus already.
    fn hold(&self, bits: i64, before: i64) {
        let starts = self.tell();
        for (place, start) in starts.into_iter().enumerate() {
            let name = &self.name;
            assert!(in_time(start), "{name}: {place} leaves at {start:?}");
            let soon = (HANDING_OVER as i64 - LEAD as i64) + (place as i64 * bits + before) * BIT;
            assert!(start.1 <= soon, "{name}: {place} is over {soon}: {start:?}");
        }
    }
}

fn in_time((earliest, largest): (i64, i64)) -> bool {
    -LEAVES <= earliest && largest <= LEAVES
}

fn ranges(times: &[Vec<i64>; AXES]) -> [(i64, i64); AXES] {
    times.each_ref().map(|own| {
        let least = own.iter().copied().min().expect("ticks");
        (least, own.iter().copied().max().expect("ticks"))
    })
}

fn means(times: &[Vec<i64>; AXES]) -> [f64; AXES] {
    times
        .each_ref()
        .map(|own| own.iter().sum::<i64>() as f64 / own.len() as f64)
}

fn words(nanoseconds: [f64; AXES]) -> String {
    let [first, second, third] = nanoseconds.map(|time| time * 1e-3);
    format!("{first:.0}, {second:.0}, {third:.0} us")
}

/// Nothing is on the bus at a tick, unless it is a drive that tells its place when it likes.
#[test]
fn setpoints_of_three_odrives_leave_within_200_us_where_the_drives_speak_between_them() {
    Times::of(
        "odrive, estimates between setpoints",
        [apart(DriveKind::Odrive)],
    )
    .hold(135, 0);
}

/// Its crystal is its own, so a drive that tells its place of its own accord comes in between sooner or later.
#[test]
fn setpoints_are_through_before_the_next_tick_whenever_odrives_speak() {
    for estimates in [1, 10] {
        let setup = Setup {
            estimates,
            ..apart(DriveKind::Odrive)
        };
        let buses = (0..BUSES).map(|bus| anyhow(setup, bus));
        Times::of(
            &format!("odrive, estimates each {estimates} ms, at any time"),
            buses,
        )
        .tell();
    }
}

/// Drives in the mini-cheetah mode speak only when they are spoken to, at once or after some time.
#[test]
fn no_answer_goes_before_a_setpoint_to_the_drives_of_mini_cheetahs() {
    for reaction in [0, 20_000, 100_000] {
        let setup = Setup {
            reaction,
            ..apart(DriveKind::Mit)
        };
        let buses = (0..4).map(|bus| anyhow(setup, bus));
        Times::of(
            &format!("mit, answers after {} us", reaction / 1_000),
            buses,
        )
        .hold(135, 0);
    }
}

/// They tell their places after the SYNC, which is the last; only a heartbeat may come in between.
#[test]
fn setpoints_of_three_canopen_drives_leave_within_200_us() {
    let buses = (0..BUSES).map(|bus| anyhow(apart(DriveKind::Cia402), bus));
    Times::of("cia402", buses).hold(115, 65);
}

/// Three frames of 8 bytes, and a heartbeat may come before the first.
#[test]
fn setpoints_of_canopen_drives_with_a_torque_offset_leave_within_200_us() {
    let setup = Setup {
        rated_torque: 2.0,
        ..apart(DriveKind::Cia402)
    };
    let buses = (0..BUSES).map(|bus| anyhow(setup, bus));
    Times::of("cia402 with torque", buses).hold(135, 65);
}
