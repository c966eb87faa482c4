//! bus.log: what was on the bus, what was handed over to be sent, and how to have it again.
//!
//! The log is one of can-utils (`candump -L`). On interface `can0` is what was on the bus, at the
//! end of each frame, for people and other tools. On `host` and `stranger` is what was handed over
//! to the controllers of the host and of the device that is not ours, when it was: a replay sends
//! just these. All else (nodes, crystals, plants, faults) comes from the seed, which stands in the
//! first line. Lines of a replay may be taken out to find out which of them it takes.

use std::io::{self, Write};
use std::path::PathBuf;

use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use thiserror::Error;

use super::actor::Voice;
use super::episode::{EPISODE, Ending, Options, play};
use super::fault::{Faults, UnknownFault};
use super::sabotage::Sabotage;
use crate::log::candump::{self, LineError};

/// How the first line begins.
const HEAD: &str = "# canter soak";

/// What was handed over to a controller, and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Input {
    pub(super) time: BusTime,
    pub(super) voice: Voice,
    pub(super) frame: Frame,
}

/// All that makes an episode happen again, and what it looked like.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recording {
    pub(super) seed: u64,
    pub(super) faults: Faults,
    pub(super) axes: Option<u8>,
    /// What was wrong, for people.
    pub(super) words: String,
    pub(super) inputs: Vec<Input>,
    pub(super) frames: Vec<(BusTime, Frame)>,
}

/// Why a log cannot be replayed.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// It cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It does not say which robot it is about.
    #[error(
        "the log's first line must be `{HEAD} --seed N --faults LIST` as `canter soak` writes it"
    )]
    NoSeed,
    /// It names a fault that is not there.
    #[error("the log's first line: {0}")]
    Fault(#[from] UnknownFault),
    /// A line is not of the format.
    #[error("line {line} of the log: {source}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        source: LineError,
    },
}

fn interface(voice: Voice) -> &'static str {
    match voice {
        Voice::Host => "host",
        Voice::Stranger => "stranger",
    }
}

impl Recording {
    /// Writes the log.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "{HEAD} --seed {} --faults {}", self.seed, self.faults)?;
        if let Some(axes) = self.axes {
            write!(out, " --axes {axes}")?;
        }
        writeln!(out)?;
        writeln!(out, "# {}", self.words.replace('\n', " "))?;
        let mut inputs = self.inputs.iter().peekable();
        for (time, frame) in &self.frames {
            while let Some(input) = inputs.next_if(|input| input.time <= *time) {
                candump::write_on(out, interface(input.voice), input.time, &input.frame)?;
            }
            candump::write(out, *time, frame)?;
        }
        for input in inputs {
            candump::write_on(out, interface(input.voice), input.time, &input.frame)?;
        }
        Ok(())
    }

    /// Reads the inputs of a log.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn read(text: &str) -> Result<Self, ReplayError> {
        let mut lines = text.lines();
        let head = lines.next().and_then(|line| line.strip_prefix(HEAD));
        let mut recording = Self::head(head.ok_or(ReplayError::NoSeed)?)?;
        for (at, line) in lines.enumerate() {
            if line.trim().is_empty() || line.starts_with('#') {
                continue;
            }
            let line_number = at + 2;
            let line = candump::parse(line).map_err(|source| ReplayError::Line {
                line: line_number,
                source,
            })?;
            let voices = [Voice::Host, Voice::Stranger];
            let voice = voices
                .into_iter()
                .find(|voice| interface(*voice) == line.interface);
            match voice {
                Some(voice) => recording.inputs.push(Input {
                    time: line.time,
                    voice,
                    frame: line.frame,
                }),
                None => recording.frames.push((line.time, line.frame)),
            }
        }
        Ok(recording)
    }

    fn head(line: &str) -> Result<Self, ReplayError> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let value = |name: &str| {
            let place = words.iter().position(|word| *word == name)?;
            words.get(place + 1).copied()
        };
        let seed = value("--seed").and_then(|seed| seed.parse().ok());
        let axes = value("--axes").map(str::parse).transpose();
        Ok(Self {
            seed: seed.ok_or(ReplayError::NoSeed)?,
            faults: value("--faults").ok_or(ReplayError::NoSeed)?.parse()?,
            axes: axes.map_err(|_| ReplayError::NoSeed)?,
            words: String::new(),
            inputs: Vec::new(),
            frames: Vec::new(),
        })
    }
}

/// Has the robot of a recording get again what it got then; `sabotage` is as it was then.
pub fn replay(recording: &Recording, sabotage: Option<Sabotage>) -> Ending {
    let options = Options {
        faults: recording.faults,
        axes: recording.axes,
        sabotage,
    };
    play(recording.seed, options, |stage, _| {
        for input in &recording.inputs {
            if !stage.run(input.time) {
                return;
            }
            stage.send(input.voice, input.frame);
        }
        stage.run(BusTime(EPISODE.as_micros() as u64));
    })
}
