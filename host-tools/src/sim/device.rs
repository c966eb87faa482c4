//! A node on the simulated bus: the device's own core, a crystal, a plant, and a receive queue.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::time::Duration;

use canter_shared::axis::Axis;
use canter_shared::drive::{Drive, DriveReport};
use canter_shared::node::{AxisSetpoint, Board, BusEvent, Identity, Node};
use canter_shared::parameter::store::{Image, Loaded, Store};
use canter_shared::time::{BusTime, LocalTime};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, Function};

use super::clock::{Crystal, TrueTime};
use super::controller::Controller;
use super::disturbance::DriveTrouble;
use super::flash::{PAGE, SimulatedFlash};
use super::plant::{Plant, PlantModel, PlantState, Servo};
use super::random::SplitMix64;
use super::station::Station;
use crate::robot::RobotAxis;

/// Frames that can wait until the node looks at them: those of the firmware's channel.
pub(super) const RECEIVE_QUEUE: usize = 32;

/// Frames that the controller has taken over for sending: the FDCAN's three buffers, used as
/// a FIFO, so that two answers with one id keep their order. The rest waits in the node.
pub(super) const SEND_QUEUE: usize = 3;

/// Pages of the flash: one for each of the two slots that parameters are kept in.
const FLASH_PAGES: usize = 2;

/// Bytes of each.
const SLOT: u32 = PAGE as u32;

const _: () = assert!(Store::<SimulatedFlash>::needed(1) <= SLOT as usize);

/// How long a save takes, in nanoseconds: 22 ms to erase a page, and 80 us for each of some 30 words.
const SAVE: u64 = 25_000_000;

/// Nanoseconds of a tick.
const TICK: u64 = 1_000_000;

/// Parameters that have been written, or not, while the node does not know it yet.
#[derive(Debug)]
struct Save {
    done: TrueTime,
    image: Image<1>,
    kept: bool,
}

/// A frame on its way from the controller to the core.
#[derive(Debug, Clone, Copy)]
struct Arrival {
    time: TrueTime,
    sender: Station,
    frame: Frame,
}

/// What a node has just done.
pub(super) enum Step {
    /// It dealt with a frame.
    Frame(Station, Frame),
    /// It ticked.
    Tick(AxisSetpoint),
    /// It heard that its parameters are saved, or are not.
    Saved,
    /// It has power again.
    Started,
}

pub(super) struct Device {
    axis: RobotAxis,
    identity: Identity,
    /// None while there is no power.
    node: Option<Node<Servo, 1>>,
    crystal: Crystal,
    plant: Rc<RefCell<Plant>>,
    flash: SimulatedFlash,
    save: Option<Save>,
    /// For how long the power is cut when the flash says so.
    saving: Option<Duration>,
    /// Frames that were received and not yet looked at, in order.
    inbox: VecDeque<Arrival>,
    busy_until: TrueTime,
    /// The next tick by the node's clock, and when that is.
    next_tick: (LocalTime, TrueTime),
    synchronised: bool,
    /// Since when and until when it is without power.
    off: (TrueTime, TrueTime),
}

impl Device {
    pub(super) fn new(
        axis: &RobotAxis,
        plant: Option<&PlantModel>,
        crystal_ppm: u32,
        random: &mut SplitMix64,
    ) -> Self {
        let mut chip = [0; 12];
        for bytes in chip.chunks_mut(4) {
            bytes.copy_from_slice(&(random.next() as u32).to_le_bytes());
        }
        let crystal = Crystal::new(random, crystal_ppm);
        let fitting = PlantModel::fitting(&axis.limits());
        let mut device = Self {
            axis: *axis,
            identity: Identity {
                chip,
                firmware: crate::version(),
                board: Board::Simulated,
            },
            node: None,
            crystal,
            plant: Rc::new(RefCell::new(Plant::new(plant.unwrap_or(&fitting)))),
            flash: SimulatedFlash::new(FLASH_PAGES, crystal.seed()),
            save: None,
            saving: None,
            inbox: VecDeque::with_capacity(RECEIVE_QUEUE),
            busy_until: TrueTime::default(),
            next_tick: (LocalTime(0), TrueTime::default()),
            synchronised: false,
            off: (TrueTime::default(), TrueTime::default()),
        };
        device.boot();
        device
    }

    /// A node as it comes out of a reset.
    fn boot(&mut self) {
        self.flash.restore();
        let loaded = Store::new(&mut self.flash, 0, SLOT).load::<1>();
        let lost = loaded == Loaded::Lost;
        // Without a save it is as the robot file says.
        let mut axis = self.axis;
        if let Loaded::Image(image) = loaded
            && let Some(stored) = image.first()
            && let Some(id) = AxisId::new(stored.axis)
        {
            axis = RobotAxis {
                id,
                values: stored.values,
            };
        }
        let mut node = Node::new(self.identity);
        let servo = Servo(Rc::clone(&self.plant));
        node.add_axis_with_values(axis.id, &axis.values, servo)
            .expect("a node with room for one axis takes one");
        if lost {
            node.lose_parameters();
        }
        let due = node.next_tick();
        self.next_tick = (due, self.crystal.when(due));
        self.node = Some(node);
    }

    /// The power is gone until `until`.
    pub(super) fn cut_power(&mut self, now: TrueTime, until: TrueTime) {
        self.off = match self.node.take() {
            Some(_) => (now, until),
            None => (self.off.0, self.off.1.max(until)),
        };
        self.save = None;
        self.saving = None;
        self.inbox.clear();
        self.busy_until = TrueTime::default();
        self.synchronised = false;
    }

    /// Has the power fail in the middle of the flash's next operation after `after` whole ones.
    pub(super) fn cut_power_while_saving(&mut self, after: u32, time: Duration) {
        self.saving = Some(time);
        self.flash.cut_after(after);
    }

    /// The power has failed while the flash was at work: for how long it is to stay away.
    pub(super) fn power_failed(&self) -> Option<Duration> {
        self.saving.filter(|_| self.flash.is_cut())
    }

    /// A frame that its controller will have received at `time`, or right after the one before.
    /// Where it finds no room, the node only hears that one was lost.
    pub(super) fn deliver(&mut self, time: TrueTime, sender: Station, frame: Frame) {
        if self.inbox.len() >= RECEIVE_QUEUE {
            self.count(BusEvent::LostReception);
            return;
        }
        let time = self.inbox.back().map_or(time, |last| time.max(last.time));
        self.inbox.push_back(Arrival {
            time,
            sender,
            frame,
        });
    }

    /// It looks at no frame until then.
    pub(super) fn delay(&mut self, until: TrueTime) {
        self.busy_until = self.busy_until.max(until);
    }

    /// When something happens here next.
    pub(super) fn due(&self) -> TrueTime {
        if self.node.is_none() {
            return self.off.1;
        }
        let mut due = self.next_tick.1;
        if let Some(arrival) = self.inbox.front() {
            due = due.min(arrival.time.max(self.busy_until));
        }
        if let Some(save) = &self.save {
            due = due.min(save.done);
        }
        due
    }

    /// Does the one thing that is due at `now`: a save's end before a frame, and that before a tick.
    pub(super) fn step(&mut self, now: TrueTime, controller: &mut Controller) -> Step {
        let Some(node) = &mut self.node else {
            self.start(now);
            controller.power_on(now);
            return Step::Started;
        };
        if let Some(save) = self.save.take_if(|save| save.done <= now) {
            node.saved(&save.image, save.kept);
            self.refill(now, controller);
            return Step::Saved;
        }
        let local = self.crystal.local(now);
        let may_look = self.busy_until <= now;
        let arrival = self
            .inbox
            .pop_front_if(|arrival| may_look && arrival.time <= now);
        let step = match arrival {
            Some(Arrival { sender, frame, .. }) => {
                node.handle_frame(local, &frame);
                self.synchronised |= frame.id() == Address::All.frame_id(Function::Sync);
                Step::Frame(sender, frame)
            }
            None => {
                let setpoint = node.tick(local).first().copied();
                Step::Tick(setpoint.expect("a node with one axis has one setpoint"))
            }
        };
        node.plan();
        if self.save.is_none()
            && let Some(image) = node.take_save()
        {
            let kept = Store::new(&mut self.flash, 0, SLOT).save(&image).is_ok();
            let done = now.after(SAVE);
            self.save = Some(Save { done, image, kept });
        }
        self.refill(now, controller);
        step
    }

    fn start(&mut self, now: TrueTime) {
        let away = now.0.saturating_sub(self.off.0.0) / TICK;
        self.plant.borrow_mut().coast(away);
        self.crystal.restart(now);
        self.boot();
    }

    /// Moves on what there is to send, and sees when the next tick is.
    pub(super) fn refill(&mut self, now: TrueTime, controller: &mut Controller) {
        let Some(node) = &mut self.node else {
            return;
        };
        let local = self.crystal.local(now);
        while controller.has_room()
            && let Some(frame) = node.poll_transmit(local)
        {
            controller.push(frame);
        }
        let due = node.next_tick();
        if due != self.next_tick.0 {
            self.next_tick = (due, self.crystal.when(due));
        }
    }

    /// Tells the node what its controller saw.
    pub(super) fn count(&mut self, event: BusEvent) {
        if let Some(node) = &mut self.node {
            node.count(event);
        }
    }

    pub(super) fn trouble(&mut self, trouble: DriveTrouble, ticks: u64) {
        self.plant.borrow_mut().trouble(trouble, ticks);
    }

    /// What the node believes the bus time to be; zero while it has no power.
    pub(super) fn bus_time(&self, now: TrueTime) -> BusTime {
        let node = self.node.as_ref();
        node.map_or(BusTime(0), |node| node.bus_time(self.crystal.local(now)))
    }

    pub(super) fn axis(&self) -> Option<&Axis> {
        self.node.as_ref()?.axes().next()
    }

    pub(super) fn is_synchronised(&self) -> bool {
        self.synchronised
    }

    pub(super) fn drive(&self) -> DriveReport {
        Servo(Rc::clone(&self.plant)).report()
    }

    pub(super) fn plant(&self) -> PlantState {
        self.plant.borrow().state()
    }

    pub(super) fn flash_mut(&mut self) -> &mut SimulatedFlash {
        &mut self.flash
    }
}
