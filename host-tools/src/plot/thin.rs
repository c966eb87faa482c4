//! Fewer points that look the same.

/// At most about `most` of `points`, in their order: of each stretch its lowest and its highest,
/// so that no peak is lost, and the ends. In the middle of a flat piece none are needed.
pub(super) fn thin(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut keep = |point: (f64, f64)| {
        if let [.., before, last] = kept.as_mut_slice()
            && before.1 == last.1
            && last.1 == point.1
            && (before.0..=point.0).contains(&last.0)
        {
            *last = point;
        } else {
            kept.push(point);
        }
    };
    let stretch = if points.len() <= most {
        1
    } else {
        (2 * points.len()).div_ceil(most.max(2))
    };
    if let Some(first) = points.first() {
        keep(*first);
    }
    for part in points.chunks(stretch) {
        let by_height =
            |a: &(usize, &(f64, f64)), b: &(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        let lowest = part.iter().enumerate().min_by(by_height);
        let highest = part.iter().enumerate().max_by(by_height);
        if let (Some(a), Some(b)) = (lowest, highest) {
            keep(*if a.0 <= b.0 { a.1 } else { b.1 });
            if a.0 != b.0 {
                keep(*if a.0 <= b.0 { b.1 } else { a.1 });
            }
        }
    }
    if let Some(last) = points.last() {
        keep(*last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_and_ends_stay() {
        let mut points: Vec<(f64, f64)> = (0..100_000)
            .map(|at| (f64::from(at), (f64::from(at) * 1e-3).sin()))
            .collect();
        points[54_321].1 = 7.0;
        points[54_322].1 = -7.0;
        let fewer = thin(&points, 1_000);
        assert!(fewer.len() <= 1_004, "{}", fewer.len());
        assert!(fewer.contains(&points[54_321]) && fewer.contains(&points[54_322]));
        assert_eq!(fewer.first(), points.first());
        assert_eq!(fewer.last(), points.last());
        assert!(fewer.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn what_is_few_stays_and_what_is_flat_shrinks() {
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, 1.0)];
        let mut without_doubles = thin(&points, 10);
        without_doubles.dedup();
        assert_eq!(without_doubles, points);
        let flat: Vec<(f64, f64)> = (0..1_000).map(|at| (f64::from(at), 3.0)).collect();
        assert_eq!(thin(&flat, 100), [(0.0, 3.0), (999.0, 3.0)]);
        assert_eq!(thin(&[], 100), []);
    }
}
