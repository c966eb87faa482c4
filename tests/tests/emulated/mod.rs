//! The node's image for the emulated board, running: its CAN bus as SLCAN, and its drive port.

pub mod debugger;

use std::io::{BufReader, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::process::Command;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use canter_shared::motion::Setpoint;
use canter_shared::units::{Acceleration, Position, Velocity};
use canter_shared::wire::command::Command as Say;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::report::Report;
use canter_shared::wire::slcan::{Decoder, Line, encode};
use canter_tests::PATIENCE;
use canter_tests::process::{Finished, Process};

use crate::image;
use debugger::Debugger;

/// What every record of the drive port starts with.
const MAGIC: u16 = 0xCA7E;

/// One setpoint, as it left the drive port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    pub axis: u8,
    pub state: u8,
    pub tick: u32,
    pub position: i64,
    pub velocity: i64,
    pub acceleration: i64,
}

impl Record {
    fn parse(bytes: [u8; 32]) -> Self {
        let word = |at: usize| {
            let mut word = [0; 8];
            word.copy_from_slice(&bytes[at..at + 8]);
            i64::from_le_bytes(word)
        };
        let head = word(0) as u64;
        assert_eq!(head as u16, MAGIC, "the drive port is out of step");
        Self {
            axis: (head >> 16) as u8,
            state: (head >> 24) as u8,
            tick: (head >> 32) as u32,
            position: word(8),
            velocity: word(16),
            acceleration: word(24),
        }
    }

    pub fn setpoint(&self) -> Setpoint {
        Setpoint {
            position: Position::from_counts(self.position),
            velocity: Velocity::from_counts(self.velocity),
            acceleration: Acceleration::from_counts(self.acceleration),
        }
    }
}

/// How long an answer is waited for before the question is asked again.
const BETWEEN_QUESTIONS: Duration = Duration::from_millis(100);

/// A running node.
pub struct Emulated {
    bus: TcpStream,
    decoder: Decoder,
    _machine: Process,
}

/// The emulator, with these serial ports of the image: its bus and its drive port.
///
/// Its clock is this machine's: without `-icount`, so that idle time is spent and not simulated.
fn emulator(bus: &str, drive: &str) -> Command {
    let mut emulator = Command::new("qemu-system-arm");
    emulator
        .args(["-M", "netduinoplus2", "-kernel"])
        .arg(image::path("emulated"))
        .args(["-nographic", "-monitor", "none"])
        .args(["-serial", bus, "-serial", drive]);
    emulator
}

/// Starts the image, for tests in which it never resets itself.
fn machine(bus: &str, drive: &str) -> Process {
    Process::spawn(emulator(bus, drive).arg("-no-reboot"))
}

/// A port for QEMU to connect to: none to guess, and no moment to wait for.
fn listen() -> (TcpListener, SocketAddr) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port of our own");
    let address = listener
        .local_addr()
        .expect("a bound socket has an address");
    (listener, address)
}

fn accept(listener: &TcpListener) -> TcpStream {
    let (stream, _) = listener.accept().expect("QEMU connects");
    stream
        .set_read_timeout(Some(PATIENCE))
        .and_then(|()| stream.set_nodelay(true))
        .expect("a socket takes its options");
    stream
}

fn next_record(drive: &mut impl Read) -> Option<Record> {
    let mut bytes = [0; 32];
    drive.read_exact(&mut bytes).ok()?;
    Some(Record::parse(bytes))
}

impl Emulated {
    /// Starts the image and connects to its bus; what its drive port says is not looked at.
    pub fn start() -> Self {
        let (bus, bus_port) = listen();
        // QEMU sends byte by byte, and each counts at once.
        let machine = machine(&format!("tcp:{bus_port},nodelay=on"), "none");
        Self::booted(accept(&bus), machine)
    }

    /// Starts the image with a debugger at its processor; it runs, and it may reset itself.
    pub fn start_with_debugger() -> (Self, Debugger) {
        let (bus, bus_port) = listen();
        let (debugger, address) = listen();
        let (host, port) = (address.ip(), address.port());
        let machine = Process::spawn(
            emulator(&format!("tcp:{bus_port},nodelay=on"), "null")
                .arg("-chardev")
                .arg(format!(
                    "socket,id=debugger,host={host},port={port},nodelay=on"
                ))
                .args(["-gdb", "chardev:debugger"]),
        );
        let mut debugger = Debugger::attach(accept(&debugger));
        debugger.go();
        (Self::booted(accept(&bus), machine), debugger)
    }

    fn booted(bus: TcpStream, machine: Process) -> Self {
        let mut node = Self {
            bus,
            decoder: Decoder::new(),
            _machine: machine,
        };
        node.wait_for_boot();
        node
    }

    /// Waits until the image answers.
    fn wait_for_boot(&mut self) {
        // Bytes that come before it has switched its UART on are dropped, as on a real chip: it is
        // asked for its version until it answers.
        self.ask_until("the boot", b"V\r", |_, _| true);
        // Answers to the questions before the last one may still come.
        self.be_patient_for(BETWEEN_QUESTIONS);
        while self.bus.read_exact(&mut [0]).is_ok() {}
        self.be_patient_for(PATIENCE);
    }

    fn be_patient_for(&self, limit: Duration) {
        let taken = self.bus.set_read_timeout(Some(limit));
        taken.expect("a socket takes its options");
    }

    /// Reads byte after byte until `wanted` has what it waits for; while none comes, sends `question` again and
    /// again.
    #[track_caller]
    fn ask_until(
        &mut self,
        what: &str,
        question: &[u8],
        mut wanted: impl FnMut(&mut Decoder, u8) -> bool,
    ) {
        self.be_patient_for(BETWEEN_QUESTIONS);
        let given_up = Instant::now() + PATIENCE;
        let mut byte = [0];
        loop {
            assert!(Instant::now() < given_up, "{what} does not come");
            match self.bus.read_exact(&mut byte) {
                Ok(()) if wanted(&mut self.decoder, byte[0]) => break,
                Ok(()) => {}
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    self.write(question);
                }
                Err(error) => panic!("the node's bus: {error}"),
            }
        }
        self.be_patient_for(PATIENCE);
    }

    pub fn write(&mut self, bytes: &[u8]) {
        self.bus.write_all(bytes).expect("QEMU takes bytes");
    }

    /// Reads exactly these bytes.
    #[track_caller]
    pub fn expect(&mut self, bytes: &[u8]) {
        let mut read = vec![0; bytes.len()];
        self.bus.read_exact(&mut read).expect("the node answers");
        assert_eq!(read, bytes);
    }

    pub fn say(&mut self, address: Address, command: Say) {
        let frame = command.encode(address).expect("a command that fits");
        self.write(&encode(&frame));
    }

    /// What the node reports from now on, until `wanted` has been given what it waits for. A reset may have cut
    /// a line, and closes the channel: what cannot be read is passed over, and the channel opened again.
    #[track_caller]
    pub fn report_over_resets(
        &mut self,
        what: &str,
        mut wanted: impl FnMut(AxisId, Report) -> bool,
    ) {
        self.ask_until(what, b"O\r", |decoder, byte| {
            let Some(Ok(Line::Frame(frame))) = decoder.push(byte) else {
                return false;
            };
            matches!(Report::decode(&frame), Ok(Some((axis, report))) if wanted(axis, report))
        });
    }

    /// The next report that the node sends.
    pub fn report(&mut self) -> (AxisId, Report) {
        loop {
            let mut byte = [0];
            self.bus.read_exact(&mut byte).expect("the node speaks");
            match self.decoder.push(byte[0]) {
                None | Some(Ok(Line::Acknowledged)) => {}
                Some(Ok(Line::Frame(frame))) => {
                    if let Ok(Some(report)) = Report::decode(&frame) {
                        return report;
                    }
                }
                Some(other) => panic!("{other:?}"),
            }
        }
    }
}

/// What a drive port has said so far, and a bell that rings with each record.
#[derive(Default)]
struct Log {
    records: Mutex<Vec<Record>>,
    more: Condvar,
}

impl Log {
    fn lock(&self) -> MutexGuard<'_, Vec<Record>> {
        self.records.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn push(&self, record: Record) {
        self.lock().push(record);
        self.more.notify_all();
    }
}

/// A running node whose bus waits for hosts, one after the other.
pub struct Served {
    bus: u16,
    log: Arc<Log>,
    _machine: Process,
}

impl Served {
    /// Starts the image and keeps all that its drive port says.
    pub fn start() -> Self {
        let (free, bus) = listen();
        drop(free);
        let (drive, drive_port) = listen();
        let bus_port = format!("tcp:{bus},server=on,wait=off,nodelay=on");
        let machine = machine(&bus_port, &format!("tcp:{drive_port}"));
        let log = Arc::new(Log::default());
        let mut drive = BufReader::new(accept(&drive));
        // The first record says that the image has booted.
        log.push(next_record(&mut drive).expect("the node ticks"));
        let kept = Arc::clone(&log);
        // All of it, all the time: a full pipe would hold the machine up.
        std::thread::spawn(move || {
            while let Some(record) = next_record(&mut drive) {
                kept.push(record);
            }
        });
        Self {
            bus: bus.port(),
            log,
            _machine: machine,
        }
    }

    /// A `canter` command on the node's bus, not started yet.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(canter_tests::canter());
        let bus = format!("slcan:tcp:127.0.0.1:{}", self.bus);
        command
            .args(["--can", &bus])
            .args(arguments.split_whitespace());
        command
    }

    /// Runs a `canter` command on the node's bus to its end.
    pub fn run(&self, arguments: &str) -> Finished {
        Process::spawn(&mut self.command(arguments)).finish()
    }

    /// The setpoints of `axis` so far. One that stood until the tick before another record has one there too,
    /// which it did not say again.
    pub fn records(&self, axis: u8) -> Vec<Record> {
        let mut told: Vec<Record> = Vec::new();
        let records = self.log.lock();
        for record in records.iter().filter(|record| record.axis == axis) {
            let before = record.tick.wrapping_sub(1);
            let stood = told
                .last()
                .filter(|last| last.velocity == 0 && last.tick != before);
            told.extend(stood.map(|last| Record {
                tick: before,
                ..*last
            }));
            told.push(*record);
        }
        told
    }

    /// Waits until the setpoint of `axis` is so; one that stands says so once.
    #[track_caller]
    pub fn wait_for(&self, what: &str, axis: u8, wanted: impl Fn(&Record) -> bool) -> Record {
        let given_up = Instant::now() + PATIENCE;
        let mut records = self.log.lock();
        let last = records.iter().rposition(|record| record.axis == axis);
        let mut seen = last.unwrap_or(0);
        loop {
            let new = records[seen..].iter();
            if let Some(found) = new
                .copied()
                .find(|record| record.axis == axis && wanted(record))
            {
                return found;
            }
            seen = records.len();
            let left = given_up.saturating_duration_since(Instant::now());
            assert!(!left.is_zero(), "no {what}");
            let woken = self.log.more.wait_timeout(records, left);
            records = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}
