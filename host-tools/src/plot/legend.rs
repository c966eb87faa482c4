//! The names under a chart, in columns of one width.

use plotters::prelude::*;

use super::draw::{Failure, Surface};
use super::style::{LETTER, LEVEL, LINE_WIDTH, RADIUS, SCALE, TEXT_SIZE, colour, text_style};
use super::{Chart, Level, Mark};

const ROW: i32 = 20 * SCALE;
const SWATCH: i32 = 22 * SCALE;
const GAP: i32 = 6 * SCALE;
const DOT: i32 = RADIUS + 1;

enum Swatch {
    Line(RGBColor),
    Dots(RGBColor),
    Block(RGBColor),
    Dashes,
    Nothing,
}

/// Series in columns of one width, then each level on a row of its own.
pub(super) struct Legend {
    series: Vec<(Swatch, String)>,
    levels: Vec<(Swatch, String)>,
    columns: i32,
    column: i32,
    left: i32,
}

impl Legend {
    pub(super) fn new(chart: &Chart, shown: &[bool], left: i32, right: i32) -> Self {
        let series = series(chart);
        let letters = series.iter().map(|(_, name)| name.chars().count()).max();
        let text = letters.unwrap_or(0) as f64 * LETTER * f64::from(TEXT_SIZE);
        let column = (SWATCH + 3 * GAP + text as i32).min(right - left);
        Self {
            series,
            levels: levels(chart, shown),
            columns: ((right - left) / column).max(1),
            column,
            left,
        }
    }

    fn rows_of_series(&self) -> i32 {
        (self.series.len() as i32 + self.columns - 1) / self.columns
    }

    pub(super) fn height(&self) -> u32 {
        ((self.rows_of_series() + self.levels.len() as i32) * ROW).unsigned_abs()
    }

    pub(super) fn draw(&self, surface: &Surface<'_>) -> Result<(), Failure> {
        for (index, entry) in self.series.iter().enumerate() {
            let (row, column) = (index as i32 / self.columns, index as i32 % self.columns);
            draw_entry(
                surface,
                entry,
                (self.left + column * self.column, row * ROW),
            )?;
        }
        for (index, entry) in self.levels.iter().enumerate() {
            let row = self.rows_of_series() + index as i32;
            draw_entry(surface, entry, (self.left, row * ROW))?;
        }
        Ok(())
    }
}

fn series(chart: &Chart) -> Vec<(Swatch, String)> {
    let mut entries = Vec::new();
    for series in &chart.series {
        let look = chart.look_of(series);
        if look == entries.len() {
            let swatch = match series.mark {
                Mark::Line => Swatch::Line(colour(look)),
                Mark::Dots => Swatch::Dots(colour(look)),
                Mark::Bar => Swatch::Block(colour(look)),
            };
            entries.push((swatch, series.name.clone()));
        }
    }
    // A single one is what the axis says.
    if entries.len() < 2 {
        entries.clear();
    }
    entries
}

fn levels(chart: &Chart, shown: &[bool]) -> Vec<(Swatch, String)> {
    let mut entries = Vec::new();
    for (index, level) in chart.levels.iter().enumerate() {
        let same = |other: &Level| other.name == level.name;
        if chart.levels.iter().position(same) != Some(index) {
            continue;
        }
        let mut together = chart.levels.iter().zip(shown);
        entries.push(if together.any(|(other, shown)| same(other) && *shown) {
            (Swatch::Dashes, level.name.clone())
        } else {
            (
                Swatch::Nothing,
                format!("{}: outside the picture", level.name),
            )
        });
    }
    entries
}

fn draw_entry(
    surface: &Surface<'_>,
    (swatch, name): &(Swatch, String),
    (x, top): (i32, i32),
) -> Result<(), Failure> {
    let y = top + ROW / 2;
    let line = |colour: RGBColor| {
        PathElement::new(
            [(x, y), (x + SWATCH, y)],
            colour.stroke_width(LINE_WIDTH + LINE_WIDTH / 2),
        )
    };
    match swatch {
        Swatch::Line(colour) => surface.draw(&line(*colour))?,
        Swatch::Dashes => surface.draw(&line(LEVEL))?,
        Swatch::Dots(colour) => {
            for place in [x + DOT, x + SWATCH / 2, x + SWATCH - DOT] {
                surface.draw(&Circle::new((place, y), DOT, colour.filled()))?;
            }
        }
        Swatch::Block(colour) => {
            let corners = [(x + GAP, y - GAP), (x + SWATCH, y + GAP)];
            surface.draw(&Rectangle::new(corners, colour.filled()))?;
        }
        Swatch::Nothing => {}
    }
    let text_at = match swatch {
        Swatch::Nothing => x,
        _ => x + SWATCH + GAP,
    };
    // The letters' middle at the row's.
    surface.draw(&Text::new(
        name.clone(),
        (text_at, y - TEXT_SIZE / 2),
        text_style(),
    ))
}
