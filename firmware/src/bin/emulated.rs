//! The emulated board, for QEMU's netduinoplus2 machine (STM32F405, Cortex-M4F):
//!
//! ```text
//! qemu-system-arm -M netduinoplus2 -kernel IMAGE -nographic -monitor none -no-reboot \
//!     -serial tcp:127.0.0.1:PORT,server=on,wait=off,nodelay=on -serial file:TRACE
//! ```
//!
//! The first serial port is the CAN bus, as SLCAN; the second is the drive port, see
//! [`canter_firmware::emulated::trace`]. Without `-icount` the node's clock is the host's; with it
//! the node lags behind whenever QEMU does, and no SYNC can discipline that.
#![no_std]
#![no_main]

use canter_firmware::bus::{self, Signals};
use canter_firmware::emulated::trace::Trace;
use canter_firmware::emulated::{slcan, time};
use canter_firmware::node::{self, FIRST_AXIS, SharedNode};
use canter_firmware::port::NoWatchdog;
use canter_firmware::{control, crash, planning, priority, storage};
use canter_shared::node::Board;
use canter_shared::parameter::flash::MemoryFlash;
use canter_shared::parameter::store::Store;
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m_rt::entry;
use embassy_executor::InterruptExecutor;
use static_cell::StaticCell;
use stm32_metapac::{Interrupt, interrupt};

// Executors run in interrupts that are otherwise unused here. None runs in thread mode, because
// the thread executor sleeps by WFE, which QEMU treats as no operation: it would burn a host's core.
static CONTROL: InterruptExecutor = InterruptExecutor::new();
static BUS: InterruptExecutor = InterruptExecutor::new();
static PLANNING: InterruptExecutor = InterruptExecutor::new();
static STORAGE: InterruptExecutor = InterruptExecutor::new();

static SIGNALS: Signals = Signals::new();
static NODE: StaticCell<SharedNode> = StaticCell::new();

/// No flash that could be written is emulated: what is saved lasts until the emulator ends.
type Memory = MemoryFlash<{ 2 * SLOT as usize }, { SLOT as usize }>;
const SLOT: u32 = 1024;

/// There is no chip to have an id: one for each image, so that several can share a bus.
const CHIP: [u8; 12] = {
    let mut chip = *b"QEMU node 00";
    chip[10] += FIRST_AXIS / 10;
    chip[11] += FIRST_AXIS % 10;
    chip
};

#[entry]
fn main() -> ! {
    let Some(mut core) = cortex_m::Peripherals::take() else {
        SCB::sys_reset()
    };
    crash::guard_stack();
    time::start(core.SYST);
    let (receiver, transmitter, monitor) = slcan::start();
    let mut store = storage::store(Memory::new(), 0, SLOT);
    let loaded = storage::load(&mut store);
    let restart = crash::take().map(|crash| crash.restart);
    let node = node::begin(&NODE, CHIP, Board::Emulated, &loaded, restart);

    // SAFETY: no executor runs yet and no lock is held, so no order of priorities is in use.
    unsafe {
        let mut set = |interrupt, level| {
            core.NVIC.set_priority(interrupt, priority::register(level));
        };
        set(Interrupt::USART1, priority::CAN_INTERRUPT);
        set(Interrupt::UART5, priority::CONTROL);
        set(Interrupt::UART4, priority::BUS);
        set(Interrupt::USART3, priority::PLANNING);
        set(Interrupt::USART6, priority::STORAGE);
    }
    let keeper = STORAGE.start(Interrupt::USART6);
    keeper.spawn(storage_task(node, store).unwrap());
    let planner = PLANNING.start(Interrupt::USART3);
    planner.spawn(planning_task(node).unwrap());
    let bus = BUS.start(Interrupt::UART4);
    bus.spawn(receive_task(node, receiver).unwrap());
    bus.spawn(transmit_task(node, transmitter).unwrap());
    let control = CONTROL.start(Interrupt::UART5);
    control.spawn(control_task(node, monitor, Trace::start()).unwrap());
    // SAFETY: everything that the interrupt touches is set up.
    unsafe { NVIC::unmask(Interrupt::USART1) };
    loop {
        cortex_m::asm::wfi();
    }
}

#[interrupt]
fn USART1() {
    slcan::on_interrupt();
}

#[interrupt]
unsafe fn UART5() {
    // SAFETY: this is the interrupt that `CONTROL` is started with, and nothing else calls it.
    unsafe { CONTROL.on_interrupt() }
}

#[interrupt]
unsafe fn UART4() {
    // SAFETY: this is the interrupt that `BUS` is started with, and nothing else calls it.
    unsafe { BUS.on_interrupt() }
}

#[interrupt]
unsafe fn USART3() {
    // SAFETY: this is the interrupt that `PLANNING` is started with, and nothing else calls it.
    unsafe { PLANNING.on_interrupt() }
}

#[interrupt]
unsafe fn USART6() {
    // SAFETY: this is the interrupt that `STORAGE` is started with, and nothing else calls it.
    unsafe { STORAGE.on_interrupt() }
}

#[embassy_executor::task]
async fn control_task(node: &'static SharedNode, monitor: slcan::Monitor, trace: Trace) -> ! {
    control::run(node, &SIGNALS, monitor, trace, NoWatchdog).await
}

#[embassy_executor::task]
async fn receive_task(node: &'static SharedNode, receiver: slcan::Receiver) -> ! {
    bus::receive(node, &SIGNALS, receiver).await
}

#[embassy_executor::task]
async fn transmit_task(node: &'static SharedNode, transmitter: slcan::Transmitter) -> ! {
    bus::transmit(node, &SIGNALS, transmitter).await
}

#[embassy_executor::task]
async fn planning_task(node: &'static SharedNode) -> ! {
    planning::run(node, &SIGNALS).await
}

#[embassy_executor::task]
async fn storage_task(node: &'static SharedNode, store: Store<Memory>) -> ! {
    storage::run(node, &SIGNALS, store).await
}
