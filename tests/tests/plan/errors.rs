//! What is wrong is named, with what to do, and ends with the right exit code.

use super::canter_plan;

#[test]
fn wrong_usage_ends_with_2_and_names_the_flag() {
    for (arguments, words) in [
        ("--to 1 --duration 1", "--from"),
        ("--from nan --to 1 --duration 1", "--from"),
        ("--from 0 --to inf --duration 1", "--to"),
        ("--from 0 --to -inf --duration 1", "--to"),
        ("--from 0 --to 1e16 --duration 1", "--to"),
        ("--from 0 --to x --duration 1", "--to"),
        ("--from 0 --to 1 --vmax 0 --amax 1", "--vmax"),
        ("--from 0 --to 1 --vmax -2 --amax 1", "--vmax"),
        ("--from 0 --to 1 --vmax 1 --amax NaN", "--amax"),
        ("--from 0 --to 1 --vmax 1 --amax 1 --dmax 1e-16", "--dmax"),
        ("--from 0 --to 1 --vmax 1 --amax 1 --jmax inf", "--jmax"),
        ("--from 0 --to 1 --duration 0", "--duration"),
        ("--from 0 --to 1 --duration -1", "--duration"),
        ("--from 0 --to 1 --duration nan", "--duration"),
        ("--from 0 --to 1 --duration 1 --dt 0", "--dt"),
        ("--from 0 --to 1 --duration 1 --dt -inf", "--dt"),
        ("--from 0 --to 1 --duration 1 --t0 nan", "--t0"),
        ("--from 0 --to 1 --duration 1 --v0 nan", "--v0"),
        ("--from 0 --to 1 --duration 1 --a1 --v0", "--a1"),
        ("--from 0 --to 1 --duration 1 --p 1.9", "--p"),
        ("--from 0 --to 1 --duration 1 --p 5.1", "--p"),
        ("--from 0 --to 1 --duration 1 --profile sine", "--profile"),
        ("--from 0 --to 1 --duration 1 --format png", "--format"),
        ("--from 0 --to 1 --duration 1 --at f --dt 1", "--dt"),
        ("--from 0 --to 1 --duration 1 --exact --device", "--device"),
        // What the profile does not have, or what it needs.
        ("--from 0 --to 1", "--vmax"),
        ("--from 0 --to 1 --duration 1 --v0 1", "--v0"),
        ("--from 0 --to 1 --duration 1 --v1 -1", "--v1"),
        ("--from 0 --to 1 --duration 1 --a0 1", "--a0"),
        ("--profile trapezoid --from 0 --to 1 --vmax 1", "--amax"),
        ("--profile trapezoid --from 0 --to 1 --amax 1", "--vmax"),
        (
            "--profile trapezoid --from 0 --to 1 --vmax 1 --amax 1 --a0 1",
            "--a0",
        ),
        (
            "--profile trapezoid --from 0 --to 1 --duration 1 --v0 1",
            "--amax",
        ),
        (
            "--profile s-curve --from 0 --to 1 --vmax 1 --amax 1",
            "--jmax",
        ),
        (
            "--profile s-curve --from 0 --to 1 --amax 1 --jmax 1",
            "--vmax",
        ),
        (
            "--profile s-curve --from 0 --to 1 --vmax 1 --amax 1 --jmax 1 --a1 1",
            "--a1",
        ),
        (
            "--profile s-curve --from 0 --to 1 --vmax 1 --amax 1 --jmax 1 --v1 1 --duration 9",
            "--duration with --v1",
        ),
        (
            "--profile cubic --from 0 --to 1 --duration 1 --a1 1",
            "--a1",
        ),
        ("--profile septic --from 0 --to 1 --duration 1 --p 3", "--p"),
        ("--profile quintic --from 0 --to 1", "--duration"),
        ("--device --profile cubic --from 0 --to 1", "--device"),
        ("--device --from 0 --to 1 --v0 1", "--v0"),
        ("--device --from 0 --to 1 --p 3", "--p"),
        ("--device --from 0 --to 1 --dt 0.0015", "--dt"),
    ] {
        let refused = canter_plan(arguments, "");
        assert_eq!(refused.status.code(), Some(2), "{arguments}: {refused:#?}");
        assert!(refused.stderr.contains(words), "{arguments}: {refused:#?}");
        assert!(refused.stdout.is_empty(), "{arguments}: {refused:#?}");
    }
}

#[test]
fn what_cannot_be_ends_with_1_and_says_what_could() {
    let limits = "--from 0 --to 1 --vmax 10 --amax 2";
    for (arguments, words) in [
        (
            format!("--profile trapezoid {limits} --v0 5"),
            "--v0: start velocity 5 is too high to slow down within the range: start with at most 2,",
        ),
        (
            format!("--profile trapezoid {limits} --v1 5"),
            "--v1: stop velocity 5 cannot be reached within the range: stop with at most 2,",
        ),
        (
            format!("--profile trapezoid {limits} --v0 50"),
            "--v0: start velocity must be a number from -10 to 10",
        ),
        (
            format!("{limits} --duration 1"),
            "--duration: duration 1 s is too short for the limits; it must be at least 1.8",
        ),
        (
            format!("--profile trapezoid {limits} --duration 1"),
            "--duration: duration 1 s is too short for the limits; it must be at least 1.41",
        ),
        (
            format!("--profile s-curve {limits} --jmax 20 --duration 1"),
            "--duration: duration 1 s is too short for the limits; it must be at least 1.5",
        ),
        (
            format!("--profile quintic {limits} --duration 1"),
            "--duration: duration 1 s is too short for the limits; it must be at least 1.69",
        ),
        (
            "--profile quintic --from 0 --to 1 --a0 1 --vmax 1.5 --amax 9 --duration 30".to_owned(),
            "--vmax: a quintic of this duration reaches",
        ),
        (
            "--from 0 --to 1 --duration 1 --dt 1e-9".to_owned(),
            "--dt 0.000000001 s makes 1000000001 rows",
        ),
        (
            "--device --from 0 --to 7000".to_owned(),
            "--device: position in rad must be a number from -6433",
        ),
        (
            "--device --from 0 --to 6300".to_owned(),
            "is outside the travel",
        ),
        (
            "--device --from 0 --to 1 --vmax 20000".to_owned(),
            "--device: limits.velocity must be a number from 0.0001 to 10000 rad/s",
        ),
        (
            "--device --from 0 --to 1 --duration 0.01".to_owned(),
            "--duration: duration 0.01 s is too short",
        ),
        (
            "--from 0 --to 1 --duration 1 --at /no/such/times".to_owned(),
            "--at /no/such/times: No such file",
        ),
    ] {
        let refused = canter_plan(&arguments, "");
        assert_eq!(refused.status.code(), Some(1), "{arguments}: {refused:#?}");
        assert!(refused.stderr.contains(words), "{arguments}: {refused:#?}");
        assert!(refused.stdout.is_empty(), "{arguments}: {refused:#?}");
        // Said once, not with every layer that it came through.
        assert_eq!(refused.stderr.matches(words).count(), 1, "{refused:#?}");
    }
}

#[test]
fn a_bad_time_is_named_with_its_line() {
    for (times, words) in [
        ("0\nnan\n1\n", "line 2: `nan`"),
        ("0\n\n0.5\nsoon\n", "line 4: `soon`"),
        ("inf\n", "line 1: `inf`"),
        ("0,1\n", "line 1: `0,1`"),
    ] {
        let refused = canter_plan("--from 0 --to 1 --duration 1 --at -", times);
        assert_eq!(refused.status.code(), Some(1), "{times}: {refused:#?}");
        assert!(refused.stderr.contains(words), "{times}: {refused:#?}");
        assert!(refused.stdout.is_empty(), "{times}: {refused:#?}");
    }
}

#[test]
fn with_json_an_error_is_a_document() {
    let refused = canter_plan("--json --from 0 --to 1 --duration 1 --v0 1", "");
    assert_eq!(refused.status.code(), Some(2));
    let error = refused.json()["error"].as_str().map(str::to_owned);
    assert!(error.is_some_and(|error| error.starts_with("--v0 is not for profile beta")));
}
