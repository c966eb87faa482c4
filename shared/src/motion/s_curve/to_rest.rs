//! placeholder
use super::*;
/// tmp
pub fn to_rest(from: Sample, target: f64, bounds: &SignedBounds) -> Result<Segments, ProfileError> {
    time_optimal(from, Sample::at_rest(target), bounds)
}
