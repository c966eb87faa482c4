//! The bxCAN controllers of an STM32F4: CAN1 is the host's bus, CAN2 the drives'.
//!
//! What embassy-stm32 0.6.0 does that a node cannot live with, and what is done about it:
//!
//! - Its buffered reception drops frames without a word when its buffer is full. Not buffered, it clears
//!   the flag for frames that the hardware lost whenever it takes one out, because it writes back what it
//!   read. So frames are taken out of the hardware here.
//! - Its interrupt for errors switches itself off until somebody reads an error. So that one is
//!   answered here too, which clears it before the driver looks.
//! - `set_automatic_retransmit` does the opposite. It is left alone: retransmission is on.
//! - `enable` waits until the bus is idle, which a broken one never is, and lets a controller back onto
//!   its bus at once after bus-off. So the controller is woken here, and comes back as
//!   [`canter_shared::node::bus_off`] says.

use core::future::poll_fn;
use core::num::{NonZeroU8, NonZeroU16};
use core::task::Poll;

use canter_shared::wire::frame::Frame;
use embassy_stm32::can::filter::Mask32;
use embassy_stm32::can::util::NominalBitTiming;
use embassy_stm32::can::{self, Can, CanTx, Fifo, RxPin, StandardId, TxPin};
use embassy_stm32::interrupt::typelevel::{CAN1_RX0, CAN1_SCE, CAN2_RX0, CAN2_SCE, Handler};
use embassy_stm32::interrupt::{Interrupt, InterruptExt};
use embassy_stm32::pac::can::vals::Lec;
use embassy_stm32::peripherals::{CAN1, CAN2};
use embassy_stm32::{Peri, bind_interrupts, interrupt, pac};
use embassy_sync::waitqueue::AtomicWaker;

use super::level;
use super::line::{self, Line, Monitor};
use crate::bit_timing::BitTiming;
use crate::port::{CanReceive, CanTransmit, Received};
use crate::{now, priority};

bind_interrupts!(struct Interrupts {
    CAN1_TX => can::TxInterruptHandler<CAN1>;
    // The driver's handler switches the interrupt off until a frame is asked for, ours wakes.
    CAN1_RX0 => can::Rx0InterruptHandler<CAN1>, Watch;
    CAN1_RX1 => can::Rx1InterruptHandler<CAN1>;
    // Ours comes first, so that the driver's finds nothing.
    CAN1_SCE => Watch, can::SceInterruptHandler<CAN1>;
    CAN2_TX => can::TxInterruptHandler<CAN2>;
    CAN2_RX0 => can::Rx0InterruptHandler<CAN2>, Watch;
    CAN2_RX1 => can::Rx1InterruptHandler<CAN2>;
    CAN2_SCE => Watch, can::SceInterruptHandler<CAN2>;
});

/// The most quanta to a bit: 1 + 16 + 8.
pub const MOST_QUANTA: u32 = 25;

/// Filter banks of CAN1: the first half of the two controllers' 28.
const BANKS_OF_HOST: u8 = 14;

/// What belongs to the host's bus.
pub static HOST: Line = Line::new();
static DRIVES: Line = Line::new();

static HOST_FRAME: AtomicWaker = AtomicWaker::new();
static DRIVE_FRAME: AtomicWaker = AtomicWaker::new();

/// A bus that is switched on.
pub struct Bus {
    /// Frames in.
    pub(super) receiver: Receiver,
    /// Frames out.
    pub(super) transmitter: Transmitter,
    /// For the 1 kHz task.
    pub(super) monitor: Monitor<Controller>,
}

/// Switches the host's bus on. It comes before the drives' bus, because its controller has the filters
/// of both.
pub fn open_host(
    peripheral: Peri<'static, CAN1>,
    receive: Peri<'static, impl RxPin<CAN1>>,
    transmit: Peri<'static, impl TxPin<CAN1>>,
    timing: BitTiming,
) -> Bus {
    let mut can = Can::new(peripheral, receive, transmit, Interrupts);
    let mut filters = can.modify_filters();
    filters.set_split(BANKS_OF_HOST);
    filters.enable_bank(0, Fifo::Fifo0, all());
    filters
        .slave_filters()
        .enable_bank(BANKS_OF_HOST, Fifo::Fifo0, all());
    drop(filters);
    let interrupts = [
        interrupt::CAN1_TX,
        interrupt::CAN1_RX0,
        interrupt::CAN1_RX1,
        interrupt::CAN1_SCE,
    ];
    let transmitter = open(can, timing, pac::CAN1, interrupts);
    Bus {
        receiver: Receiver {
            registers: pac::CAN1,
            arrived: &HOST_FRAME,
        },
        transmitter: Transmitter(transmitter, &HOST),
        monitor: Monitor::of_host(Controller::new(pac::CAN1), &HOST),
    }
}

/// Switches the drives' bus on.
pub fn open_drives(
    peripheral: Peri<'static, CAN2>,
    receive: Peri<'static, impl RxPin<CAN2>>,
    transmit: Peri<'static, impl TxPin<CAN2>>,
    timing: BitTiming,
) -> Bus {
    let can = Can::new(peripheral, receive, transmit, Interrupts);
    let interrupts = [
        interrupt::CAN2_TX,
        interrupt::CAN2_RX0,
        interrupt::CAN2_RX1,
        interrupt::CAN2_SCE,
    ];
    let transmitter = open(can, timing, pac::CAN2, interrupts);
    Bus {
        receiver: Receiver {
            registers: pac::CAN2,
            arrived: &DRIVE_FRAME,
        },
        transmitter: Transmitter(transmitter, &DRIVES),
        monitor: Monitor::of_drives(Controller::new(pac::CAN2), &DRIVES),
    }
}

/// Data frames with any 11-bit id; the hardware drops everything else.
fn all() -> Mask32 {
    let mut all = Mask32::frames_with_std_id(StandardId::ZERO, StandardId::ZERO);
    all.data_frames_only();
    all
}

fn open(
    mut can: Can<'static>,
    timing: BitTiming,
    registers: pac::can::Can,
    interrupts: [Interrupt; 4],
) -> CanTx<'static> {
    can.modify_config().set_bit_timing(parts(timing));
    can.set_tx_fifo_scheduling(true);
    let (transmitter, _) = can.split();
    // The driver would switch the controller off with it.
    core::mem::forget(can);
    registers.ier().modify(|w| {
        w.set_fovie(0, true);
        // Warnings are no errors.
        w.set_ewgie(false);
        w.set_epvie(false);
    });
    for interrupt in interrupts {
        // The same for all: none may come between another's reading of a register and its writing.
        interrupt.set_priority(level(priority::CAN_INTERRUPT));
    }
    registers.mcr().modify(|w| {
        w.set_abom(false);
        w.set_sleep(false);
    });
    transmitter
}

fn parts(timing: BitTiming) -> NominalBitTiming {
    NominalBitTiming {
        prescaler: NonZeroU16::new(timing.prescaler).unwrap_or(NonZeroU16::MIN),
        seg1: NonZeroU8::new(timing.before_sample).unwrap_or(NonZeroU8::MIN),
        seg2: NonZeroU8::new(timing.after_sample).unwrap_or(NonZeroU8::MIN),
        sync_jump_width: NonZeroU8::new(timing.after_sample).unwrap_or(NonZeroU8::MIN),
    }
}

/// Frames out of the three-deep hardware FIFO, stamped as they are taken.
pub struct Receiver {
    registers: pac::can::Can,
    arrived: &'static AtomicWaker,
}

impl CanReceive for Receiver {
    async fn receive(&mut self) -> Received {
        poll_fn(|context| {
            self.arrived.register(context.waker());
            match take(self.registers) {
                Some(received) => Poll::Ready(received),
                None => {
                    // The interrupts' handlers write this register too.
                    critical_section::with(|_| {
                        self.registers.ier().modify(|w| w.set_fmpie(0, true));
                    });
                    Poll::Pending
                }
            }
        })
        .await
    }
}

/// The oldest frame in the hardware.
fn take(registers: pac::can::Can) -> Option<Received> {
    let fifo = registers.rfr(0);
    // The hardware lets go of a frame some clocks after it was told to.
    while fifo.read().rfom() {}
    if fifo.read().fmp() == 0 {
        return None;
    }
    let at = now();
    let mailbox = registers.rx(0);
    let id = mailbox.rir().read().stid();
    let [low, high] = [mailbox.rdlr().read().0, mailbox.rdhr().read().0];
    let bytes = (u64::from(high) << 32 | u64::from(low)).to_le_bytes();
    let length = usize::from(mailbox.rdtr().read().dlc());
    let frame = Frame::new(id, bytes.get(..length).unwrap_or(&bytes));
    // Flags are cleared by writing a one, so that the others stay.
    fifo.write(|w| w.set_rfom(true));
    frame.map(|frame| Received { frame, at })
}

/// Frames into the three mailboxes. In the order of their coming the driver takes none back.
pub struct Transmitter(CanTx<'static>, &'static Line);

impl CanTransmit for &mut Transmitter {
    async fn transmit(&mut self, frame: &Frame) {
        if let Ok(frame) = can::Frame::new_standard(frame.id(), frame.data()) {
            self.0.write(&frame).await;
            self.1.count_sent();
        }
    }
}

/// Wakes, and counts what only the interrupts see.
struct Watch;

impl Handler<CAN1_RX0> for Watch {
    unsafe fn on_interrupt() {
        arrive(pac::CAN1, &HOST_FRAME, &HOST);
    }
}

impl Handler<CAN2_RX0> for Watch {
    unsafe fn on_interrupt() {
        arrive(pac::CAN2, &DRIVE_FRAME, &DRIVES);
    }
}

fn arrive(registers: pac::can::Can, arrived: &AtomicWaker, line: &Line) {
    let fifo = registers.rfr(0);
    if fifo.read().fovr() {
        fifo.write(|w| w.set_fovr(true));
        line.lost.raise();
    }
    arrived.wake();
}

impl Handler<CAN1_SCE> for Watch {
    unsafe fn on_interrupt() {
        watch(pac::CAN1, &HOST);
    }
}

impl Handler<CAN2_SCE> for Watch {
    unsafe fn on_interrupt() {
        watch(pac::CAN2, &DRIVES);
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

/// One controller's registers.
pub struct Controller {
    registers: pac::can::Can,
}

impl Controller {
    const fn new(registers: pac::can::Can) -> Self {
        Self { registers }
    }
}

impl line::Controller for Controller {
    fn recover(&mut self) {
        let mode = self.registers.mcr();
        // To begin anew and to go on: off the bus the hardware takes some clocks for the first. Where it
        // takes longer, the bus is not off.
        mode.modify(|w| w.set_inrq(true));
        let _ = (0..1_000).find(|_| self.registers.msr().read().inak());
        mode.modify(|w| w.set_inrq(false));
    }

    fn error_frames(&mut self) -> u32 {
        // The interrupt counts them.
        0
    }

    fn is_sending(&self) -> bool {
        let state = self.registers.tsr().read();
        (0..3).any(|mailbox| !state.tme(mailbox))
    }

    fn discard(&mut self) {
        // The interrupt for a mailbox that became free wakes whoever waits.
        self.registers.tsr().write(|w| {
            for mailbox in 0..3 {
                w.set_abrq(mailbox, true);
            }
        });
    }
}
