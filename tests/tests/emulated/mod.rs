//! The node's image for the emulated board, running: its CAN bus as SLCAN, and its drive port.

use std::io::{BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Command;

use canter_shared::axis::state::State;
use canter_shared::motion::Setpoint;
use canter_shared::units::{Acceleration, Position, Velocity};
use canter_shared::wire::command::Command as Say;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::report::Report;
use canter_shared::wire::slcan::{Decoder, Line, encode};
use canter_tests::PATIENCE;
use canter_tests::process::Process;

use crate::image;

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

/// A running node.
pub struct Emulated {
    bus: TcpStream,
    decoder: Decoder,
    drive: BufReader<TcpStream>,
    _machine: Process,
}

impl Emulated {
    /// Starts the image. Its clock is this machine's: without `-icount`, so that idle time is
    /// spent and not simulated.
    pub fn start() -> Self {
        // QEMU connects to us: no port to guess, and no moment to wait for.
        let listen = || TcpListener::bind("127.0.0.1:0").expect("a port of our own");
        let (bus, drive) = (listen(), listen());
        let serial = |listener: &TcpListener| {
            let address = listener
                .local_addr()
                .expect("a bound socket has an address");
            format!("tcp:{address}")
        };
        // QEMU sends byte by byte. On the bus each counts at once; on the drive port, which carries
        // a hundred times as many, a packet for each would keep a core busy.
        let bus_port = serial(&bus) + ",nodelay=on";
        let machine = Process::spawn(
            Command::new("qemu-system-arm")
                .args(["-M", "netduinoplus2", "-kernel"])
                .arg(image::path("emulated"))
                .args(["-nographic", "-monitor", "none", "-no-reboot"])
                .args(["-serial", &bus_port, "-serial", &serial(&drive)]),
        );
        let accept = |listener: TcpListener| {
            let (stream, _) = listener.accept().expect("QEMU connects");
            stream
                .set_read_timeout(Some(PATIENCE))
                .and_then(|()| stream.set_nodelay(true))
                .expect("a socket takes its options");
            stream
        };
        let mut node = Self {
            bus: accept(bus),
            decoder: Decoder::new(),
            drive: BufReader::new(accept(drive)),
            _machine: machine,
        };
        // Bytes that come before it has switched its UART on are dropped, as on a real chip.
        node.next_record();
        node
    }

    /// Opens the SLCAN channel.
    pub fn open(&mut self) {
        self.write(b"O\r");
        self.expect(b"\r");
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

    /// The next setpoint of `axis`.
    pub fn record(&mut self, axis: AxisId) -> Record {
        loop {
            let record = self.next_record();
            if record.axis == axis.get() {
                return record;
            }
        }
    }

    fn next_record(&mut self) -> Record {
        let mut bytes = [0; 32];
        self.drive.read_exact(&mut bytes).expect("the node ticks");
        Record::parse(bytes)
    }

    /// Waits until `axis` is in `state`.
    pub fn wait_for_state(&mut self, axis: AxisId, state: State) -> Record {
        loop {
            let record = self.record(axis);
            if record.state == u8::from(state) {
                return record;
            }
        }
    }
}
