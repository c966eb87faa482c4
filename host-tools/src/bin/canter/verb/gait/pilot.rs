//! Who leads the robot: a script, a person, or nobody; and when it has walked enough.

use super::keys::Keys;
use super::lines::Lines;
use super::signals::Signals;
use canter::gait::Body;
use canter::walk::{Order, Orders, Phase, Settings, WalkError};
use std::time::{Duration, Instant};

/// Cycles of a walk that nobody ends sooner, and s of a stand.
const LEAST_CYCLES: f64 = 4.0;
const LEAST_STAND: f64 = 1.0;

/// What a leader has said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heard {
    Order(Order),
    Nothing,
    /// Nothing, and never again.
    Over,
}

/// Where orders come from.
pub enum Source {
    Nobody,
    Lines(Lines),
    Keys(Keys),
}

/// Leads the robot.
pub struct Pilot {
    source: Source,
    signals: Signals,
    /// For how long it walks, in s, where that was said.
    span: Option<f64>,
    /// For how long it walks at least, in s.
    least: f64,
    body: Body,
    /// The body before the last order, which may yet be refused.
    before: Body,
    phase: Option<Phase>,
    /// When it began to walk, in s of the motion.
    began: Option<f64>,
    /// When the motion's time was 0, for a motion in virtual time that is to be seen.
    origin: Option<Instant>,
    is_over: bool,
    /// Orders that were refused.
    pub refused: u32,
}

impl Pilot {
    /// Leads by `source`; `is_paced` lets virtual time pass as fast as real time.
    pub fn new(
        source: Source,
        signals: Signals,
        settings: &Settings,
        span: Option<f64>,
        is_paced: bool,
    ) -> Self {
        let period = settings.gait.map(|gait| gait.period);
        Self {
            source,
            signals,
            span,
            least: period.map_or(LEAST_STAND, |period| LEAST_CYCLES * period),
            body: settings.body,
            before: settings.body,
            phase: None,
            began: None,
            origin: is_paced.then(Instant::now),
            is_over: false,
            refused: 0,
        }
    }

    fn hear(&mut self, time: f64, walks: bool) -> Heard {
        match &mut self.source {
            // A file's first line is for the first step.
            Source::Lines(lines) if walks => lines.next(time, &self.body),
            Source::Lines(_) => Heard::Nothing,
            Source::Keys(keys) => keys.next(&self.body),
            Source::Nobody => Heard::Over,
        }
    }
}

impl Orders for Pilot {
    fn next(&mut self, time: f64, phase: Phase) -> Option<Order> {
        let walks = phase == Phase::Walking;
        let mut order = None;
        if !self.is_over {
            match self.hear(time, walks) {
                Heard::Order(heard) => order = Some(heard),
                Heard::Nothing => {}
                Heard::Over => self.is_over = true,
            }
        }
        let walked = time - self.began.unwrap_or(time);
        let is_long_enough = match self.span {
            Some(span) => walked >= span,
            None => self.is_over && walked >= self.least,
        };
        if self.signals.has_stopped() || (walks && is_long_enough) || order == Some(Order::Stop) {
            // The next signal does not ask for what is under way.
            self.signals.stop();
            return Some(Order::Stop);
        }
        if let Some(Order::Body(body)) = order {
            self.before = self.body;
            self.body = body;
        }
        order
    }

    fn refused(&mut self, order: &Order, why: &WalkError) {
        self.refused += 1;
        if matches!(order, Order::Body(_)) {
            self.body = self.before;
        }
        say(&format!("order refused: {why}"));
    }

    fn passes(&mut self, time: f64, phase: Phase) {
        self.signals.walks();
        if phase == Phase::Walking {
            self.began.get_or_insert(time);
        }
        if self.phase.replace(phase) != Some(phase) {
            say(&format!("{time:7.2} s: {}", phase.words()));
        }
        if let Source::Keys(keys) = &mut self.source
            && self.signals.has_stopped()
        {
            // Nobody asks for orders any more, but a person may yet want to end it at once.
            keys.next(&self.body);
        }
        if let Some(origin) = self.origin {
            let due = origin + Duration::from_secs_f64(time);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }
}

/// Says something on stderr, whatever mode the terminal is in.
pub fn say(words: &str) {
    let end = match crossterm::terminal::is_raw_mode_enabled() {
        Ok(true) => "\r\n",
        _ => "\n",
    };
    eprint!("{words}{end}");
}
