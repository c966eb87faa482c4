//! NUCLEO-G474RE: FDCAN1 on PA11 (receive) and PA12 (transmit), the user LED on PA5.
#![no_std]
#![no_main]

use core::num::{NonZeroU8, NonZeroU16};
use core::panic::PanicInfo;

use canter_firmware::bus::{self, Signals};
use canter_firmware::node::{self, FIRST_AXIS, SharedNode};
use canter_firmware::port::{
    BusCounts, BusMonitor, CanReceive, CanTransmit, Received, SetpointSink, Tally, Watchdog,
};
use canter_firmware::{control, now, planning, priority, storage};
use canter_shared::axis::state::State;
use canter_shared::node::{AxisSetpoint, Board};
use canter_shared::parameter::store::Store;
use canter_shared::wire::frame::Frame;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, entry, exception};
use defmt_rtt as _;
use embassy_executor::InterruptExecutor;
use embassy_stm32::can::config::{
    FdCanConfig, GlobalFilter, NominalBitTiming, NonMatchingFilter, TxBufferMode,
};
use embassy_stm32::can::{self, CanConfigurator, CanRx, CanTx};
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::interrupt::typelevel::{FDCAN1_IT0, Handler};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::peripherals::{FDCAN1, IWDG};
use embassy_stm32::time::Hertz;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, interrupt, pac, rcc};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, block_for};
use embedded_storage::nor_flash::NorFlash;
use static_cell::StaticCell;

bind_interrupts!(struct Interrupts {
    // The tally comes first: the driver's handler clears the flags that it looks at.
    FDCAN1_IT0 => BusTally, can::IT0InterruptHandler<FDCAN1>;
    FDCAN1_IT1 => can::IT1InterruptHandler<FDCAN1>;
});

// Executors run in interrupts that are otherwise unused here.
static RECEPTION: InterruptExecutor = InterruptExecutor::new();
static CONTROL: InterruptExecutor = InterruptExecutor::new();
static BUS: InterruptExecutor = InterruptExecutor::new();
static PLANNING: InterruptExecutor = InterruptExecutor::new();
static STORAGE: InterruptExecutor = InterruptExecutor::new();

static SIGNALS: Signals = Signals::new();
static NODE: StaticCell<SharedNode> = StaticCell::new();

/// Frames between the hardware and the receive task. The receive task is held off by a tick and by
/// what it does about the frames before, together far under 1 ms, in which 1 Mbit/s brings at most
/// 21 frames (47 us each).
static FRAMES: Channel<CriticalSectionRawMutex, Received, 32> = Channel::new();

static BUS_OFF: Tally = Tally::new();
static LOST: Tally = Tally::new();

/// The nucleo's crystal. CAN needs one: its nodes may differ by 0.5 % at most at 1 Mbit/s and the
/// chip's own RC oscillator strays 1 % over temperature.
const CRYSTAL: Hertz = Hertz(24_000_000);

/// The watchdog's period: 20 ticks, far above any jitter, and short enough that a drive's own
/// time-out (25 ms and more) is not the first to notice. The LSI that clocks it, nominally 32 kHz,
/// is 29.5 to 34 kHz, so it bites after 18.8 to 21.7 ms.
const WATCHDOG_MICROSECONDS: u32 = 20_000;

/// The slots of the parameters: the last two pages of the second bank. The image is in the first one
/// (see build.rs), from which the processor goes on reading while a page of the second is erased, for
/// some 22 ms: neither the 1 kHz task nor the watchdog waits for that, only the storage task does.
const SLOTS: u32 = 512 * 1024 - 2 * SLOT;
const SLOT: u32 = 2 * 1024;
const _: () = assert!(SLOT as usize == <Flash as NorFlash>::ERASE_SIZE);

#[entry]
fn main() -> ! {
    let board = embassy_stm32::init(clocks());
    defmt::info!(
        "canter {}: nucleo-g474re, axes from {}, after a reset by {}",
        env!("CARGO_PKG_VERSION"),
        FIRST_AXIS,
        reset_cause(),
    );

    let mut watchdog = IndependentWatchdog::new(board.IWDG, WATCHDOG_MICROSECONDS);
    // A processor that a debugger has halted cannot feed it.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
    let mut store = storage::store(Flash::new_blocking(board.FLASH), SLOTS, SLOT);
    let loaded = storage::load(&mut store);
    let chip = embassy_stm32::uid::uid();
    let node = NODE.init(node::new(chip, Board::NucleoG474re, &loaded));
    let led = Led::new(Output::new(board.PA5, Level::Low, Speed::Low));

    // The driver subtracts up to 65535 x 41 ns = 2.7 ms from the time of a frame and panics where
    // that is before the boot.
    block_for(Duration::from_millis(3));
    let mut configurator = CanConfigurator::new(board.FDCAN1, board.PA11, board.PA12, Interrupts);
    configurator.set_config(can_config());
    let (transmitter, receiver, _) = configurator.into_normal_mode().split();
    pac::FDCAN1.ie().modify(|w| w.set_rfle(0, true));

    interrupt::FDCAN1_IT0.set_priority(level(priority::CAN_INTERRUPT));
    interrupt::UART4.set_priority(level(priority::RECEPTION));
    interrupt::UART5.set_priority(level(priority::CONTROL));
    interrupt::LPUART1.set_priority(level(priority::BUS));
    interrupt::USART3.set_priority(level(priority::PLANNING));
    interrupt::USART2.set_priority(level(priority::STORAGE));

    watchdog.unleash();
    let keeper = STORAGE.start(interrupt::USART2);
    keeper.spawn(storage_task(node, store).unwrap());
    let planner = PLANNING.start(interrupt::USART3);
    planner.spawn(planning_task(node).unwrap());
    let bus = BUS.start(interrupt::LPUART1);
    bus.spawn(receive_task(node).unwrap());
    bus.spawn(transmit_task(node, transmitter).unwrap());
    let control = CONTROL.start(interrupt::UART5);
    control.spawn(control_task(node, led, Dog(watchdog)).unwrap());
    let reception = RECEPTION.start(interrupt::UART4);
    reception.spawn(reception_task(receiver).unwrap());
    loop {
        cortex_m::asm::wfi();
    }
}

/// 24 MHz / 6 x 85 = 340 MHz, / 2 = 170 MHz for the processor and the buses; above 150 MHz the
/// core needs its boost voltage. FDCAN takes the crystal directly: exact, whatever the PLL does.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(rcc::Hse {
        freq: CRYSTAL,
        mode: rcc::HseMode::Oscillator,
    });
    config.rcc.pll = Some(rcc::Pll {
        source: rcc::PllSource::HSE,
        prediv: rcc::PllPreDiv::DIV6,
        mul: rcc::PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(rcc::PllRDiv::DIV2),
    });
    config.rcc.sys = rcc::Sysclk::PLL1_R;
    config.rcc.boost = true;
    config.rcc.hsi48 = None;
    config.rcc.mux.fdcansel = rcc::mux::Fdcansel::HSE;
    config
}

/// 1 Mbit/s: 24 MHz / 1 = 24 quanta to a bit = 1 (sync) + 20 + 3, sampled after 21 of 24, 87.5 %.
/// The jump width is as wide as the second segment, so that a far-off clock is still followed.
const BIT_TIMING: NominalBitTiming = NominalBitTiming {
    prescaler: NonZeroU16::MIN,
    seg1: NonZeroU8::new(20).unwrap(),
    seg2: NonZeroU8::new(3).unwrap(),
    sync_jump_width: NonZeroU8::new(3).unwrap(),
};

/// Classic frames with an 11-bit id are all accepted; the hardware drops everything else.
fn can_config() -> FdCanConfig {
    FdCanConfig::default()
        .set_nominal_bit_timing(BIT_TIMING)
        .set_global_filter(
            GlobalFilter::reject_all().set_handle_standard_frames(NonMatchingFilter::IntoRxFifo0),
        )
        // A queue by priority would let two replies with one id overtake each other.
        .set_tx_buffer_mode(TxBufferMode::Fifo)
}

fn level(priority: u8) -> Priority {
    Priority::from(priority::register(priority))
}

fn reset_cause() -> &'static str {
    let causes = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    // Every reset also pulls the pin, so the pin alone is the last to be believed.
    if causes.iwdgrstf() {
        "the watchdog"
    } else if causes.sftrstf() {
        "software: a fault, or a debugger"
    } else if causes.borrstf() {
        "power-on"
    } else {
        "the pin"
    }
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
unsafe fn LPUART1() {
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
async fn control_task(node: &'static SharedNode, led: Led, watchdog: Dog) -> ! {
    control::run(node, &SIGNALS, Monitor, led, watchdog).await
}

#[embassy_executor::task]
async fn receive_task(node: &'static SharedNode) -> ! {
    bus::receive(node, &SIGNALS, Queue).await
}

#[embassy_executor::task]
async fn transmit_task(node: &'static SharedNode, transmitter: CanTx<'static>) -> ! {
    bus::transmit(node, &SIGNALS, Transmitter(transmitter)).await
}

#[embassy_executor::task]
async fn planning_task(node: &'static SharedNode) -> ! {
    planning::run(node, &SIGNALS).await
}

#[embassy_executor::task]
async fn storage_task(node: &'static SharedNode, store: Store<Flash<'static, Blocking>>) -> ! {
    storage::run(node, &SIGNALS, store).await
}

/// Empties the three-deep hardware FIFO and stamps the frames.
///
/// The driver's own buffering would do it in the interrupt, but drops frames without a word when
/// its buffer is full.
#[embassy_executor::task]
async fn reception_task(mut receiver: CanRx<'static>) -> ! {
    loop {
        // Bus errors come as results too, but only such as a wake-up happens to find: the
        // hardware's own count in `Monitor` is the better one.
        let Ok(envelope) = receiver.read().await else {
            continue;
        };
        let at = now();
        let embedded_can::Id::Standard(id) = *envelope.frame.id() else {
            continue;
        };
        if let Some(frame) = Frame::new(id.as_raw(), envelope.frame.data())
            && FRAMES.try_send(Received { frame, at }).is_err()
        {
            LOST.raise();
        }
    }
}

/// The receive task's end of [`FRAMES`].
struct Queue;

impl CanReceive for Queue {
    async fn receive(&mut self) -> Received {
        FRAMES.receive().await
    }
}

struct Transmitter(CanTx<'static>);

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
struct BusTally;

impl Handler<FDCAN1_IT0> for BusTally {
    unsafe fn on_interrupt() {
        let flags = pac::FDCAN1.ir().read();
        if flags.rfl(0) {
            pac::FDCAN1.ir().write(|w| w.set_rfl(0, true));
            LOST.raise();
        }
        // The flag says that the state changed; leaving bus-off is no event.
        if flags.bo() && pac::FDCAN1.psr().read().bo() {
            BUS_OFF.raise();
        }
    }
}

/// Collects the counts at every tick.
struct Monitor;

impl BusMonitor for Monitor {
    fn take(&mut self) -> BusCounts {
        BusCounts {
            bus_off: BUS_OFF.take(),
            // Counts to 255 and starts again when it is read. An error frame lasts 20 us at
            // least, so one tick's worth is 50 at most.
            error_frames: u32::from(pac::FDCAN1.ecr().read().cel()),
            lost_receptions: LOST.take(),
        }
    }
}

struct Dog(IndependentWatchdog<'static, IWDG>);

impl Watchdog for Dog {
    fn feed(&mut self) {
        self.0.pet();
    }
}

/// Shows that the control loop lives: one blink in a second, five while an axis has a fault.
///
/// There is no drive behind this board's port yet, so the setpoints end here.
struct Led {
    pin: Output<'static>,
    ticks: u32,
}

impl Led {
    const HALF_PERIOD: u32 = 500;
    const HALF_PERIOD_IN_FAULT: u32 = 100;

    fn new(pin: Output<'static>) -> Self {
        Self { pin, ticks: 0 }
    }
}

impl SetpointSink for Led {
    fn put(&mut self, setpoints: &[AxisSetpoint]) {
        let fault = setpoints.iter().any(|axis| axis.state == State::Fault);
        let half_period = if fault {
            Self::HALF_PERIOD_IN_FAULT
        } else {
            Self::HALF_PERIOD
        };
        self.ticks += 1;
        if self.ticks >= half_period {
            self.ticks = 0;
            self.pin.toggle();
        }
    }
}

/// A reset is the safe state: setpoints stop at once, the drives' own time-outs act, and the node
/// comes back with its axes disabled. Stopping here instead would keep the fault's state for
/// a debugger that is hardly ever there, and take the axes off the bus until somebody pulls the plug.
#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    if let Some(location) = info.location() {
        defmt::error!("panic at {}:{}", location.file(), location.line());
    }
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    defmt::error!("hard fault at {:x}", frame.pc());
    SCB::sys_reset()
}

/// A word of flash whose programming was cut short has no valid check bits, and to read it brings
/// this interrupt. In the parameters' bank that is no reason for a reset, which would only read it
/// again: the store finds by its own check that the slot is not whole, and takes the other one.
#[exception]
unsafe fn NonMaskableInt() {
    let state = pac::FLASH.eccr().read();
    if (state.eccd() || state.eccd2()) && state.bk_ecc() {
        // The flags are cleared by writing them back.
        pac::FLASH.eccr().write_value(state);
        return;
    }
    SCB::sys_reset()
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    defmt::error!("unexpected interrupt {}", number);
    SCB::sys_reset()
}
