//! Counts the instructions of the bus clock: what each tick asks of it, and each SYNC.
#![no_std]
#![no_main]

use core::hint::black_box;

use canter_images::{Spread, count, finish};
use canter_shared::time::bus_clock::BusClock;
use canter_shared::time::{BusTime, LocalTime};
use cortex_m_rt::entry;

/// SYNCs: 40 s of them.
const SYNCS: u64 = 2_000;

/// Between two of them, in microseconds.
const PERIOD: u64 = 20_000;

#[entry]
fn main() -> ! {
    let mut clock = BusClock::new();
    let mut random = 1u64;
    let (mut syncs, mut shown, mut due) = (Spread::new(), Spread::new(), Spread::new());
    for index in 0..SYNCS {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        // A crystal of 100 ppm, and receptions late by up to 20 us, one in eight by 2 ms.
        let late = (random >> 33) % 21 + if random >> 61 == 0 { 2_000 } else { 0 };
        let sent = index * PERIOD;
        let received = LocalTime(1_000 + sent + sent / 10_000 + late);
        // Half of the time something moves.
        let rests = index % 400 < 200;
        let sent = BusTime(3_600_000_000 + sent);
        syncs.add(count(|| {
            black_box(&mut clock).synchronise(black_box(received), index as u8, sent, rests)
        }));
        for tick in 1..20 {
            let now = black_box(LocalTime(received.0 + tick * 1_000));
            shown.add(count(|| black_box(&clock).bus_time(now)));
            let tick = black_box(BusTime(sent.0 + tick * 1_000));
            due.add(count(|| black_box(&clock).local_time(tick)));
        }
    }
    syncs.report("clock.synchronise");
    shown.report("clock.bus_time");
    due.report("clock.local_time");
    finish()
}
