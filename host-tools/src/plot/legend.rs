//! The names under a chart, in columns of one width.

use plotters::prelude::*;

use super::draw::{INK, LEVEL, LINE_WIDTH, SCALE, Surface, TEXT_SIZE, colour, text_style};
use super::{Chart, Mark};

const ROW: i32 = 20 * SCALE;
const SWATCH: i32 = 22 * SCALE;
const GAP: i32 = 6 * SCALE;

/// Width of a letter of ordinary text as a share of its size; what is too wide for its column
/// runs into the next, so this is rather too much than too little.
const LETTER: f64 = 0.56;

enum Swatch {
    Line(RGBColor),
    Block(RGBColor),
    Dashes,
    Nothing,
}

pub(super) struct Legend {
    entries: Vec<(Swatch, String)>,
    columns: i32,
    column: i32,
    left: i32,
}

impl Legend {
    pub(super) fn new(chart: &Chart, shown: &[bool], left: i32, width: i32) -> Self {
        let mut entries = Vec::new();
        // A single series is what the axis says.
        if chart.series.len() > 1 {
            for (index, series) in chart.series.iter().enumerate() {
                let swatch = match series.mark {
                    Mark::Line => Swatch::Line(colour(index)),
                    Mark::Bar => Swatch::Block(colour(index)),
                };
                entries.push((swatch, series.name.clone()));
            }
        }
        for (index, level) in chart.levels.iter().enumerate() {
            let same = |other: &super::Level| other.name == level.name;
            if chart.levels.iter().position(same) != Some(index) {
                continue;
            }
            let mut together = chart.levels.iter().zip(shown);
            entries.push(if together.any(|(other, shown)| same(other) && *shown) {
                (Swatch::Dashes, level.name.clone())
            } else {
                (Swatch::Nothing, format!("{}: outside the picture", level.name))
            });
        }
        let letters = entries
            .iter()
            .map(|(_, name)| name.chars().count())
            .max()
            .unwrap_or(0);
        let text = (letters as f64 * LETTER * f64::from(TEXT_SIZE)) as i32;
        let column = (SWATCH + GAP + text + 2 * GAP).min(width - left);
        Self {
            columns: ((width - left) / column.max(1)).max(1),
            column,
            entries,
            left,
        }
    }

    pub(super) fn height(&self) -> u32 {
        let rows = (self.entries.len() as i32 + self.columns - 1) / self.columns;
        (rows * ROW).unsigned_abs()
    }

    pub(super) fn draw(&self, surface: &Surface<'_>) -> Result<(), super::draw::Failure> {
        for (index, (swatch, name)) in self.entries.iter().enumerate() {
            let (row, column) = (index as i32 / self.columns, index as i32 % self.columns);
            let x = self.left + column * self.column;
            let y = row * ROW + ROW / 2;
            let ends = |colour: RGBColor| {
                PathElement::new([(x, y), (x + SWATCH, y)], colour.stroke_width(LINE_WIDTH * 2))
            };
            let text_at = match swatch {
                Swatch::Nothing => x,
                _ => x + SWATCH + GAP,
            };
            match swatch {
                Swatch::Line(colour) => surface.draw(&ends(*colour))?,
                Swatch::Dashes => surface.draw(&ends(LEVEL))?,
                Swatch::Block(colour) => {
                    let corners = [(x + GAP, y - GAP), (x + SWATCH, y + GAP)];
                    surface.draw(&Rectangle::new(corners, colour.filled()))?;
                }
                Swatch::Nothing => {}
            }
            // Half the height of the letters below the middle of the row.
            let baseline = y - TEXT_SIZE / 2;
            surface.draw(&Text::new(name.clone(), (text_at, baseline), text_style(INK)))?;
        }
        Ok(())
    }
}
