//! How long a frame is on the bus, bit by bit (ISO 11898-1, classic base format).

use canter_shared::wire::frame::Frame;

/// CRC delimiter, acknowledge slot and delimiter, end of frame: never stuffed.
const TAIL: u32 = 1 + 2 + 7;

/// Recessive bits after a frame before the next may begin.
pub(crate) const INTERFRAME: u32 = 3;

const CRC_BITS: u32 = 15;

/// x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1.
const CRC_POLYNOMIAL: u16 = 0x4599;

const CRC_MASK: u16 = (1 << CRC_BITS) - 1;

/// What each byte makes of a CRC of zero.
const CRC_TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < table.len() {
        let mut crc = (byte as u16) << (CRC_BITS - 8);
        let mut bit = 0;
        while bit < 8 {
            let feedback = crc >> (CRC_BITS - 1) & 1;
            crc = (crc << 1) & CRC_MASK ^ (feedback * CRC_POLYNOMIAL);
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

/// Equal bits after which a complementary one is put in.
const RUN: u32 = 5;

/// Bits, the first sent being the most significant of `count`.
#[derive(Clone, Copy)]
struct Bits {
    word: u128,
    count: u32,
}

impl Bits {
    fn push(&mut self, value: u16, count: u32) {
        self.word = (self.word << count) | u128::from(value);
        self.count += count;
    }

    /// The first `count` of them.
    fn head(self, count: u32) -> Self {
        Self {
            word: self.word >> self.count.saturating_sub(count),
            count: count.min(self.count),
        }
    }

    fn iter(self) -> impl Iterator<Item = bool> {
        (0..self.count)
            .rev()
            .map(move |place| (self.word >> place) & 1 == 1)
    }

    /// Bit after bit from the first on; zeros before it, which make whole bytes of them, change
    /// nothing.
    fn crc(self) -> u16 {
        let bytes = self.word.to_be_bytes();
        let first = bytes.len() - self.count.div_ceil(8) as usize;
        bytes[first..].iter().fold(0, |crc, byte| {
            let place = (crc >> (CRC_BITS - 8)) as u8 ^ byte;
            (crc << 8) & CRC_MASK ^ CRC_TABLE[usize::from(place)]
        })
    }

    /// Bits that stuffing puts in. One that was put in begins the next run.
    fn stuffed(self) -> u32 {
        let (mut last, mut run, mut stuffed) = (true, 0, 0);
        for bit in self.iter() {
            if run > 0 && bit == last {
                run += 1;
            } else {
                (last, run) = (bit, 1);
            }
            if run == RUN {
                stuffed += 1;
                (last, run) = (!bit, 1);
            }
        }
        stuffed
    }
}

/// What is stuffed of a frame: its start, identifier, length, data and CRC.
fn stuffed_part(frame: &Frame) -> Bits {
    let mut bits = Bits { word: 0, count: 0 };
    // Start of frame, identifier; data frame (RTR), base format (IDE) and r0 are dominant.
    bits.push(0, 1);
    bits.push(frame.id(), 11);
    bits.push(0, 3);
    bits.push(frame.data().len() as u16, 4);
    for byte in frame.data() {
        bits.push(u16::from(*byte), 8);
    }
    bits.push(bits.crc(), CRC_BITS);
    bits
}

/// Bits from the start of the frame to the end of its end-of-frame field, stuff bits included.
pub(crate) fn length(frame: &Frame) -> u32 {
    let bits = stuffed_part(frame);
    bits.count + bits.stuffed() + TAIL
}

/// Bits of the longest frame of so many bytes, the space to the next frame included: of those that may
/// be stuffed, every fourth after the first has a stuff bit behind it.
pub(crate) const fn longest(bytes: u8) -> u32 {
    // Start, identifier, RTR, IDE and r0, length.
    let head = 1 + 11 + 3 + 4;
    let stuffed = head + 8 * bytes as u32 + CRC_BITS;
    stuffed + (stuffed - 1) / (RUN - 1) + TAIL + INTERFRAME
}

/// The first bit, counted from 0 and without stuff bits, at which two frames differ.
pub(super) fn first_difference(one: &Frame, other: &Frame) -> Option<u32> {
    let (one, other) = (stuffed_part(one), stuffed_part(other));
    // Frames of different length differ in the bits that tell it, long before the shorter ends.
    let common = one.count.min(other.count);
    let differences = one.head(common).word ^ other.head(common).word;
    (differences != 0).then(|| common - 1 - differences.ilog2())
}

/// Whether the bit of that number is recessive.
pub(super) fn is_recessive(frame: &Frame, bit: u32) -> bool {
    let bits = stuffed_part(frame);
    bit < bits.count && (bits.word >> (bits.count - 1 - bit)) & 1 == 1
}

/// How many bits have been on the wire, stuff bits included, once the bit of that number is over.
pub(super) fn on_wire(frame: &Frame, bit: u32) -> u32 {
    bit + stuffed_part(frame).head(bit).stuffed() + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::random::SplitMix64;

    fn bits(text: &str) -> Bits {
        let mut bits = Bits { word: 0, count: 0 };
        for digit in text.chars() {
            bits.push(u16::from(digit == '1'), 1);
        }
        bits
    }

    fn with_interframe(id: u16, data: &[u8]) -> u32 {
        length(&Frame::new(id, data).expect("a valid frame")) + INTERFRAME
    }

    #[test]
    fn crc_gives_the_check_value_of_crc_15_can() {
        // The catalogue of parametrised CRC algorithms: CRC-15/CAN of "123456789" is 0x059E.
        let mut text = Bits { word: 0, count: 0 };
        for byte in b"123456789" {
            text.push(u16::from(*byte), 8);
        }
        assert_eq!(text.crc(), 0x059E);
    }

    #[test]
    fn stuffing_by_hand() {
        for (text, stuffed) in [
            ("", 0),
            ("0000", 0),
            ("00000", 1),
            // The stuffed 1 interrupts: five more zeros for the next.
            ("000000000", 1),
            ("0000000000", 2),
            // The stuffed 1 counts for the run of ones.
            ("000001111", 2),
            ("00000111", 1),
            ("0101010101010101", 0),
        ] {
            assert_eq!(bits(text).stuffed(), stuffed, "{text}");
        }
        // The worst that 98 bits can be: 00000 1111 0000 1111 ..., (98 - 1) / 4 stuff bits.
        let worst: String = (0..98)
            .map(|at| {
                if at == 0 || (at - 1) / 4 % 2 == 0 {
                    '0'
                } else {
                    '1'
                }
            })
            .collect();
        assert_eq!(bits(&worst).stuffed(), 24);
        assert_eq!(98 + 24 + TAIL + INTERFRAME, 135);
    }

    #[test]
    fn no_frame_is_longer_than_the_longest() {
        assert_eq!(longest(8), 135);
        let mut random = SplitMix64::new(3);
        for bytes in 0..=8 {
            let data = 0x1E1E_1E1E_1E1E_1E1E_u64.to_le_bytes();
            assert!(with_interframe(0x78, &data[..usize::from(bytes)]) <= longest(bytes));
            let data = random.next().to_le_bytes();
            assert!(with_interframe(0x078, &data[..usize::from(bytes)]) <= longest(bytes));
        }
    }

    #[test]
    fn an_empty_frame_of_id_zero_by_hand() {
        // 19 zeros before the CRC, which is zero too: 34 zeros, 6 stuff bits.
        assert_eq!(with_interframe(0, &[]), 34 + 6 + 10 + 3);
    }

    #[test]
    fn eight_bytes_take_111_to_135_bits() {
        let mut random = SplitMix64::new(7);
        let mut least = u32::MAX;
        for _ in 0..100_000 {
            let id = random.up_to(0x7FF) as u16;
            let length = with_interframe(id, &random.next().to_le_bytes());
            assert!((111..=135).contains(&length), "{length}");
            least = least.min(length);
        }
        assert_eq!(least, 111);
    }
}
