//! Frames from station to station: who begins, how it ends, and who gets it.

use canter_shared::wire::frame::Frame;

use super::SimulatedBus;
use super::bits;
use super::clock::TrueTime;
use super::contest::{Contender, Outcome, decide};
use super::controller::{Controller, NOTHING};
use super::fault_confinement::{ErrorCounters, ErrorState};
use super::medium::{Fate, OnWire, Transmission};
use super::observer::Destruction;
use super::station::Station;

/// Bits from the acknowledge slot on to the end of a frame.
const AFTER_ACKNOWLEDGE: u32 = 8;

impl SimulatedBus {
    /// When somebody begins a frame, if nothing else happens before; never while one is under way.
    pub(super) fn begins(&self) -> Option<TrueTime> {
        let free = self.medium.free()?;
        if self.lowest == NOTHING {
            return None;
        }
        if self.suspended <= free {
            return Some(free);
        }
        let waiting = self
            .controllers
            .iter()
            .filter(|one| one.wanted() != NOTHING);
        waiting.map(|one| one.suspended().max(free)).min()
    }

    /// Lets those begin that want to, where the bus is free.
    pub(super) fn begin(&mut self) {
        if self.medium.free().is_none_or(|free| free > self.now) {
            return;
        }
        let mut lowest = self.lowest;
        if lowest == NOTHING {
            return;
        }
        let now = self.now;
        if self.suspended > now {
            let may = self.controllers.iter().filter(|one| one.suspended() <= now);
            lowest = may.map(|one| one.wanted()).min().unwrap_or(NOTHING);
            if lowest == NOTHING {
                return;
            }
        }
        self.count_recessive();
        let senders = self.wanted.iter().zip(&self.controllers).enumerate();
        let senders = senders
            .filter(|(_, (wanted, one))| **wanted == lowest && one.suspended() <= now)
            .map(|(place, _)| place);
        self.medium.line_up(senders);
        let collision = self.contest();
        // Those that gave up have left the bus to what the others send.
        let Some((sender, frame)) = self.first_sender() else {
            return;
        };
        let bits = bits::length(&frame);
        let fate = collision.unwrap_or_else(|| self.fate(bits));
        self.medium.begin(now, sender, frame, bits, fate);
    }

    /// The first of those that send, and its frame.
    fn first_sender(&self) -> Option<(usize, Frame)> {
        let place = *self.medium.senders().first()?;
        Some((place, *self.controllers[place].first()?))
    }

    /// Several begin at once: what comes of that, unless one frame is left.
    fn contest(&mut self) -> Option<Fate> {
        if self.medium.senders().len() < 2 {
            return None;
        }
        let contender = |place: &usize| {
            let controller = &self.controllers[*place];
            controller.first().map(|frame| Contender {
                place: *place,
                frame: *frame,
                error_active: controller.state() == ErrorState::ErrorActive,
            })
        };
        let contenders = self.medium.senders().iter().filter_map(contender);
        match decide(contenders.collect()) {
            Outcome::Destroyed(bits) => {
                let cause = Destruction::Collision;
                Some(Fate::Destroyed { bits, cause })
            }
            Outcome::Decided { given_up } => {
                for place in given_up {
                    self.medium.give_up(place);
                }
                None
            }
        }
    }

    /// What becomes of a frame of `bits` bits that the stations in the line-up send.
    fn fate(&mut self, bits: u32) -> Fate {
        if !(0..self.controllers.len()).any(|place| self.receives(place)) {
            let cause = Destruction::NotAcknowledged;
            let bits = bits - AFTER_ACKNOWLEDGE;
            return Fate::Destroyed { bits, cause };
        }
        if self.chance.corrupts() || take(&mut self.corruptions) {
            let cause = Destruction::Disturbed;
            let bits = self.chance.one_to(bits - 1);
            return Fate::Destroyed { bits, cause };
        }
        if let Some(place) = self.misreader() {
            if self.controllers[place].state() == ErrorState::ErrorActive {
                let cause = Destruction::Misread(self.station(place));
                let bits = self.chance.one_to(bits - 1);
                return Fate::Destroyed { bits, cause };
            }
            self.medium.miss(place);
            return Fate::Whole;
        }
        if let Some(but) = self.doubler() {
            if self.controllers[but].state() == ErrorState::ErrorActive {
                return Fate::Doubled { but };
            }
            self.medium.miss(but);
        }
        Fate::Whole
    }

    /// Whether the station at `place` would receive the frame that is about to begin.
    fn receives(&self, place: usize) -> bool {
        self.controllers[place].listens(self.now) && self.medium.receives(place)
    }

    /// Who misreads the frame that is about to begin.
    fn misreader(&mut self) -> Option<usize> {
        let by_chance = self.chance.misreader().map(|node| node + 1);
        by_chance
            .filter(|place| self.receives(*place))
            .or_else(|| self.marked(|one| &mut one.misreads))
    }

    /// Who sees an error in the last bit but one of the frame that is about to begin.
    fn doubler(&mut self) -> Option<usize> {
        let by_chance = self.chance.doubler().map(|node| node + 1);
        by_chance
            .filter(|place| self.receives(*place))
            .or_else(|| self.marked(|one| &mut one.doubles))
    }

    /// The first receiver that is to do something wrong so many times more; takes one of them away.
    fn marked(&mut self, times: impl Fn(&mut Controller) -> &mut u32) -> Option<usize> {
        if !self.has_marks {
            return None;
        }
        let place = (0..self.controllers.len()).find(|place| {
            let wanted = *times(&mut self.controllers[*place]) > 0;
            wanted && self.receives(*place)
        })?;
        *times(&mut self.controllers[place]) -= 1;
        Some(place)
    }

    /// The frame under way is over, if it is.
    pub(super) fn finish(&mut self) {
        let Some(ended) = self.medium.finish(self.now) else {
            return;
        };
        match ended.fate {
            Fate::Whole => {
                self.deliver(&ended, None);
                self.count_lapses();
                if let Some(observer) = &mut self.observer {
                    observer.frame(&Transmission {
                        start: ended.start,
                        end: ended.end,
                        bits: ended.bits,
                        sender: Station::at(ended.sender, self.devices.len()),
                        frame: ended.frame,
                    });
                }
            }
            Fate::Doubled { but } => {
                self.deliver(&ended, Some(but));
                self.destroy(&ended, Destruction::Misread(self.station(but)), false);
            }
            Fate::Destroyed { cause, .. } => self.destroy(&ended, cause, true),
        }
        self.suspend();
    }

    /// A frame is given to all that heard it, except to `but` and, as its sender knows of that,
    /// without telling the sender.
    fn deliver(&mut self, ended: &OnWire, but: Option<usize>) {
        let sender = self.station(ended.sender);
        // The nodes in their order, then the stranger, then the host.
        let places = self.controllers.len();
        for place in (1..places).chain([0]) {
            let controller = &mut self.controllers[place];
            if !self.medium.receives(place) {
                if but.is_none() && self.medium.senders().contains(&place) {
                    controller.sent();
                    self.refill(place, ended.end);
                }
                continue;
            }
            if but == Some(place) || !controller.listens(ended.start) {
                continue;
            }
            if self.count(place, ErrorCounters::received) {
                self.tell_state(place);
            }
            self.give(place, sender, ended);
        }
        self.find_first_due();
    }

    /// The controller at `place` has the frame; its station has it a little later.
    fn give(&mut self, place: usize, sender: Station, ended: &OnWire) {
        if place > self.devices.len() {
            return;
        }
        let jitter = self.random.up_to(self.receive_jitter);
        if self.chance.loses() || take(&mut self.controllers[place].losses) {
            return;
        }
        let time = ended.end.after(jitter);
        match place.checked_sub(1) {
            None => self.host.deliver(time, sender, ended.frame),
            Some(node) => {
                self.devices[node].deliver(time, sender, ended.frame);
                self.due[node] = self.devices[node].due();
            }
        }
    }

    /// Error passive senders of the last frame leave the bus to others for a while.
    fn suspend(&mut self) {
        let until = self.medium.suspension();
        let lapses = self.medium.lapses().iter();
        let gave_up = lapses.filter(|lapse| lapse.sent).map(|lapse| lapse.place);
        for place in self.medium.senders().iter().copied().chain(gave_up) {
            let controller = &mut self.controllers[place];
            if controller.state() == ErrorState::ErrorPassive {
                controller.suspend_until(until);
                self.suspended = until;
            }
        }
    }
}

/// Takes one away, if there is one.
fn take(count: &mut u32) -> bool {
    let is_some = *count > 0;
    *count = count.saturating_sub(1);
    is_some
}
