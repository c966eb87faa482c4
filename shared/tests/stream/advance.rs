//! A stream that makes its pieces as it goes says the same as one that is only asked.

use super::{START, knot, limits, period, sines};
use canter_shared::motion::stream::{LONGEST_GAP, Pushed, Stream};
use canter_shared::time::{Tick, Ticks};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn going_on_changes_no_setpoint(
        ticks in 1u8..=25,
        knots in prop::collection::vec((prop::bool::weighted(0.2), any::<bool>()), 30),
        ahead in 1u32..=9,
        (cut, later) in (0usize..60, 0u32..40),
    ) {
        let limits = limits();
        let at = |number: usize| sines(number as f64 * f64::from(ticks) / 1e3, 0.5);
        let asked = Stream::new(START, 0, at(0), period(ticks));
        let mut streams = [asked.clone(), asked];
        let mut now = START;
        let mut missing = 0;
        for (number, (lost, quintic)) in knots.into_iter().enumerate().skip(1) {
            // Longer gaps are refused.
            missing = if lost && missing + 1 < LONGEST_GAP { missing + 1 } else { 0 };
            if missing > 0 {
                continue;
            }
            let knot = knot(at(number), quintic);
            let [asked, advanced] = streams
                .each_mut()
                .map(|stream| stream.push(now, number as u8, &knot, &limits));
            prop_assert_eq!(asked, advanced);
            prop_assert!(matches!(asked, Ok(Pushed::Accepted { .. })), "{asked:?}");
            if number == cut {
                for stream in &mut streams {
                    stream.cut(now.after(Ticks(later)), &limits);
                }
                break;
            }
            // Up to the very tick of the last knot, where another is still in time.
            while now < streams[0].ends()
                && now.after(Ticks(ahead * u32::from(ticks))) <= streams[0].ends()
            {
                now = now.after(Ticks(1));
                let [asked, advanced] = &mut streams;
                advanced.advance(now);
                // Now, and wherever a plan asks.
                for later in [0, 1, u32::from(ticks), 5 * u32::from(ticks)] {
                    let tick = now.after(Ticks(later));
                    prop_assert_eq!(advanced.at(tick), asked.at(tick));
                }
            }
        }
        let [asked, advanced] = &mut streams;
        let rests = asked.rests();
        for tick in now.0..=rests.0 + 2 {
            advanced.advance(Tick(tick));
            prop_assert_eq!(advanced.at(Tick(tick)), asked.at(Tick(tick)));
        }
        prop_assert_eq!(advanced.rests(), rests);
        prop_assert!(!advanced.is_moving(rests));
    }
}
