//! The drive that the parameters choose.

use super::cia402::Cia402;
use super::mit::Mit;
use super::odrive::Odrive;
use super::settings::{DriveKind, DriveSettings};
use super::simulated::Simulated;
use super::{Drive, DriveCommand, DriveReport};
use crate::time::Tick;
use crate::units::Position;
use crate::wire::frame::Frame;

#[derive(Debug, Clone)]
enum Language {
    Simulated(Simulated),
    Odrive(Odrive),
    Mit(Mit),
    Cia402(Cia402),
}

/// A drive of any language.
#[derive(Debug, Clone)]
pub struct DriveLink {
    settings: DriveSettings,
    language: Language,
}

/// Does the same with the drive of each language.
macro_rules! each {
    ($language:expr, $drive:ident => $what:expr) => {
        match $language {
            Language::Simulated($drive) => $what,
            Language::Odrive($drive) => $what,
            Language::Mit($drive) => $what,
            Language::Cia402($drive) => $what,
        }
    };
}

impl DriveLink {
    /// A drive that has not been heard yet; a simulated one stands at zero.
    pub fn new(settings: &DriveSettings) -> Self {
        let language = match settings.kind {
            DriveKind::Simulated => Language::Simulated(Simulated::new(Position::ZERO)),
            DriveKind::Odrive => Language::Odrive(Odrive::new(settings)),
            DriveKind::Mit => Language::Mit(Mit::new(settings)),
            DriveKind::Cia402 => Language::Cia402(Cia402::new(settings)),
        };
        Self {
            settings: *settings,
            language,
        }
    }

    /// What it knows of its drive.
    pub fn settings(&self) -> &DriveSettings {
        &self.settings
    }
}

impl Drive for DriveLink {
    fn command(&mut self, tick: Tick, command: DriveCommand) {
        each!(&mut self.language, drive => drive.command(tick, command));
    }

    fn report(&self) -> DriveReport {
        each!(&self.language, drive => drive.report())
    }

    fn receive(&mut self, frame: &Frame) -> bool {
        each!(&mut self.language, drive => drive.receive(frame))
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        each!(&mut self.language, drive => drive.poll_transmit())
    }

    fn take_sync(&mut self) -> bool {
        each!(&mut self.language, drive => drive.take_sync())
    }

    fn configure(&mut self, settings: impl FnOnce() -> DriveSettings) {
        let settings = settings();
        if let (Language::Simulated(drive), DriveKind::Simulated) =
            (&mut self.language, settings.kind)
        {
            drive.shift(settings.offset - self.settings.offset);
            self.settings = settings;
        } else if settings != self.settings {
            // As a new one: what was heard may have been another drive's, or meant another place.
            *self = Self::new(&settings);
        }
    }
}
