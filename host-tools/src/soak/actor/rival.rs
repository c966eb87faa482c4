//! A second host: it holds, moves and stops what it can get, and does not always beat.

use canter_shared::time::{BusTime, Tick};
use canter_shared::wire::command::{Action, Command, Session};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::Address;

use super::{Actor, Heard, Sheet, Voice, after, choice, say};
use crate::soak::dice::Dice;

/// The rival.
#[derive(Debug)]
pub(in crate::soak) struct Rival {
    dice: Dice,
    session: Session,
    sheets: Vec<Sheet>,
    sequence: u8,
    due: BusTime,
}

impl Rival {
    pub(in crate::soak) fn new(seed: u64, sheets: impl Iterator<Item = Sheet>) -> Self {
        let mut dice = Dice::new(seed, "rival");
        Self {
            session: dice.between(1, 0xFFFF) as Session,
            sheets: sheets.collect(),
            sequence: 0,
            due: BusTime(dice.between(0, 1_000_000)),
            dice,
        }
    }
}

impl Actor for Rival {
    fn voice(&self) -> Voice {
        Voice::Stranger
    }

    fn due(&self) -> BusTime {
        self.due
    }

    fn act(&mut self, now: BusTime, heard: &Heard, out: &mut Vec<Frame>) {
        let (dice, session) = (&mut self.dice, self.session);
        self.due = after(now, dice.between(1_000, 200_000));
        let sheet = dice.one_of(&self.sheets);
        self.sequence = self.sequence.wrapping_add(1);
        let sequence = self.sequence;
        let known = heard.axis(sheet.id).copied().unwrap_or_default();
        let control = |action| Command::Control {
            action,
            sequence,
            session,
        };
        let command = match dice.between(0, 19) {
            0..=4 if known.session != session => control(Action::Hold),
            0..=1 => control(Action::Clear),
            2..=3 => control(Action::Enable),
            4 => control(choice::action(dice)),
            5..=9 => {
                let (target, duration) = choice::goal(dice, &sheet, known.position);
                Command::Move {
                    profile: choice::profile(dice),
                    staged: dice.percent(20),
                    target,
                    duration,
                    sequence,
                }
            }
            10 => Command::Stop { sequence },
            11 => control(Action::Release),
            12 => {
                let (parameter, value) = choice::parameter(dice, sheet.id.get());
                Command::ParameterWrite {
                    parameter: parameter.into(),
                    value,
                    sequence,
                }
            }
            13 => {
                let trigger = Command::Trigger {
                    group: sequence.wrapping_sub(1),
                    session,
                    start: Tick(now.0 / 1_000 + dice.between(0, 100)),
                };
                say(out, Address::All, trigger);
                return;
            }
            _ => {
                say(out, Address::All, Command::HostHeartbeat { session });
                return;
            }
        };
        say(out, sheet.id, command);
    }
}
