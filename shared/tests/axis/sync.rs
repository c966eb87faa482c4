//! SYNC that stops, jumps, comes twice, or comes from two hosts.

use super::bench::trapezoid;
use super::node_bench::{NodeBench, OFFSET};
use canter_shared::drive::simulated::Simulated;
use canter_shared::time::bus_clock::{BusClock, Discipline};
use canter_shared::time::{BusTime, LocalTime};

/// Between two SYNCs of a host, in microseconds.
const PERIOD: u64 = 20_000;

/// A clock on a crystal that is `ppm` fast, and the bus that it listens to.
struct Listener {
    clock: BusClock,
    ppm: i64,
    /// True time in microseconds; bus time is ahead of it by `offset`.
    now: u64,
    offset: u64,
    counter: u8,
    random: u64,
    may_step: bool,
}

impl Listener {
    /// One that has heard five seconds of SYNCs, each received up to 20 us late.
    fn settled(ppm: i64, seed: u64) -> Self {
        let mut listener = Self {
            clock: BusClock::new(),
            ppm,
            now: 1_000_000,
            offset: OFFSET,
            counter: 0,
            random: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15),
            may_step: true,
        };
        listener.listen(5_000_000);
        listener
    }

    fn local(&self, time: u64) -> LocalTime {
        LocalTime(time.saturating_add_signed(time as i64 * self.ppm / 1_000_000))
    }

    fn listen(&mut self, microseconds: u64) {
        for _ in 0..microseconds / PERIOD {
            self.random = self
                .random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let received = self.local(self.now + (self.random >> 33) % 21);
            let sent = BusTime(self.now + self.offset);
            self.counter = self.counter.wrapping_add(1);
            self.clock
                .synchronise(received, self.counter, sent, self.may_step);
            self.now += PERIOD;
        }
    }

    /// Bus time as shown minus bus time as it is, in microseconds.
    fn error(&self) -> i64 {
        let shown = self.clock.bus_time(self.local(self.now)).0;
        shown.wrapping_sub(self.now + self.offset) as i64
    }
}

/// Every crystal and some seeds.
fn listeners() -> impl Iterator<Item = Listener> {
    [-100, -37, 0, 63, 100]
        .into_iter()
        .flat_map(|ppm| (1..=20).map(move |seed| Listener::settled(ppm, seed)))
}

#[test]
fn without_sync_a_clock_runs_on_at_the_rate_that_it_has_learned() {
    for mut listener in listeners() {
        for (silence, bound) in [(10_000_000, 100), (50_000_000, 500)] {
            listener.now += silence;
            let error = listener.error();
            assert!(error.abs() <= bound, "off by {error} us");
        }
        // And is back at once.
        listener.listen(2 * PERIOD);
        let error = listener.error();
        assert!(error.abs() <= 25, "off by {error} us afterwards");
    }
}

#[test]
fn a_small_jump_of_the_host_s_clock_is_followed_at_rest() {
    for jump in [100, 400, 5_000, 49_000, -100, -400, -5_000, -49_000] {
        for mut listener in listeners() {
            listener.offset = OFFSET.saturating_add_signed(jump);
            // Forward with the next point; backward it could be delay, until eight points say so.
            listener.listen(if jump > 0 { 360_000 } else { 3_100_000 });
            let error = listener.error();
            assert!(error.abs() <= 35, "{jump} us: off by {error} us");
        }
    }
}

#[test]
fn a_small_jump_of_the_host_s_clock_is_made_up_for_slowly_in_motion() {
    for jump in [100, 400, -100, -400] {
        for mut listener in listeners() {
            listener.may_step = false;
            listener.offset = OFFSET.saturating_add_signed(jump);
            let mut shown = listener.clock.bus_time(listener.local(listener.now)).0;
            for _ in 0..(3_100_000 + jump.unsigned_abs() * 5_000) / PERIOD {
                listener.listen(PERIOD);
                let now = listener.clock.bus_time(listener.local(listener.now)).0;
                let part = (now - shown) as f64 / PERIOD as f64 - 1.0;
                // 200 ppm, what little the rate is wrong, and a microsecond of each reading.
                assert!(part.abs() <= 220e-6 + 1.0 / PERIOD as f64, "{part}");
                shown = now;
            }
            let error = listener.error();
            assert!(error.abs() <= 35, "{jump} us: off by {error} us");
        }
    }
}

/// A jump that is too large for drift is taken for another host's clock: it counts when the old
/// one has been silent for half a second, and at rest.
#[test]
fn a_large_jump_waits_for_silence_and_rest() {
    for jump in [-400_000_000, -60_000, 5_000_000] {
        let mut listener = Listener::settled(50, 7);
        listener.offset = OFFSET.saturating_add_signed(jump);
        listener.may_step = false;
        listener.listen(3_000_000);
        let error = listener.error();
        assert!((error + jump).abs() <= 100, "{jump} us: {error} in motion");
        listener.may_step = true;
        listener.listen(2 * PERIOD);
        let error = listener.error();
        assert!(error.abs() <= 25, "{jump} us: off by {error} us at rest");
        // At rest all the time it takes the half second.
        listener.offset = listener.offset.saturating_add_signed(jump);
        listener.listen(480_000);
        let error = listener.error();
        assert!((error + jump).abs() <= 50, "{jump} us: {error} too soon");
        listener.listen(2 * PERIOD);
        let error = listener.error();
        assert!(error.abs() <= 25, "{jump} us: off by {error} us");
    }
}

/// The SYNCs before it were late, the first one among them.
#[test]
fn a_sync_that_is_far_ahead_sets_the_clock_at_rest() {
    for late in [60_000, 900_000] {
        let mut listener = Listener::settled(50, 7);
        listener.offset += late;
        listener.may_step = false;
        listener.listen(PERIOD);
        let error = listener.error();
        assert!(error.abs_diff(-(late as i64)) <= 25, "{error} in motion");
        listener.may_step = true;
        listener.listen(PERIOD);
        let error = listener.error();
        assert!(error.abs() <= 25, "{late} us: off by {error} us");
    }
}

#[test]
fn a_sync_that_comes_twice_counts_once() {
    let mut listener = Listener::settled(0, 1);
    let received = listener.local(listener.now + 300);
    let sent = BusTime(listener.now + OFFSET);
    let clock = &mut listener.clock;
    let mut hear = |counter: u8| clock.synchronise(received, counter, sent, true);
    let counter = listener.counter;
    assert_eq!(hear(counter), Discipline::Ignored);
    assert_eq!(hear(counter.wrapping_add(1)), Discipline::Sampled);
    assert_eq!(hear(counter.wrapping_add(1)), Discipline::Ignored);
}

#[test]
fn lost_syncs_do_not_end_a_source() {
    for lost in [1, 5, 15] {
        let mut listener = Listener::settled(100, 3);
        listener.counter = listener.counter.wrapping_add(lost);
        listener.now += u64::from(lost) * PERIOD;
        // Not a millisecond near the old time, so that nothing but the number speaks for it.
        listener.offset += 2_000;
        listener.listen(2 * PERIOD + 320_000);
        let error = listener.error();
        assert!(error.abs() <= 25, "{lost} lost: off by {error} us");
    }
}

/// Hosts with clocks of their own: which one a node follows, and for how long.
struct TwoHosts {
    bench: NodeBench<Simulated>,
    /// What each host's clock is ahead of the node's, and how often it has sent.
    hosts: [(u64, u8); 2],
}

impl TwoHosts {
    fn new(bench: NodeBench<Simulated>, other: u64) -> Self {
        let first = bench.node.bus_time(LocalTime(bench.now)).0 - bench.now;
        Self {
            bench,
            hosts: [(first, 1), (other, 101)],
        }
    }

    /// Those that speak do so in turn.
    fn run(&mut self, speak: [bool; 2], microseconds: u64) {
        for _ in 0..microseconds / PERIOD {
            for ((offset, counter), _) in self
                .hosts
                .iter_mut()
                .zip(speak)
                .filter(|(_, speaks)| *speaks)
            {
                *counter = counter.wrapping_add(1);
                let time = self.bench.now + *offset;
                self.bench.sync_numbered(*counter, time);
                self.bench.run(PERIOD / 4);
            }
            self.bench
                .run(PERIOD - PERIOD / 4 * speak.map(u64::from).iter().sum::<u64>());
        }
    }

    #[track_caller]
    fn follows(&self, host: usize) {
        let shown = self.bench.node.bus_time(LocalTime(self.bench.now)).0;
        let off = shown.abs_diff(self.bench.now + self.hosts[host].0);
        assert!(off <= 25, "{off} us off host {host}");
    }
}

/// Far apart, and within what a SYNC may be late by: then only the numbers tell them apart.
const OTHERS: [u64; 3] = [OFFSET * 7, 5_000_000, OFFSET + 12_000];

#[test]
fn a_second_host_is_not_heard_while_the_first_one_speaks() {
    for other in OTHERS {
        let mut hosts = TwoHosts::new(NodeBench::enabled(), other);
        hosts.run([true, false], 500_000);
        hosts.bench.sent.clear();
        hosts.run([true, true], 5_000_000);
        hosts.follows(0);
        let ticks = hosts.bench.sent.windows(2);
        for pair in ticks {
            assert_eq!(pair[1].setpoint.tick.0, pair[0].setpoint.tick.0 + 1);
        }
    }
}

#[test]
fn a_second_host_is_followed_when_the_first_one_falls_silent() {
    for other in OTHERS {
        let mut hosts = TwoHosts::new(NodeBench::enabled(), other);
        hosts.run([true, true], 500_000);
        hosts.run([false, true], 460_000);
        hosts.follows(0);
        hosts.run([false, true], 140_000);
        hosts.follows(1);
        // And then the first one is the second.
        hosts.run([true, true], 2_000_000);
        hosts.follows(1);
    }
}

#[test]
fn a_second_host_is_not_followed_before_the_axes_rest() {
    let mut bench = NodeBench::enabled();
    bench.send(trapezoid(3, 20.0, 10_000));
    let mut hosts = TwoHosts::new(bench, OFFSET * 7);
    hosts.run([true, true], 500_000);
    hosts.run([false, true], 9_000_000);
    assert!(hosts.bench.axis().is_moving());
    hosts.follows(0);
    hosts.run([false, true], 1_000_000);
    assert!(!hosts.bench.axis().is_moving());
    hosts.follows(1);
}

/// The next program on the same machine has the same clock and counts from anywhere.
#[test]
fn a_host_that_tells_the_same_time_is_followed_at_once() {
    let mut listener = Listener::settled(100, 9);
    // From 7 behind on; then the numbers go on from there.
    listener.counter = listener.counter.wrapping_sub(7);
    for _ in 0..3 {
        listener.counter = listener.counter.wrapping_add(1);
        let sent = BusTime(listener.now + OFFSET);
        let received = listener.local(listener.now);
        let heard = listener
            .clock
            .synchronise(received, listener.counter, sent, true);
        assert_ne!(heard, Discipline::Ignored);
        listener.now += PERIOD;
    }
}
