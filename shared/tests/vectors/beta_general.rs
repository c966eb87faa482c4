//! The beta curve of any p against 50 digits, against the product's p = 5/2, and what is said of it.

use super::csv::rows;
use canter_shared::motion::beta::general::{Curve, Profile};
use canter_shared::motion::beta::{PEAK_ACCELERATION, PEAK_JERK, PEAK_VELOCITY, exact};
use canter_shared::motion::trajectory::Trajectory;

#[test]
fn any_p() {
    for row in rows("beta_general.csv") {
        let [p, u] = row.numbers(["p", "u"]);
        let profile = Profile::lasting(p, 0.0, 1.0, 1.0).expect("valid");
        let (at, peaks) = (profile.at(u), profile.peaks());
        for (got, column, largest) in [
            (at.position, "position", 1.0),
            (at.velocity, "velocity", peaks.velocity),
            (at.acceleration, "acceleration", peaks.acceleration),
            (at.jerk, "jerk", peaks.jerk),
        ] {
            let want = row.number(column);
            assert!(
                (got - want).abs() <= 5e-15 * largest,
                "{row:?} {column}: {got}"
            );
        }
        // Near the start the relative error is as low.
        let want = row.number("position");
        assert!(
            (at.position - want).abs() <= 1e-14 * want,
            "{row:?}: {}",
            at.position
        );
    }
}

#[test]
fn five_halves_is_the_product() {
    let (from, to, duration) = (-3.0, 10.0, 1.7);
    let general = Profile::lasting(2.5, from, to, duration).expect("valid");
    let product = exact::Profile::lasting(from, to, duration).expect("valid");
    for step in -5..=105 {
        let time = f64::from(step) * 0.01 * duration;
        let (general, product) = (general.at(time), product.at(time));
        let near = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-14 * 13.0 * scale;
        assert!(near(general.position, product.position, 1.0), "{time}");
        assert!(near(general.velocity, product.velocity, 2.0), "{time}");
        assert!(
            near(general.acceleration, product.acceleration, 6.0),
            "{time}"
        );
        assert!(near(general.jerk, product.jerk, 40.0), "{time}");
    }
    let peaks = Curve::new(2.5).expect("valid").peaks();
    for (got, want) in [
        (peaks.velocity, PEAK_VELOCITY),
        (peaks.acceleration, PEAK_ACCELERATION),
        (peaks.jerk, PEAK_JERK),
    ] {
        assert!((got - want).abs() <= 1e-14 * want, "{got}, not {want}");
    }
}

fn peak_jerk(p: f64) -> f64 {
    Curve::new(p).expect("valid").peaks().jerk
}

/// What the curve's authors say: of all p, 5/2 has the least peak jerk.
#[test]
fn five_halves_has_the_least_peak_jerk() {
    let best = peak_jerk(2.5);
    for step in 0..=30_000 {
        let p = 2.0 + f64::from(step) * 1e-4;
        if p == 2.5 {
            continue;
        }
        assert!(peak_jerk(p) > best, "{p}");
    }
    // A search that knows nothing of 5/2 finds it.
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (2.0, 5.0);
    while high - low > 1e-12 {
        let step = golden * (high - low);
        if peak_jerk(high - step) < peak_jerk(low + step) {
            high = low + step;
        } else {
            low = high - step;
        }
    }
    assert!((low - 2.5).abs() < 1e-11, "{low}");
}

/// The peaks in closed form are those of the samples.
#[test]
fn closed_peaks_are_what_samples_show() {
    for step in 0..=30 {
        let p = 2.0 + f64::from(step) * 0.1;
        let profile = Profile::lasting(p, 0.0, 1.0, 1.0).expect("valid");
        let peaks = profile.peaks();
        let mut seen = [0.0f64; 3];
        for step in 0..10_000 {
            let at = profile.at(f64::from(step) * 1e-4);
            for (seen, value) in seen.iter_mut().zip([at.velocity, at.acceleration, at.jerk]) {
                *seen = seen.max(value.abs());
            }
        }
        for (seen, peak) in seen
            .into_iter()
            .zip([peaks.velocity, peaks.acceleration, peaks.jerk])
        {
            // The samples fall short of a peak by its curvature over half a step squared.
            assert!(
                seen <= peak * (1.0 + 1e-13) && seen >= peak * (1.0 - 1e-5),
                "{p}: {seen} {peak}"
            );
        }
    }
}
