//! The peak of something smooth that is seen at even places only.

/// The greatest value so far, with what may be between the places.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peak {
    before: Option<f64>,
    last: Option<f64>,
    most: f64,
}

impl Peak {
    /// Takes the next place's value. Between three places a parabola is higher than the greatest of
    /// them by at most an eighth of their second difference; twice that is taken, since a curve may
    /// bend more than its parabola.
    pub fn push(&mut self, value: f64) {
        self.most = self.most.max(value);
        if let (Some(first), Some(second)) = (self.before, self.last) {
            let bulge = (2.0 * second - first - value).max(0.0) / 4.0;
            self.most = self.most.max(first.max(second).max(value) + bulge);
        }
        (self.before, self.last) = (self.last, Some(value));
    }

    /// What comes next does not smoothly follow what was.
    pub fn restart(&mut self) {
        (self.before, self.last) = (None, None);
    }

    /// The greatest value.
    pub fn most(&self) -> f64 {
        self.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_between_places_is_covered() {
        for shift in 0..10 {
            let mut peak = Peak::default();
            for place in -5..=5 {
                let x = f64::from(place) / 5.0 + f64::from(shift) / 50.0;
                peak.push(x.cos());
            }
            assert!(peak.most() >= 1.0 && peak.most() < 1.01, "{}", peak.most());
        }
    }

    #[test]
    fn a_step_is_no_bulge_after_a_restart() {
        let mut peak = Peak::default();
        for value in [0.0, 0.0] {
            peak.push(value);
        }
        peak.restart();
        for value in [1.0, 1.0, 1.0] {
            peak.push(value);
        }
        assert_eq!(peak.most(), 1.0);
    }
}
