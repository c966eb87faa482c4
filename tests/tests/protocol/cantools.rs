//! What cantools, which shares no code with canter, makes of canter.dbc.

use super::golden::{self, text};
use canter::dbc::{addresses, message_name};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, split};
use canter_shared::wire::layout::{Choices, Field, LAYOUTS, Layout};
use canter_tests::root;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

/// The interpreter that has cantools.
fn python() -> String {
    let candidates = [std::env::var("CANTER_PYTHON").ok(), Some("python3".into())];
    let has_cantools = |python: &String| {
        let output = Command::new(python)
            .args(["-c", "import cantools"])
            .output();
        output.is_ok_and(|output| output.status.success())
    };
    candidates
        .into_iter()
        .flatten()
        .find(has_cantools)
        .expect("no Python has cantools: run `tests/run fast`, which makes one and names it in CANTER_PYTHON")
}

/// Hands the frames to tests/golden/decode.py and gives what it says.
fn ask(frames: &[Frame]) -> Value {
    let mut child = Command::new(python())
        .arg(root().join("tests/golden/decode.py"))
        .arg(root().join("canter.dbc"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python runs");
    let frames: Vec<_> = frames.iter().map(text).collect();
    let mut input = child.stdin.take().expect("its input is piped");
    // It reads all of its input before it writes.
    let written = input.write_all(json!(frames).to_string().as_bytes());
    drop(input);
    let output = child.wait_with_output().expect("Python ends");
    assert!(output.status.success(), "decode.py failed: {output:?}");
    written.expect("Python reads its input");
    serde_json::from_slice(&output.stdout).expect("decode.py writes JSON")
}

/// The fields that a payload has.
fn fields(layout: &Layout, word: u64) -> impl Iterator<Item = &'static Field> {
    let part = layout.fields.first().map(|first| first.get(word));
    let present = move |field: &&Field| field.part.is_none() || field.part.map(i64::from) == part;
    layout.fields.iter().filter(present)
}

/// Holds what cantools says of a frame against the table of fields: the raw values, and the values
/// with their factor to the last bit.
#[track_caller]
fn check(frame: &Frame, said: &Value) {
    let function = split(frame.id()).map(|(function, _)| function);
    let layout = function.and_then(Layout::of).expect("a known function");
    let word = frame.word();
    for field in fields(layout, word) {
        let raw = field.get(word);
        assert_eq!(said["raw"][field.name], raw, "{}: {said}", field.name);
        let scaled = said["scaled"][field.name].as_str().expect("text");
        if field.factor == 1.0 {
            assert_eq!(scaled.parse(), Ok(raw), "{}: {said}", field.name);
        } else {
            let wanted = raw as f64 * field.factor;
            assert_eq!(scaled.parse(), Ok(wanted), "{}: {said}", field.name);
        }
    }
    let count = |what: &str| said[what].as_object().map(serde_json::Map::len);
    let wanted = Some(fields(layout, word).count());
    assert_eq!((count("raw"), count("scaled")), (wanted, wanted), "{said}");
    assert_eq!(said["from_raw"], text(frame).as_str(), "{said}");
}

/// Frames with each field at one end of its range and the others at the other end: a field that
/// lies elsewhere shows.
fn edges(layout: &Layout, address: Address) -> Vec<Frame> {
    let id = address.frame_id(layout.function);
    let parts = layout.fields.iter().filter_map(|field| field.part);
    let parts: Vec<_> = parts
        .max()
        .map_or(vec![None], |last| (0..=last).map(Some).collect());
    let mut frames = Vec::new();
    for part in parts {
        let present: Vec<_> = layout
            .fields
            .iter()
            .filter(|field| field.part == part)
            .collect();
        // Only the first field tells parts apart, so it keeps its value.
        let base = match (part, layout.fields.first()) {
            (Some(part), Some(first)) => first.put(0, part.into()),
            _ => 0,
        };
        let fill = |word: u64, field: &Field, high: bool| {
            let (least, greatest) = field.range();
            field.put(word, if high { greatest } else { least })
        };
        for chosen in 0..=present.len() {
            for high in [false, true] {
                let word = present
                    .iter()
                    .enumerate()
                    .fold(base, |word, (index, field)| {
                        fill(word, field, high == (index == chosen))
                    });
                let data = word.to_le_bytes();
                let data = &data[..usize::from(layout.length)];
                frames.push(Frame::new(id, data).expect("it fits"));
            }
        }
    }
    frames
}

#[test]
fn cantools_reads_and_writes_the_golden_frames() {
    let goldens = golden::read();
    let frames: Vec<_> = goldens.iter().map(|golden| golden.frame).collect();
    let said = ask(&frames);
    for (golden, said) in goldens
        .iter()
        .zip(said["frames"].as_array().expect("a list"))
    {
        check(&golden.frame, said);
        assert_eq!(said["message"], golden.message.as_str());
        assert_eq!(said["from_scaled"], golden.text.as_str());
    }
    let names = |text: &str| {
        let index = goldens.iter().position(|golden| golden.text == text);
        &said["frames"][index.expect("a golden frame")]["names"]
    };
    assert_eq!(names("187#0302DEC0")["action"], "enable");
    let refused = names("407#030806E4000000");
    assert_eq!(
        (&refused["function"], &refused["reason"]),
        (&json!("MoveBeta"), &json!("too_fast"))
    );
    let heartbeat = names("607#0702000001020304");
    assert_eq!(
        (&heartbeat["state"], &heartbeat["fault"]),
        (&json!("fault"), &json!("host_timeout"))
    );
    assert_eq!(names("607#0400DEC000000000")["fault"], "none");
    assert_eq!(names("747#00010210000102")["board"], "nucleo-g474re");
}

#[test]
fn cantools_knows_every_frame_and_every_bit() {
    let mut frames = Vec::new();
    let mut messages = serde_json::Map::new();
    for layout in &LAYOUTS {
        for address in addresses(layout.addressing) {
            frames.extend(edges(layout, address));
            let signal = |field: &Field| {
                let choices = field.choices != Choices::None;
                let signal = json!({ "unit": field.unit, "choices": choices });
                (field.name.to_owned(), signal)
            };
            let signals: serde_json::Map<_, _> = layout.fields.iter().map(signal).collect();
            let id = address.frame_id(layout.function);
            let sender = format!("{:?}", layout.sender);
            let message =
                json!({ "id": id, "length": layout.length, "sender": sender, "signals": signals });
            messages.insert(message_name(layout.function, address), message);
        }
    }
    let said = ask(&frames);
    let known = said["messages"].as_object().expect("an object");
    for (name, message) in &messages {
        assert_eq!(known.get(name), Some(message), "{name}");
    }
    assert_eq!(
        known.len(),
        messages.len(),
        "canter.dbc has frames of its own"
    );
    let answers = said["frames"].as_array().expect("a list");
    assert_eq!(answers.len(), frames.len());
    for (frame, said) in frames.iter().zip(answers) {
        check(frame, said);
    }
}
