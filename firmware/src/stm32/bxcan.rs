//! The bxCAN controllers of an STM32F4: CAN1 is the host's bus.
//!
//! What embassy-stm32 0.6.0 does that a node cannot live with, and what is done about it:
//!
//! - Its buffered reception drops frames without a word when its buffer is full. Not buffered, it clears
//!   the flag for frames that the hardware lost whenever it takes one out, because it writes back what it
//!   read. So the interrupt takes the frames out itself, here.
//! - Its interrupt for errors switches itself off until somebody reads an error. So that one is
//!   answered here too, which clears it before the driver looks.
//! - `set_automatic_retransmit` does the opposite. It is left alone: retransmission is on.
//! - `enable` waits until the bus is idle, which a broken one never is, and lets a controller back onto
//!   its bus at once after bus-off. So the controller is woken here, and comes back as
//!   [`canter_shared::node::bus_off`] says.

use core::num::{NonZeroU8, NonZeroU16};

use canter_shared::node::bus_off::BusOffRecovery;
use canter_shared::wire::frame::Frame;
use embassy_stm32::can::filter::Mask32;
use embassy_stm32::can::util::NominalBitTiming;
use embassy_stm32::can::{self, Can, CanTx, Fifo, RxPin, StandardId, TxPin};
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::interrupt::typelevel::{CAN1_RX0, CAN1_SCE, Handler};
use embassy_stm32::pac::can::vals::Lec;
use embassy_stm32::peripherals::CAN1;
use embassy_stm32::{Peri, bind_interrupts, interrupt, pac};

use super::level;
use super::line::{Line, Queue};
use crate::bit_timing::BitTiming;
use crate::port::{BusCounts, BusMonitor, CanTransmit, Received};
use crate::{now, priority};

bind_interrupts!(struct Interrupts {
    CAN1_TX => can::TxInterruptHandler<CAN1>;
    // The driver's handler switches the interrupt off, ours takes the frames and switches it on again.
    CAN1_RX0 => can::Rx0InterruptHandler<CAN1>, Reception;
    CAN1_RX1 => can::Rx1InterruptHandler<CAN1>;
    // Ours comes first, so that the driver's finds nothing.
    CAN1_SCE => Watch, can::SceInterruptHandler<CAN1>;
});

/// The most quanta to a bit: 1 + 16 + 8.
pub const MOST_QUANTA: u32 = 25;

static HOST: Line = Line::new();

/// A bus that is switched on. Its reception is all in the interrupt.
pub struct Bus {
    /// For the receive task.
    pub(super) queue: Queue,
    /// For the transmit task.
    pub(super) transmitter: Transmitter,
    /// For the 1 kHz task.
    pub(super) monitor: Monitor,
}

/// Switches CAN1 on.
pub fn open(
    controller: Peri<'static, CAN1>,
    receive: Peri<'static, impl RxPin<CAN1>>,
    transmit: Peri<'static, impl TxPin<CAN1>>,
    timing: BitTiming,
) -> Bus {
    let mut can = Can::new(controller, receive, transmit, Interrupts);
    can.modify_config().set_bit_timing(parts(timing));
    can.set_tx_fifo_scheduling(true);
    // Data frames with any 11-bit id; the hardware drops everything else.
    let mut all = Mask32::frames_with_std_id(StandardId::ZERO, StandardId::ZERO);
    all.data_frames_only();
    can.modify_filters().enable_bank(0, Fifo::Fifo0, all);
    let (transmitter, _) = can.split();
    // The driver would switch the controller off with it.
    core::mem::forget(can);

    pac::CAN1.ier().modify(|w| {
        w.set_fovie(0, true);
        // Warnings are no errors.
        w.set_ewgie(false);
        w.set_epvie(false);
    });
    for interrupt in [
        interrupt::CAN1_TX,
        interrupt::CAN1_RX0,
        interrupt::CAN1_RX1,
        interrupt::CAN1_SCE,
    ] {
        // The same for all: none may come between another's reading of a register and its writing.
        interrupt.set_priority(level(priority::CAN_INTERRUPT));
    }
    pac::CAN1.mcr().modify(|w| {
        w.set_abom(false);
        w.set_sleep(false);
    });
    Bus {
        queue: Queue(&HOST),
        transmitter: Transmitter(transmitter),
        monitor: Monitor {
            registers: pac::CAN1,
            line: &HOST,
            recovery: BusOffRecovery::new(),
            asking: false,
        },
    }
}

fn parts(timing: BitTiming) -> NominalBitTiming {
    NominalBitTiming {
        prescaler: NonZeroU16::new(timing.prescaler).unwrap_or(NonZeroU16::MIN),
        seg1: NonZeroU8::new(timing.before_sample).unwrap_or(NonZeroU8::MIN),
        seg2: NonZeroU8::new(timing.after_sample).unwrap_or(NonZeroU8::MIN),
        sync_jump_width: NonZeroU8::new(timing.after_sample).unwrap_or(NonZeroU8::MIN),
    }
}

/// Frames out. In a FIFO the driver takes none back.
pub struct Transmitter(CanTx<'static>);

impl CanTransmit for Transmitter {
    async fn transmit(&mut self, frame: &Frame) {
        if let Ok(frame) = can::Frame::new_standard(frame.id(), frame.data()) {
            self.0.write(&frame).await;
        }
    }
}

/// Empties the three-deep hardware FIFO and stamps the frames.
struct Reception;

impl Handler<CAN1_RX0> for Reception {
    unsafe fn on_interrupt() {
        receive(pac::CAN1, &HOST);
    }
}

fn receive(registers: pac::can::Can, line: &Line) {
    let fifo = registers.rfr(0);
    loop {
        let state = fifo.read();
        if state.fovr() {
            // Flags are cleared by writing a one; the others stay.
            fifo.write(|w| w.set_fovr(true));
            line.lost.raise();
        }
        if state.fmp() == 0 {
            break;
        }
        // The hardware lets go of a frame some clocks after it was told to.
        if state.rfom() {
            continue;
        }
        let mailbox = registers.rx(0);
        let id = mailbox.rir().read().stid();
        let [low, high] = [mailbox.rdlr().read().0, mailbox.rdhr().read().0];
        let bytes = (u64::from(high) << 32 | u64::from(low)).to_le_bytes();
        let length = usize::from(mailbox.rdtr().read().dlc());
        let data = bytes.get(..length).unwrap_or(&bytes);
        if let Some(frame) = Frame::new(id, data) {
            line.keep(Received { frame, at: now() });
        }
        fifo.write(|w| w.set_rfom(true));
    }
    registers.ier().modify(|w| w.set_fmpie(0, true));
}

/// Counts what only the interrupt sees.
struct Watch;

impl Handler<CAN1_SCE> for Watch {
    unsafe fn on_interrupt() {
        watch(pac::CAN1, &HOST);
    }
}

fn watch(registers: pac::can::Can, line: &Line) {
    registers.msr().write(|w| w.set_erri(true));
    let state = registers.esr().read();
    match state.lec() {
        Lec::NO_ERROR | Lec::CUSTOM => {}
        _ => {
            line.error_frames.raise();
            // So that the next one is seen as new.
            registers.esr().write(|w| w.set_lec(Lec::CUSTOM));
        }
    }
    if state.boff() {
        line.bus_off.raise();
    }
}

/// Collects the counts at every tick.
pub struct Monitor {
    registers: pac::can::Can,
    line: &'static Line,
    recovery: BusOffRecovery,
    /// Whether the controller was told to begin anew, the first half of asking to come back.
    asking: bool,
}

impl BusMonitor for Monitor {
    fn take(&mut self) -> BusCounts {
        let registers = self.registers;
        if self.asking && registers.msr().read().inak() {
            // From here on the hardware waits for 128 times 11 recessive bits.
            registers.mcr().modify(|w| w.set_inrq(false));
            self.asking = false;
        }
        let asking = &mut self.asking;
        self.line.take(&mut self.recovery, || {
            registers.mcr().modify(|w| w.set_inrq(true));
            *asking = true;
        })
    }
}
