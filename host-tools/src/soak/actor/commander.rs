//! The host that the robot belongs to: polite, busy, and sometimes absent.

use canter_shared::axis::state::State;
use canter_shared::time::{BusTime, Tick};
use canter_shared::wire::command::{Action, Command, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::Address;

use super::streaming::Stream;
use super::{Actor, Heard, Known, Sheet, Voice, after, choice, say};
use crate::soak::dice::Dice;
use crate::soak::scenario::Absence;

/// Microseconds between two SYNCs.
const SYNC_PERIOD: u64 = 20_000;

/// Microseconds between two heartbeats.
const BEAT_PERIOD: u64 = 50_000;

/// An axis, and what it was told last.
#[derive(Debug)]
struct Own {
    sheet: Sheet,
    sequence: u8,
    last: Option<Frame>,
    stream: Option<Stream>,
    /// Microseconds of bus time until which it is left alone, so that some moves arrive.
    left_alone: BusTime,
}

/// The commander.
#[derive(Debug)]
pub(in crate::soak) struct Commander {
    dice: Dice,
    session: Session,
    axes: Vec<Own>,
    /// The longest time from one thought to the next, in microseconds.
    pace: u64,
    counter: u8,
    sync_at: BusTime,
    beat_at: BusTime,
    think_at: BusTime,
    /// A trigger that is to follow, and when.
    trigger: Option<(BusTime, u8)>,
    /// Those to come, in the order of their beginnings.
    absences: Vec<Absence>,
}

impl Commander {
    pub(in crate::soak) fn new(
        seed: u64,
        sheets: impl Iterator<Item = Sheet>,
        absences: &[Absence],
    ) -> Self {
        let mut dice = Dice::new(seed, "commander");
        let own = |sheet| Own {
            sheet,
            sequence: 0,
            last: None,
            stream: None,
            left_alone: BusTime(0),
        };
        let axes: Vec<Own> = sheets.map(own).collect();
        // The busier the more axes there are, and some are busier than others.
        let pace = dice.between(5_000, 120_000) / axes.len().max(1) as u64 + 1_000;
        Self {
            session: dice.between(1, 0xFFFF) as Session,
            axes,
            pace,
            counter: 0,
            sync_at: BusTime(0),
            beat_at: BusTime(0),
            think_at: BusTime(100_000),
            trigger: None,
            absences: absences.iter().rev().copied().collect(),
            dice,
        }
    }

    /// Whether it is not there, and what becomes of it then.
    fn is_absent(&mut self, now: BusTime) -> bool {
        let Some(absence) = self.absences.pop_if(|absence| absence.from <= now) else {
            return false;
        };
        let back = absence.to.max(now);
        (self.sync_at, self.beat_at) = (back, back);
        self.think_at = after(back, 1);
        if absence.killed {
            // Another process, which knows nothing of what the first one was at.
            self.session = self.dice.between(1, 0xFFFF) as Session;
            self.trigger = None;
            for own in &mut self.axes {
                own.stream = None;
                own.last = None;
            }
        }
        // What it was about to do at once, it does when it is back.
        self.trigger = self.trigger.map(|(_, group)| (back, group));
        true
    }

    fn stream_due(&self) -> Option<BusTime> {
        let streams = self.axes.iter().filter_map(|own| own.stream.as_ref());
        streams.filter_map(Stream::due).min()
    }

    fn think(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        self.think_at = after(now, self.dice.between(500, self.pace));
        if self.dice.percent(8) {
            self.stage_all(now, heard, out);
            return;
        }
        let place = self.dice.between(0, self.axes.len() as u64 - 1) as usize;
        let axis = self.axes[place].sheet.id;
        let Some(known) = heard.axis(axis).copied() else {
            say(out, axis, Command::IdentityRequest);
            return;
        };
        if let Some(number) = known.number {
            let sequence = &mut self.axes[place].sequence;
            if number.wrapping_sub(*sequence) < 128 {
                *sequence = number;
            }
        }
        if known.session != self.session {
            self.control(place, Action::Hold, out);
        } else if known.fault != 0 {
            if self.dice.percent(40) {
                self.control(place, Action::Clear, out);
            }
        } else if known.state == u8::from(State::SwitchOnDisabled) {
            self.set_up(place, out);
        } else if known.state == u8::from(State::OperationEnabled)
            && self.axes[place].left_alone <= now
        {
            self.command(place, &known, now, out);
        }
    }

    fn number(&mut self, place: usize) -> u8 {
        let skipped = if self.dice.percent(5) {
            self.dice.between(1, 20)
        } else {
            0
        };
        let own = &mut self.axes[place];
        own.sequence = own.sequence.wrapping_add(1 + skipped as u8);
        own.sequence
    }

    fn send(&mut self, place: usize, command: Command, out: &mut Vec<Frame>) {
        let own = &mut self.axes[place];
        if let Ok(frame) = command.encode(own.sheet.id.into()) {
            own.last = Some(frame);
            out.push(frame);
        }
    }

    fn control(&mut self, place: usize, action: Action, out: &mut Vec<Frame>) {
        let sequence = self.number(place);
        let session = self.session;
        let command = Command::Control {
            action,
            sequence,
            session,
        };
        self.send(place, command, out);
    }

    /// A disabled axis is set up, then enabled.
    fn set_up(&mut self, place: usize, out: &mut Vec<Frame>) {
        match self.dice.between(0, 9) {
            0 => self.control(place, Action::Save, out),
            1 => self.write_parameter(place, out),
            2 => self.control(place, Action::Release, out),
            3 if self.dice.percent(20) => self.control(place, Action::Restore, out),
            _ => self.control(place, Action::Enable, out),
        }
    }

    fn write_parameter(&mut self, place: usize, out: &mut Vec<Frame>) {
        self.control(place, Action::Configure, out);
        let sequence = self.number(place);
        let axis = self.axes[place].sheet.id.get();
        let (parameter, value) = choice::parameter(&mut self.dice, axis);
        let command = Command::ParameterWrite {
            parameter: parameter.into(),
            value,
            sequence,
        };
        self.send(place, command, out);
    }

    /// An enabled axis is given something to do.
    fn command(&mut self, place: usize, known: &Known, now: BusTime, out: &mut Vec<Frame>) {
        match self.dice.between(0, 99) {
            0..55 => self.move_one(place, known, now, out),
            55..63 => {
                let sequence = self.number(place);
                let sheet = self.axes[place].sheet;
                let preparation = choice::preparation(&mut self.dice, &sheet, sequence);
                self.send(place, preparation, out);
                self.move_one(place, known, now, out);
            }
            63..75 => self.begin_stream(place, known, now, out),
            75..83 => {
                let sequence = self.dice.bits() as u8;
                let axis = self.axes[place].sheet.id;
                let to = if self.dice.percent(20) {
                    Address::All
                } else {
                    axis.into()
                };
                say(out, to, Command::Stop { sequence });
            }
            83..85 => self.control(place, Action::Disable, out),
            85 => {
                let axis = self.axes[place].sheet.id;
                let to = if self.dice.percent(20) {
                    Address::All
                } else {
                    axis.into()
                };
                say(out, to, Command::EmergencyStop);
            }
            86..89 => self.control(place, Action::Release, out),
            89..91 => self.control(place, Action::Hold, out),
            91..94 => self.write_parameter(place, out),
            // As one that has heard no answer.
            _ => out.extend(self.axes[place].last),
        }
    }

    fn move_one(&mut self, place: usize, known: &Known, now: BusTime, out: &mut Vec<Frame>) {
        let sequence = self.number(place);
        let sheet = self.axes[place].sheet;
        let (target, duration) = choice::goal(&mut self.dice, &sheet, known.position);
        let command = Command::Move {
            profile: choice::profile(&mut self.dice),
            staged: false,
            target,
            duration,
            sequence,
        };
        self.send(place, command, out);
        if self.dice.percent(50) {
            let lasts = u64::from(duration.0.min(3_000)) * 1_000;
            self.axes[place].left_alone = after(now, lasts);
        }
    }

    fn begin_stream(&mut self, place: usize, known: &Known, now: BusTime, out: &mut Vec<Frame>) {
        let sequence = self.number(place);
        let sheet = self.axes[place].sheet;
        let stream = Stream::draw(&mut self.dice, &sheet, known, now);
        self.send(place, stream.begin(sequence), out);
        let last = stream.due().unwrap_or(now);
        if self.dice.percent(80) {
            self.axes[place].left_alone = after(last, 2_000_000);
        }
        self.axes[place].stream = Some(stream);
    }

    /// Stages a move on every axis that can move, under one number, and triggers them later.
    fn stage_all(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        // A number that is ahead for all of them, where there is one.
        let group = match self.axes.iter().map(|own| own.sequence).max() {
            Some(most) => most.wrapping_add(1),
            None => return,
        };
        for place in 0..self.axes.len() {
            let sheet = self.axes[place].sheet;
            let ready = heard.axis(sheet.id).filter(|known| {
                known.session == self.session && known.state == u8::from(State::OperationEnabled)
            });
            let Some(known) = ready else {
                continue;
            };
            let (target, duration) = choice::goal(&mut self.dice, &sheet, known.position);
            let command = Command::Move {
                profile: choice::profile(&mut self.dice),
                staged: true,
                target,
                duration,
                sequence: group,
            };
            self.axes[place].sequence = group;
            self.send(place, command, out);
        }
        let wait = self.dice.between(1_000, 60_000);
        self.trigger = Some((after(now, wait), group));
    }

    fn pull_trigger(&mut self, now: BusTime, group: u8, out: &mut Vec<Frame>) {
        let ahead = match self.dice.between(0, 9) {
            0 => 0,
            1 => self.dice.between(0, 12_000),
            _ => self.dice.between(3, 200),
        };
        let trigger = Command::Trigger {
            group,
            session: self.session,
            start: Tick(now.0 / 1_000 + ahead),
        };
        say(out, Address::All, trigger);
        if self.dice.percent(20) {
            say(out, Address::All, trigger);
        }
    }
}

impl Actor for Commander {
    fn voice(&self) -> Voice {
        Voice::Host
    }

    fn due(&self) -> BusTime {
        let regular = self.sync_at.min(self.beat_at).min(self.think_at);
        let trigger = self.trigger.map(|(at, _)| at);
        [trigger, self.stream_due()]
            .into_iter()
            .flatten()
            .fold(regular, BusTime::min)
    }

    fn act(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        if self.is_absent(now) {
            return;
        }
        if self.sync_at <= now {
            self.sync_at = after(now, SYNC_PERIOD);
            self.counter = self.counter.wrapping_add(1);
            let sync = Command::Sync {
                counter: self.counter,
                time: now,
            };
            say(out, Address::All, sync);
        }
        if self.beat_at <= now {
            self.beat_at = after(now, BEAT_PERIOD);
            let session = self.session;
            say(out, Address::All, Command::HostHeartbeat { session });
        }
        for own in &mut self.axes {
            if let Some(stream) = &mut own.stream {
                stream.feed(now, &mut self.dice, out);
            }
        }
        if let Some((_, group)) = self.trigger.take_if(|(at, _)| *at <= now) {
            self.pull_trigger(now, group, out);
        }
        if self.think_at <= now {
            self.think(now, heard, out);
        }
    }
}
