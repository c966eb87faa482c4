//! What only the clock itself can be asked.

use super::*;

/// A crystal 100 ppm fast, an offset of an hour, receptions late by up to 5 ms.
#[test]
fn follows_a_crystal_through_jitter() {
    let mut clock = BusClock::new();
    let mut seed = 1u64;
    let mut worst = 0i64;
    for step in 0..3_000u64 {
        let bus = 3_600_000_000 + step * 20_000;
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        // One in four arrives at once.
        let late = if seed >> 62 == 0 {
            0
        } else {
            (seed >> 33) % 5_000
        };
        let local = |bus: u64| LocalTime(1_000 + (bus - 3_600_000_000) * 10_001 / 10_000);
        clock.synchronise(local(bus + late), step as u8, BusTime(bus), true);
        if step > 1_000 {
            let shown = clock.bus_time(local(bus));
            worst = worst.max((shown.0 as i64 - bus as i64).abs());
        }
    }
    assert!(worst <= 150, "off by {worst} us");
}

#[test]
fn never_steps_while_axes_move() {
    let mut clock = BusClock::new();
    clock.synchronise(LocalTime(0), 0, BusTime(1_000_000), true);
    let before = clock.bus_time(LocalTime(1_000_010));
    for wild in [0, 5_000_000, u64::MAX] {
        assert_eq!(
            clock.synchronise(LocalTime(1_000_010), 1, BusTime(wild), false),
            Discipline::Refused
        );
        assert_eq!(clock.bus_time(LocalTime(1_000_010)), before);
    }
}

#[test]
fn local_and_bus_time_are_inverse() {
    let mut clock = BusClock::new();
    clock.synchronise(LocalTime(7), 0, BusTime(1_000_000), true);
    clock.rate = 429_496; // 100 ppm
    for slew in [0, SLEW, -SLEW] {
        (clock.slew, clock.slew_time) = (slew, 10_000_000);
        for bus in (1_000_000..50_000_000).step_by(999_983) {
            let back = clock.bus_time(clock.local_time(BusTime(bus)));
            assert!(back.0.abs_diff(bus) <= 1, "{back:?} for {bus}");
        }
    }
}
