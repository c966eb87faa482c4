//! Opening the serial line or the TCP connection that an adapter is behind.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::Duration;

use serial2::SerialPort;

use super::{ANSWER_LIMIT, Slcan};
use crate::bus::{Bitrate, BusError};

/// How long each address of a host may take to accept a connection.
const CONNECT_LIMIT: Duration = Duration::from_secs(3);

impl Slcan {
    /// Opens the adapter that is the serial device `path`, at `baud` (which USB adapters
    /// ignore), on a bus of `bitrate`.
    ///
    /// # Errors
    /// The device is missing, in use or not permitted, or the adapter refuses to start.
    pub fn open_serial(path: &Path, baud: u32, bitrate: Bitrate) -> Result<Self, BusError> {
        let device = open_device(path, baud).map_err(|cause| match cause.kind() {
            ErrorKind::NotFound => BusError::NoSerialDevice {
                path: path.to_owned(),
                present: serial_devices(),
            },
            ErrorKind::PermissionDenied => BusError::SerialPermission {
                path: path.to_owned(),
            },
            ErrorKind::ResourceBusy | ErrorKind::WouldBlock => BusError::SerialInUse {
                path: path.to_owned(),
            },
            _ => BusError::System {
                bus: description(path),
                doing: "open it as a serial device",
                cause,
            },
        })?;
        Self::new(Box::new(device), description(path)).start(bitrate, ANSWER_LIMIT)
    }

    /// Opens the adapter that the TCP server at `host` and `port` stands for, on a bus of
    /// `bitrate`.
    ///
    /// # Errors
    /// The host is unknown, nobody accepts the connection, or the adapter refuses to start.
    pub fn open_tcp(host: &str, port: u16, bitrate: Bitrate) -> Result<Self, BusError> {
        let server = format!("{host}:{port}");
        let connection = connect(&server)?;
        let description = format!("slcan tcp:{server}");
        // A frame is worth sending at once: a whole packet's worth of them is never coming.
        connection
            .set_nodelay(true)
            .and_then(|()| connection.set_nonblocking(true))
            .map_err(|cause| BusError::System {
                bus: description.clone(),
                doing: "set the connection up",
                cause,
            })?;
        Self::new(Box::new(connection), description).start(bitrate, ANSWER_LIMIT)
    }
}

fn description(path: &Path) -> String {
    format!("slcan {}", path.display())
}

fn open_device(path: &Path, baud: u32) -> io::Result<File> {
    let port = SerialPort::open(path, baud)?;
    // What is in there was said to somebody else.
    port.discard_buffers()?;
    // The descriptor does not block, and serial2 would wait on its own, in milliseconds.
    let device = File::from(OwnedFd::from(port));
    device.try_lock()?;
    Ok(device)
}

fn serial_devices() -> Vec<String> {
    let ports = SerialPort::available_ports().unwrap_or_default();
    let mut names: Vec<_> = ports
        .iter()
        .map(|port| port.display().to_string())
        // The sixteen-odd built-in ports of a PC are seldom wired to anything.
        .filter(|name| !name.starts_with("/dev/ttyS"))
        .collect();
    names.sort();
    names
}

fn connect(server: &str) -> Result<TcpStream, BusError> {
    let unknown = |cause| BusError::UnknownHost {
        server: server.to_owned(),
        cause,
    };
    let mut failure = io::Error::new(ErrorKind::NotFound, "the name has no address");
    let mut resolved = false;
    for address in server.to_socket_addrs().map_err(unknown)? {
        resolved = true;
        match TcpStream::connect_timeout(&address, CONNECT_LIMIT) {
            Ok(connection) => return Ok(connection),
            Err(cause) => failure = cause,
        }
    }
    Err(if resolved {
        BusError::Connect {
            server: server.to_owned(),
            cause: failure,
        }
    } else {
        unknown(failure)
    })
}
