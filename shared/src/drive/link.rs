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
pub struct DriveLink(Language);

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
        Self(match settings.kind {
            DriveKind::Simulated => {
                let drive = Simulated::new(Position::ZERO);
                Language::Simulated(drive.with_zero(settings.offset))
            }
            DriveKind::Odrive => Language::Odrive(Odrive::new(settings)),
            DriveKind::Mit => Language::Mit(Mit::new(settings)),
            DriveKind::Cia402 => Language::Cia402(Cia402::new(settings)),
        })
    }
}

impl Drive for DriveLink {
    fn command(&mut self, tick: Tick, command: DriveCommand) {
        each!(&mut self.0, drive => drive.command(tick, command));
    }

    fn report(&self) -> DriveReport {
        each!(&self.0, drive => drive.report())
    }

    fn receive(&mut self, frame: &Frame) -> bool {
        each!(&mut self.0, drive => drive.receive(frame))
    }

    fn poll_transmit(&mut self) -> Option<Frame> {
        each!(&mut self.0, drive => drive.poll_transmit())
    }

    fn take_sync(&mut self) -> bool {
        each!(&mut self.0, drive => drive.take_sync())
    }

    fn configure(&mut self, settings: impl FnOnce() -> DriveSettings) {
        let settings = settings();
        match (&mut self.0, settings.kind) {
            (Language::Simulated(drive), DriveKind::Simulated) => drive.set_zero(settings.offset),
            // As a new one: what was heard may have been another drive's, or meant another place.
            _ => *self = Self::new(&settings),
        }
    }
}
