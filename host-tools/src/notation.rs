//! How people write axes and quantities: `1-3,7`, `90deg`, `-0.5turn`, `1.5rad`; and what is said of one
//! that is out of its range.

mod axes;
mod parameter;
mod quantity;
mod range;

pub use axes::{AxisList, AxisListError, parse_axes};
pub use parameter::{ParameterTextError, parameter_named, parameter_raw, parameter_text};
pub use quantity::{QuantityError, angle, rate, seconds};
pub use range::{OutOfRange, Range};
