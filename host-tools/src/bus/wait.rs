//! The real buses' clock, and waiting until an instant of it.

use std::cell::Cell;
use std::io;
use std::os::fd::BorrowedFd;
use std::time::Duration;

use canter_shared::time::BusTime;
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::prctl;
use nix::sys::time::TimeSpec;
use nix::time::{ClockId, clock_gettime};

/// The machine's CLOCK_MONOTONIC as bus time: the same for every process on it.
pub fn monotonic_time() -> BusTime {
    BusTime(microseconds(ClockId::CLOCK_MONOTONIC))
}

/// A clock in microseconds, which the kernel always has and which does not show less than zero.
fn microseconds(clock: ClockId) -> u64 {
    clock_gettime(clock).map_or(0, |time| Duration::from(time).as_micros() as u64)
}

/// How far the machine's wall clock, which the kernel stamps arrivals with, is ahead.
#[derive(Debug)]
pub(super) struct WallClock {
    /// Wall clock less CLOCK_MONOTONIC, in microseconds.
    lead: i64,
    compared: BusTime,
}

impl WallClock {
    /// How long a comparison holds, in microseconds. The kernel steers both clocks alike: only one that is
    /// set goes wrong, by so little that it is not seen, and for no longer than this.
    const COMPARISON_HOLDS: u64 = 100_000;

    /// How far outside the possible an arrival may seem before the wall clock counts as set, in
    /// microseconds: the thread may have been put aside within a comparison.
    const TOLERANCE: u64 = 1_000;

    /// The wall clock as it is now.
    pub(super) fn new() -> Self {
        // The thread may be put aside between two readings, and the narrowest of a few
        // brackets errs the least.
        let (_, lead, compared) = (0..4)
            .map(|_| {
                let before = microseconds(ClockId::CLOCK_MONOTONIC);
                let wall = microseconds(ClockId::CLOCK_REALTIME);
                let after = microseconds(ClockId::CLOCK_MONOTONIC);
                let middle = before + (after - before) / 2;
                (after - before, wall as i64 - middle as i64, after)
            })
            .min()
            .unwrap_or_default();
        Self {
            lead,
            compared: BusTime(compared),
        }
    }

    /// The bus time at which the wall clock showed `wall`, in microseconds, which was at or after `earliest`
    /// and before `now`, the present.
    pub(super) fn bus_time(&mut self, wall: u64, earliest: BusTime, now: BusTime) -> BusTime {
        let possible = earliest.0.saturating_sub(Self::TOLERANCE)..=now.0 + Self::TOLERANCE;
        let is_old = now.0.saturating_sub(self.compared.0) > Self::COMPARISON_HOLDS;
        if is_old || !possible.contains(&self.shown(wall).0) {
            *self = Self::new();
        }
        self.shown(wall).min(now).max(earliest)
    }

    fn shown(&self, wall: u64) -> BusTime {
        BusTime(wall.saturating_add_signed(self.lead.saturating_neg()))
    }
}

/// Waits until `descriptor` is ready for one of `interest`, or has failed; gives what it is
/// ready for, or nothing where `until` has passed first.
pub(super) fn wait(
    descriptor: BorrowedFd<'_>,
    interest: PollFlags,
    until: BusTime,
) -> io::Result<PollFlags> {
    sharpen_timers();
    loop {
        let left = until.0.saturating_sub(monotonic_time().0);
        let mut polled = [PollFd::new(descriptor, interest)];
        let timeout = TimeSpec::from_duration(Duration::from_micros(left));
        match ppoll(&mut polled, Some(timeout), None) {
            Ok(_) => return Ok(polled[0].revents().unwrap_or(PollFlags::empty())),
            Err(Errno::EINTR) => {}
            Err(errno) => return Err(errno.into()),
        }
    }
}

/// Asks the kernel not to delay this thread's timers: by default it may add 50 us to each wait,
/// which a loop at 1 kHz would see as jitter.
fn sharpen_timers() {
    thread_local!(static SHARPENED: Cell<bool> = const { Cell::new(false) });
    if !SHARPENED.replace(true) {
        // A kernel that refuses leaves the waits as they are, 50 us coarser.
        let _ = prctl::set_timerslack(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_wall_clock_shows_now_is_now() {
        let before = monotonic_time();
        let wall_clock = WallClock::new();
        let wall = microseconds(ClockId::CLOCK_REALTIME);
        let now = monotonic_time();
        let shown = wall_clock.shown(wall);
        // Each reading is cut to whole microseconds, and the bracket's middle is a guess.
        let bracket = now.0 - before.0 + 3;
        assert!(shown.0.abs_diff(now.0) <= bracket, "{shown:?} {now:?}");
    }

    #[test]
    fn an_old_comparison_is_made_anew() {
        let now = monotonic_time();
        let mut wall_clock = WallClock {
            lead: 0,
            compared: BusTime(now.0 - WallClock::COMPARISON_HOLDS),
        };
        let wall = now.0 - 5;
        assert_eq!(wall_clock.bus_time(wall, BusTime(0), now), BusTime(wall));
        wall_clock.bus_time(wall, BusTime(0), BusTime(now.0 + 1));
        assert_ne!(wall_clock.lead, 0);
    }

    #[test]
    fn a_clock_that_was_set_is_noticed_at_once() {
        for ahead in [-3_600_000_000, -2_000, 2_000, 3_600_000_000] {
            let earliest = monotonic_time();
            let mut wall_clock = WallClock::new();
            let right = wall_clock.lead;
            wall_clock.lead += ahead;
            let wall = microseconds(ClockId::CLOCK_REALTIME);
            let now = monotonic_time();
            let arrived = wall_clock.bus_time(wall, earliest, now);
            assert!((earliest..=now).contains(&arrived));
            assert!(wall_clock.lead.abs_diff(right) < 1_000, "{ahead}");
        }
    }
}
