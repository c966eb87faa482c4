//! NUCLEO-H743ZI2 (UM2407): the host's bus is FDCAN1 on PD0 (receive) and PD1 (transmit), the drives'
//! FDCAN2 on PB5 and PB6; the green user LED LD1 is on PB0.
#![no_std]
#![no_main]

use canter_firmware::bit_timing::{BITRATE, BitTiming, DRIVE_BITRATE};
use canter_firmware::stm32::flash::ParameterFlash;
use canter_firmware::stm32::led::Led;
use canter_firmware::stm32::watchdog::Dog;
use canter_firmware::stm32::{Parts, can, start};
use canter_shared::node::Board;
use cortex_m_rt::entry;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, rcc};

/// What the ST-LINK puts out on MCO, from its own crystal: the board has none for this chip. CAN needs a
/// crystal: see `bit_timing` for what its nodes may differ by, and the chip's own RC oscillator strays
/// 1 % and more.
const CRYSTAL: Hertz = Hertz(8_000_000);

/// What CAN is clocked with: see [`clocks`].
const CAN_CLOCK: u32 = CRYSTAL.0 / 2 * 200 / 10;

#[entry]
fn main() -> ! {
    let board = embassy_stm32::init(clocks());
    // Off at the start; flash is slow. Data are in the processor's own RAM and need no cache.
    if let Some(mut core) = cortex_m::Peripherals::take() {
        core.SCB.enable_icache();
    }
    let timing = const { BitTiming::new(CAN_CLOCK, BITRATE, can::MOST_QUANTA) };
    let drive_timing = const { BitTiming::new(CAN_CLOCK, DRIVE_BITRATE, can::MOST_QUANTA) };
    start(Parts {
        board: Board::NucleoH743zi2,
        host: can::open_host(board.FDCAN1, board.PD0, board.PD1, timing),
        drives: can::open_drives(board.FDCAN2, board.PB5, board.PB6, drive_timing),
        flash: ParameterFlash::new(board.FLASH),
        led: Led::new(Output::new(board.PB0, Level::Low, Speed::Low)),
        watchdog: Dog::new(board.IWDG1),
    });
    // Everything runs in interrupts. The loop stands here because the compiler does not work out ahead
    // what comes before a call that never ends: the set-up of the clocks would be 3 KiB larger.
    loop {
        cortex_m::asm::wfi();
    }
}

/// 8 MHz / 2 x 200 = 800 MHz, / 2 = 400 MHz for the processor, / 2 = 200 MHz for AHB, / 2 = 100 MHz
/// for the peripherals; 800 MHz / 10 = 80 MHz for CAN, which must be no faster than its peripheral bus.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(rcc::Hse {
        freq: CRYSTAL,
        mode: rcc::HseMode::Bypass,
    });
    config.rcc.pll1 = Some(rcc::Pll {
        source: rcc::PllSource::HSE,
        prediv: rcc::PllPreDiv::DIV2,
        mul: rcc::PllMul::MUL200,
        fracn: None,
        divp: Some(rcc::PllDiv::DIV2),
        divq: Some(rcc::PllDiv::DIV10),
        divr: None,
    });
    config.rcc.sys = rcc::Sysclk::PLL1_P;
    config.rcc.ahb_pre = rcc::AHBPrescaler::DIV2;
    config.rcc.apb1_pre = rcc::APBPrescaler::DIV2;
    config.rcc.apb2_pre = rcc::APBPrescaler::DIV2;
    config.rcc.apb3_pre = rcc::APBPrescaler::DIV2;
    config.rcc.apb4_pre = rcc::APBPrescaler::DIV2;
    config.rcc.voltage_scale = rcc::VoltageScale::Scale1;
    config.rcc.hsi48 = None;
    config.rcc.mux.fdcansel = rcc::mux::Fdcansel::PLL1_Q;
    config
}
