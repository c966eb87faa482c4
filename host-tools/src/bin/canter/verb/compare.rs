//! `canter compare`: the profiles side by side for one move.

use crate::arguments::{Compare, CompareFormat, ShaperArgument};
use crate::context::{Context, print_all};
use anyhow::Result;
use canter::plot::{Axis, Chart, Series};
use canter::profile::compare::{Comparison, Question, Row, compare};
use canter::profile::picture::{OWN_UNITS, Picture, evenly, samples};
use canter::profile::table::number;
use canter::profile::vibration::{MOST_CYCLES, Resonance};
use canter_shared::motion::shaping::{Shaped, ShaperKind};
use serde_json::{Value, json};

pub fn run(context: &Context, arguments: &Compare) -> Result<()> {
    let question = question(arguments);
    let comparison = compare(&question)?;
    let format = if context.json {
        CompareFormat::Json
    } else {
        arguments.format
    };
    let lines = match format {
        CompareFormat::Text => text(&question, &comparison),
        CompareFormat::Csv => csv(&question, &comparison),
        CompareFormat::Json => vec![document(&question, &comparison).to_string()],
        CompareFormat::Svg => vec![picture(arguments, &question, &comparison)?],
    };
    print_all(lines.into_iter())?;
    if format != CompareFormat::Json {
        for note in &comparison.notes {
            eprintln!("note: {note}");
        }
    }
    if matches!(format, CompareFormat::Csv | CompareFormat::Svg) {
        eprintln!("{}", comparison.advice);
    }
    Ok(())
}

fn question(arguments: &Compare) -> Question {
    let shapers = match arguments.shaper {
        None | Some(ShaperArgument::All) => vec![ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Ei],
        Some(ShaperArgument::Zv) => vec![ShaperKind::Zv],
        Some(ShaperArgument::Zvd) => vec![ShaperKind::Zvd],
        Some(ShaperArgument::Ei) => vec![ShaperKind::Ei],
        Some(ShaperArgument::None) => Vec::new(),
    };
    Question {
        from: arguments.way.from,
        to: arguments.way.to,
        limits: arguments.way.limits(),
        resonance: arguments.mass_on_a_spring(),
        shapers,
    }
}

/// What is left swinging, as a share of the way.
fn share(question: &Question, row: &Row) -> Option<f64> {
    let way = (question.to - question.from).abs();
    row.residual
        .map(|residual| if way > 0.0 { residual / way } else { 0.0 })
}

/// A table and a sentence.
fn text(question: &Question, comparison: &Comparison) -> Vec<String> {
    let mut head = vec![
        "profile",
        "duration s",
        "ratio",
        "velocity",
        "acceleration",
        "jerk",
    ];
    if question.resonance.is_some() {
        head.extend(["swings", "% of way"]);
    }
    let mut table = vec![head.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    for row in &comparison.rows {
        let mut cells = vec![
            row.name(),
            short(row.duration),
            format!("{:.3}", row.ratio),
            short(row.peaks.velocity),
            short(row.peaks.acceleration),
            if row.steps() {
                "steps".to_owned()
            } else {
                short(row.peaks.jerk)
            },
        ];
        if let (Some(residual), Some(share)) = (row.residual, share(question, row)) {
            cells.push(short(residual));
            cells.push(format!("{:.3}", share * 100.0));
        }
        table.push(cells);
    }
    let width = |column: usize| {
        let cells = table.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..8).map(width).collect();
    let mut lines: Vec<String> = table
        .iter()
        .map(|row| {
            let cells = row.iter().zip(&widths).enumerate();
            let padded = cells.map(|(column, (cell, width))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            });
            padded.collect::<Vec<_>>().join("  ")
        })
        .collect();
    lines.push(String::new());
    lines.push(comparison.advice.clone());
    lines
}

/// Six digits, for reading.
fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e7).contains(&size) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - size.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

fn csv(question: &Question, comparison: &Comparison) -> Vec<String> {
    let mut head =
        "profile,shaper,duration,ratio,peak_velocity,peak_acceleration,peak_jerk".to_owned();
    if question.resonance.is_some() {
        head.push_str(",residual,residual_share");
    }
    let mut lines = vec![head];
    for row in &comparison.rows {
        let shaper = row.shaping.map(|shaping| shaping.kind().to_string());
        let mut cells = vec![row.kind.to_string(), shaper.unwrap_or_default()];
        let values = [
            row.duration,
            row.ratio,
            row.peaks.velocity,
            row.peaks.acceleration,
            row.peaks.jerk,
        ];
        cells.extend(values.map(number));
        cells.extend(row.residual.map(number));
        cells.extend(share(question, row).map(number));
        lines.push(cells.join(","));
    }
    lines
}

fn document(question: &Question, comparison: &Comparison) -> Value {
    let entry = |row: &Row| {
        json!({
            "profile": row.kind.name(),
            "shaper": row.shaping.map(|shaping| shaping.kind().to_string()),
            "duration": row.duration,
            "ratio": row.ratio,
            "peak_velocity": row.peaks.velocity,
            "peak_acceleration": row.peaks.acceleration,
            // Null where the acceleration steps.
            "peak_jerk": row.peaks.jerk,
            "residual": row.residual,
            "residual_share": share(question, row),
        })
    };
    let limits = &question.limits;
    let resonance = question
        .resonance
        .map(|resonance| json!({ "frequency": resonance.frequency, "damping": resonance.damping }));
    json!({
        "from": question.from,
        "to": question.to,
        "limits": {
            "velocity": limits.velocity,
            "acceleration": limits.acceleration,
            "deceleration": limits.meant_deceleration(),
            "jerk": limits.jerk,
        },
        "resonance": resonance,
        "profiles": comparison.rows.iter().map(entry).collect::<Vec<_>>(),
        "choice": comparison.rows.get(comparison.choice).map(entry),
        "advice": comparison.advice,
        "notes": comparison.notes,
    })
}

/// The bare profiles over each other, with those behind a shaper that was named, and the chosen one.
fn picture(arguments: &Compare, question: &Question, comparison: &Comparison) -> Result<String> {
    let named = !matches!(arguments.shaper, None | Some(ShaperArgument::All));
    let rows: Vec<&Row> = comparison
        .rows
        .iter()
        .enumerate()
        .filter(|(at, row)| row.shaping.is_none() || named || *at == comparison.choice)
        .map(|(_, row)| row)
        .collect();
    let mut picture = Picture::new("comparison", OWN_UNITS);
    for row in &rows {
        let drawn = match &row.shaping {
            Some(shaping) => evenly(&Shaped::in_ticks(row.curve.clone(), shaping), 0.0),
            None => samples(&row.curve, 0.0),
        };
        picture.add(&row.name(), &drawn);
    }
    picture.limit(&question.limits, question.to >= question.from);
    if rows.iter().any(|row| row.steps()) {
        picture.say_that_it_steps();
    }
    if let Some(resonance) = &question.resonance
        && let Some(chart) = over_frequency(question, resonance, &rows)?
    {
        picture.put_below(chart);
    }
    Ok(picture.svg()?)
}

/// What each row leaves swinging, over the frequency; `None` where that would take too long.
fn over_frequency(
    question: &Question,
    resonance: &Resonance,
    rows: &[&Row],
) -> Result<Option<Chart>> {
    /// Steps of the frequency, up to this many times the one that was named.
    const STEPS: u32 = 300;
    const SPAN: f64 = 3.0;
    /// Less than this is the floor of the picture, in dB.
    const FLOOR: f64 = -120.0;

    let way = (question.to - question.from).abs();
    let longest = rows.iter().map(|row| row.duration).fold(0.0, f64::max);
    let cycles = f64::from(STEPS) * SPAN * resonance.frequency * longest;
    if way == 0.0 || cycles > MOST_CYCLES {
        return Ok(None);
    }
    let mut chart = Chart::new(
        "comparison: what is left swinging, over the frequency of the mass on its spring",
        Axis::new("frequency", "Hz"),
        Axis::new("residual", "dB of the way"),
    );
    for row in rows {
        let mut points = Vec::new();
        for step in 1..=STEPS {
            let frequency = SPAN * resonance.frequency * f64::from(step) / f64::from(STEPS);
            let other = Resonance {
                frequency,
                ..*resonance
            };
            let level = 20.0 * (row.residual_of(&other)? / way).log10();
            points.push((frequency, level.max(FLOOR)));
        }
        chart.series.push(Series::line(row.name(), points));
    }
    Ok(Some(chart))
}
