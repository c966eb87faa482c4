//! The streams of knots that a commander feeds: smooth ones, some of which it lets run dry.

use canter_shared::time::{BusTime, Tick};
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;

use super::{Known, Sheet, choice, say};
use crate::soak::dice::Dice;

/// Numbers of knots.
const NUMBERS: u64 = 64;

/// One stream to one axis.
#[derive(Debug, Clone)]
pub(super) struct Stream {
    sheet: Sheet,
    start: Tick,
    period: u8,
    /// The number of the place that it leaves from.
    number: u8,
    /// In rad.
    from: f64,
    way: f64,
    knots: u64,
    /// The next knot to send, from 1 on.
    next: u64,
    /// The knot from which on nothing is sent: the last one, or an earlier one.
    ends: u64,
    /// Microseconds by which knots are sent ahead of their time.
    ahead: u64,
}

impl Stream {
    /// Draws one that leaves from where the axis is; the caller begins it with the command.
    pub(super) fn draw(dice: &mut Dice, sheet: &Sheet, known: &Known, now: BusTime) -> Self {
        // Knots go before answers: at every tick, and to many axes, they take the whole bus.
        let period = match dice.between(0, 49) {
            0 => 1,
            _ => dice.one_of(&[4, 5, 10, 20, 20, 50, 200]),
        };
        let seconds = dice.decades(0.1, 3.0);
        let knots = ((seconds * 1_000.0) as u64 / u64::from(period)).max(2);
        let way = choice::distance(dice, sheet, seconds);
        let ends = if dice.percent(75) {
            knots + 1
        } else {
            dice.between(1, knots)
        };
        let lead = dice.between(2, 150);
        Self {
            sheet: *sheet,
            start: Tick(now.0 / 1_000 + lead),
            period,
            number: dice.between(0, NUMBERS - 1) as u8,
            from: known.position.radians(),
            way,
            knots,
            next: 1,
            ends,
            // A few knots at least, and no more than are likely to be taken.
            ahead: u64::from(period) * 1_000 * dice.between(2, 5) + 5_000,
        }
    }

    pub(super) fn begin(&self, sequence: u8) -> Command {
        Command::StreamBegin {
            start: self.start,
            period: self.period,
            number: self.number,
            sequence,
        }
    }

    /// When the next knot is to be sent; none where there is none.
    pub(super) fn due(&self) -> Option<BusTime> {
        let tick = self.start.0 + self.next * u64::from(self.period);
        (self.next < self.ends).then(|| BusTime((tick * 1_000).saturating_sub(self.ahead)))
    }

    /// Sends what is due by `now`; some knots are forgotten, and some are sent twice.
    pub(super) fn feed(&mut self, now: BusTime, dice: &mut Dice, out: &mut Vec<Frame>) {
        while self.due().is_some_and(|due| due <= now) {
            let knot = self.knot(self.next);
            self.next += 1;
            if !dice.percent(98) {
                continue;
            }
            say(out, self.sheet.id, knot);
            if dice.percent(2) {
                say(out, self.sheet.id, knot);
            }
        }
    }

    /// Along 10 u^3 - 15 u^4 + 6 u^5, which is at rest at both ends.
    fn knot(&self, knot: u64) -> Command {
        let u = (knot as f64 / self.knots as f64).min(1.0);
        let lasts = self.knots as f64 * f64::from(self.period) / 1_000.0;
        let part = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
        let rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / lasts;
        Command::Knot {
            position: Position::from_radians(self.from + self.way * part).unwrap_or_default(),
            velocity: Velocity::from_radians(self.way * rate).unwrap_or_default(),
            number: ((u64::from(self.number) + knot) % NUMBERS) as u8,
        }
    }
}
