//! Charts as SVG, and reports as one HTML file that needs nothing else.
//!
//! | file | what it holds |
//! |---|---|
//! | `report` | the page: what matters at its head, sections of figures, a summary |
//! | `chart` | what a chart shows |
//! | `timeline` | what is on when |
//! | `draw` | a chart as SVG |
//! | `style` | colours, dashes and sizes |
//! | `legend` | the names under a chart |
//! | `stack` | charts under each other |
//! | `thin` | fewer points that look the same |

mod chart;
mod draw;
mod legend;
pub mod report;
mod stack;
mod style;
mod thin;
mod timeline;

pub use chart::{Axis, Chart, Level, Mark, Series};
pub use stack::stack;
pub use timeline::Timeline;

use thiserror::Error;

/// Why something cannot be plotted.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PlotError {
    /// A number that has no place in a picture.
    #[error("chart `{chart}`, `{name}`: number {index} is infinite or none at all")]
    NotFinite {
        /// The chart's title.
        chart: String,
        /// The name of the series or level.
        name: String,
        /// Which point of the series, from 0; 0 for a level.
        index: usize,
    },
    /// The drawing library gave up.
    #[error("chart `{chart}` cannot be drawn: {cause}")]
    Draw {
        /// The chart's title.
        chart: String,
        /// What it said.
        cause: String,
    },
}
