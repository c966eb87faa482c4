//! What was measured, in words.

use super::super::Measurements;

/// What was measured, in words: what, how much, and what to compare it with.
pub fn rows(measurements: &Measurements) -> Vec<(String, String, String)> {
    let mut rows = Vec::new();
    let mut row = |what: String, value: String, note: &str| {
        rows.push((what, value, note.to_owned()));
    };
    for measured in &measurements.moves {
        let title = measured.title;
        row(
            format!("{title}: duration"),
            format!("{:.3} s", measured.duration),
            if measured.together {
                "all axes arrive in one tick"
            } else {
                "the axes do not arrive in one tick"
            },
        );
        row(
            format!("{title}: start skew"),
            format!("{:.1} \u{b5}s", measured.skew()),
            "true time, over all axes",
        );
        if let Some(distance) = measured.distance {
            row(
                format!("{title}: distance from the curve"),
                format!("{distance:.1e} rad"),
                "at most 2e-6 rad at any tick",
            );
        }
    }
    if let Some(walk) = &measurements.walk {
        let percent = |part: f64| format!("{:.2} % of the limit", 100.0 * part);
        row(
            String::from("walk: duration, way, turn"),
            format!(
                "{:.2} s, {:.2} m, {:.0} deg",
                walk.duration,
                walk.distance,
                walk.turned.to_degrees()
            ),
            "up, trot with a turn, last steps, down",
        );
        row(
            String::from("walk: start skew"),
            format!("{:.1} \u{b5}s", walk.skew()),
            "true time, over all axes",
        );
        row(
            String::from("walk: distance from the ideal curves"),
            format!("{:.1e} rad", walk.deviation),
            "at most 5e-5 rad at any tick of any joint",
        );
        row(
            String::from("walk: shafts off their setpoints"),
            format!("{:.1e} rad", walk.following),
            "inertia, friction, encoder",
        );
        row(
            String::from("walk: peak velocity"),
            percent(walk.shares[0]),
            "never above 100 %",
        );
        row(
            String::from("walk: peak acceleration"),
            percent(walk.shares[1]),
            "never above 100 %",
        );
        row(
            String::from("walk: bus load in the trot"),
            format!("{:.1} %", 100.0 * walk.load),
            "at most 40 % of 1 Mbit/s",
        );
        row(
            String::from("walk: bus load, busiest 0.1 s"),
            format!("{:.1} %", 100.0 * walk.peak_load),
            "",
        );
        row(
            String::from("walk: knots lost"),
            walk.missing.to_string(),
            "",
        );
    }
    row(
        String::from("peak velocity"),
        format!("{:.2} % of the limit", 100.0 * measurements.velocity),
        "never above 100 %",
    );
    row(
        String::from("peak acceleration"),
        format!("{:.2} % of the limit", 100.0 * measurements.acceleration),
        "never above 100 %",
    );
    row(
        String::from("shafts off their setpoints"),
        format!("{:.1e} rad", measurements.following),
        "whenever they are enabled",
    );
    row(
        String::from("stop in mid-move: time to rest"),
        format!("{:.3} s", measurements.stopping),
        "inside the limits, jerk too",
    );
    row(
        String::from("bus load"),
        format!("{:.1} %", 100.0 * measurements.load),
        "over everything, the scan and the rests too",
    );
    row(
        String::from("frames, setpoints"),
        format!("{}, {}", measurements.frames, measurements.setpoints),
        "",
    );
    rows
}
