//! How long a bit is, and where it is sampled.
//!
//! Every board samples at 87.5 %, which CiA 301 asks for, and counts a bit in quanta of its
//! controller's clock:
//!
//! | board | clock | 1 Mbit/s | 500 kbit/s | 250 kbit/s |
//! |---|---|---|---|---|
//! | nucleo-g474re | 24 MHz | / 1 = 24 = 1 + 20 + 3 | / 1 = 48 = 1 + 41 + 6 | / 2 = 48 = 1 + 41 + 6 |
//! | nucleo-f446re | 40 MHz | / 5 = 8 = 1 + 6 + 1 | / 5 = 16 = 1 + 13 + 2 | / 10 = 16 = 1 + 13 + 2 |
//! | nucleo-h743zi2 | 80 MHz | / 1 = 80 = 1 + 69 + 10 | / 2 = 80 = 1 + 69 + 10 | / 4 = 80 = 1 + 69 + 10 |
//!
//! The first quantum synchronises, the sample is between the other two parts, and the last part is an
//! eighth of the bit. So is the jump width: as wide as it may be, so that a far-off clock is still
//! followed. After ISO 11898-1 two nodes may then differ by
//! 1/8 / (2 (13 - 1/8)) = 0.485 % each, at any of these rates.

/// The bit rate of the host's bus in bit/s. `CANTER_BITRATE=500000 cargo build ...` builds an image
/// for another one.
pub const BITRATE: u32 = rate(option_env!("CANTER_BITRATE"));

/// The bit rate of the drives' bus in bit/s: `CANTER_DRIVE_BITRATE`.
pub const DRIVE_BITRATE: u32 = rate(option_env!("CANTER_DRIVE_BITRATE"));

const fn rate(text: Option<&str>) -> u32 {
    match text {
        None => 1_000_000,
        Some(text) => match text.as_bytes() {
            b"1000000" => 1_000_000,
            b"500000" => 500_000,
            b"250000" => 250_000,
            _ => panic!("CANTER_BITRATE and CANTER_DRIVE_BITRATE are 1000000, 500000 or 250000"),
        },
    }
}

/// The parts of a bit, each in quanta of the divided clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BitTiming {
    /// What the controller's clock is divided by.
    pub prescaler: u16,
    /// Between the synchronising quantum and the sample.
    pub before_sample: u8,
    /// From the sample to the end of the bit.
    pub after_sample: u8,
}

impl BitTiming {
    /// Exactly `bitrate` from `clock`, both in Hz, sampled at exactly 87.5 %, with as many quanta to
    /// a bit as there are up to `most`.
    ///
    /// # Panics
    /// There is no such timing. It is worked out while the image is compiled.
    pub const fn new(clock: u32, bitrate: u32, most: u32) -> Self {
        let mut prescaler = 1;
        loop {
            assert!(
                prescaler * bitrate <= clock,
                "this clock has no such bit rate"
            );
            let quanta = clock / (prescaler * bitrate);
            let exact = quanta * prescaler * bitrate == clock;
            if exact && quanta.is_multiple_of(8) && quanta <= most {
                let after = quanta / 8;
                return Self {
                    prescaler: prescaler as u16,
                    before_sample: (quanta - 1 - after) as u8,
                    after_sample: after as u8,
                };
            }
            prescaler += 1;
        }
    }

    /// Quanta of a whole bit.
    const fn quanta(&self) -> u32 {
        1 + self.before_sample as u32 + self.after_sample as u32
    }
}

/// Every board's table, held to what it promises whichever board is built.
const _: () = {
    let boards = [(24_000_000, 80), (40_000_000, 25), (80_000_000, 80)];
    let rates = [1_000_000, 500_000, 250_000];
    let mut at = 0;
    while at < boards.len() * rates.len() {
        let (clock, most) = boards[at / rates.len()];
        let rate = rates[at % rates.len()];
        let timing = BitTiming::new(clock, rate, most);
        let quanta = timing.quanta();
        assert!(clock == rate * quanta * timing.prescaler as u32);
        // 87.5 % is 7 of 8.
        assert!(8 * (1 + timing.before_sample as u32) == 7 * quanta);
        // What bxCAN has room for, where `most` is its own.
        assert!(most > 25 || timing.before_sample <= 16 && timing.after_sample <= 8);
        at += 1;
    }
};
