//! The FDCAN controllers of an STM32G4 and H7: FDCAN1 is the host's bus, FDCAN2 the drives'.
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

use canter_shared::wire::frame::Frame;
use embassy_stm32::can::config::{
    FdCanConfig, GlobalFilter, NominalBitTiming, NonMatchingFilter, TxBufferMode,
};
use embassy_stm32::can::{self, CanConfigurator, CanRx, CanTx, Instance, RxPin, TxPin};
use embassy_stm32::interrupt::typelevel::{Binding, FDCAN1_IT0, FDCAN2_IT0, Handler};
use embassy_stm32::interrupt::{Interrupt, InterruptExt};
use embassy_stm32::pac::can::Fdcan;
use embassy_stm32::peripherals::{FDCAN1, FDCAN2};
use embassy_stm32::{Peri, bind_interrupts, pac};
use embassy_time::{Duration, block_for};

use super::level;
use super::line::{self, Line, Monitor};
use crate::bit_timing::BitTiming;
use crate::port::{CanReceive, CanTransmit, Received};
use crate::{now, priority};

bind_interrupts!(struct Interrupts {
    // The watch comes first: the driver's handler clears the flags that it looks at.
    FDCAN1_IT0 => Watch, can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
    FDCAN2_IT0 => Watch, can::IT0InterruptHandler<FDCAN2>;
    FDCAN2_IT1 => can::IT1InterruptHandler<FDCAN2>;
});

/// The most quanta to a bit: enough for a sample at 87.5 % from any clock, and far below the
/// controller's 385.
pub const MOST_QUANTA: u32 = 80;

/// As far as the driver subtracts from the time of a frame: 65535 times what it takes for a tick of the
/// controller's counter, the prescaled clock. From 24 MHz / 2, the slowest here, that is 5.5 ms.
const DRIVER_LOOKS_BACK: Duration = Duration::from_millis(6);

/// What belongs to the host's bus.
pub static HOST: Line = Line::new();
static DRIVES: Line = Line::new();

/// A bus that is switched on.
pub struct Bus {
    /// Frames in.
    pub(super) receiver: Receiver,
    /// Frames out.
    pub(super) transmitter: Transmitter,
    /// For the 1 kHz task.
    pub(super) monitor: Monitor<Controller>,
}

/// Switches the host's bus on.
pub fn open_host(
    peripheral: Peri<'static, FDCAN1>,
    receive: Peri<'static, impl RxPin<FDCAN1>>,
    transmit: Peri<'static, impl TxPin<FDCAN1>>,
    timing: BitTiming,
) -> Bus {
    let controller = Controller {
        registers: pac::FDCAN1,
        interrupt: Interrupt::FDCAN1_IT0,
    };
    let (receiver, transmitter) = open(peripheral, receive, transmit, timing, controller, &HOST);
    Bus {
        receiver,
        transmitter,
        monitor: Monitor::of_host(controller, &HOST),
    }
}

/// Switches the drives' bus on.
pub fn open_drives(
    peripheral: Peri<'static, FDCAN2>,
    receive: Peri<'static, impl RxPin<FDCAN2>>,
    transmit: Peri<'static, impl TxPin<FDCAN2>>,
    timing: BitTiming,
) -> Bus {
    let controller = Controller {
        registers: pac::FDCAN2,
        interrupt: Interrupt::FDCAN2_IT0,
    };
    let (receiver, transmitter) = open(peripheral, receive, transmit, timing, controller, &DRIVES);
    Bus {
        receiver,
        transmitter,
        monitor: Monitor::of_drives(controller, &DRIVES),
    }
}

fn open<T: Instance>(
    peripheral: Peri<'static, T>,
    receive: Peri<'static, impl RxPin<T>>,
    transmit: Peri<'static, impl TxPin<T>>,
    timing: BitTiming,
    controller: Controller,
    line: &'static Line,
) -> (Receiver, Transmitter)
where
    Interrupts: Binding<T::IT0Interrupt, can::IT0InterruptHandler<T>>
        + Binding<T::IT1Interrupt, can::IT1InterruptHandler<T>>,
{
    block_for(DRIVER_LOOKS_BACK);
    let configurator = CanConfigurator::new(peripheral, receive, transmit, Interrupts);
    begin(configurator, timing, controller, line)
}

/// What does not ask which controller it is: once for both.
#[inline(never)]
fn begin(
    mut configurator: CanConfigurator<'static>,
    timing: BitTiming,
    controller: Controller,
    line: &'static Line,
) -> (Receiver, Transmitter) {
    configurator.set_config(config(timing));
    let (transmitter, receiver, _) = configurator.into_normal_mode().split();
    controller.registers.ie().modify(|w| w.set_rfle(0, true));
    let interrupt = controller.interrupt;
    interrupt.set_priority(level(priority::CAN_INTERRUPT));
    (Receiver(receiver), Transmitter(transmitter, line))
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

/// Frames out of the three-deep hardware FIFO, stamped as they are taken.
pub struct Receiver(CanRx<'static>);

impl CanReceive for Receiver {
    async fn receive(&mut self) -> Received {
        loop {
            let Ok(envelope) = self.0.read().await else {
                continue;
            };
            let at = now();
            if let embedded_can::Id::Standard(id) = *envelope.frame.id()
                && let Some(frame) = Frame::new(id.as_raw(), envelope.frame.data())
            {
                return Received { frame, at };
            }
        }
    }
}

/// Frames into the three-deep hardware FIFO.
pub struct Transmitter(CanTx<'static>, &'static Line);

impl CanTransmit for &mut Transmitter {
    async fn transmit(&mut self, frame: &Frame) {
        let mut next = can::Frame::new_standard(frame.id(), frame.data()).ok();
        // The driver may hand back another frame that it took out to make room.
        while let Some(frame) = &next {
            next = self.0.write(frame).await;
        }
        self.1.count_sent();
    }
}

/// Counts what only the interrupt sees.
struct Watch;

impl Handler<FDCAN1_IT0> for Watch {
    unsafe fn on_interrupt() {
        watch(pac::FDCAN1, &HOST);
    }
}

impl Handler<FDCAN2_IT0> for Watch {
    unsafe fn on_interrupt() {
        watch(pac::FDCAN2, &DRIVES);
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

/// One controller's registers and the interrupt that its driver waits for.
#[derive(Clone, Copy)]
pub struct Controller {
    registers: Fdcan,
    interrupt: Interrupt,
}

impl line::Controller for Controller {
    fn recover(&mut self) {
        // Bus-off has set it.
        self.registers.cccr().modify(|w| w.set_init(false));
    }

    fn error_frames(&mut self) -> u32 {
        // Counts to 255 and starts again when it is read. An error frame lasts 20 us at
        // least, so one tick's worth is 50 at most.
        u32::from(self.registers.ecr().read().cel())
    }

    fn is_sending(&self) -> bool {
        self.registers.txbrp().read().0 != 0
    }

    fn discard(&mut self) {
        let waiting = self.registers.txbrp().read().0;
        self.registers.txbcr().write(|w| w.0 = waiting);
        // The driver's handler wakes whoever waits, whatever the interrupt came from.
        self.interrupt.pend();
    }
}
