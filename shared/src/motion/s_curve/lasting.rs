//! placeholder
use super::*;
/// tmp
pub fn lasting(
    from: Sample,
    target: f64,
    duration: f64,
    bounds: &SignedBounds,
) -> Result<Segments, ProfileError> {
    let _ = duration;
    time_optimal(from, Sample::at_rest(target), bounds)
}
