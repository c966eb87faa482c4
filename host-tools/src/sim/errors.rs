//! Errors on the wire: what every station counts, who is bus-off, and the way back.

use canter_shared::node::BusEvent;

use super::SimulatedBus;
use super::clock::TrueTime;
use super::fault_confinement::{ErrorCounters, ErrorState};
use super::host;
use super::medium::OnWire;
use super::observer::{Destroyed, Destruction};
use super::station::Station;

impl SimulatedBus {
    /// Those that saw an error in a frame which went on without them: a sender that gave up has
    /// it still to send, a receiver has missed it.
    pub(super) fn count_lapses(&mut self) {
        for at in 0..self.medium.lapses().len() {
            let lapse = self.medium.lapses()[at];
            let event = if lapse.sent {
                ErrorCounters::transmit_error
            } else {
                ErrorCounters::receive_error
            };
            self.count_error(lapse.place, event);
        }
    }

    /// The frame ended in an error frame, which is over: all count it. Where `all_saw`, the
    /// receivers took it for an error too.
    pub(super) fn destroy(&mut self, ended: &OnWire, cause: Destruction, all_saw: bool) {
        for place in 0..self.controllers.len() {
            if self.medium.sends(place) {
                match cause {
                    Destruction::NotAcknowledged => {
                        self.count_error(place, ErrorCounters::not_acknowledged);
                    }
                    _ => self.count_error(place, ErrorCounters::transmit_error),
                }
            } else if self.controllers[place].listens(ended.start) {
                let first = cause == Destruction::Misread(self.station(place));
                if first || all_saw {
                    self.count_error(place, ErrorCounters::receive_error);
                }
                if first && self.count(place, ErrorCounters::dominant_after_flag) {
                    self.tell_state(place);
                }
            }
        }
        if let Some(observer) = &mut self.observer {
            observer.destroyed(&Destroyed {
                start: ended.start,
                end: ended.end,
                sender: Station::at(ended.sender, self.devices.len()),
                frame: ended.frame,
                cause,
            });
        }
    }

    /// Changes the counters at `place`; says whether the state changed with them.
    pub(super) fn count(&mut self, place: usize, event: impl FnOnce(&mut ErrorCounters)) -> bool {
        self.controllers[place].count(event)
    }

    /// An error that the station hears of.
    pub(super) fn count_error(&mut self, place: usize, event: impl FnOnce(&mut ErrorCounters)) {
        let changed = self.count(place, event);
        if let Some(node) = place
            .checked_sub(1)
            .filter(|node| *node < self.devices.len())
        {
            self.devices[node].count(BusEvent::ErrorFrame);
        }
        if changed {
            self.tell_state(place);
        }
    }

    /// The error state at `place` has changed.
    pub(super) fn tell_state(&mut self, place: usize) {
        let state = self.controllers[place].state();
        let station = self.station(place);
        if state == ErrorState::BusOff {
            let pause = if station == Station::Host {
                host::RESTART
            } else {
                0
            };
            // What is recessive from the error frame's delimiter on counts already.
            let from = self.medium.recessive_since().after(pause);
            self.controllers[place].leave(from);
            self.off.push(place);
            self.look_at(place);
        }
        match station {
            Station::Host => self.host.tell(self.now, state),
            Station::Node(node) if state == ErrorState::BusOff => {
                self.devices[node].count(BusEvent::BusOff);
            }
            _ => {}
        }
        if let Some(observer) = &mut self.observer {
            observer.error_state(self.now, station, state);
        }
    }

    /// When the first controller that is off the bus is back, if nobody sends meanwhile.
    pub(super) fn recovers(&self) -> Option<TrueTime> {
        if self.off.is_empty() || self.medium.free().is_none() {
            return None;
        }
        let (since, bit) = (self.medium.recessive_since(), self.medium.bit());
        let off = self.off.iter();
        off.filter_map(|place| self.controllers[*place].back(since, bit))
            .min()
    }

    /// Controllers that have been off the bus for long enough are back.
    pub(super) fn recover(&mut self) {
        if self.off.is_empty() || self.medium.free().is_none() {
            return;
        }
        let (since, bit, now) = (self.medium.recessive_since(), self.medium.bit(), self.now);
        for place in std::mem::take(&mut self.off) {
            match self.controllers[place].back(since, bit) {
                Some(back) if back <= now => {
                    self.controllers[place].rejoin(now);
                    self.look_at(place);
                    if place == 0 {
                        self.host.tell_restart(now);
                    }
                    let station = self.station(place);
                    if let Some(observer) = &mut self.observer {
                        observer.error_state(now, station, ErrorState::ErrorActive);
                    }
                }
                Some(_) => self.off.push(place),
                // It lost its power meanwhile.
                None => {}
            }
        }
    }

    /// A frame begins: what was recessive until now is counted by those that are off the bus.
    pub(super) fn count_recessive(&mut self) {
        let (since, bit) = (self.medium.recessive_since(), self.medium.bit());
        for place in &self.off {
            self.controllers[*place].count_recessive(since, self.now, bit);
        }
    }
}
