//! Real sockets and a real pseudo-terminal, with the adapter's side played by hand.

use std::fs;
use std::io::{BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::thread::{self, JoinHandle};

use nix::pty::openpty;

use super::*;
use crate::bus::open;

/// Far longer than anything here takes: a test that gets there has failed.
const PATIENCE: Duration = Duration::from_secs(30);

const OPENING: &[u8] = b"C\rC\rS8\rO\r";

fn frame(id: u16, data: &[u8]) -> Frame {
    Frame::new(id, data).expect("a valid frame")
}

/// Reads as many bytes as `expected` has and compares.
fn expect(stream: &mut impl Read, expected: &[u8]) {
    let mut bytes = vec![0; expected.len()];
    stream.read_exact(&mut bytes).expect("enough bytes");
    assert_eq!(bytes, expected, "{}", String::from_utf8_lossy(&bytes));
}

/// A TCP server that plays `part` with its one client, and its bus address.
fn server<T: Send + 'static>(
    part: impl FnOnce(TcpStream) -> T + Send + 'static,
) -> (String, JoinHandle<T>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("bound");
    let player = thread::spawn(move || part(listener.accept().expect("a client").0));
    (format!("slcan:tcp:{address}"), player)
}

fn next(bus: &mut dyn Bus) -> Event {
    let received = bus.receive(later(PATIENCE)).expect("an open bus");
    let received = received.expect("something before the patience ends");
    assert!(received.time <= bus.now());
    received.event
}

/// A bus that is not yet started on one end of a socket pair, whose other end is given too.
fn unstarted() -> (Slcan, UnixStream) {
    let (ours, theirs) = UnixStream::pair().expect("a socket pair");
    ours.set_nonblocking(true).expect("set");
    let bus = Slcan::new(Box::new(ours), "slcan test".to_owned());
    (bus, theirs)
}

/// A bus on one end of a socket pair, whose other end is given too.
fn pair() -> (Slcan, UnixStream) {
    let (mut bus, theirs) = unstarted();
    bus.answers = CLOSINGS;
    (bus, theirs)
}

/// Sends, as often as it takes, to a peer that a loaded machine keeps from reading.
fn insist(bus: &mut Slcan, frame: &Frame) {
    while let Err(error) = bus.send(frame) {
        assert!(matches!(error, BusError::SendQueueFull { .. }), "{error}");
    }
}

/// The next `count` frames from the other side, or fewer where it ends before.
fn read_frames(stream: &mut impl Read, count: usize) -> Vec<Frame> {
    let mut decoder = Decoder::new();
    let bytes = BufReader::new(stream).bytes().map_while(Result::ok);
    bytes
        .filter_map(|byte| match decoder.push(byte) {
            Some(Ok(Line::Frame(frame))) => Some(frame),
            _ => None,
        })
        .take(count)
        .collect()
}

#[test]
fn frames_go_both_ways_over_tcp() {
    let (address, player) = server(|mut client| {
        expect(&mut client, b"C\rC\rS6\rO\r");
        client.write_all(b"\r\x07\r\r").expect("sent");
        expect(&mut client, b"t1232ABCD\r");
        // A remote and a 29-bit frame in between are others' business.
        client
            .write_all(b"z\rt7FF0\rr1230\rT000001230\rt00081122334455667788\r")
            .expect("sent");
        expect(&mut client, b"C\r");
    });
    let mut bus = open(&format!("{address},bitrate=500000")).expect("opened");
    assert!(bus.description().starts_with("slcan tcp:127.0.0.1:"));
    bus.send(&frame(0x123, &[0xAB, 0xCD])).expect("sent");
    assert_eq!(next(&mut *bus), Event::Frame(frame(0x7FF, &[])));
    let data = [0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88];
    assert_eq!(next(&mut *bus), Event::Frame(frame(0, &data)));
    drop(bus);
    player.join().expect("the server saw what it expected");
}

#[test]
fn an_adapter_that_never_answers_is_used_all_the_same() {
    let (address, player) = server(|mut client| {
        expect(&mut client, OPENING);
        expect(&mut client, b"t0010\r");
        client.write_all(b"t0020\r").expect("sent");
        expect(&mut client, b"C\r");
    });
    let mut bus = open(&address).expect("opened");
    bus.send(&frame(1, &[])).expect("sent");
    assert_eq!(next(&mut *bus), Event::Frame(frame(2, &[])));
    drop(bus);
    player.join().expect("the server saw what it expected");
}

#[test]
fn frames_from_before_the_opening_are_dropped_and_those_after_kept() {
    let (bus, mut adapter) = unstarted();
    let player = thread::spawn(move || {
        expect(&mut adapter, b"C\r");
        adapter.write_all(b"\r").expect("sent");
        expect(&mut adapter, b"C\r");
        adapter.write_all(b"t0010\rt0020\r\x07").expect("sent");
        expect(&mut adapter, b"S8\r");
        adapter.write_all(b"t0030\r\r").expect("sent");
        expect(&mut adapter, b"O\r");
        adapter.write_all(b"\rt0040\r").expect("sent");
        adapter
    });
    let started = bus.start(Bitrate::default(), PATIENCE);
    assert_eq!(
        next(&mut started.expect("opened")),
        Event::Frame(frame(4, &[]))
    );
    drop(player.join().expect("the adapter saw what it expected"));
}

#[test]
fn a_refused_bitrate_is_an_error_that_says_so() {
    let (bus, mut adapter) = unstarted();
    let player = thread::spawn(move || {
        for _ in 0..CLOSINGS {
            expect(&mut adapter, b"C\r");
            adapter.write_all(b"\r").expect("sent");
        }
        expect(&mut adapter, b"S8\r");
        adapter.write_all(b"\x07").expect("sent");
        adapter
    });
    let started = bus.start(Bitrate::default(), PATIENCE);
    let error = started.err().expect("refused").to_string();
    assert!(error.contains("refused `S8`"), "{error}");
    drop(player.join().expect("the adapter saw what it expected"));
}

#[test]
fn a_closed_connection_is_an_error_that_says_so() {
    let (address, player) = server(|mut client| {
        expect(&mut client, OPENING);
        client.write_all(b"\r\r\r\rt0010\r").expect("sent");
    });
    let mut bus = open(&address).expect("opened");
    player.join().expect("the server saw what it expected");
    assert_eq!(next(&mut *bus), Event::Frame(frame(1, &[])));
    let error = bus.receive(later(PATIENCE)).expect_err("closed");
    assert!(matches!(error, BusError::Closed { .. }), "{error}");
}

#[test]
fn a_refused_connection_names_the_server() {
    let port = TcpListener::bind("127.0.0.1:0")
        .and_then(|listener| listener.local_addr())
        .expect("a free port")
        .port();
    let error = open(&format!("slcan:tcp:127.0.0.1:{port}"));
    let error = error.err().expect("nobody listens");
    assert!(matches!(error, BusError::Connect { .. }), "{error}");
    assert!(error.to_string().contains(&format!("127.0.0.1:{port}")));
}

#[test]
fn nothing_comes_until_the_time_is_up() {
    let (mut bus, _theirs) = pair();
    assert_eq!(bus.receive(BusTime(0)).expect("open"), None);
    let until = later(Duration::from_millis(2));
    assert_eq!(bus.receive(until).expect("open"), None);
    assert!(bus.now() >= until);
}

#[test]
fn answers_alone_do_not_keep_a_wait_going() {
    let (mut bus, mut theirs) = pair();
    let chatter = thread::spawn(move || while theirs.write_all(b"z\r").is_ok() {});
    let until = later(Duration::from_millis(2));
    assert_eq!(bus.receive(until).expect("open"), None);
    drop(bus);
    chatter.join().expect("ended with the bus");
}

#[test]
fn lines_that_arrive_in_pieces_are_put_together() {
    let (mut bus, mut theirs) = pair();
    theirs.write_all(b"t12").expect("sent");
    assert_eq!(bus.receive(BusTime(0)).expect("open"), None);
    theirs.write_all(b"31AB").expect("sent");
    assert_eq!(bus.receive(BusTime(0)).expect("open"), None);
    theirs.write_all(b"\rt1").expect("sent");
    assert_eq!(next(&mut bus), Event::Frame(frame(0x123, &[0xAB])));
}

#[test]
fn noise_and_refusals_are_reported_and_survived() {
    let (mut bus, mut theirs) = pair();
    theirs.write_all(b"t12X\r\x07t0010\r").expect("sent");
    let events = [next(&mut bus), next(&mut bus), next(&mut bus)];
    let words: Vec<_> = events
        .iter()
        .filter_map(|event| match event {
            Event::Error(error) => Some(error.to_string()),
            Event::Frame(_) => None,
        })
        .collect();
    assert_eq!(words.len(), 2, "{events:?}");
    assert!(words[0].contains("from the adapter: "), "{words:?}");
    assert!(words[1].contains("refused a frame"), "{words:?}");
    assert!(events.contains(&Event::Frame(frame(1, &[]))));
}

#[test]
fn a_peer_that_takes_nothing_is_an_error_and_no_frame_goes_out_late_or_in_part() {
    let (mut bus, mut theirs) = pair();
    let mut sent = 0;
    let error = loop {
        match bus.send(&frame(0x555, &[0x55; 8])) {
            Ok(()) => sent += 1,
            Err(error) => break error,
        }
    };
    assert!(matches!(error, BusError::SendQueueFull { .. }), "{error}");
    assert!(bus.send(&frame(0x666, &[])).is_err(), "still full");

    let reader = thread::spawn(move || read_frames(&mut theirs, usize::MAX));
    insist(&mut bus, &frame(0x777, &[]));
    drop(bus);
    let frames = reader.join().expect("read to the end");
    assert_eq!(frames.len(), sent + 1);
    assert_eq!(frames.last(), Some(&frame(0x777, &[])));
}

#[test]
fn many_frames_both_ways_at_once_all_arrive() {
    const COUNT: u16 = 5_000;
    let numbered = |number: u16| frame(number % 0x800, &number.to_le_bytes());
    let all: Vec<_> = (0..COUNT).map(numbered).collect();
    let (mut bus, theirs) = pair();
    let mut writer = theirs.try_clone().expect("cloned");
    let theirs_to_send = all.clone();
    // This side sends all before it reads any: the bus must read while it sends.
    let player = thread::spawn(move || {
        for frame in &theirs_to_send {
            writer.write_all(&encode(frame)).expect("sent");
        }
        let mut reader = theirs;
        read_frames(&mut reader, theirs_to_send.len())
    });
    for frame in &all {
        insist(&mut bus, frame);
    }
    for frame in &all {
        assert_eq!(next(&mut bus), Event::Frame(*frame));
    }
    assert_eq!(player.join().expect("read to the end"), all);
}

#[test]
fn a_serial_adapter_is_opened_raw_and_for_one_program_only() {
    let pty = openpty(None, None).expect("a pseudo-terminal");
    let path: PathBuf = fs::read_link(format!("/proc/self/fd/{}", pty.slave.as_raw_fd()))
        .expect("the terminal's path");
    let mut adapter = fs::File::from(pty.master);
    let player = thread::spawn(move || {
        expect(&mut adapter, OPENING);
        adapter
            .write_all(b"\r\r\r\rt0008112233440A0D0711\r")
            .expect("sent");
        // CR must not have become LF on the way, and nothing must have been echoed.
        expect(&mut adapter, b"t7FF10D\r");
        expect(&mut adapter, b"C\r");
        adapter
    });
    let address = format!("slcan:{}", path.display());
    let mut bus = open(&address).expect("opened");
    assert_eq!(bus.description(), format!("slcan {}", path.display()));
    let data = [0x11, 0x22, 0x33, 0x44, 0x0A, 0x0D, 0x07, 0x11];
    assert_eq!(next(&mut *bus), Event::Frame(frame(0, &data)));
    let error = open(&address).err().expect("in use");
    assert!(matches!(error, BusError::SerialInUse { .. }), "{error}");

    bus.send(&frame(0x7FF, &[0x0D])).expect("sent");
    drop(bus);
    drop(player.join().expect("the adapter saw what it expected"));
}

#[test]
fn an_unplugged_serial_adapter_is_an_error_that_says_so() {
    let pty = openpty(None, None).expect("a pseudo-terminal");
    let path = fs::read_link(format!("/proc/self/fd/{}", pty.slave.as_raw_fd()))
        .expect("the terminal's path");
    let mut bus = open(&format!("slcan:{}", path.display())).expect("opened");
    drop(pty);
    let error = bus.receive(later(PATIENCE)).expect_err("closed");
    assert!(matches!(error, BusError::Closed { .. }), "{error}");
}

#[test]
fn a_missing_serial_device_is_named() {
    let error = open("slcan:/dev/no-such-adapter").err().expect("missing");
    assert!(matches!(error, BusError::NoSerialDevice { .. }), "{error}");
    assert!(error.to_string().contains("/dev/no-such-adapter"));
}
