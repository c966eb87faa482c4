//! The FDCAN controllers of an STM32G4 and H7: FDCAN1 is the host's bus.
//!
//! What embassy-stm32 0.6.0 does that a node cannot live with, and what is done about it:
//!
//! - Its buffered reception drops frames without a word when its buffer is full, and the interrupt for
//!   frames that the hardware had no room for is off. So the reception is not buffered: a task of its
//!   own empties the three-deep FIFO, and both kinds of loss are counted.
//! - Where a result of `read` is an error it is whatever error was seen last. It is passed over: the
//!   hardware's own count is the better one.
//! - The time of a frame is worked out from a counter and panics where that is before the boot, and it
//!   does not count what it says. It is not used, and [`open`] waits until it cannot be before the boot.
//! - `write` may hand back another frame that it took out of the hardware to make room. It is sent again;
//!   in a FIFO, as here, there is none.
//! - Range filters have their bounds swapped, delay compensation is ignored, FD frames leave
//!   their bit rate alone: no filter but the global one, and neither is used.
//! - It lets a controller back onto its bus at once after bus-off. That is switched off: see
//!   [`canter_shared::node::bus_off`].

use core::num::{NonZeroU8, NonZeroU16};

use canter_shared::node::bus_off::BusOffRecovery;
use canter_shared::wire::frame::Frame;
use embassy_stm32::can::config::{
    FdCanConfig, GlobalFilter, NominalBitTiming, NonMatchingFilter, TxBufferMode,
};
use embassy_stm32::can::{self, CanConfigurator, CanRx, CanTx, RxPin, TxPin};
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::interrupt::typelevel::{FDCAN1_IT0, Handler};
use embassy_stm32::pac::can::Fdcan;
use embassy_stm32::peripherals::FDCAN1;
use embassy_stm32::{Peri, bind_interrupts, interrupt, pac};
use embassy_time::{Duration, block_for};

use super::level;
use super::line::{Line, Queue};
use crate::bit_timing::BitTiming;
use crate::port::{BusCounts, BusMonitor, CanTransmit, Received};
use crate::{now, priority};

bind_interrupts!(struct Interrupts {
    // The watch comes first: the driver's handler clears the flags that it looks at.
    FDCAN1_IT0 => Watch, can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
});

/// The most quanta to a bit: enough for a sample at 87.5 % from any clock, and far below the
/// controller's 385.
pub const MOST_QUANTA: u32 = 80;

/// As far as the driver subtracts from the time of a frame: 65535 times what it takes for a tick of the
/// controller's counter, the prescaled clock. From 24 MHz / 2, the slowest here, that is 5.5 ms.
const DRIVER_LOOKS_BACK: Duration = Duration::from_millis(6);

static HOST: Line = Line::new();

/// A bus that is switched on.
pub struct Bus {
    /// The hardware's end, for the reception task.
    pub(super) reception: Reception,
    /// For the receive task.
    pub(super) queue: Queue,
    /// For the transmit task.
    pub(super) transmitter: Transmitter,
    /// For the 1 kHz task.
    pub(super) monitor: Monitor,
}

/// Switches FDCAN1 on.
pub fn open(
    controller: Peri<'static, FDCAN1>,
    receive: Peri<'static, impl RxPin<FDCAN1>>,
    transmit: Peri<'static, impl TxPin<FDCAN1>>,
    timing: BitTiming,
) -> Bus {
    block_for(DRIVER_LOOKS_BACK);
    let mut configurator = CanConfigurator::new(controller, receive, transmit, Interrupts);
    configurator.set_config(config(timing));
    let (transmitter, receiver, _) = configurator.into_normal_mode().split();
    pac::FDCAN1.ie().modify(|w| w.set_rfle(0, true));
    interrupt::FDCAN1_IT0.set_priority(level(priority::CAN_INTERRUPT));
    Bus {
        reception: Reception {
            receiver,
            line: &HOST,
        },
        queue: Queue(&HOST),
        transmitter: Transmitter(transmitter),
        monitor: Monitor {
            registers: pac::FDCAN1,
            line: &HOST,
            recovery: BusOffRecovery::new(),
        },
    }
}

/// Classic frames with an 11-bit id are all accepted; the hardware drops everything else.
fn config(timing: BitTiming) -> FdCanConfig {
    let parts = NominalBitTiming {
        prescaler: NonZeroU16::new(timing.prescaler).unwrap_or(NonZeroU16::MIN),
        seg1: NonZeroU8::new(timing.before_sample).unwrap_or(NonZeroU8::MIN),
        seg2: NonZeroU8::new(timing.after_sample).unwrap_or(NonZeroU8::MIN),
        sync_jump_width: NonZeroU8::new(timing.after_sample).unwrap_or(NonZeroU8::MIN),
    };
    FdCanConfig::default()
        .set_nominal_bit_timing(parts)
        .set_global_filter(
            GlobalFilter::reject_all().set_handle_standard_frames(NonMatchingFilter::IntoRxFifo0),
        )
        // A queue by priority would let two replies with one id overtake each other.
        .set_tx_buffer_mode(TxBufferMode::Fifo)
        .set_automatic_bus_off_recovery(false)
}

/// Empties the three-deep hardware FIFO and stamps the frames.
pub struct Reception {
    receiver: CanRx<'static>,
    line: &'static Line,
}

impl Reception {
    /// Never ends.
    pub(super) async fn run(mut self) -> ! {
        loop {
            let Ok(envelope) = self.receiver.read().await else {
                continue;
            };
            let at = now();
            let embedded_can::Id::Standard(id) = *envelope.frame.id() else {
                continue;
            };
            if let Some(frame) = Frame::new(id.as_raw(), envelope.frame.data()) {
                self.line.keep(Received { frame, at });
            }
        }
    }
}

/// Frames out.
pub struct Transmitter(CanTx<'static>);

impl CanTransmit for Transmitter {
    async fn transmit(&mut self, frame: &Frame) {
        let mut next = can::Frame::new_standard(frame.id(), frame.data()).ok();
        // The driver may hand back another frame that it took out to make room.
        while let Some(frame) = next {
            next = self.0.write(&frame).await;
        }
    }
}

/// Counts what only the interrupt sees.
struct Watch;

impl Handler<FDCAN1_IT0> for Watch {
    unsafe fn on_interrupt() {
        watch(pac::FDCAN1, &HOST);
    }
}

fn watch(registers: Fdcan, line: &Line) {
    let flags = registers.ir().read();
    if flags.rfl(0) {
        registers.ir().write(|w| w.set_rfl(0, true));
        line.lost.raise();
    }
    // The flag says that the state changed; leaving bus-off is no event.
    if flags.bo() && registers.psr().read().bo() {
        line.bus_off.raise();
    }
}

/// Collects the counts at every tick.
pub struct Monitor {
    registers: Fdcan,
    line: &'static Line,
    recovery: BusOffRecovery,
}

impl BusMonitor for Monitor {
    fn take(&mut self) -> BusCounts {
        let registers = self.registers;
        let mut counts = self.line.take(&mut self.recovery, || {
            // Bus-off has set it. Once it is gone the hardware waits for 128 times 11 recessive bits.
            registers.cccr().modify(|w| w.set_init(false));
        });
        // Counts to 255 and starts again when it is read. An error frame lasts 20 us at
        // least, so one tick's worth is 50 at most.
        counts.error_frames += u32::from(registers.ecr().read().cel());
        counts
    }
}
