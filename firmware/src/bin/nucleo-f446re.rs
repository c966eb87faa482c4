//! NUCLEO-F446RE (UM1724): the host's bus is CAN1 on PB8 (receive) and PB9 (transmit), the drives' CAN2
//! on PB12 and PB13; the user LED LD2 is on PA5.
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
use embassy_stm32::{Config, pac, rcc};

/// What the ST-LINK puts out on MCO, from its own crystal: the board has none for this chip. CAN needs a
/// crystal: see `bit_timing` for what its nodes may differ by, and the chip's own RC oscillator strays
/// 1 % and more.
const CRYSTAL: Hertz = Hertz(8_000_000);

/// What CAN is clocked with: see [`clocks`].
const PERIPHERALS: u32 = CRYSTAL.0 / 4 * 160 / 2 / 4;

#[entry]
fn main() -> ! {
    let board = embassy_stm32::init(clocks());
    // The chip starts without its caches, and each step to another line of flash would take six clocks.
    pac::FLASH.acr().modify(|w| {
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    let timing = const { BitTiming::new(PERIPHERALS, BITRATE, can::MOST_QUANTA) };
    let drive_timing = const { BitTiming::new(PERIPHERALS, DRIVE_BITRATE, can::MOST_QUANTA) };
    start(Parts {
        board: Board::NucleoF446re,
        host: can::open_host(board.CAN1, board.PB8, board.PB9, timing),
        drives: can::open_drives(board.CAN2, board.PB12, board.PB13, drive_timing),
        flash: ParameterFlash::new(board.FLASH),
        led: Led::new(Output::new(board.PA5, Level::Low, Speed::Low)),
        watchdog: Dog::new(board.IWDG),
    });
    // Everything runs in interrupts. The loop stands here because the compiler does not work out ahead
    // what comes before a call that never ends: the set-up of the clocks would be 3 KiB larger.
    loop {
        cortex_m::asm::wfi();
    }
}

/// 8 MHz / 4 x 160 = 320 MHz, / 2 = 160 MHz for the processor, / 4 = 40 MHz for CAN. The fastest
/// 180 MHz would leave CAN 45 MHz, from which no bit of 1 Mbit/s can be sampled at 87.5 %.
fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(rcc::Hse {
        freq: CRYSTAL,
        mode: rcc::HseMode::Bypass,
    });
    config.rcc.pll_src = rcc::PllSource::HSE;
    config.rcc.pll = Some(rcc::Pll {
        prediv: rcc::PllPreDiv::DIV4,
        mul: rcc::PllMul::MUL160,
        divp: Some(rcc::PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    config.rcc.sys = rcc::Sysclk::PLL1_P;
    config.rcc.ahb_pre = rcc::AHBPrescaler::DIV1;
    config.rcc.apb1_pre = rcc::APBPrescaler::DIV4;
    config.rcc.apb2_pre = rcc::APBPrescaler::DIV2;
    config
}
