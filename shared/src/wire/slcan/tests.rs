extern crate std;

use std::string::ToString;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;

fn decode_all(bytes: &[u8]) -> Vec<Result<Line, SlcanError>> {
    let mut decoder = Decoder::new();
    bytes.iter().filter_map(|&b| decoder.push(b)).collect()
}

fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::new(id, data).expect("a valid frame")
}

#[test]
fn a_frame_is_written_as_lawicel_wrote_it() {
    assert_eq!(encode(&frame(0x123, &[0xAB, 0xCD])), b"t1232ABCD\r");
    assert_eq!(encode(&frame(0x7FF, &[])), b"t7FF0\r");
    assert_eq!(
        encode(&frame(0, &[1, 2, 3, 4, 5, 6, 7, 0x8F])),
        b"t0008010203040506078F\r"
    );
}

#[test]
fn frames_are_read_with_and_without_time_stamp_in_either_case() {
    let expected = [Ok(Line::Frame(frame(0x12A, &[0xAB])))];
    assert_eq!(decode_all(b"t12A1AB\r"), expected);
    assert_eq!(decode_all(b"t12a1ab\r\n"), expected);
    assert_eq!(decode_all(b"t12A1ABEA5F\r"), expected);
}

#[test]
fn commands_and_answers_are_told_apart() {
    for (text, line) in [
        (&b"O\r"[..], Line::Open),
        (b"C\r", Line::Close),
        (b"S8\r", Line::Bitrate(8)),
        (b"V\r", Line::Version),
        (b"N\r", Line::SerialNumber),
        (b"F\r", Line::Status),
        (b"Z0\r", Line::Timestamp(false)),
        (b"Z1\r", Line::Timestamp(true)),
        (b"L\r", Line::ListenOnly),
        (b"\r", Line::Acknowledged),
        (b"z\r", Line::Acknowledged),
        (b"Z\r", Line::Acknowledged),
        (b"\x07", Line::Refused),
        (b"T000001232ABCD\r", Line::Unsupported),
        (b"T1FFFFFFF80102030405060708FFFF\r", Line::Unsupported),
        (b"r1230\r", Line::Unsupported),
        (b"R000001230\r", Line::Unsupported),
        (b"V1013\r", Line::Unsupported),
        (b"M00000000\r", Line::Unsupported),
    ] {
        assert_eq!(decode_all(text), [Ok(line)], "{text:?}");
    }
}

#[test]
fn bad_lines_say_what_is_wrong() {
    for (text, error) in [
        (&b"t12\r"[..], "a line of 3 characters is not a whole `t`"),
        (b"t1232AB\r", "not a whole `t` command"),
        (b"t1232ABCD1\r", "not a whole `t` command"),
        (b"t12X0\r", "byte 0x58 where a digit must be"),
        (b"t1231G0\r", "byte 0x47"),
        (b"t123100000G\r", "byte 0x47"),
        (b"t8000\r", "id 0x800 is over 0x7FF"),
        (b"t1239\r", "a frame of 9 bytes"),
        (b"S9\r", "bitrate number 9; the numbers are 0 to 8"),
        (b"Sx\r", "byte 0x78"),
        (b"S\r", "not a whole `S` command"),
        (b"O1\r", "not a whole `O` command"),
        (b"?\r", "no command starts with byte 0x3F"),
    ] {
        let lines = decode_all(text);
        let [Err(found)] = lines.as_slice() else {
            panic!("{text:?} gave {lines:?}");
        };
        assert!(found.to_string().contains(error), "{text:?}: {found}");
    }
}

#[test]
fn an_overlong_line_is_dropped_whole_with_one_error() {
    let mut bytes = [b't'; 1000].to_vec();
    bytes.extend_from_slice(b"\rO\r");
    assert_eq!(
        decode_all(&bytes),
        [Err(SlcanError::LineTooLong), Ok(Line::Open)]
    );
}

#[test]
fn a_refusal_drops_the_line_that_it_cut_off() {
    assert_eq!(
        decode_all(b"t12\x07O\r"),
        [Ok(Line::Refused), Ok(Line::Open)]
    );
}

proptest! {
    #[test]
    fn what_is_encoded_is_decoded(
        id in 0u16..0x800,
        data in prop::collection::vec(any::<u8>(), 0..=8),
        timestamp in prop::option::of(any::<u16>()),
    ) {
        let sent = frame(id, &data);
        let mut line = encode(&sent).to_vec();
        if let Some(timestamp) = timestamp {
            line.truncate(line.len() - 1);
            line.extend(std::format!("{timestamp:04x}\r").bytes());
        }
        prop_assert_eq!(decode_all(&line), [Ok(Line::Frame(sent))]);
    }

    #[test]
    fn any_bytes_are_survived_and_then_a_frame_is_read(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let sent = frame(0x123, &[1]);
        let mut all = bytes;
        all.push(CR);
        all.extend_from_slice(&encode(&sent));
        let lines = decode_all(&all);
        prop_assert_eq!(lines.last(), Some(&Ok(Line::Frame(sent))));
    }

    #[test]
    fn lines_that_look_like_frames_are_survived(text in "[tTZSz0-9A-Fa-f\r]{0,200}") {
        for decoded in decode_all(text.as_bytes()) {
            if let Ok(Line::Frame(frame)) = decoded {
                prop_assert_eq!(decode_all(&encode(&frame)), [Ok(Line::Frame(frame))]);
            }
        }
    }
}
