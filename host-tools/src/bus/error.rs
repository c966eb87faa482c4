//! What goes wrong with a bus, and the cure.

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use thiserror::Error;

use super::AddressError;

/// Why a bus could not be opened, or no longer works.
///
/// Each message stands alone: it names the bus, the cause and what to do.
#[derive(Debug, Error)]
pub enum BusError {
    /// The text is no bus's address.
    #[error(transparent)]
    Address(#[from] AddressError),

    /// `sim` was to be opened as a bus of the machine.
    #[error(
        "`sim` lives inside one command and cannot be joined from outside; \
         name a real bus, such as `--can vcan0`"
    )]
    Simulated,

    /// There is no network interface of this name.
    #[error(
        "no CAN interface `{interface}`: {}; create a virtual one with `ip link add dev \
         {interface} type vcan && ip link set up {interface}`, or plug the adapter in \
         (`ip link show` lists what there is)",
        there_are(.present)
    )]
    NoInterface {
        /// The name.
        interface: String,
        /// The CAN interfaces that there are.
        present: Vec<String>,
    },

    /// The network interface is there, and is something else.
    #[error(
        "`{interface}` is a network interface, but not a CAN interface: {}",
        there_are(.present)
    )]
    NotCan {
        /// The name.
        interface: String,
        /// The CAN interfaces that there are.
        present: Vec<String>,
    },

    /// ENETDOWN.
    #[error(
        "the CAN interface `{interface}` is down; bring it up with `ip link set up {interface}` \
         (a real one needs its bitrate first: `ip link set {interface} type can bitrate 1000000 \
         restart-ms 100`)"
    )]
    InterfaceDown {
        /// The name.
        interface: String,
    },

    /// ENODEV on an interface that was open.
    #[error("the CAN interface `{interface}` is gone: it was unplugged or deleted")]
    InterfaceGone {
        /// The name.
        interface: String,
    },

    /// The kernel does not know CAN sockets.
    #[error(
        "this kernel has no SocketCAN ({cause}); load it with `modprobe can-raw`, or reach the \
         bus through an adapter with `slcan:/dev/ttyACM0`"
    )]
    KernelWithoutCan {
        /// What the kernel said.
        cause: io::Error,
    },

    /// There is no such device.
    #[error(
        "no serial device `{}`: {}; plug the adapter in and see `dmesg` for its name",
        .path.display(), there_are(.present)
    )]
    NoSerialDevice {
        /// The path.
        path: PathBuf,
        /// The serial devices that there are.
        present: Vec<String>,
    },

    /// EACCES.
    #[error(
        "no permission to open `{}`; join the group that owns it (`ls -l` shows it) with \
         `sudo usermod -aG dialout $USER` and log in again",
        .path.display()
    )]
    SerialPermission {
        /// The path.
        path: PathBuf,
    },

    /// Somebody else has it: two readers would take each other's bytes.
    #[error("`{}` is in use by another program; `fuser {}` names it", .path.display(), .path.display())]
    SerialInUse {
        /// The path.
        path: PathBuf,
    },

    /// The host's name has no address.
    #[error("cannot find the host of `{server}`: {cause}")]
    UnknownHost {
        /// Host and port.
        server: String,
        /// What the resolver said.
        cause: io::Error,
    },

    /// Nobody accepts connections there.
    #[error(
        "cannot connect to the SLCAN server `{server}`: {cause}; is it running, and does it \
         listen on that port?"
    )]
    Connect {
        /// Host and port.
        server: String,
        /// What the system said.
        cause: io::Error,
    },

    /// The other end ended the connection, or the device was unplugged.
    #[error("{bus}: the other end closed the connection (was it stopped or unplugged?)")]
    Closed {
        /// The bus.
        bus: String,
    },

    /// The adapter said no to a command that it must carry out.
    #[error("{bus}: the adapter refused `{command}`, which is to {purpose}")]
    AdapterRefused {
        /// The bus.
        bus: String,
        /// The command as it was sent.
        command: String,
        /// What the command is for.
        purpose: &'static str,
    },

    /// The send queue did not drain; the frame was not sent.
    #[error("{bus}: the send queue has been full for {} ms; {advice}", .waited.as_millis())]
    SendQueueFull {
        /// The bus.
        bus: String,
        /// How long was waited.
        waited: Duration,
        /// What to look at.
        advice: &'static str,
    },

    /// Anything else that the system said.
    #[error("{bus}: cannot {doing}: {cause}")]
    System {
        /// The bus.
        bus: String,
        /// What was to be done.
        doing: &'static str,
        /// What the system said.
        cause: io::Error,
    },
}

fn there_are(present: &[String]) -> String {
    if present.is_empty() {
        "there is none on this machine".to_owned()
    } else {
        format!("this machine has {}", present.join(", "))
    }
}
