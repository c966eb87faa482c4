//! What a commander sends all the time, SYNC and its heartbeat, and whose time is bus time.
//!
//! A bus has one clock. A client that hears another host's SYNC sends none: it follows that host's
//! time as the nodes do, so that both their moves start when they should. When the other host has
//! gone, the client goes on with its counter and its time, and the nodes see little of it.

use super::link::{MILLISECOND, after};
use super::{Client, ClientError};
use crate::bus::Bus;
use canter_shared::time::bus_clock::{BusClock, Discipline};
use canter_shared::time::{BusTime, LocalTime};
use canter_shared::wire::command::{Command, Session};
use canter_shared::wire::id::Address;

/// Between two SYNCs, in microseconds: some 20 ms, in which crystals of +-100 ppm part by 4 us.
///
/// Nodes send their reports around whole milliseconds, after their ticks. SYNCs at whole milliseconds too would
/// meet the same report again and again and come late each time. So each is earlier in its
/// millisecond than the one before by 1 - 0.618, the golden section, which spreads them evenly.
pub(crate) const SYNC_PERIOD: u64 = 19_618;

/// Between the first SYNCs: quick, so that the nodes' clocks settle before the first move.
const FIRST_SYNC_PERIOD: u64 = 3_618;

/// SYNCs that go out quickly, and those of them that are waited for before anything moves: 0.23 s,
/// after which 12 clocks are within 15 us.
const FIRST_SYNCS: u32 = 128;
const SETTLING_SYNCS: u64 = 64;

/// Between two host heartbeats: five within the axes' time-out of 250 ms.
pub(crate) const HEARTBEAT_PERIOD: u64 = 50 * MILLISECOND;

/// Silence of another host's SYNC after which this one takes over: before the nodes, which wait
/// for 0.5 s, take to anybody.
const TAKE_OVER: u64 = 300 * MILLISECOND;

/// Of several that could take over, each waits longer by its session's share of this.
const TAKE_OVER_SPREAD: u64 = 128 * MILLISECOND;

/// Who has sent SYNC for this long goes on with it when another host begins to send its own: it is
/// the one that the nodes follow.
const ESTABLISHED: u64 = 1_000 * MILLISECOND;

/// How long a SYNC takes on a bus of 1 Mbit/s, in microseconds: 111 to 135 bits. A clock that is
/// followed is known as of its SYNCs' arrival, so that who takes over must name that time too.
const TRANSIT: u64 = 123;

/// When SYNC and the host's heartbeat are due, in the bus's own time, and what bus time is.
#[derive(Debug, Default)]
pub(super) struct Beacon {
    /// The clock of another host as it is followed; before the first SYNC it shows the bus's own.
    clock: BusClock,
    /// Of the last SYNC, whoever sent it.
    counter: u8,
    /// Quick SYNCs that have gone out.
    quick: u32,
    next_sync: BusTime,
    next_heartbeat: BusTime,
    /// Since when this host sends SYNC, and the last one.
    sending: Option<(BusTime, BusTime)>,
}

impl Beacon {
    /// When the next thing is to be sent.
    pub(super) fn due(&self) -> BusTime {
        self.next_sync.min(self.next_heartbeat)
    }

    /// Whether this host sends SYNC and has for some time.
    fn is_established(&self, now: BusTime) -> bool {
        self.sending.is_some_and(|(since, last)| {
            now >= after(since, ESTABLISHED) && now < after(last, ESTABLISHED)
        })
    }

    /// Takes another host's SYNC; says whether it is followed.
    fn hear(&mut self, now: BusTime, counter: u8, time: BusTime, session: Session) -> bool {
        if self.is_established(now) {
            return false;
        }
        let heard = self
            .clock
            .synchronise(LocalTime(now.0), counter, time, true);
        if heard == Discipline::Ignored {
            return false;
        }
        self.counter = counter;
        self.sending = None;
        let share = (TAKE_OVER_SPREAD * u64::from(session)) >> Session::BITS;
        self.next_sync = after(now, TAKE_OVER + share);
        true
    }

    /// The SYNC that is due at `now`.
    fn sync(&mut self, now: BusTime) -> Command {
        let period = if self.quick < FIRST_SYNCS {
            self.quick += 1;
            FIRST_SYNC_PERIOD
        } else {
            SYNC_PERIOD
        };
        self.next_sync = after(now, period);
        let since = match self.sending {
            Some((since, last)) if now < after(last, ESTABLISHED) => since,
            _ => now,
        };
        self.sending = Some((since, now));
        self.counter = self.counter.wrapping_add(1);
        Command::Sync {
            counter: self.counter,
            time: self.named(now),
        }
    }

    /// What a SYNC says that is sent at `now`.
    fn named(&self, now: BusTime) -> BusTime {
        let time = self.clock.bus_time(LocalTime(now.0));
        if self.clock.is_synchronised() {
            after(time, TRANSIT)
        } else {
            time
        }
    }
}

impl<B: Bus> Client<B> {
    /// Bus time: the bus's own clock, or that of another host whose SYNC is followed.
    pub fn bus_time(&self) -> BusTime {
        let now = self.bus.now();
        self.beacon.clock.bus_time(LocalTime(now.0))
    }

    pub(super) fn hear_sync(&mut self, now: BusTime, counter: u8, time: BusTime) {
        if !self.beacon.hear(now, counter, time, self.session) && self.beacon.is_established(now) {
            self.complain(String::from(
                "another host sends SYNC while this one does: the nodes follow one of them, so \
                 start one host after the other",
            ));
        }
    }

    /// Sends SYNC and the host's heartbeat where they are due.
    pub(super) fn send_beacon(&mut self) -> Result<(), ClientError> {
        let now = self.bus.now();
        if now >= self.beacon.next_heartbeat {
            self.beacon.next_heartbeat = after(now, HEARTBEAT_PERIOD);
            let session = self.session;
            self.tell(Address::All, Command::HostHeartbeat { session })?;
        }
        if now >= self.beacon.next_sync {
            // Asked for last, so that little can come between it and the send.
            let sync = self.beacon.sync(self.bus.now());
            self.tell(Address::All, sync)?;
        }
        Ok(())
    }

    /// Starts the quick SYNCs over and waits for half of them: the nodes' clocks agree then. Another
    /// host's SYNCs are waited for as long.
    pub(super) fn settle_clocks(&mut self) -> Result<(), ClientError> {
        self.beacon.quick = 0;
        if self.beacon.sending.is_some() {
            self.beacon.next_sync = self.bus.now();
        }
        let settling = (SETTLING_SYNCS + 1) * FIRST_SYNC_PERIOD;
        let until = after(self.bus.now(), settling);
        self.wait(until, |_| false)?;
        Ok(())
    }
}
