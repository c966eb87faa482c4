//! Many points of a beta move at once.

use canter_shared::motion::beta::exact::Profile;

/// Writes the position at each time, the same bits as [`Profile::position_at`] gives.
///
/// There are as many positions as times; of two lengths, the shorter counts. A processor that can
/// work on four numbers at once does.
pub fn positions(profile: &Profile, times: &[f64], positions: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: this processor has AVX2, as was just asked.
        return unsafe { four_at_once(profile, times, positions) };
    }
    one_by_one(profile, times, positions);
}

/// The same code, compiled for processors with AVX2; without fused products, so that the bits stay.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn four_at_once(profile: &Profile, times: &[f64], positions: &mut [f64]) {
    one_by_one(profile, times, positions);
}

#[inline(always)]
fn one_by_one(profile: &Profile, times: &[f64], positions: &mut [f64]) {
    // A copy, which no position can be written into: the compiler needs to know.
    let profile = *profile;
    for (position, time) in positions.iter_mut().zip(times) {
        // The compiler's own square root is correctly rounded, and can be taken of several at once.
        *position = profile.position_with(*time, f64::sqrt);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_at_once_are_the_same_bits_as_one() {
        let profile = Profile::lasting(-3.0, 10.0, 5.354).expect("a move");
        let mut times: Vec<f64> = (-50..1_200).map(|at| f64::from(at) * 0.005).collect();
        times.extend([
            0.0,
            5.354,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1e-300,
        ]);
        // Lengths that are no multiple of what is worked on at once, too.
        for length in [times.len(), times.len() - 1, 7, 1, 0] {
            let mut many = vec![f64::MAX; length];
            positions(&profile, &times[..length], &mut many);
            for (time, position) in times.iter().zip(&many) {
                let one = profile.position_at(*time);
                assert_eq!(position.to_bits(), one.to_bits(), "at {time}");
            }
        }
    }
}
