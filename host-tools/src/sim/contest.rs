//! What happens when several send the same identifier at once.
//!
//! Arbitration does not tell them apart, so they go on together until one sends a recessive bit
//! where another sends a dominant one. It takes that for an error. As long as it is error active,
//! its flag destroys the frame of all of them; error passive, it only gives up.

use canter_shared::wire::frame::Frame;

use super::bits;

/// One of those that send.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contender {
    /// Its place on the bus.
    pub(super) place: usize,
    /// What it sends.
    pub(super) frame: Frame,
    /// Whether it may destroy frames.
    pub(super) error_active: bool,
}

/// How it ends.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// After this many bits for all of them.
    Destroyed(u32),
    /// These have given up, and the others send the very same to its end.
    Decided { given_up: Vec<usize> },
}

/// Lets `contenders`, who send one identifier, go on until all that are left send the same.
pub(super) fn decide(mut contenders: Vec<Contender>) -> Outcome {
    let mut given_up = Vec::new();
    loop {
        // The first bit at which anybody differs from the first; then who of them is recessive.
        let Some(first) = contenders.first() else {
            return Outcome::Decided { given_up };
        };
        let difference = contenders
            .iter()
            .filter_map(|other| bits::first_difference(&first.frame, &other.frame))
            .min();
        let Some(bit) = difference else {
            return Outcome::Decided { given_up };
        };
        let (recessive, dominant): (Vec<_>, Vec<_>) = contenders
            .into_iter()
            .partition(|contender| bits::is_recessive(&contender.frame, bit));
        if recessive.iter().any(|contender| contender.error_active) {
            let passed = dominant
                .first()
                .map_or(0, |one| bits::on_wire(&one.frame, bit));
            return Outcome::Destroyed(passed);
        }
        given_up.extend(recessive.iter().map(|contender| contender.place));
        contenders = dominant;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contender(place: usize, data: &[u8], error_active: bool) -> Contender {
        Contender {
            place,
            frame: Frame::new(0x123, data).expect("a valid frame"),
            error_active,
        }
    }

    #[test]
    fn the_same_frame_is_sent_together() {
        let frames = (0..3).map(|place| contender(place, &[1, 2], true));
        let decided = Outcome::Decided { given_up: vec![] };
        assert_eq!(decide(frames.collect()), decided);
    }

    #[test]
    fn different_payloads_destroy_each_other_at_the_first_different_bit() {
        let frames = vec![contender(0, &[0], true), contender(1, &[1], true)];
        // 0 00100100011 000 0001: 19 bits up to the data, and one stuff bit in the six zeros.
        // Of the data the last of 8 bits differs, and the seven zeros before have one, too.
        let passed = 19 + 1 + 8 + 1;
        assert_eq!(decide(frames), Outcome::Destroyed(passed));
    }

    #[test]
    fn an_error_passive_one_gives_up_to_the_dominant_bit() {
        let frames = vec![
            contender(3, &[0x80], false),
            contender(5, &[0x40], false),
            contender(7, &[0x00], true),
        ];
        let given_up = vec![3, 5];
        assert_eq!(decide(frames), Outcome::Decided { given_up });
        // A shorter frame has the dominant bits in its length.
        let frames = vec![contender(3, &[0; 2], false), contender(5, &[0; 1], false)];
        let given_up = vec![3];
        assert_eq!(decide(frames), Outcome::Decided { given_up });
    }
}
