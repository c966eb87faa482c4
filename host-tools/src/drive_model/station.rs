//! A drive that gets into trouble, some time after it was enabled.

use super::{Model, Seen};
use canter_shared::wire::frame::Frame;

/// Ticks that a drive is away when its power goes and comes.
const AWAY: u32 = 2_000;

/// What a drive can get into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trouble {
    /// A fault: its supply is too low.
    Fault,
    /// Its power goes and comes.
    Reboot,
    /// Nobody hears it any more, though it goes on.
    Silence,
    /// It hears nobody any more, though it speaks.
    Deaf,
    /// It stops by itself, without a fault.
    DropOut,
}

/// Which trouble, how many ticks after it was enabled first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    /// What happens.
    pub trouble: Trouble,
    /// When.
    pub after: u32,
}

/// A drive with a number, and the trouble that waits for it.
pub struct Station {
    node: u8,
    model: Box<dyn Model>,
    trials: Vec<Trial>,
    /// Ticks since it was enabled first.
    enabled: Option<u32>,
    away: u32,
    silent: bool,
    deaf: bool,
}

impl Station {
    /// The drive of this id.
    pub fn new(node: u8, model: Box<dyn Model>, trials: Vec<Trial>) -> Self {
        Self {
            node,
            model,
            trials,
            enabled: None,
            away: 0,
            silent: false,
            deaf: false,
        }
    }

    /// Its id.
    pub fn node(&self) -> u8 {
        self.node
    }

    /// What it does.
    pub fn seen(&self) -> Seen {
        self.model.seen()
    }

    /// Takes a frame of the bus.
    pub fn receive(&mut self, frame: &Frame) {
        if self.away == 0 && !self.deaf {
            self.model.receive(frame);
        }
    }

    /// The next frame for the bus.
    pub fn poll_transmit(&mut self) -> Option<Frame> {
        // What nobody hears is gone all the same.
        let heard = !self.silent && self.away == 0;
        std::iter::from_fn(|| self.model.poll_transmit()).find(|_| heard)
    }

    /// Gets into trouble now.
    pub fn suffer(&mut self, trouble: Trouble) {
        match trouble {
            Trouble::Fault => self.model.fail(),
            Trouble::DropOut => self.model.drop_out(),
            Trouble::Silence => self.silent = true,
            Trouble::Deaf => self.deaf = true,
            Trouble::Reboot => {
                self.model.drop_out();
                self.away = AWAY;
            }
        }
    }

    /// A millisecond passes; the trouble that came with it.
    pub fn tick(&mut self) -> Option<Trouble> {
        self.model.tick();
        if self.away > 0 {
            self.away -= 1;
            if self.away == 0 {
                self.model.restart();
            }
        }
        if self.enabled.is_some() || self.model.seen().enabled {
            self.enabled = Some(self.enabled.map_or(0, |ticks| ticks + 1));
        }
        let due = self
            .trials
            .iter()
            .find(|trial| self.enabled == Some(trial.after));
        let trouble = due.map(|trial| trial.trouble)?;
        self.suffer(trouble);
        Some(trouble)
    }
}
