//! What is printed: rows, documents, pictures.

use super::{canter_plan, rows, rows_at, summary};
use canter::profile::{AskedLimits, Kind, Request, plan};
use canter_shared::motion::trajectory::Trajectory;

#[test]
fn rows_read_back_to_the_bits_of_the_library() {
    let limits = AskedLimits {
        velocity: Some(1.7),
        acceleration: Some(3.3),
        deceleration: Some(2.9),
        jerk: Some(41.0),
    };
    for kind in Kind::ALL {
        let request = Request {
            limits,
            ..Request::rest_to_rest(kind, 0.3, -2.1)
        };
        let curve = plan(&request).expect("a move").curve;
        let arguments = format!(
            "--profile {kind} --from 0.3 --to -2.1 --vmax 1.7 --amax 3.3 --dmax 2.9 --jmax 41"
        );
        let times = [0.1, -1.0, curve.duration(), 1.0 / 3.0, 0.0, 1e3, 1e-9];
        for row in rows_at(&arguments, times) {
            let want = curve.at(row[0]);
            let want = [want.position, want.velocity, want.acceleration, want.jerk];
            // Zero has no sign on paper.
            assert_eq!(row[1..], want, "{kind} at {}", row[0]);
        }
        let told = summary(&arguments);
        let peaks = curve.peaks();
        assert_eq!(told["profile"], kind.name());
        assert_eq!(told["duration"].as_f64(), Some(curve.duration()));
        assert_eq!(told["peak_velocity"].as_f64(), Some(peaks.velocity));
        assert_eq!(told["peak_acceleration"].as_f64(), Some(peaks.acceleration));
        let jerk = peaks.jerk.is_finite().then_some(peaks.jerk);
        assert_eq!(
            told["peak_jerk"].as_f64(),
            jerk,
            "null where it is infinite"
        );
    }
}

#[test]
fn rows_run_from_start_to_end() {
    let finished = canter_plan("--from 0 --to 1 --duration 1 --dt 0.3 --t0 -2", "").success();
    let times: Vec<f64> = rows(&finished).iter().map(|row| row[0]).collect();
    assert_eq!(times, [-2.0, -1.7, -1.4, -1.1, -1.0]);
    let usual = rows(&canter_plan("--from 3 --to -1 --vmax 2 --amax 1", "").success());
    assert_eq!(usual.len(), 1_001);
    assert_eq!(usual[0][1..4], [3.0, 0.0, 0.0]);
    assert_eq!(usual[1_000][1..4], [-1.0, 0.0, 0.0]);
    // A range of zero, and the tiniest and hugest.
    let none = rows(&canter_plan("--from 2 --to 2 --vmax 1 --amax 1", "").success());
    assert_eq!(none, [[0.0, 2.0, 0.0, 0.0, 0.0]]);
    for range in ["1e-12", "-1e12"] {
        for kind in Kind::ALL {
            let arguments = format!(
                "--profile {kind} --from 0 --to {range} --vmax 3 --amax 2 --jmax 100 --dt 1e11"
            );
            let last = *rows(&canter_plan(&arguments, "").success())
                .last()
                .expect("the end");
            assert_eq!(
                last[1],
                range.parse::<f64>().expect("a number"),
                "{arguments}"
            );
        }
    }
}

#[test]
fn before_the_start_and_after_the_end_it_coasts() {
    let arguments = "--profile trapezoid --from 1 --to 5 --v0 1 --v1 2 --vmax 3 --amax 4 --t0 10";
    let end = summary(arguments)["end"].as_f64().expect("seconds");
    let got = rows_at(arguments, [8.0, 10.0, end, end + 2.0]);
    assert_eq!(got[0][1..4], [-1.0, 1.0, 0.0]);
    assert_eq!(got[1][1..3], [1.0, 1.0]);
    assert_eq!(got[2][1..3], [5.0, 2.0]);
    assert_eq!(got[3][2..4], [2.0, 0.0]);
    assert!((got[3][1] - 9.0).abs() < 1e-12, "{:?}", got[3]);
}

#[test]
fn a_duration_alone_makes_thirds_and_sevenths() {
    let trapezoid = summary("--profile trapezoid --from 0 --to 6 --duration 3");
    assert_eq!(trapezoid["duration"], 3.0);
    let peak = trapezoid["peak_velocity"].as_f64().expect("a number");
    assert!((peak - 3.0).abs() < 1e-6, "{peak}");
    let s_curve = summary("--profile s-curve --from 8 --to 0 --duration 7");
    let pieces = s_curve["pieces"].as_array().expect("pieces");
    assert_eq!(pieces.len(), 7);
    for piece in pieces {
        let duration = piece["duration"].as_f64().expect("seconds");
        assert!((duration - 1.0).abs() < 1e-6, "{piece}");
    }
}

#[test]
fn a_longer_duration_is_kept_inside_the_limits() {
    for kind in Kind::ALL {
        let told = summary(&format!(
            "--profile {kind} --from 0 --to 2 --vmax 2 --amax 5 --jmax 60 --duration 4"
        ));
        let duration = told["duration"].as_f64().expect("seconds");
        assert!((duration - 4.0).abs() < 1e-12, "{kind}: {duration}");
        for (key, most) in [("peak_velocity", 2.0), ("peak_acceleration", 5.0)] {
            let peak = told[key].as_f64().expect("a number");
            assert!(peak <= most * (1.0 + 1e-9), "{kind}: {key} {peak}");
        }
    }
}

#[test]
fn backward_the_first_ramp_has_the_acceleration_limit_and_the_last_the_deceleration_limit() {
    for kind in ["trapezoid", "s-curve"] {
        for duration in ["", "--duration 3"] {
            let arguments = format!(
                "--profile {kind} --from 1 --to -1 --vmax 2 --amax 5 --dmax 3 --jmax 60 {duration}"
            );
            let rows = rows(&canter_plan(&arguments, "").success());
            let accelerations = || rows.iter().map(|row| row[3]);
            let least = accelerations().fold(f64::INFINITY, f64::min);
            let most = accelerations().fold(f64::NEG_INFINITY, f64::max);
            let is_near = |value: f64, want: f64| (value - want).abs() < 1e-9;
            assert!(
                is_near(least, -5.0) && is_near(most, 3.0),
                "{arguments}: {least}, {most}"
            );
        }
    }
}

#[test]
fn samples_are_in_the_document_where_they_are_asked_for() {
    let bare = summary("--from 0 --to 1 --duration 1");
    assert_eq!(bare.get("samples"), None);
    assert_eq!(bare["pieces"], serde_json::Value::Null);
    let told = summary("--from 0 --to 1 --duration 1 --dt 0.5");
    let samples = told["samples"].as_array().expect("a list");
    assert_eq!(samples.len(), 3);
    assert_eq!(samples[1]["t"], 0.5);
    let middle = samples[1]["position"].as_f64().expect("a number");
    assert!((middle - 0.5).abs() < 1e-15, "{middle}");
    // --json is the same as --format json.
    let arguments = "--json --from 0 --to 1 --duration 1 --dt 0.5";
    assert_eq!(canter_plan(arguments, "").success().json(), told);
}

#[test]
fn a_picture_stands_alone_and_has_the_limits_in_it() {
    for profile in ["beta", "trapezoid", "s-curve", "septic"] {
        let arguments =
            format!("--profile {profile} --from 0 --to 1 --vmax 1 --amax 4 --jmax 60 --format svg");
        let svg = canter_plan(&arguments, "").success().stdout;
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
        for text in ["position", "velocity", "acceleration", "jerk", "limit"] {
            assert!(svg.contains(text), "{profile}: no {text}");
        }
        assert!(svg.matches("stroke-dasharray").count() >= 4, "{profile}");
        let foreign = svg.replace("http://www.w3.org/2000/svg", "");
        assert!(!foreign.contains("http"), "{profile}");
    }
}
