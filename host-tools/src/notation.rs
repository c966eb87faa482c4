//! How people write axes and quantities: `1-3,7`, `90deg`, `-0.5turn`, `1.5rad`.

mod axes;
mod quantity;

pub use axes::{AxisList, AxisListError, parse_axes};
pub use quantity::{QuantityError, angle, rate, seconds};
