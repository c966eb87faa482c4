//! `canter log`: what is in a log of the bus, how full the bus was, and its commands once more.

use crate::arguments::{LogAction, LogFile, LogStats};
use crate::context::{Context, on_signal, print_all};
use anyhow::{Context as _, Result, bail};
use canter::bus::Bitrate;
use canter::log::{Decoded, Entry, ReadError, Reader, Statistics, Traffic, Value, decode, replay};
use canter_shared::time::BusTime;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::Address;
use serde_json::{Map, Value as Json, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

pub fn run(context: &Context, action: &LogAction) -> Result<()> {
    match action {
        LogAction::Decode(log) => decode_all(context, log),
        LogAction::Stats(arguments) => stats(context, arguments),
        LogAction::Replay(log) => play(context, log),
    }
}

type Frames<'a> = Reader<Box<dyn BufRead + 'a>>;

fn open(log: &LogFile) -> Result<Frames<'static>> {
    let input: Box<dyn BufRead> = if log.file == "-" {
        Box::new(std::io::stdin().lock())
    } else {
        let file = File::open(&log.file).with_context(|| format!("cannot read {}", log.file))?;
        Box::new(BufReader::new(file))
    };
    Ok(Reader::new(input))
}

/// What is passed over in a log, and told at the end.
#[derive(Default)]
struct PassedOver {
    unreadable: u64,
    foreign: BTreeMap<&'static str, u64>,
}

impl PassedOver {
    /// The frame of an entry, where it is one of the wanted interface.
    fn frame(
        &mut self,
        log: &LogFile,
        entry: Result<Entry, ReadError>,
    ) -> Result<Option<(BusTime, String, Frame)>> {
        match entry {
            Ok(Entry::Frame {
                time,
                interface,
                frame,
            }) => {
                let wanted = log.interface.as_ref().is_none_or(|only| *only == interface);
                Ok(wanted.then_some((time, interface, frame)))
            }
            Ok(Entry::Foreign(kind)) => {
                *self.foreign.entry(kind).or_default() += 1;
                Ok(None)
            }
            Err(error @ ReadError::Line { .. }) => {
                eprintln!("{}: {error}", log.file);
                self.unreadable += 1;
                Ok(None)
            }
            Err(error @ ReadError::File { .. }) => Err(error).context(log.file.clone()),
        }
    }

    /// Tells of it; a log that could not be read whole is a failure.
    fn tell(&self, log: &LogFile) -> Result<()> {
        for (kind, count) in &self.foreign {
            eprintln!("passed over: {count} {kind} frames, which canter does not use");
        }
        if self.unreadable > 0 {
            let (count, file) = (self.unreadable, &log.file);
            bail!(
                "{count} lines of {file} are not of a candump log, see above; the others were read"
            );
        }
        Ok(())
    }
}

fn decode_all(context: &Context, log: &LogFile) -> Result<()> {
    let mut passed_over = PassedOver::default();
    let mut failed = None;
    let mut lines = open(log)?.filter_map(|entry| match passed_over.frame(log, entry) {
        Ok(frame) => frame.map(|(time, interface, frame)| {
            if context.json {
                json_of(time, &interface, &frame).to_string()
            } else {
                let (seconds, rest) = (time.0 / 1_000_000, time.0 % 1_000_000);
                format!("({seconds:010}.{rest:06}) {interface} {}", words(&frame))
            }
        }),
        Err(error) => {
            failed = Some(error);
            None
        }
    });
    if log.file == "-" {
        // Whoever writes it may still be writing: each line is shown when it comes.
        lines.try_for_each(|line| print_all(std::iter::once(line)))?;
    } else {
        print_all(lines)?;
    }
    failed.map_or_else(|| passed_over.tell(log), Err)
}

/// The meaning of a frame, or the frame itself where it is none of canter's.
fn words(frame: &Frame) -> String {
    decode(frame).map_or_else(
        || format!("{:03X}#{} is no frame of canter's", frame.id(), hex(frame)),
        |decoded| decoded.to_string(),
    )
}

fn hex(frame: &Frame) -> String {
    frame
        .data()
        .iter()
        .map(|byte| format!("{byte:02X}"))
        .collect()
}

fn json_of(time: BusTime, interface: &str, frame: &Frame) -> Json {
    let decoded = decode(frame);
    json!({
        "time": time.0 as f64 / 1e6,
        "interface": interface,
        "id": frame.id(),
        "data": hex(frame),
        "message": decoded.as_ref().map(|decoded| format!("{:?}", decoded.function)),
        "axis": decoded.as_ref().and_then(|decoded| match decoded.address {
            Address::All => None,
            Address::Axis(axis) => Some(axis.get()),
        }),
        "fields": decoded.as_ref().map(fields),
    })
}

/// Numbers in rad and s, names as words.
fn fields(decoded: &Decoded) -> Map<String, Json> {
    let fields = decoded.fields.iter().map(|(name, value)| {
        let value = match value {
            Value::Number {
                value, unit: "", ..
            } => json!(*value as i64),
            Value::Number { value, .. } => json!(value),
            Value::Name(name) => json!(name),
        };
        ((*name).to_owned(), value)
    });
    fields.collect()
}

fn stats(context: &Context, arguments: &LogStats) -> Result<()> {
    let (log, bitrate) = (&arguments.log, arguments.bitrate);
    let mut passed_over = PassedOver::default();
    let mut statistics = Statistics::default();
    for entry in open(log)? {
        if let Some((time, interface, frame)) = passed_over.frame(log, entry)? {
            statistics.add(&interface, time, &frame);
        }
    }
    let buses = statistics.buses();
    context.print_json(&json!({
        "bitrate": bitrate.bits_per_second(),
        "interfaces": buses.map(|(name, bus)| document(name, bus, bitrate)).collect::<Vec<_>>(),
        "foreign": passed_over.foreign,
        "unreadable": passed_over.unreadable,
    }));
    if !context.json {
        for (name, bus) in statistics.buses() {
            print_all(table(name, bus, bitrate).into_iter())?;
        }
    }
    passed_over.tell(log)
}

fn document(name: &str, bus: &Traffic, bitrate: Bitrate) -> Json {
    let messages = bus.messages().map(|(message, count)| {
        json!({
            "message": message,
            "frames": count.frames,
            "load": bus.load_of(count, bitrate),
        })
    });
    json!({
        "interface": name,
        "frames": bus.total().frames,
        "duration": bus.duration(),
        "load": bus.load_of(bus.total(), bitrate),
        "peak_load": bus.peak_load(bitrate),
        "longest_silence": bus.longest_silence(),
        "messages": messages.collect::<Vec<_>>(),
    })
}

fn table(name: &str, bus: &Traffic, bitrate: Bitrate) -> Vec<String> {
    let percent = |share: f64| 100.0 * share;
    let total = bus.total();
    let mut lines = vec![
        format!(
            "{name}: {} frames in {:.3} s; at {} bit/s the bus was {:.1} % full, in its fullest 0.1 s {:.1} %; \
             longest silence {:.6} s",
            total.frames,
            bus.duration(),
            bitrate.bits_per_second(),
            percent(bus.load_of(total, bitrate)),
            percent(bus.peak_load(bitrate)),
            bus.longest_silence(),
        ),
        format!(
            "{:<16} {:>10} {:>12} {:>8}",
            "message", "frames", "frames/s", "load %"
        ),
    ];
    let mut messages: Vec<_> = bus.messages().collect();
    messages.sort_by_key(|(_, count)| std::cmp::Reverse(count.bits));
    let duration = bus.duration();
    lines.extend(messages.into_iter().map(|(message, count)| {
        let rate = if duration > 0.0 {
            count.frames as f64 / duration
        } else {
            0.0
        };
        let load = percent(bus.load_of(count, bitrate));
        format!(
            "{message:<16} {:>10} {rate:>12.1} {load:>8.2}",
            count.frames
        )
    }));
    lines
}

fn play(context: &Context, log: &LogFile) -> Result<()> {
    // Read whole before anything is sent: a bad line moves nothing.
    let mut passed_over = PassedOver::default();
    let mut frames = Vec::new();
    let mut interfaces = BTreeSet::new();
    for entry in open(log)? {
        if let Some((time, interface, frame)) = passed_over.frame(log, entry)? {
            frames.push((time, frame));
            interfaces.insert(interface);
        }
    }
    passed_over.tell(log).context("nothing was sent")?;
    if interfaces.len() > 1 {
        let names = interfaces.into_iter().collect::<Vec<_>>().join(", ");
        bail!(
            "{} has frames of {names}: choose one with --interface",
            log.file
        );
    }
    let interrupt = Arc::new(AtomicBool::new(false));
    on_signal(Arc::clone(&interrupt))?;
    let mut bus = context.open(context.bitrate())?;
    let replayed = replay(&mut *bus, &frames, &interrupt)?;
    if replayed.frames == 0 {
        bail!(
            "{} has no frame that a host would send: nothing was sent",
            log.file
        );
    }
    let positions = &replayed.positions;
    let axes = positions.iter();
    context.print_json(&json!({
        "frames": replayed.frames,
        "latest_us": replayed.latest,
        "axes": axes
            .map(|(axis, position)| json!({ "axis": axis.get(), "position": position }))
            .collect::<Vec<_>>(),
    }));
    if !context.json {
        eprintln!(
            "{} frames were sent, the latest {} us late",
            replayed.frames, replayed.latest
        );
        println!("axis  position rad");
        for (axis, position) in positions {
            println!("{axis:>4}  {position:>12.6}");
        }
    }
    Ok(())
}
