//! The robot from its right side, moving: a still picture that a small script sets in motion.

use super::Walk;
use super::posture::Posture;
use crate::gait::{LEG_NAMES, LEGS};
use crate::plot::report::Script;
use crate::walk::Phase;
use serde_json::json;
use std::fmt::Write as _;

/// What sets the picture in motion.
pub const SCRIPT: Script = Script {
    source: include_str!("scene.js"),
    sha256: "7OfSDiMP66+Gjjoicr9jpU/viEO+nLvuicWEe0s/Lfo=",
};

/// How it looks.
pub const STYLE: &str = include_str!("scene.css");

/// From picture to picture, in ticks.
const EVERY: usize = 10;

/// What is to be seen, in mm: to both sides of the body's middle, above the ground and below it.
const ASIDE: f64 = 420.0;
const ABOVE: f64 = 380.0;
const BELOW: f64 = 40.0;

/// From mark to mark on the ground, in mm.
const MARKS: f64 = 100.0;

/// How far the body reaches beyond its hips, in mm.
const OVERHANG: f64 = 30.0;

const fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::StandingUp => "standing up",
        Phase::Walking => "trotting",
        Phase::Settling => "last steps",
        Phase::SittingDown => "sitting down",
        Phase::Sitting => "sitting",
    }
}

/// A place as numbers of the picture: mm to the right, mm down from the ground.
fn place(posture: &Posture, [x, _, z]: [f64; 3]) -> [f64; 2] {
    // The very numbers that the script has; in whole ones there is no negative zero.
    [whole(x), -(whole(posture.height) + whole(z))].map(|tenths| tenths as f64 / 10.0)
}

/// m as whole tenths of a mm.
fn whole(value: f64) -> i64 {
    (value * 1e4).round() as i64
}

/// The picture with its controls and its data.
pub fn markup(walk: &Walk, postures: &[Posture]) -> String {
    // Those on the right are nearer to who looks from there, and are drawn last.
    let mut order: Vec<usize> = (0..LEGS).collect();
    let left = |leg: &usize| walk.quadruped.mounts[*leg].leg.place[1];
    order.sort_by(|a, b| left(b).total_cmp(&left(a)));
    let is_near = |leg: usize| walk.quadruped.mounts[leg].leg.place[1] < 0.0;
    let mut html = String::from("<div class=\"scene\" id=\"scene\">\n");
    // Writing to a string cannot fail.
    let _ = writeln!(
        html,
        "<svg viewBox=\"{} {} {} {}\" role=\"img\" aria-label=\"The robot from its right side\">",
        -ASIDE,
        -ABOVE,
        2.0 * ASIDE,
        ABOVE + BELOW
    );
    let still = still(postures);
    let posture = postures.get(still);
    put_ground(&mut html, posture);
    let Some(posture) = posture else {
        html.push_str("</svg>\n</div>\n");
        return html;
    };
    for (place, leg) in order.iter().enumerate() {
        if place == LEGS / 2 {
            put_body(&mut html, walk, posture);
        }
        let side = if is_near(*leg) { "near" } else { "far" };
        put_leg(&mut html, posture, *leg, side);
    }
    html.push_str("</svg>\n");
    html.push_str(CONTROLS);
    let _ = writeln!(
        html,
        "<script type=\"application/json\" id=\"scene-data\">{}</script>\n</div>",
        data(walk, postures, still / EVERY)
    );
    html
}

/// The moment to show where nothing moves: in the middle of the walk, with the front right foot high.
fn still(postures: &[Posture]) -> usize {
    let middle = postures.len() / 2;
    let around = middle.saturating_sub(200)..(middle + 200).min(postures.len());
    let lift = |index: &usize| postures[*index].height + postures[*index].feet[1][2];
    let highest = around.max_by(|a, b| lift(a).total_cmp(&lift(b)));
    highest.unwrap_or(0)
}

fn put_ground(html: &mut String, still: Option<&Posture>) {
    let _ = writeln!(
        html,
        "<rect class=\"earth\" x=\"{}\" y=\"0\" width=\"{}\" height=\"{BELOW}\"/>\n\
         <path class=\"ground\" d=\"M{} 0H{ASIDE}\"/>",
        -ASIDE,
        2.0 * ASIDE,
        -ASIDE
    );
    let way = still.map_or(0.0, |posture| 1e3 * posture.way);
    let mut marks = String::new();
    let count = (ASIDE / MARKS) as i32 + 2;
    for mark in -count..=count {
        let length = if mark % 5 == 0 { 24 } else { 14 };
        let _ = write!(marks, "M{} 0v{length}", f64::from(mark) * MARKS);
    }
    let shift = -(way % (5.0 * MARKS));
    let _ = writeln!(
        html,
        "<path class=\"marks\" d=\"{marks}\" transform=\"translate({shift:.1} 0)\"/>"
    );
    for leg in 0..LEGS {
        let _ = writeln!(html, "<polyline class=\"trail leg-{leg}\" points=\"\"/>");
    }
}

fn put_body(html: &mut String, walk: &Walk, posture: &Posture) {
    let hips = walk
        .quadruped
        .mounts
        .each_ref()
        .map(|mount| 1e3 * mount.leg.place[0]);
    let rear = hips.into_iter().fold(f64::INFINITY, f64::min) - OVERHANG;
    let front = hips.into_iter().fold(f64::NEG_INFINITY, f64::max) + OVERHANG;
    // A nose, to show where forward is.
    let _ = writeln!(
        html,
        "<g class=\"trunk\" transform=\"translate(0 {:.1})\">\
         <path d=\"M{rear} -22H{front}L{} 0L{front} 22H{rear}Z\"/></g>",
        -1e3 * posture.height,
        front + 34.0
    );
}

fn put_leg(html: &mut String, posture: &Posture, leg: usize, side: &str) {
    let points = posture.limbs[leg]
        .iter()
        .map(|joint| place(posture, *joint));
    let points: Vec<[f64; 2]> = points.collect();
    let line: Vec<String> = points
        .iter()
        .map(|[x, y]| format!("{x:.1},{y:.1}"))
        .collect();
    let _ = writeln!(
        html,
        "<g class=\"leg {side} leg-{leg}\"><title>{}</title><polyline points=\"{}\"/>",
        LEG_NAMES[leg],
        line.join(" ")
    );
    for [x, y] in points {
        let _ = writeln!(
            html,
            "<circle class=\"joint\" cx=\"{x}\" cy=\"{y}\" r=\"7\"/>"
        );
    }
    let [x, y] = place(posture, posture.feet[leg]);
    let on = if posture.grounded[leg] { " on" } else { "" };
    let _ = writeln!(
        html,
        "<circle class=\"foot{on}\" cx=\"{x}\" cy=\"{y}\" r=\"11\"/></g>"
    );
}

/// They work with the script only, which shows them.
const CONTROLS: &str = "<div class=\"controls\" hidden>\n\
    <button type=\"button\" id=\"scene-play\">Play</button>\n\
    <label>time <input type=\"range\" id=\"scene-time\" min=\"0\" max=\"1\" value=\"0\" step=\"1\">\
    </label>\n\
    <label>speed <select id=\"scene-speed\"><option value=\"0.1\">1/10\
    <option value=\"0.25\">1/4<option value=\"0.5\">1/2\
    <option value=\"1\" selected>real time</select></label>\n</div>\n\
    <p class=\"readout\" id=\"scene-readout\"></p>\n";

/// Every picture, in tenths of a mm.
fn data(walk: &Walk, postures: &[Posture], still: usize) -> serde_json::Value {
    let mut phases: Vec<&str> = Vec::new();
    let mut frames = Vec::new();
    for posture in postures.iter().step_by(EVERY) {
        let phase = name(posture.phase);
        if phases.last() != Some(&phase) {
            phases.push(phase);
        }
        let mut numbers = vec![
            phases.len() as i64 - 1,
            whole(posture.height),
            whole(posture.way),
        ];
        let feet = posture.grounded.iter().enumerate();
        numbers.push(feet.map(|(leg, on)| i64::from(*on) << leg).sum());
        for leg in 0..LEGS {
            let joints = posture.limbs[leg].iter().chain([&posture.feet[leg]]);
            numbers.extend(joints.flat_map(|joint| [whole(joint[0]), whole(joint[2])]));
        }
        frames.push(numbers);
    }
    let joints = postures
        .first()
        .map_or([0; LEGS], |posture| posture.limbs.each_ref().map(Vec::len));
    json!({
        "step": EVERY as f64 * 1e-3,
        "phases": phases,
        "legs": LEG_NAMES,
        "joints": joints,
        "marks": 5.0 * MARKS,
        "near": (0..LEGS).filter(|leg| walk.quadruped.mounts[*leg].leg.place[1] < 0.0).collect::<Vec<_>>(),
        "still": still,
        "frames": frames,
    })
}
