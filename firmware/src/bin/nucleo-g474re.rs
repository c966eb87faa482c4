//! NUCLEO-G474RE (UM2505): the host's bus is FDCAN1 on PA11 (receive) and PA12 (transmit), the drives'
//! FDCAN2 on PB12 and PB13; the user LED LD2 is on PA5.
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

/// The board's crystal X3. CAN needs one: see `bit_timing` for what its nodes may differ by, and the
/// chip's own RC oscillator strays 1 % over temperature.
const CRYSTAL: Hertz = Hertz(24_000_000);

#[entry]
fn main() -> ! {
    let board = embassy_stm32::init(clocks());
    boost();
    let timing = const { BitTiming::new(CRYSTAL.0, BITRATE, can::MOST_QUANTA) };
    let drive_timing = const { BitTiming::new(CRYSTAL.0, DRIVE_BITRATE, can::MOST_QUANTA) };
    start(Parts {
        board: Board::NucleoG474re,
        host: can::open_host(board.FDCAN1, board.PA11, board.PA12, timing),
        drives: can::open_drives(board.FDCAN2, board.PB12, board.PB13, drive_timing),
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

/// 24 MHz / 6 x 85 = 340 MHz, / 4 = 85 MHz, until [`boost`] doubles it. FDCAN takes the crystal directly:
/// exact, whatever the PLL does.
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
        divr: Some(rcc::PllRDiv::DIV4),
    });
    config.rcc.sys = rcc::Sysclk::PLL1_R;
    config.rcc.hsi48 = None;
    config.rcc.mux.fdcansel = rcc::mux::Fdcansel::HSE;
    config
}

/// From 85 to 170 MHz for the processor: above 150 MHz the core needs its boost voltage.
///
/// The library would do it, but clears another bit than R1MODE, which is bit 8 of PWR_CR5 (RM0440, 6.4),
/// and the core would be without that voltage. To have it set up the clocks twice, with the bit cleared
/// between, takes 3 KiB. What it knows of the clocks stays true of the peripherals: the timers and APB1
/// have 85 MHz before and after.
fn boost() {
    use embassy_stm32::pac::{FLASH, PWR, RCC, flash::vals::Latency};

    // The order of RM0440, 6.1.5: half of the frequency until the voltage is there.
    RCC.cfgr().modify(|w| w.set_sw(rcc::Sysclk::HSI));
    while RCC.cfgr().read().sws() != rcc::Sysclk::HSI {}
    RCC.cr().modify(|w| w.set_pllon(false));
    while RCC.cr().read().pllrdy() {}
    RCC.pllcfgr().modify(|w| w.set_pllr(rcc::PllRDiv::DIV2));
    RCC.cr().modify(|w| w.set_pllon(true));
    while !RCC.cr().read().pllrdy() {}
    RCC.cfgr().modify(|w| w.set_hpre(rcc::AHBPrescaler::DIV2));
    PWR.cr5().modify(|w| w.0 &= !(1 << 8));
    FLASH.acr().modify(|w| w.set_latency(Latency::WS4));
    while FLASH.acr().read().latency() != Latency::WS4 {}
    RCC.cfgr().modify(|w| w.set_sw(rcc::Sysclk::PLL1_R));
    while RCC.cfgr().read().sws() != rcc::Sysclk::PLL1_R {}
    // At least 1 us.
    cortex_m::asm::delay(170);
    RCC.cfgr().modify(|w| {
        w.set_hpre(rcc::AHBPrescaler::DIV1);
        w.set_ppre1(rcc::APBPrescaler::DIV2);
        // Timers run at twice the rate of a bus that is divided.
        w.set_ppre2(rcc::APBPrescaler::DIV4);
    });
}
