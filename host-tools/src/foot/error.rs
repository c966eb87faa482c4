//! Why a foot trajectory cannot be had.

use crate::notation::OutOfRange;
use canter_shared::motion::error::ProfileError;
use thiserror::Error;

/// Why a foot trajectory cannot be had.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FootError {
    /// A value that is outside of its range, or no number.
    #[error(transparent)]
    Value(#[from] OutOfRange),
    /// A curve that the motion library refuses.
    #[error(transparent)]
    Curve(#[from] ProfileError),
}
