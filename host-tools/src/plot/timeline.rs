//! What is on when: one row for each thing, one bar for each time that it is on.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::View;
use super::draw::{Failure, MARGIN, Size, element, frame};
use super::style::{SCALE, colour, dressed, text_style};
use super::{Axis, PlotError};

const ROW: i32 = 34 * SCALE;

/// Below the rows, and above them.
const AROUND: i32 = 38 * SCALE + 2 * MARGIN;

/// Half the height of a bar, where rows are 1 apart.
const HALF: f64 = 0.3;

/// What is on when.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// What it shows.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The rows from the top: a name of at most 12 letters, and from when to when it is on.
    pub rows: Vec<(String, Vec<(f64, f64)>)>,
}

impl Timeline {
    /// As an element of a page.
    ///
    /// # Errors
    /// A number that is not finite.
    pub(super) fn element(&self) -> Result<String, PlotError> {
        let mut ends: Option<(f64, f64)> = None;
        for (name, spans) in &self.rows {
            for (index, (from, to)) in spans.iter().enumerate() {
                if !(from.is_finite() && to.is_finite()) {
                    return Err(PlotError::NotFinite {
                        chart: self.title.clone(),
                        name: name.clone(),
                        index,
                    });
                }
                let (least, most) = ends.unwrap_or((*from, *to));
                ends = Some((least.min(*from), most.max(*to)));
            }
        }
        let mut svg = String::new();
        self.draw_into(&mut svg, ends.unwrap_or((0.0, 1.0)))
            .map_err(|cause| PlotError::Draw {
                chart: self.title.clone(),
                cause: cause.to_string(),
            })?;
        Ok(element(&dressed(&svg), &self.title))
    }

    fn draw_into(&self, svg: &mut String, ends: (f64, f64)) -> Result<(), Failure> {
        let size = Size {
            height: AROUND + ROW * self.rows.len() as i32,
            left: 88 * SCALE,
            ..Size::ON_PAGE
        };
        let whole = (size.width.unsigned_abs(), size.height.unsigned_abs());
        let root = SVGBackend::with_string(svg, whole).into_drawing_area();
        let view = View {
            x: ends,
            y: (0.0, self.rows.len() as f64),
            levels: Vec::new(),
        };
        let nothing = Axis::new("", "");
        let numbers = [size.numbers, 0];
        let mut context = frame(&root, size, &view, numbers, [&self.x, &nothing])?;
        for (row, (name, spans)) in self.rows.iter().enumerate() {
            let middle = (self.rows.len() - row) as f64 - 0.5;
            let bars = spans.iter().map(|(from, to)| {
                let corners = [(*from, middle - HALF), (*to, middle + HALF)];
                Rectangle::new(corners, colour(0).filled())
            });
            context.draw_series(bars)?;
            let at = (size.left - MARGIN, MARGIN + ROW * row as i32 + ROW / 2);
            let style = text_style().pos(Pos::new(HPos::Right, VPos::Center));
            let name: String = name.chars().filter(|c| !c.is_control()).collect();
            root.draw(&Text::new(name, at, style))?;
        }
        root.present()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feet() -> Timeline {
        let spans = vec![(0.0, 1.0), (2.0, 3.0)];
        Timeline {
            title: "feet".to_owned(),
            x: Axis::new("time", "s"),
            rows: vec![("<left>".to_owned(), spans), ("right".to_owned(), vec![])],
        }
    }

    #[test]
    fn each_span_is_a_bar_and_each_row_has_its_name() {
        let svg = feet().element().expect("finite");
        assert_eq!(svg.matches("<rect").count(), 2);
        assert!(
            svg.contains("&lt;left&gt;") && svg.contains("right"),
            "{svg}"
        );
        assert!(svg.starts_with("<svg role=\"img\" aria-label=\"feet\" viewBox="));
    }

    #[test]
    fn a_span_without_an_end_is_an_error() {
        let mut endless = feet();
        endless.rows[0].1[1].1 = f64::INFINITY;
        let error = endless.element().expect_err("it has no end");
        assert!(matches!(error, PlotError::NotFinite { index: 1, .. }));
    }
}
