//! CANopen drives in CiA 402's cyclic synchronous position mode.
//!
//! The link sets a drive up over SDO as soon as it answers, starts it, and from then on sends controlword
//! and target in RPDO1 before each SYNC; statusword and place come back in TPDO1 after it. A target is taken
//! at the SYNC, so the drives of a node move in the same instant. Where the drive takes a torque offset
//! (60B2h, in thousandths of its rated torque), it stands in RPDO1 behind the target. There is no room for
//! a velocity offset as well, nor need of it: the drive has the velocity from its targets.
//!
//! | file | what it holds |
//! |---|---|
//! | `objects` | ids, and what is set up |
//! | `state` | statusword, controlword, complaints |

pub mod objects;
pub mod state;

use super::scale::Scale;
use super::settings::DriveSettings;
use super::{Condition, Drive, DriveCommand, DriveReport, Trouble};
use crate::time::{TICKS_PER_SECOND, Tick};
use crate::wire::frame::Frame;
use objects::{
    BOOT_UP, EMCY, HEARTBEAT, NMT, NMT_PRE_OPERATIONAL, NMT_START, OPERATIONAL, RPDO1, SDO_ABORT,
    SDO_ANSWER, SDO_DONE, SDO_REQUEST, SETUP, Setup, TPDO1,
};
use state::{DISABLE_VOLTAGE, FAULT_RESET, Status};

/// The greatest node id.
pub const LAST_NODE: u8 = 127;

/// Ticks for which an answer to an SDO is waited for before the whole set-up begins again. So often a drive
/// that is not there is asked.
const SDO_PATIENCE: u16 = 100;

/// Ticks after the order to start in which a heartbeat may still tell of the time before: two of them.
const START_PATIENCE: u16 = 200;

/// What the newest difference of places counts for in the speed: they are whole increments, and coarse.
const SMOOTHING: f32 = 0.25;

/// How far the drive has come with its set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// The write of this number waits for its answer, for so many more ticks.
    Setup { step: u8, left: u16 },
    /// It refused a write, and is asked again after so many ticks.
    Refused { left: u16 },
    /// It takes setpoints.
    Running,
}

/// The link to one drive.
#[derive(Debug, Clone)]
pub struct Cia402 {
    scale: Scale,
    timeout: u16,
    setup: Setup,
    /// Thousandths of the rated torque in one Nm; 0 where no torque is told.
    torque: f32,
    stage: Stage,
    /// Network management that is to be sent before all else.
    nmt: Option<u8>,
    sdo_due: bool,
    rpdo: Option<u64>,
    sync_due: bool,
    wait: u16,
    /// Whether the axis wants torque, and whether the drive has followed since it does.
    wanted: bool,
    followed: bool,
    resets: bool,
    complaint: Trouble,
    /// A trouble that the drive does not hold by itself, kept until the axis has taken its order back.
    trouble: Option<Trouble>,
    statusword: u16,
    /// Its place in increments, and the difference to the one before, over several periods.
    place: i32,
    moved: f32,
    /// Turns/s of its shaft for an increment in a period.
    speed: f32,
    /// Ticks since the drive was started.
    running: u16,
    /// Ticks since the last place, and whether there was one since the drive runs.
    age: u16,
    told: bool,
}

impl Cia402 {
    /// A drive that has not been heard yet.
    pub fn new(settings: &DriveSettings) -> Self {
        let period = settings.period.0.clamp(1, u8::MAX.into());
        let takes_torque = settings.rated_torque > 0.0;
        Self {
            scale: settings.scale_to(settings.increments.into()),
            timeout: settings.timeout.0.min(u16::MAX.into()) as u16,
            setup: Setup {
                node: settings.node.min(LAST_NODE),
                period: period as u8,
                torque: takes_torque,
            },
            torque: if takes_torque {
                1e3 / settings.rated_torque
            } else {
                0.0
            },
            stage: Stage::Refused { left: 1 },
            nmt: None,
            sdo_due: false,
            rpdo: None,
            sync_due: false,
            wait: 0,
            wanted: false,
            followed: false,
            resets: false,
            complaint: Trouble::Other,
            trouble: None,
            statusword: 0,
            place: 0,
            moved: 0.0,
            speed: TICKS_PER_SECOND as f32 / (period as f32 * settings.increments as f32),
            running: 0,
            age: u16::MAX,
            told: false,
        }
    }

    #[inline(never)]
    fn set_up(&mut self) {
        self.told = false;
        self.rpdo = None;
        self.nmt = Some(NMT_PRE_OPERATIONAL);
        self.write(0);
    }

    /// Does the write of this number, or the one behind it where this drive does not get it.
    fn write(&mut self, step: u8) {
        let write = SETUP.get(usize::from(step));
        let step = step + u8::from(write.is_some_and(|write| !write.is_for(self.setup)));
        self.stage = Stage::Setup {
            step,
            left: SDO_PATIENCE,
        };
        self.sdo_due = true;
    }

    fn step(&self) -> Option<&'static objects::Write> {
        match self.stage {
            Stage::Setup { step, .. } => SETUP.get(usize::from(step)),
            _ => None,
        }
    }

    #[inline(never)]
    fn take_answer(&mut self, word: u64) {
        let (Some(write), Stage::Setup { step, .. }) = (self.step(), self.stage) else {
            return;
        };
        if word as u32 >> 8 != write.place() {
            return;
        }
        match word as u8 {
            SDO_DONE if usize::from(step) + 1 < SETUP.len() => self.write(step + 1),
            SDO_DONE => {
                self.nmt = Some(NMT_START);
                self.stage = Stage::Running;
                self.age = 0;
                self.running = 0;
            }
            SDO_ABORT => {
                self.trouble = Some(Trouble::Setup);
                self.stage = Stage::Refused {
                    left: 10 * SDO_PATIENCE,
                };
            }
            _ => {}
        }
    }

    #[inline(never)]
    fn take_place(&mut self, word: u64) {
        if self.stage != Stage::Running {
            return;
        }
        let place = (word >> 16) as u32 as i32;
        if self.told {
            let step = place.wrapping_sub(self.place) as f32;
            self.moved += (step - self.moved) * SMOOTHING;
        } else {
            self.moved = 0.0;
        }
        self.statusword = word as u16;
        self.place = place;
        self.told = true;
        self.age = 0;
        if self.wanted && state::strays(self.statusword) {
            self.trouble = Some(Trouble::Following);
        }
        self.followed |= self.wanted && state::follows(self.statusword);
    }

    /// A drive that is no longer operational must be set up anew: its settings may be gone.
    fn take_heartbeat(&mut self, network_state: u8) {
        let runs = self.stage == Stage::Running;
        if network_state == BOOT_UP {
            if runs && self.wanted {
                self.trouble = Some(Trouble::Restart);
            }
            self.set_up();
        } else if runs && network_state != OPERATIONAL && self.running > START_PATIENCE {
            self.set_up();
        }
    }

    fn status(&self) -> Status {
        Status::of(self.statusword)
    }

    #[inline(never)]
    fn lead(&mut self, command: &DriveCommand) {
        let mut control = if self.resets && self.status() == Status::Fault {
            FAULT_RESET
        } else if !command.enable || self.trouble.is_some() || self.is_gone() {
            DISABLE_VOLTAGE
        } else {
            self.status().towards_enabled()
        };
        let (mut target, mut torque) = (self.place, 0);
        if command.enable {
            match i32::try_from(self.scale.position(command.position)) {
                Ok(place) => {
                    target = place;
                    // Beyond the greatest i16, which is 32 times the rated torque, it is the greatest.
                    let thousandths = self.torque * self.scale.torque(command.acceleration);
                    torque = libm::roundf(thousandths) as i16;
                }
                Err(_) => {
                    // There is no such place: no torque is better than another one.
                    self.trouble = Some(Trouble::Range);
                    control = DISABLE_VOLTAGE;
                }
            }
        }
        let torque = u64::from(torque as u16) << 48;
        self.rpdo = Some(u64::from(control) | u64::from(target as u32) << 16 | torque);
    }

    /// It is lost, or has followed and does no longer: it is not led up again.
    fn is_gone(&self) -> bool {
        self.is_lost() || self.followed && !state::follows(self.statusword)
    }

    fn is_lost(&self) -> bool {
        self.stage != Stage::Running || !self.told || self.age > self.timeout
    }
}

impl Drive for Cia402 {
    fn command(&mut self, _tick: Tick, command: DriveCommand) {
        self.age = self.age.saturating_add(1);
        self.running = self.running.saturating_add(1);
        self.wanted = command.enable;
        if !command.enable {
            self.followed = false;
            if self.stage == Stage::Running {
                self.trouble = None;
            }
        }
        if command.reset {
            // Only what is there now: a later fault is not forgotten by the way.
            self.resets = self.status() == Status::Fault;
        }
        match &mut self.stage {
            Stage::Setup { left, .. } | Stage::Refused { left } => {
                *left -= 1;
                if *left == 0 {
                    self.set_up();
                }
            }
            Stage::Running if self.age > self.timeout.max(SDO_PATIENCE) => self.set_up(),
            Stage::Running => {}
        }
        self.wait = self.wait.saturating_sub(1);
        if self.wait == 0 {
            self.wait = self.setup.period.into();
            if self.stage == Stage::Running {
                if self.told {
                    self.lead(&command);
                }
                self.sync_due = true;
            }
        }
    }

    #[inline(never)]
    fn report(&self) -> DriveReport {
        let condition = if let Some(trouble) = self.trouble {
            Condition::Faulted(trouble)
        } else if self.is_lost() {
            Condition::Lost
        } else {
            match self.status() {
                Status::Fault | Status::Reacting => Condition::Faulted(self.complaint),
                _ if self.wanted && state::follows(self.statusword) => Condition::Enabled,
                _ => Condition::Disabled,
            }
        };
        DriveReport {
            condition,
            position: self.scale.axis_position(self.place.into()),
            velocity: self.scale.axis_velocity(self.moved * self.speed),
        }
    }

    #[inline(never)]
    fn receive(&mut self, frame: &Frame) -> bool {
        let node = frame.id() & u16::from(LAST_NODE);
        if node != self.setup.node.into() {
            return false;
        }
        let (word, length) = (frame.word(), frame.data().len());
        match (frame.id() - node, length) {
            (TPDO1, 6) => self.take_place(word),
            (SDO_ANSWER, 8) => self.take_answer(word),
            (HEARTBEAT, 1) => self.take_heartbeat(word as u8 & 0x7F),
            (EMCY, 8) => {
                let code = word as u16;
                self.complaint = if code == 0 {
                    Trouble::Other
                } else {
                    state::complaint(code)
                };
            }
            _ => return false,
        }
        true
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        let node = u16::from(self.setup.node);
        let frame = |id: u16, word: u64, length: u8| Some(Frame::from_word(id, word, length));
        if let Some(order) = self.nmt.take() {
            return frame(NMT, u64::from(order) | u64::from(self.setup.node) << 8, 2);
        }
        if core::mem::take(&mut self.sdo_due)
            && let Some(write) = self.step()
        {
            let payload = write.payload(self.setup);
            return frame(SDO_REQUEST + node, payload, 8);
        }
        let word = self.rpdo.take()?;
        // Only now: a bus that takes longer than a tick sends the newest word, and none before it.
        self.resets &= word as u16 != FAULT_RESET;
        let length = if self.setup.torque { 8 } else { 6 };
        frame(RPDO1 + node, word, length)
    }

    fn take_sync(&mut self) -> bool {
        core::mem::take(&mut self.sync_due)
    }
}

/// The SYNC of a drives' bus.
pub fn sync() -> Frame {
    Frame::from_word(objects::SYNC, 0, 0)
}

/// Where a drive may be, in increments of its own to both sides of zero.
pub const REACH: i64 = i32::MAX as i64;
