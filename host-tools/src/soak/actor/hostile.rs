//! A device that sends what it should not: forged, wild, stale, doubled, malformed, in floods.

use canter_shared::time::{BusTime, Tick};
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::{Frame, MAXIMUM_LENGTH};
use canter_shared::wire::id::{Address, Function};
use canter_shared::wire::layout::Layout;

use super::{Actor, Heard, Sheet, Voice, after, choice, say};
use crate::soak::dice::Dice;

/// The most frames of a flood.
const FLOOD: u64 = 300;

/// The hostile device.
#[derive(Debug)]
pub(in crate::soak) struct Hostile {
    dice: Dice,
    sheets: Vec<Sheet>,
    /// The longest time from one act to the next, in microseconds.
    pace: u64,
    due: BusTime,
}

impl Hostile {
    pub(in crate::soak) fn new(seed: u64, sheets: impl Iterator<Item = Sheet>) -> Self {
        let mut dice = Dice::new(seed, "hostile");
        Self {
            sheets: sheets.collect(),
            pace: dice.decades(2_000.0, 500_000.0) as u64,
            due: BusTime(dice.between(0, 1_000_000)),
            dice,
        }
    }

    /// A frame from before, as it was or a little changed.
    fn stale(&mut self, heard: &Heard) -> Option<Frame> {
        let dice = &mut self.dice;
        let last = heard.recent.len().checked_sub(1)?;
        let frame = heard.recent[dice.between(0, last as u64) as usize];
        let mut bytes = [0; MAXIMUM_LENGTH];
        let mut length = frame.data().len();
        bytes[..length].copy_from_slice(frame.data());
        match dice.between(0, 5) {
            0 => length = dice.between(0, MAXIMUM_LENGTH as u64) as usize,
            1 => {
                let bit = dice.between(0, 63);
                bytes[(bit / 8) as usize] ^= 1 << (bit % 8);
            }
            _ => {}
        }
        Frame::new(frame.id(), &bytes[..length])
    }

    /// A frame of some function to or from some axis, of the right length or not, with any bytes.
    fn wild(&mut self) -> Option<Frame> {
        let dice = &mut self.dice;
        let axis = dice.one_of(&self.sheets).id;
        let mut function = Function::try_from(dice.between(0, 31) as u8).ok()?;
        // Emergency stops are obeyed from anybody, and a robot that is always stopped shows little.
        if function == Function::EmergencyStop && dice.percent(80) {
            function = Function::MoveBeta;
        }
        let to = if dice.percent(20) {
            Address::All
        } else {
            axis.into()
        };
        let bytes = dice.bits().to_le_bytes();
        let length = if dice.percent(70) {
            Layout::of(function)?.length.into()
        } else {
            dice.between(0, MAXIMUM_LENGTH as u64) as usize
        };
        Frame::new(to.frame_id(function), bytes.get(..length)?)
    }

    /// A command that might be the holder's own, as far as can be guessed.
    fn forged(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        let dice = &mut self.dice;
        let sheet = dice.one_of(&self.sheets);
        let known = heard.axis(sheet.id).copied().unwrap_or_default();
        let sequence = known
            .number
            .unwrap_or_default()
            .wrapping_add(dice.between(1, 60) as u8);
        let session = known.session;
        let (target, duration) = choice::goal(dice, &sheet, known.position);
        let command = match dice.between(0, 5) {
            0 => Command::Control {
                action: choice::action(dice),
                sequence,
                session,
            },
            1 => choice::preparation(dice, &sheet, sequence),
            2 => Command::StreamBegin {
                start: Tick(now.0 / 1_000 + dice.between(0, 50)),
                period: dice.between(0, 20) as u8,
                number: dice.between(0, 63) as u8,
                sequence,
            },
            _ => Command::Move {
                profile: choice::profile(dice),
                staged: dice.percent(20),
                target,
                duration,
                sequence,
            },
        };
        say(out, sheet.id, command);
    }

    /// The clock or the heartbeat of somebody else.
    fn pulse(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        let dice = &mut self.dice;
        let axis = dice.one_of(&self.sheets).id;
        let session = heard.axis(axis).map_or(0, |known| known.session);
        let time = match dice.between(0, 4) {
            0 => dice.bits() >> 8,
            1 => now.0.saturating_sub(dice.between(0, 10_000_000)),
            2 => now.0 + dice.between(0, 10_000_000),
            _ => now.0 + dice.between(0, 100_000),
        };
        let command = if dice.percent(50) {
            Command::HostHeartbeat { session }
        } else {
            Command::Sync {
                counter: dice.bits() as u8,
                time: BusTime(time),
            }
        };
        say(out, Address::All, command);
    }

    fn one(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        match self.dice.between(0, 9) {
            0..=2 => out.extend(self.stale(heard)),
            3..=4 => out.extend(self.wild()),
            5..=7 => self.forged(now, heard, out),
            8 => self.pulse(now, heard, out),
            _ => {
                let bytes = self.dice.bits().to_le_bytes();
                let length = self.dice.between(0, MAXIMUM_LENGTH as u64) as usize;
                // Above the emergency stops and the triggers: see `wild`.
                let id = self.dice.between(0xC0, 0x7FF) as u16;
                out.extend(Frame::new(id, &bytes[..length]));
            }
        }
    }
}

impl Actor for Hostile {
    fn voice(&self) -> Voice {
        Voice::Stranger
    }

    fn due(&self) -> BusTime {
        self.due
    }

    fn act(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        self.due = after(now, self.dice.between(100, self.pace));
        let count = if self.dice.percent(2) {
            self.dice.between(1, FLOOD)
        } else {
            1
        };
        // A flood of one frame, or of many.
        if count > 1 && self.dice.percent(50) {
            let begin = out.len();
            self.one(now, heard, out);
            if let Some(frame) = out.get(begin).copied() {
                out.extend(std::iter::repeat_n(frame, count as usize));
            }
        } else {
            for _ in 0..count {
                self.one(now, heard, out);
            }
        }
    }
}
