//! The host's end of the simulated bus: a process that can stand still, and the queues of a Linux
//! CAN interface between it and its controller.

use std::collections::VecDeque;
use std::time::Duration;

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, Function};

use super::SimulatedBus;
use super::clock::TrueTime;
use super::fault_confinement::ErrorState;
use super::observer::Delivery;
use super::station::Station;
use crate::bus::{Bus, BusError, ErrorEvent, Event, Received};

/// Frames that the host can have waiting: those of a Linux CAN interface (`txqueuelen`), so that
/// a client meets its first full queue here and not on the robot.
pub(super) const SEND_QUEUE: usize = 10;

/// How long a full queue is waited for, as on a real interface.
const SEND_LIMIT: Duration = Duration::from_millis(50);

/// Frames that wait for a host that does not read: 4 MiB of socket, 768 bytes for each frame.
const RECEIVE_QUEUE: usize = (4 << 20) / 768;

/// How long a controller that was bus-off waits until it begins to come back, in nanoseconds:
/// an interface set up with `restart-ms 100`.
pub(super) const RESTART: u64 = 100_000_000;

/// Something that waits to be read.
#[derive(Debug)]
struct Arrival {
    time: TrueTime,
    sender: Station,
    event: Event,
}

/// The host.
#[derive(Debug, Default)]
pub(super) struct Host {
    incoming: VecDeque<Arrival>,
    /// Frames that found no room since the last one that did.
    lost: u32,
    stalled_until: TrueTime,
    killed: bool,
    sync_lost_until: TrueTime,
}

impl Host {
    pub(super) fn stall(&mut self, until: TrueTime) {
        self.stalled_until = self.stalled_until.max(until);
    }

    pub(super) fn kill(&mut self) {
        self.killed = true;
    }

    pub(super) fn revive(&mut self) {
        *self = Self::default();
    }

    pub(super) fn lose_sync(&mut self, until: TrueTime) {
        self.sync_lost_until = self.sync_lost_until.max(until);
    }

    /// A frame that its controller has received at `time`, or right after the one before.
    pub(super) fn deliver(&mut self, time: TrueTime, sender: Station, frame: Frame) {
        if self.incoming.len() >= RECEIVE_QUEUE {
            self.lost += 1;
            return;
        }
        if self.lost > 0 {
            let lost = std::mem::take(&mut self.lost);
            self.put(
                time,
                sender,
                Event::Error(ErrorEvent::LostReception(Some(lost))),
            );
        }
        self.put(time, sender, Event::Frame(frame));
    }

    /// Its controller's state has changed, or it is back from bus-off.
    pub(super) fn tell(&mut self, time: TrueTime, state: ErrorState) {
        let event = match state {
            ErrorState::BusOff => ErrorEvent::BusOff,
            ErrorState::ErrorPassive => ErrorEvent::ErrorPassive,
            ErrorState::ErrorActive => return,
        };
        self.put(time, Station::Host, Event::Error(event));
    }

    pub(super) fn tell_restart(&mut self, time: TrueTime) {
        self.put(time, Station::Host, Event::Error(ErrorEvent::Restarted));
    }

    fn put(&mut self, time: TrueTime, sender: Station, event: Event) {
        // Nobody reads any more.
        if self.killed {
            return;
        }
        let time = self
            .incoming
            .back()
            .map_or(time, |last| time.max(last.time));
        self.incoming.push_back(Arrival {
            time,
            sender,
            event,
        });
    }
}

impl SimulatedBus {
    /// Lets the time pass in which the host's process stands still.
    fn wake(&mut self) -> Result<(), BusError> {
        while !self.host.killed && self.host.stalled_until > self.now {
            self.advance(self.host.stalled_until);
        }
        if self.host.killed {
            let bus = self.description();
            return Err(BusError::Closed { bus });
        }
        Ok(())
    }

    /// Waits until the host can have one more frame waiting.
    fn wait_for_room(&mut self) -> Result<(), BusError> {
        let deadline = self.now.after(SEND_LIMIT.as_nanos() as u64);
        while !self.controllers[0].has_room() {
            match self.next_event() {
                Some(event) if event <= deadline => self.step(event),
                _ => {
                    self.now = self.now.max(deadline);
                    return Err(BusError::SendQueueFull {
                        bus: self.description(),
                        waited: SEND_LIMIT,
                        advice: "nobody acknowledges, or more urgent frames fill the bus",
                    });
                }
            }
            self.wake()?;
        }
        Ok(())
    }
}

impl Bus for SimulatedBus {
    fn now(&self) -> BusTime {
        self.now.bus_time()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.wake()?;
        let is_sync = frame.id() == Address::All.frame_id(Function::Sync);
        if is_sync && self.now < self.host.sync_lost_until {
            return Ok(());
        }
        self.wait_for_room()?;
        self.controllers[0].push(*frame);
        self.look_at(0);
        Ok(())
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        let until = TrueTime::of(until);
        loop {
            self.wake()?;
            let until = until.max(self.now);
            let arrives = self.host.incoming.front().map(|arrival| arrival.time);
            let event = self.next_event();
            // At one instant the robot is first, so that nothing of it is left in the past.
            if let Some(event) = event.filter(|event| *event <= arrives.unwrap_or(until).min(until))
            {
                self.step(event);
            } else if let Some(arrival) = self
                .host
                .incoming
                .pop_front_if(|arrival| arrival.time <= until)
            {
                let Arrival {
                    time,
                    sender,
                    event,
                } = arrival;
                self.now = self.now.max(time);
                if let (Some(observer), Event::Frame(frame)) = (&mut self.observer, &event) {
                    let delivery = Delivery {
                        receiver: Station::Host,
                        sender,
                        frame: *frame,
                    };
                    observer.delivery(self.now, &delivery);
                }
                let time = time.bus_time();
                return Ok(Some(Received { time, event }));
            } else {
                self.now = until;
                return Ok(None);
            }
        }
    }

    fn description(&self) -> String {
        format!("simulated robot of {} axes", self.devices.len())
    }
}
