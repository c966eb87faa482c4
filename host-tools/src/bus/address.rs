//! What a bus is called on the command line.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use canter_shared::wire::slcan;
use thiserror::Error;

use super::{Bus, BusError, Slcan, SocketCan};

/// Bytes that the kernel allows in an interface's name.
const LONGEST_INTERFACE_NAME: usize = 15;

/// Baud rate of a serial line where the address names none; USB adapters ignore it.
const DEFAULT_BAUD: u32 = 115_200;

/// Where a bus is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// `sim`: the simulated robot.
    Simulated,
    /// `socketcan:IFACE` or the bare name: a CAN interface of the kernel.
    SocketCan {
        /// The interface's name, such as `can0`.
        interface: String,
    },
    /// `slcan:TARGET[,bitrate=BIT_PER_S]`: an adapter that speaks SLCAN.
    Slcan {
        /// Where the adapter is.
        target: SlcanTarget,
        /// The CAN bus's bitrate, which the adapter is told.
        bitrate: Bitrate,
    },
}

/// Where an SLCAN adapter is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SlcanTarget {
    /// `/dev/ttyACM0[,baud=BAUD]`: on a serial line or on USB.
    Serial {
        /// The device's path.
        path: PathBuf,
        /// The serial line's rate in baud; USB adapters ignore it.
        baud: u32,
    },
    /// `tcp:HOST:PORT`: behind a TCP server.
    Tcp {
        /// Name or number of the host.
        host: String,
        /// The server's port.
        port: u16,
    },
}

/// One of the bitrates that SLCAN has a number for; 1 Mbit/s by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bitrate(u8);

/// Why a text is no bus's address.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum AddressError {
    /// Nothing was named.
    #[error("the bus address is empty; {KINDS}")]
    Empty,
    /// What stands before the first colon is no kind of bus.
    #[error("`{scheme}:` in the bus address `{address}` is no kind of bus; {KINDS}")]
    UnknownScheme {
        /// What stands before the colon.
        scheme: String,
        /// The whole address.
        address: String,
    },
    /// A name that no network interface can have.
    #[error("`{name}` cannot be a CAN interface: a name has 1 to 15 bytes, no `/` and no space{}", hint(.name))]
    BadInterface {
        /// The name.
        name: String,
    },
    /// `slcan:` with something behind it that is neither a path nor `tcp:`.
    #[error(
        "`{target}` is no SLCAN adapter: name a device's path (`slcan:/dev/ttyACM0`) \
         or a TCP server (`slcan:tcp:HOST:PORT`)"
    )]
    BadAdapter {
        /// What stands behind `slcan:`.
        target: String,
    },
    /// A TCP server without a host or without a usable port.
    #[error("`tcp:{server}` needs a host and a port from 1 to 65535, as in `slcan:tcp:HOST:PORT`")]
    BadServer {
        /// What stands behind `tcp:`.
        server: String,
    },
    /// An option that this kind of adapter does not have.
    #[error("`{option}` is no option of this SLCAN adapter: there are {known}")]
    UnknownOption {
        /// The option as it was written.
        option: String,
        /// Those that there are.
        known: &'static str,
    },
    /// A CAN bitrate that SLCAN has no number for.
    #[error(
        "`bitrate={value}` cannot be set over SLCAN; the rates in bit/s are 10000, 20000, 50000, \
         100000, 125000, 250000, 500000, 800000 and 1000000"
    )]
    BadBitrate {
        /// The rate as it was written.
        value: String,
    },
    /// A serial rate that is no positive number.
    #[error("`baud={value}` must be a whole number over 0, such as 115200")]
    BadBaud {
        /// The rate as it was written.
        value: String,
    },
}

const KINDS: &str = "there are `sim`, `socketcan:IFACE` (or the bare name of an interface), \
                     `slcan:/dev/ttyACM0` and `slcan:tcp:HOST:PORT`";

fn hint(name: &str) -> String {
    if name.starts_with('/') {
        format!("; for the serial adapter say `slcan:{name}`")
    } else {
        String::new()
    }
}

impl Address {
    /// Opens the bus that is there.
    ///
    /// # Errors
    /// [`BusError::Simulated`] for `sim`, which is no bus of the machine; otherwise why the bus
    /// could not be opened and what to do about it.
    pub fn open(&self) -> Result<Box<dyn Bus>, BusError> {
        Ok(match self {
            Self::Simulated => return Err(BusError::Simulated),
            Self::SocketCan { interface } => Box::new(SocketCan::open(interface)?),
            Self::Slcan { target, bitrate } => match target {
                SlcanTarget::Serial { path, baud } => {
                    Box::new(Slcan::open_serial(path, *baud, *bitrate)?)
                }
                SlcanTarget::Tcp { host, port } => {
                    Box::new(Slcan::open_tcp(host, *port, *bitrate)?)
                }
            },
        })
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        match text.split_once(':') {
            None if text.is_empty() => Err(AddressError::Empty),
            None if text == "sim" => Ok(Self::Simulated),
            None => socketcan(text),
            Some(("socketcan", name)) => socketcan(name),
            Some(("slcan", rest)) => slcan_adapter(rest),
            Some((scheme, _)) => Err(AddressError::UnknownScheme {
                scheme: scheme.to_owned(),
                address: text.to_owned(),
            }),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (target, bitrate) = match self {
            Self::Simulated => return formatter.write_str("sim"),
            Self::SocketCan { interface } => return write!(formatter, "socketcan:{interface}"),
            Self::Slcan { target, bitrate } => (target, bitrate),
        };
        match target {
            SlcanTarget::Serial { path, baud } => {
                write!(formatter, "slcan:{}", path.display())?;
                if *baud != DEFAULT_BAUD {
                    write!(formatter, ",baud={baud}")?;
                }
            }
            SlcanTarget::Tcp { host, port } => write!(formatter, "slcan:tcp:{host}:{port}")?,
        }
        if *bitrate != Bitrate::default() {
            write!(formatter, ",bitrate={}", bitrate.bits_per_second())?;
        }
        Ok(())
    }
}

impl Bitrate {
    /// From bit/s; `None` where SLCAN has no number for it.
    pub fn from_bits_per_second(rate: u32) -> Option<Self> {
        (0..=u8::MAX)
            .map_while(|number| Some((number, slcan::bits_per_second(number)?)))
            .find_map(|(number, known)| (known == rate).then_some(Self(number)))
    }

    /// In bit/s.
    pub fn bits_per_second(self) -> u32 {
        slcan::bits_per_second(self.0).expect("built from a number that has a rate")
    }

    /// The digit of the SLCAN command `S`.
    pub(super) fn number(self) -> u8 {
        self.0
    }
}

impl Default for Bitrate {
    fn default() -> Self {
        Self::from_bits_per_second(1_000_000).expect("SLCAN has 1 Mbit/s")
    }
}

fn socketcan(name: &str) -> Result<Address, AddressError> {
    let bad_character = |c: char| c == '/' || c == ':' || c.is_whitespace() || c.is_control();
    if name.is_empty()
        || name.len() > LONGEST_INTERFACE_NAME
        || name.contains(bad_character)
        || matches!(name, "." | "..")
    {
        return Err(AddressError::BadInterface {
            name: name.to_owned(),
        });
    }
    Ok(Address::SocketCan {
        interface: name.to_owned(),
    })
}

fn slcan_adapter(text: &str) -> Result<Address, AddressError> {
    let mut parts = text.split(',');
    let target = parts.next().unwrap_or_default();
    let mut target = if let Some(server) = target.strip_prefix("tcp:") {
        tcp_server(server)?
    } else if target.contains('/') {
        SlcanTarget::Serial {
            path: target.into(),
            baud: DEFAULT_BAUD,
        }
    } else {
        return Err(AddressError::BadAdapter {
            target: target.to_owned(),
        });
    };
    let mut bitrate = Bitrate::default();
    for option in parts {
        match (option.split_once('='), &mut target) {
            (Some(("bitrate", value)), _) => {
                bitrate = value
                    .parse()
                    .ok()
                    .and_then(Bitrate::from_bits_per_second)
                    .ok_or_else(|| AddressError::BadBitrate {
                        value: value.to_owned(),
                    })?;
            }
            (Some(("baud", value)), SlcanTarget::Serial { baud, .. }) => {
                *baud = value.parse().ok().filter(|baud| *baud > 0).ok_or_else(|| {
                    AddressError::BadBaud {
                        value: value.to_owned(),
                    }
                })?;
            }
            (_, target) => {
                return Err(AddressError::UnknownOption {
                    option: option.to_owned(),
                    known: match target {
                        SlcanTarget::Serial { .. } => "`bitrate=BIT_PER_S` and `baud=BAUD`",
                        SlcanTarget::Tcp { .. } => "`bitrate=BIT_PER_S` alone",
                    },
                });
            }
        }
    }
    Ok(Address::Slcan { target, bitrate })
}

fn tcp_server(server: &str) -> Result<SlcanTarget, AddressError> {
    // The last colon: a host in IPv6 numbers has more.
    server
        .rsplit_once(':')
        .and_then(|(host, port)| Some((host, port.parse::<u16>().ok()?)))
        .filter(|(host, port)| !host.is_empty() && *port > 0)
        .map(|(host, port)| SlcanTarget::Tcp {
            host: host.to_owned(),
            port,
        })
        .ok_or_else(|| AddressError::BadServer {
            server: server.to_owned(),
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn socket_can(interface: &str) -> Address {
        Address::SocketCan {
            interface: interface.to_owned(),
        }
    }

    fn serial(path: &str, baud: u32, rate: u32) -> Address {
        Address::Slcan {
            target: SlcanTarget::Serial {
                path: path.into(),
                baud,
            },
            bitrate: Bitrate::from_bits_per_second(rate).expect("a known rate"),
        }
    }

    fn tcp(host: &str, port: u16, rate: u32) -> Address {
        Address::Slcan {
            target: SlcanTarget::Tcp {
                host: host.to_owned(),
                port,
            },
            bitrate: Bitrate::from_bits_per_second(rate).expect("a known rate"),
        }
    }

    #[test]
    fn every_kind_of_bus_is_read_and_written_back() {
        for (text, address) in [
            ("sim", Address::Simulated),
            ("socketcan:can0", socket_can("can0")),
            ("socketcan:sim", socket_can("sim")),
            (
                "slcan:/dev/ttyACM0",
                serial("/dev/ttyACM0", 115_200, 1_000_000),
            ),
            (
                "slcan:/dev/ttyUSB0,baud=1000000,bitrate=500000",
                serial("/dev/ttyUSB0", 1_000_000, 500_000),
            ),
            (
                "slcan:tcp:localhost:4000",
                tcp("localhost", 4000, 1_000_000),
            ),
            (
                "slcan:tcp:[::1]:4000,bitrate=250000",
                tcp("[::1]", 4000, 250_000),
            ),
        ] {
            assert_eq!(text.parse(), Ok(address.clone()), "{text}");
            assert_eq!(address.to_string(), text);
        }
        assert_eq!("vcan0".parse(), Ok(socket_can("vcan0")));
    }

    #[test]
    fn what_is_no_address_is_told_why() {
        for (text, why) in [
            ("", "the bus address is empty; there are `sim`,"),
            ("pcan:1", "`pcan:` in the bus address `pcan:1` is no kind"),
            ("socketcan:", "`` cannot be a CAN interface"),
            ("a-name-too-long1", "1 to 15 bytes"),
            ("can 0", "no space"),
            ("/dev/ttyACM0", "say `slcan:/dev/ttyACM0`"),
            ("slcan:", "`` is no SLCAN adapter: name a device's path"),
            ("slcan:ttyACM0", "`ttyACM0` is no SLCAN adapter"),
            ("slcan:tcp:", "needs a host and a port"),
            ("slcan:tcp:host", "`tcp:host` needs a host and a port"),
            ("slcan:tcp::4000", "`tcp::4000` needs a host"),
            ("slcan:tcp:host:0", "a port from 1 to 65535"),
            ("slcan:tcp:host:70000", "a port from 1 to 65535"),
            (
                "slcan:tcp:host:1,baud=9600",
                "there are `bitrate=BIT_PER_S` alone",
            ),
            ("slcan:/dev/x,speed=1", "`speed=1` is no option"),
            (
                "slcan:/dev/x,baud=0",
                "`baud=0` must be a whole number over 0",
            ),
            (
                "slcan:/dev/x,bitrate=1",
                "`bitrate=1` cannot be set over SLCAN",
            ),
        ] {
            let error = text.parse::<Address>().expect_err(text);
            assert!(error.to_string().contains(why), "{text}: {error}");
        }
    }
}
