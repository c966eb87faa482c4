use canter_shared::motion::bounds::Bounds;
use canter_shared::motion::s_curve::*;
use canter_shared::motion::trajectory::*;
#[test]
fn debug() {
    use proptest::prelude::*;
    use proptest::test_runner::*;
    let mut r = TestRunner::new(Config::with_cases(200_000));
    let res = r.run(
        &(
            0.01..30.0f64,
            0.0..3.0f64,
            0.0..3.0f64,
            0.0..3.5f64,
            -1.0..1.0f64,
            -1.0..1.0f64,
            -10.0..10.0f64,
            1.0..3.0f64,
        ),
        |(v, a, d, j, v0, a0, target, slower)| {
            let (a, d) = (10f64.powf(a) / 6.28, 10f64.powf(d) / 6.28);
            let jj = a.max(d) * 10f64.powf(j);
            let b = Bounds::new(v, a, d, jj).unwrap();
            let from = Sample {
                position: 0.0,
                velocity: v * v0 * 1.5,
                acceleration: a.min(d) * a0,
                jerk: 0.0,
            };
            let sb = if target > 0.0 {
                SignedBounds::forward(&b)
            } else {
                SignedBounds::backward(&b)
            }
            .unwrap();
            let q = to_rest(from, target, &sb).unwrap();
            for (name, s) in [
                ("rest", q.clone()),
                (
                    "lasting",
                    lasting(from, target, q.duration() * slower * 1.1, &sb).unwrap_or(q.clone()),
                ),
                ("stop", change_velocity(from, 0.0, &sb).unwrap()),
            ] {
                let last = s.segments().last().unwrap();
                let e = last.entry.after(last.duration);
                prop_assert!(
                    (e.velocity - s.end().velocity).abs() < 1e-6 * v,
                    "{name}: {e:?} {s:#?}"
                );
                prop_assert!((e.acceleration).abs() < 1e-5 * a, "{name}: {e:?} {s:#?}");
                prop_assert!(
                    (e.position - s.end().position).abs() < 1e-6 * (1.0 + target.abs()),
                    "{name}: {e:?} {s:#?}"
                );
                for w in s.segments().windows(2) {
                    let e = w[0].entry.after(w[0].duration);
                    prop_assert!(
                        (e.velocity - w[1].entry.velocity).abs() < 1e-9 * v,
                        "{name} {s:#?}"
                    );
                    prop_assert!(
                        (e.position - w[1].entry.position).abs() < 1e-8,
                        "{name} {s:#?}"
                    );
                    prop_assert!(
                        (e.acceleration - w[1].entry.acceleration).abs() < 1e-6 * a,
                        "{name} {s:#?}"
                    );
                }
                prop_assert!(s.segments().len() <= 9, "{name} {s:#?}");
            }
            Ok(())
        },
    );
    if let Err(e) = res {
        println!("{e}");
        panic!()
    }
}
