//! The time driver: TIM2 tells the time, SysTick wakes.
//!
//! SysTick alone could do both, but then it either interrupts at a fixed rate (at 10 kHz QEMU's
//! clock falls behind the host's, seen), or is set anew for each alarm and loses a fraction of
//! a count each time. A counter that is only read does not drift.

use core::cell::{Cell, RefCell};
use core::task::Waker;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use critical_section::{CriticalSection, Mutex};
use embassy_time_driver::{Driver, time_driver_impl};
use embassy_time_queue_utils::Queue;
use stm32_metapac::TIM2;

/// QEMU drives its timers with 1 GHz, whatever the clock controller says (which it lacks).
const TIMER_CLOCKS_PER_MICROSECOND: u16 = 1_000;

/// SysTick counts the core's 168 MHz.
const SYSTICK_COUNTS_PER_MICROSECOND: u32 = 168;

/// SysTick has 24 bits, enough for 99.8 ms. A longer sleep is interrupted on the way.
const LONGEST_SLEEP: u64 = 99_000;

struct EmulatedDriver {
    /// The time of the last look, in microseconds. The hardware's 32 bits last 71 minutes, and
    /// somebody looks far more often than that, at the least once in [`LONGEST_SLEEP`].
    last: Mutex<Cell<u64>>,
    queue: Mutex<RefCell<Queue>>,
    systick: Mutex<RefCell<Option<SYST>>>,
}

time_driver_impl!(static DRIVER: EmulatedDriver = EmulatedDriver {
    last: Mutex::new(Cell::new(0)),
    queue: Mutex::new(RefCell::new(Queue::new())),
    systick: Mutex::new(RefCell::new(None)),
});

/// Starts the clock at zero.
pub fn start(mut systick: SYST) {
    TIM2.psc().write_value(TIMER_CLOCKS_PER_MICROSECOND - 1);
    TIM2.cnt().write_value(0);
    systick.set_clock_source(SystClkSource::Core);
    systick.enable_interrupt();
    critical_section::with(|cs| {
        DRIVER.systick.borrow(cs).replace(Some(systick));
        DRIVER.advance(cs);
    });
}

impl EmulatedDriver {
    fn now(&self, cs: CriticalSection) -> u64 {
        let last = self.last.borrow(cs);
        let passed = TIM2.cnt().read().wrapping_sub(last.get() as u32);
        last.set(last.get() + u64::from(passed));
        last.get()
    }

    /// Wakes whoever is due, and sets the alarm for whoever is next.
    fn advance(&self, cs: CriticalSection) {
        let mut queue = self.queue.borrow(cs).borrow_mut();
        let sleep = loop {
            let now = self.now(cs);
            let next = queue.next_expiration(now);
            if next > now {
                break (next - now).min(LONGEST_SLEEP);
            }
        };
        if let Some(systick) = self.systick.borrow(cs).borrow_mut().as_mut() {
            systick.set_reload(sleep as u32 * SYSTICK_COUNTS_PER_MICROSECOND);
            systick.clear_current();
            systick.enable_counter();
        }
    }
}

impl Driver for EmulatedDriver {
    fn now(&self) -> u64 {
        critical_section::with(|cs| self.now(cs))
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            let changed = self.queue.borrow(cs).borrow_mut().schedule_wake(at, waker);
            if changed {
                self.advance(cs);
            }
        });
    }
}

#[exception]
fn SysTick() {
    critical_section::with(|cs| DRIVER.advance(cs));
}
