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
use embassy_stm32::{Config, pac, rcc};

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

/// Gives the core the voltage that it needs above 150 MHz: for that R1MODE is cleared, which is bit 8 of
/// PWR_CR5 (RM0440). The library clears bit 0 (stm32-metapac 21.0), and resets what is written before it
/// begins. So the processor is at 170 MHz some microseconds too early, once, on its way from there to here;
/// from then on the order is the manual's: half of the frequency until the voltage is there.
fn boost() {
    pac::RCC
        .cfgr()
        .modify(|w| w.set_hpre(rcc::AHBPrescaler::DIV2));
    pac::PWR.cr5().modify(|w| w.0 &= !(1 << 8));
    // 2 us, where one is asked for.
    cortex_m::asm::delay(170);
    pac::RCC
        .cfgr()
        .modify(|w| w.set_hpre(rcc::AHBPrescaler::DIV1));
}
