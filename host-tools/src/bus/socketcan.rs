//! A CAN interface of the kernel.

use std::collections::VecDeque;
use std::fs;
use std::io::{self, IoSliceMut};
use std::mem;
use std::os::fd::{AsFd, AsRawFd};
use std::thread;
use std::time::Duration;

use ::socketcan::errors::{CanError, ControllerProblems, ErrorCause};
use ::socketcan::id::ERR_MASK_ALL;
use ::socketcan::{
    CanAddr, CanErrorFrame, CanFilter, CanFrame, CanSocket, EmbeddedFrame, Socket, SocketOptions,
};
use canter_shared::time::BusTime;
use canter_shared::wire::frame::{Frame, MAXIMUM_LENGTH};
use nix::errno::Errno;
use nix::libc::{CAN_EFF_FLAG, CAN_ERR_FLAG, CAN_RTR_FLAG, CAN_SFF_MASK};
use nix::poll::PollFlags;
use nix::sys::socket::{
    ControlMessageOwned, MsgFlags, MultiHeaders, recvmmsg, setsockopt, sockopt,
};
use nix::sys::time::TimeSpec;

use super::wait::{WallClock, monotonic_time, wait};
use super::{Bus, BusError, ErrorEvent, Event, Received};

/// Receive buffer to ask for, in bytes. The kernel doubles it for its own overhead and then
/// charges 768 bytes for each frame: 2 * 4 MiB / 768 = 10 922 frames, which is half a second of
/// the shortest frames (47 bits) and 1.2 s of full ones (111 bits) at 1 Mbit/s. By default
/// there is room for 277, and more are lost without an error.
const RECEIVE_BUFFER: usize = 4 << 20;

/// Bytes of the receive buffer that the kernel charges for one frame, by measurement.
const RECEIVE_BUFFER_PER_FRAME: usize = 768;

/// How long a full send queue is waited for. An interface queues 10 frames unless told
/// otherwise, and at 250 kbit/s these take 6 ms: what takes longer is not going out.
const SEND_LIMIT: Duration = Duration::from_millis(50);

/// How often a full queue is tried again; the kernel does not signal that it has room.
const SEND_RETRY: Duration = Duration::from_micros(200);

/// Messages that are read in one call: 6 ms of 10 000 frames a second.
const AT_ONCE: usize = 64;

/// The kernel's `struct can_frame`: id and flags, length, 3 bytes of no interest, data.
const KERNEL_FRAME: usize = 16;

/// The id that network interfaces of the CAN type have in sysfs (ARPHRD_CAN).
const CAN_INTERFACE_TYPE: &str = "280";

/// A CAN interface of this machine's kernel, such as `can0` or `vcan0`.
///
/// Other programs on the machine see what is sent here, and it sees what they send. Frames
/// that were lost for want of room are noticed with the next frame that got through.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    interface: String,
    pending: VecDeque<Received>,
    control: Vec<u8>,
    /// Frames that the kernel has dropped since the socket was opened, as it last said.
    dropped: u32,
    wall_clock: WallClock,
    /// When the latest message arrived.
    latest: BusTime,
    /// When messages were last read.
    looked: BusTime,
    /// Whether that left none behind.
    drained: bool,
}

impl SocketCan {
    /// Opens the interface named `interface`, which must be up.
    ///
    /// # Errors
    /// The interface is missing, down or not CAN, or the kernel has no SocketCAN.
    pub fn open(interface: &str) -> Result<Self, BusError> {
        let address = CanAddr::from_iface(interface).map_err(|cause| missing(interface, cause))?;
        let socket = CanSocket::open_addr(&address).map_err(|cause| unopened(interface, cause))?;
        let now = monotonic_time();
        let bus = Self {
            socket,
            interface: interface.to_owned(),
            pending: VecDeque::new(),
            control: nix::cmsg_space!(TimeSpec, u32),
            dropped: 0,
            wall_clock: WallClock::new(),
            latest: now,
            looked: now,
            drained: false,
        };
        bus.configure()
            .map_err(|cause| bus.failed("set the socket up", cause))?;
        // Binding to an interface that is down succeeds; the socket holds the error.
        match bus.socket.as_raw_socket().take_error() {
            Ok(None) => Ok(bus),
            Ok(Some(cause)) | Err(cause) => Err(bus.failed("open it", cause)),
        }
    }

    fn configure(&self) -> io::Result<()> {
        let socket = &self.socket;
        socket.set_nonblocking(true)?;
        // The rights to go over the system's limit are rare, and the limit is better than nothing.
        if setsockopt(socket, sockopt::RcvBufForce, &RECEIVE_BUFFER).is_err() {
            setsockopt(socket, sockopt::RcvBuf, &RECEIVE_BUFFER)?;
        }
        setsockopt(socket, sockopt::RxqOvfl, &1)?;
        socket.set_recv_timestamp(true)?;
        socket.set_error_mask(ERR_MASK_ALL)?;
        // What is filtered in the kernel takes no room in the buffer.
        socket.set_filters(&[CanFilter::new(0, CAN_EFF_FLAG | CAN_RTR_FLAG)])
    }

    /// How many frames the kernel keeps for this bus while nobody reads.
    ///
    /// Without the right CAP_NET_ADMIN it is bounded by `sysctl net.core.rmem_max`.
    ///
    /// # Errors
    /// The system does not say.
    pub fn receive_capacity(&self) -> Result<usize, BusError> {
        self.socket
            .as_raw_socket()
            .recv_buffer_size()
            .map(|bytes| bytes / RECEIVE_BUFFER_PER_FRAME)
            .map_err(|cause| self.failed("read the buffer's size", cause))
    }

    /// Reads what has come into `pending`, many messages in one call of the system: a node keeps
    /// up with a bus that is flooded. `false` where there was none.
    fn read(&mut self) -> Result<bool, BusError> {
        let mut bytes = [[0; KERNEL_FRAME]; AT_ONCE];
        let mut parts = bytes.each_mut().map(|bytes| [IoSliceMut::new(bytes)]);
        let mut headers = MultiHeaders::<()>::preallocate(AT_ONCE, Some(self.control.clone()));
        let read = recvmmsg(
            self.socket.as_raw_fd(),
            &mut headers,
            parts.iter_mut(),
            MsgFlags::MSG_DONTWAIT,
            None,
        );
        let messages = match read {
            Ok(messages) => messages,
            Err(Errno::EAGAIN | Errno::EINTR) => return Ok(false),
            Err(errno) => return Err(self.failed("receive", errno.into())),
        };
        let mut arrived = Vec::with_capacity(AT_ONCE);
        for message in messages {
            let (mut stamp, mut dropped) = (None, None);
            for control in message.cmsgs().into_iter().flatten() {
                match control {
                    ControlMessageOwned::ScmTimestampns(time) => stamp = Some(time),
                    ControlMessageOwned::RxqOvfl(count) => dropped = Some(count),
                    _ => {}
                }
            }
            arrived.push((message.bytes, stamp, dropped));
        }
        let now = monotonic_time();
        self.looked = now;
        self.drained = arrived.len() < AT_ONCE;
        for ((length, stamp, dropped), bytes) in arrived.into_iter().zip(&bytes) {
            let time = self.arrival(stamp, now);
            let dropped = dropped.unwrap_or(self.dropped);
            let lost = dropped.wrapping_sub(self.dropped);
            self.dropped = dropped;
            if lost > 0 {
                self.report(time, ErrorEvent::LostReception(Some(lost)));
            }
            // Anything of another length is CAN FD or longer still.
            if length == KERNEL_FRAME {
                self.take(time, bytes);
            }
        }
        Ok(true)
    }

    /// When a message arrived that the kernel stamped with its wall clock: after the previous one.
    fn arrival(&mut self, stamp: Option<TimeSpec>, now: BusTime) -> BusTime {
        self.latest = stamp.map_or(now, |stamp| {
            let wall = Duration::from(stamp).as_micros() as u64;
            self.wall_clock.bus_time(wall, self.latest, now)
        });
        self.latest
    }

    fn take(&mut self, time: BusTime, bytes: &[u8; KERNEL_FRAME]) {
        let [i0, i1, i2, i3, length, _, _, _, data @ ..] = bytes;
        let id = u32::from_ne_bytes([*i0, *i1, *i2, *i3]);
        if id & CAN_ERR_FLAG != 0 {
            if let Ok(frame) = CanErrorFrame::new_error(id, data) {
                for event in error_events(&frame.into_error()) {
                    self.report(time, event);
                }
            }
        } else if id & (CAN_EFF_FLAG | CAN_RTR_FLAG) == 0 {
            let length = usize::from(*length).min(MAXIMUM_LENGTH);
            let frame = Frame::new((id & CAN_SFF_MASK) as u16, &data[..length]);
            self.pending.extend(frame.map(|frame| Received {
                time,
                event: Event::Frame(frame),
            }));
        }
    }

    fn report(&mut self, time: BusTime, event: ErrorEvent) {
        self.pending.push_back(Received {
            time,
            event: Event::Error(event),
        });
    }

    fn failed(&self, doing: &'static str, cause: io::Error) -> BusError {
        let interface = self.interface.clone();
        match cause.raw_os_error().map(Errno::from_raw) {
            Some(Errno::ENETDOWN) => BusError::InterfaceDown { interface },
            Some(Errno::ENODEV | Errno::ENXIO) => BusError::InterfaceGone { interface },
            _ => BusError::System {
                bus: self.description(),
                doing,
                cause,
            },
        }
    }
}

impl Bus for SocketCan {
    fn now(&self) -> BusTime {
        monotonic_time()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        let kernel_frame = CanFrame::new(EmbeddedFrame::id(frame), frame.data())
            .expect("a frame has at most 8 bytes");
        // When it was first refused: looking at the clock is a call of the system on some machines.
        let mut refused = None;
        loop {
            let cause = match self.socket.write_frame(&kernel_frame) {
                Ok(()) => return Ok(()),
                Err(cause) => cause,
            };
            match cause.raw_os_error().map(Errno::from_raw) {
                Some(Errno::EINTR) => continue,
                // EAGAIN: this socket's own share of the queue is used up.
                Some(Errno::ENOBUFS | Errno::EAGAIN) => {}
                _ => return Err(self.failed("send", cause)),
            }
            let now = monotonic_time().0;
            let waited = Duration::from_micros(now - *refused.get_or_insert(now));
            if waited >= SEND_LIMIT {
                return Err(BusError::SendQueueFull {
                    bus: self.description(),
                    waited,
                    advice: "is another node on the bus, at the same bitrate, and are both ends \
                             terminated? (without one that acknowledges nothing is sent)",
                });
            }
            thread::sleep(SEND_RETRY);
        }
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        loop {
            if let Some(received) = self.pending.pop_front() {
                return Ok(Some(received));
            }
            // Calls of the system are most of what a node costs: one that waits for nothing looks once.
            let is_past = until <= self.looked;
            if is_past && mem::take(&mut self.drained) {
                return Ok(None);
            }
            if self.read()? {
                continue;
            }
            if is_past {
                return Ok(None);
            }
            let ready = wait(self.socket.as_fd(), PollFlags::POLLIN, until)
                .map_err(|cause| self.failed("wait for frames", cause))?;
            if ready.is_empty() {
                return Ok(None);
            }
        }
    }

    fn description(&self) -> String {
        format!("socketcan {}", self.interface)
    }
}

/// What the causes of one error frame mean; those of no special meaning become one event.
fn error_events(error: &CanError) -> Vec<ErrorEvent> {
    let mut events = Vec::new();
    for cause in error.causes() {
        match cause {
            ErrorCause::BusOff => events.push(ErrorEvent::BusOff),
            ErrorCause::Restarted => events.push(ErrorEvent::Restarted),
            ErrorCause::Controller(problems) => {
                if problems.contains(ControllerProblems::RX_OVERFLOW) {
                    events.push(ErrorEvent::LostReception(None));
                }
                let passive = ControllerProblems::RX_PASSIVE | ControllerProblems::TX_PASSIVE;
                if problems.intersects(passive) {
                    events.push(ErrorEvent::ErrorPassive);
                }
            }
            _ => {}
        }
    }
    if events.is_empty() {
        events.push(ErrorEvent::Other(error.to_string()));
    }
    events
}

/// Why an interface's name could not be looked up.
fn missing(interface: &str, cause: io::Error) -> BusError {
    // A kernel without CAN has no CAN interfaces either, and that is then the thing to say.
    if let Err(cause) = CanSocket::open_iface(0)
        && is_without_can(&cause)
    {
        return BusError::KernelWithoutCan { cause };
    }
    unopened(interface, cause)
}

/// Why a socket could not be opened on an interface.
fn unopened(interface: &str, cause: io::Error) -> BusError {
    let interface = interface.to_owned();
    match cause.raw_os_error().map(Errno::from_raw) {
        _ if is_without_can(&cause) => BusError::KernelWithoutCan { cause },
        Some(Errno::ENODEV | Errno::ENXIO) => {
            let present = can_interfaces();
            if fs::exists(format!("/sys/class/net/{interface}")).unwrap_or(false) {
                BusError::NotCan { interface, present }
            } else {
                BusError::NoInterface { interface, present }
            }
        }
        Some(Errno::ENETDOWN) => BusError::InterfaceDown { interface },
        _ => BusError::System {
            bus: format!("socketcan {interface}"),
            doing: "open a CAN socket",
            cause,
        },
    }
}

fn is_without_can(cause: &io::Error) -> bool {
    matches!(
        cause.raw_os_error().map(Errno::from_raw),
        Some(Errno::EAFNOSUPPORT | Errno::EPROTONOSUPPORT)
    )
}

/// The CAN interfaces of this machine, by name.
fn can_interfaces() -> Vec<String> {
    let entries = fs::read_dir("/sys/class/net").into_iter().flatten();
    let mut names: Vec<_> = entries
        .flatten()
        .filter(|entry| {
            fs::read_to_string(entry.path().join("type"))
                .is_ok_and(|kind| kind.trim() == CAN_INTERFACE_TYPE)
        })
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn events(id: u32, data: [u8; 8]) -> Vec<ErrorEvent> {
        let frame = CanErrorFrame::new_error(id, &data).expect("8 bytes");
        error_events(&frame.into_error())
    }

    #[test]
    fn error_frames_are_told_in_canters_words() {
        // Bits and bytes as in linux/can/error.h.
        let controller = |problem| [0, problem, 0, 0, 0, 0, 0, 0];
        assert_eq!(events(0x40, [0; 8]), [ErrorEvent::BusOff]);
        assert_eq!(events(0x100, [0; 8]), [ErrorEvent::Restarted]);
        assert_eq!(events(0x04, controller(0x30)), [ErrorEvent::ErrorPassive]);
        assert_eq!(
            events(0x04, controller(0x01)),
            [ErrorEvent::LostReception(None)]
        );
        // A change of state that comes with the error counters is one event.
        assert_eq!(
            events(0x204, [0, 0x20, 0, 0, 0, 0, 128, 0]),
            [ErrorEvent::ErrorPassive]
        );
        let [ErrorEvent::Other(words)] = &events(0x20, [0; 8])[..] else {
            panic!("one event");
        };
        assert_eq!(words, "no ack");
    }
}
