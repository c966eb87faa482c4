//! From a board's parts to running tasks.

use canter_shared::node::Board;
use canter_shared::node::restart::Restart;
use canter_shared::parameter::store::Store;
use defmt_rtt as _;
use embassy_executor::InterruptExecutor;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use static_cell::StaticCell;

use super::can::{Bus, Controller, HOST, Receiver, Transmitter};
use super::flash::{ParameterFlash, SLOT, SLOTS};
use super::led::Led;
use super::level;
use super::line::{Both, Queue};
use super::reset::{self, Cause};
use super::watchdog::Dog;
use crate::bus::{self, Signals};
use crate::node::{self, FIRST_AXIS, SharedNode};
use crate::{control, crash, planning, priority, storage};

/// What a board has set up.
pub struct Parts {
    /// Which board.
    pub board: Board,
    /// The host's bus.
    pub host: Bus,
    /// The drives' bus.
    pub drives: Bus,
    /// The chip's flash.
    pub flash: ParameterFlash,
    /// What shows that the node lives.
    pub led: Led,
    /// What resets the chip when it does not.
    pub watchdog: Dog,
}

// Executors run in interrupts that are otherwise unused, and that every chip here has.
static RECEPTION: InterruptExecutor = InterruptExecutor::new();
static CONTROL: InterruptExecutor = InterruptExecutor::new();
static BUS: InterruptExecutor = InterruptExecutor::new();
static PLANNING: InterruptExecutor = InterruptExecutor::new();
static STORAGE: InterruptExecutor = InterruptExecutor::new();

static SIGNALS: Signals = Signals::new();
static FRAMES: Queue = Queue::new();
static NODE: StaticCell<SharedNode> = StaticCell::new();

// Here and not in the tasks, which would each hold what they are given several times.
static TO_HOST: StaticCell<Transmitter> = StaticCell::new();
static TO_DRIVES: StaticCell<Transmitter> = StaticCell::new();
static MONITOR: StaticCell<Both<Controller>> = StaticCell::new();

/// Starts the node, which then lives in interrupts.
pub fn start(mut parts: Parts) {
    crash::guard_stack();
    let restart = why();
    let mut store = storage::store(parts.flash, SLOTS, SLOT);
    let loaded = storage::load(&mut store);
    let chip = embassy_stm32::uid::uid();
    let node = node::begin(&NODE, chip, parts.board, &loaded, restart);

    interrupt::UART4.set_priority(level(priority::RECEPTION));
    interrupt::UART5.set_priority(level(priority::CONTROL));
    interrupt::USART1.set_priority(level(priority::BUS));
    interrupt::USART3.set_priority(level(priority::PLANNING));
    interrupt::USART2.set_priority(level(priority::STORAGE));

    parts.watchdog.unleash();
    let keeper = STORAGE.start(interrupt::USART2);
    keeper.spawn(storage_task(node, store).unwrap());
    let planner = PLANNING.start(interrupt::USART3);
    planner.spawn(planning_task(node).unwrap());
    let bus = BUS.start(interrupt::USART1);
    bus.spawn(receive_task(node).unwrap());
    bus.spawn(transmit_task(node, TO_HOST.init(parts.host.transmitter)).unwrap());
    let control = CONTROL.start(interrupt::UART5);
    let monitor = MONITOR.init(Both(parts.host.monitor, parts.drives.monitor));
    control.spawn(control_task(node, monitor, parts.led, parts.watchdog).unwrap());
    control.spawn(drive_receive_task(node, parts.drives.receiver).unwrap());
    control.spawn(drive_transmit_task(node, TO_DRIVES.init(parts.drives.transmitter)).unwrap());
    let reception = RECEPTION.start(interrupt::UART4);
    reception.spawn(reception_task(parts.host.receiver).unwrap());
}

/// Why the node began anew by itself, if it did.
fn why() -> Option<Restart> {
    let cause = reset::cause();
    defmt::info!(
        "canter {}: axes from {}, after a reset by {}",
        env!("CARGO_PKG_VERSION"),
        FIRST_AXIS,
        cause,
    );
    // RAM that has just got its power holds anything, and some chips' must be written before it is read.
    let crash = if cause == Cause::Power {
        None
    } else {
        crash::take()
    };
    if let Some(crash) = crash {
        defmt::warn!("the run before crashed at {:x}", crash.place);
    }
    let stalled = (cause == Cause::Watchdog).then_some(Restart::Watchdog);
    crash.map(|crash| crash.restart).or(stalled)
}

#[interrupt]
unsafe fn UART4() {
    // SAFETY: this is the interrupt that `RECEPTION` is started with, and nothing else calls it.
    unsafe { RECEPTION.on_interrupt() }
}

#[interrupt]
unsafe fn UART5() {
    // SAFETY: this is the interrupt that `CONTROL` is started with, and nothing else calls it.
    unsafe { CONTROL.on_interrupt() }
}

#[interrupt]
unsafe fn USART1() {
    // SAFETY: this is the interrupt that `BUS` is started with, and nothing else calls it.
    unsafe { BUS.on_interrupt() }
}

#[interrupt]
unsafe fn USART3() {
    // SAFETY: this is the interrupt that `PLANNING` is started with, and nothing else calls it.
    unsafe { PLANNING.on_interrupt() }
}

#[interrupt]
unsafe fn USART2() {
    // SAFETY: this is the interrupt that `STORAGE` is started with, and nothing else calls it.
    unsafe { STORAGE.on_interrupt() }
}

#[embassy_executor::task]
async fn control_task(
    node: &'static SharedNode,
    monitor: &'static mut Both<Controller>,
    led: Led,
    watchdog: Dog,
) -> ! {
    control::run(node, &SIGNALS, monitor, led, watchdog).await
}

#[embassy_executor::task]
async fn drive_receive_task(node: &'static SharedNode, receiver: Receiver) -> ! {
    bus::receive_drives(node, receiver).await
}

#[embassy_executor::task]
async fn drive_transmit_task(
    node: &'static SharedNode,
    transmitter: &'static mut Transmitter,
) -> ! {
    bus::transmit_drives(node, &SIGNALS, transmitter).await
}

#[embassy_executor::task]
async fn reception_task(receiver: Receiver) -> ! {
    FRAMES.fill(receiver, &HOST).await
}

#[embassy_executor::task]
async fn receive_task(node: &'static SharedNode) -> ! {
    bus::receive(node, &SIGNALS, &FRAMES).await
}

#[embassy_executor::task]
async fn transmit_task(node: &'static SharedNode, transmitter: &'static mut Transmitter) -> ! {
    bus::transmit(node, &SIGNALS, transmitter).await
}

#[embassy_executor::task]
async fn planning_task(node: &'static SharedNode) -> ! {
    planning::run(node, &SIGNALS).await
}

#[embassy_executor::task]
async fn storage_task(node: &'static SharedNode, store: Store<ParameterFlash>) -> ! {
    storage::run(node, &SIGNALS, store).await
}
