//! What goes wrong at random: [`Rates`] and a seed make [`Disturbance`]s.

use std::time::Duration;

use canter_shared::wire::frame::{Frame, MAXIMUM_LENGTH};

use super::Rates;
use super::clock::{NEVER, TrueTime};
use super::disturbance::{Babble, Disturbance, DriveTrouble, Recurring};
use super::random::SplitMix64;

/// Kinds of what recurs.
const KINDS: usize = 6;

/// The shortest time from one to the next of a kind: 1 us, so that the time goes on.
const SHORTEST: u64 = 1_000;

/// All that goes wrong by chance, apart from the chance of a bus without faults: without rates
/// it draws nothing, and one more fault does not change the crystals.
#[derive(Debug)]
pub(super) struct Chance {
    rates: Rates,
    random: SplitMix64,
    nodes: usize,
    /// When each kind happens next.
    next: [TrueTime; KINDS],
    due: TrueTime,
}

impl Chance {
    pub(super) fn new(rates: Rates, seed: u64, nodes: usize) -> Self {
        let mut chance = Self {
            rates,
            // Any other stream than that of the bus.
            random: SplitMix64::new(!seed),
            nodes,
            next: [NEVER; KINDS],
            due: NEVER,
        };
        chance.change(TrueTime::default(), rates);
        chance
    }

    /// Other rates from now on.
    pub(super) fn change(&mut self, now: TrueTime, rates: Rates) {
        self.rates = rates;
        for kind in 0..KINDS {
            self.next[kind] = self.after(now, kind);
        }
        self.due = self.next.iter().copied().min().unwrap_or(NEVER);
    }

    /// When something happens next.
    pub(super) fn due(&self) -> TrueTime {
        self.due
    }

    /// The next thing that happens by `now`.
    pub(super) fn take(&mut self, now: TrueTime) -> Option<Disturbance> {
        let kind = self.next.iter().position(|next| *next <= now)?;
        self.next[kind] = self.after(now, kind);
        self.due = self.next.iter().copied().min().unwrap_or(NEVER);
        Some(self.draw(kind))
    }

    fn recurring(&self, kind: usize) -> Option<Recurring> {
        [
            self.rates.delays,
            self.rates.babbling,
            self.rates.power_cuts,
            self.rates.host_stalls,
            self.rates.sync_losses,
            self.rates.drive_troubles,
        ][kind]
    }

    fn after(&mut self, now: TrueTime, kind: usize) -> TrueTime {
        let Some(recurring) = self.recurring(kind) else {
            return NEVER;
        };
        let twice = nanoseconds(recurring.every).saturating_mul(2);
        now.after(self.random.up_to(twice).max(SHORTEST))
    }

    fn draw(&mut self, kind: usize) -> Disturbance {
        let longest = self.recurring(kind).map_or(0, |it| nanoseconds(it.longest));
        let time = Duration::from_nanos(self.random.up_to(longest));
        let node = self.node();
        match kind {
            0 => Disturbance::Delay { node, time },
            1 => {
                let what = match self.random.up_to(1) {
                    0 => Babble::Anything,
                    _ => Babble::Frame(self.frame()),
                };
                Disturbance::Babble { what, time }
            }
            2 => Disturbance::CutPower { node, time },
            3 => Disturbance::StallHost { time },
            4 => Disturbance::LoseSync { time },
            _ => {
                let trouble = match self.random.up_to(3) {
                    0 => DriveTrouble::Fault,
                    1 => DriveTrouble::Disable,
                    2 => DriveTrouble::Silence,
                    _ => DriveTrouble::Blocked,
                };
                Disturbance::Drive {
                    node,
                    trouble,
                    time,
                }
            }
        }
    }

    fn node(&mut self) -> usize {
        self.random.up_to((self.nodes as u64).saturating_sub(1)) as usize
    }

    /// A frame of any identifier, length and bytes.
    pub(super) fn frame(&mut self) -> Frame {
        let id = self.random.up_to(0x7FF) as u16;
        let length = self.random.up_to(MAXIMUM_LENGTH as u64) as usize;
        let bytes = self.random.next().to_le_bytes();
        Frame::new(id, &bytes[..length]).expect("an identifier of 11 bits and at most 8 bytes")
    }

    /// A number from 1 to `greatest`.
    pub(super) fn one_to(&mut self, greatest: u32) -> u32 {
        1 + self.random.up_to(u64::from(greatest.saturating_sub(1))) as u32
    }

    fn hits(&mut self, of_a_million: u32) -> bool {
        of_a_million > 0 && self.random.up_to(999_999) < u64::from(of_a_million)
    }

    /// Whether this frame is corrupted.
    pub(super) fn corrupts(&mut self) -> bool {
        self.hits(self.rates.corrupted)
    }

    /// The node that misreads this frame.
    pub(super) fn misreader(&mut self) -> Option<usize> {
        self.hits(self.rates.misread).then(|| self.node())
    }

    /// The node that has this frame once and the others twice.
    pub(super) fn doubler(&mut self) -> Option<usize> {
        self.hits(self.rates.doubled).then(|| self.node())
    }

    /// Whether this reception is lost.
    pub(super) fn loses(&mut self) -> bool {
        self.hits(self.rates.lost)
    }
}

/// As much as 64 bits hold, 584 years.
pub(super) fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
