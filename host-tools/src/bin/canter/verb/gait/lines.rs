//! Orders by lines, from a file or from stdin.

use super::pilot::{Heard, say};
use super::signals::Signals;
use anyhow::{Context as _, Result};
use canter::gait::Body;
use canter::walk::Line;
use std::io::{BufRead, BufReader, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// What a line may be long, in bytes: more than any order.
const LONGEST_LINE: u64 = 1_000;

/// Lines that are read ahead of their time.
const AHEAD: usize = 100;

/// How often somebody who waits for a line looks for signals.
const GLANCE: Duration = Duration::from_millis(50);

/// Lines as they come.
pub struct Lines {
    lines: Receiver<std::io::Result<String>>,
    /// Whether time stands still until the next line is there, as virtual time can.
    waits: bool,
    signals: Signals,
    /// When the next line counts, in s of the motion.
    resumes: f64,
    /// Of the last line, from 1.
    number: usize,
}

impl Lines {
    /// Opens a file, or stdin for `-`.
    pub fn open(name: &str, waits: bool, signals: Signals) -> Result<Self> {
        let source: Box<dyn Read + Send> = if name == "-" {
            Box::new(std::io::stdin())
        } else {
            let file = std::fs::File::open(name);
            Box::new(file.with_context(|| format!("cannot read the orders {name}"))?)
        };
        let (sender, lines) = sync_channel(AHEAD);
        std::thread::spawn(move || {
            let mut source = BufReader::new(source);
            loop {
                let mut text = String::new();
                let read = source.by_ref().take(LONGEST_LINE).read_line(&mut text);
                if matches!(read, Ok(0)) || sender.send(read.map(|_| text)).is_err() {
                    break;
                }
            }
        });
        Ok(Self {
            lines,
            waits,
            signals,
            resumes: 0.0,
            number: 0,
        })
    }

    /// The next order, for a robot that does `body` now.
    pub fn next(&mut self, time: f64, body: &Body) -> Heard {
        while time >= self.resumes {
            let text = match self.receive() {
                Ok(Ok(text)) => text,
                Ok(Err(error)) => {
                    say(&format!("orders: {error}; no more are read"));
                    return Heard::Over;
                }
                Err(RecvTimeoutError::Timeout) => return Heard::Nothing,
                Err(RecvTimeoutError::Disconnected) => return Heard::Over,
            };
            self.number += 1;
            match Line::parse(&text, body) {
                Ok(Line::Order(order)) => return Heard::Order(order),
                Ok(Line::Wait(seconds)) => self.resumes = time + seconds,
                Ok(Line::Nothing) => {}
                Err(error) => say(&format!("line {}: {error}", self.number)),
            }
        }
        Heard::Nothing
    }

    fn receive(&self) -> Result<std::io::Result<String>, RecvTimeoutError> {
        loop {
            let limit = if self.waits { GLANCE } else { Duration::ZERO };
            let received = self.lines.recv_timeout(limit);
            let is_over =
                !self.waits || self.signals.has_stopped() || self.signals.is_interrupted();
            if is_over || !matches!(received, Err(RecvTimeoutError::Timeout)) {
                return received;
            }
        }
    }
}
