//! Lists of axes: `1-12`, `1,2,5`, `all`.

use canter_shared::wire::id::{AxisId, LAST_AXIS};

/// Which axes a verb is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AxisList {
    /// Every axis that is on the bus.
    All,
    /// These, in the order given, each once.
    These(Vec<AxisId>),
}

/// Why a text is no list of axes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AxisListError {
    /// A piece of it is neither a number nor a range.
    #[error("`{0}` is no axis: write numbers from 1 to {LAST_AXIS} such as `1,2,5` or `1-12`")]
    NotAnAxis(String),
    /// A range runs backwards.
    #[error("`{0}` runs backwards: write the smaller axis first")]
    Backwards(String),
    /// An axis stands twice.
    #[error("axis {0} is named twice")]
    Doubled(AxisId),
}

impl std::str::FromStr for AxisList {
    type Err = AxisListError;

    fn from_str(text: &str) -> Result<Self, AxisListError> {
        if text == "all" {
            Ok(Self::All)
        } else {
            parse_axes(text).map(Self::These)
        }
    }
}

/// The axes of a list such as `1-3,7`.
///
/// # Errors
/// The piece that is no axis, a range that runs backwards, an axis that stands twice.
pub fn parse_axes(text: &str) -> Result<Vec<AxisId>, AxisListError> {
    let axis = |piece: &str| {
        piece
            .parse()
            .ok()
            .and_then(AxisId::new)
            .ok_or_else(|| AxisListError::NotAnAxis(piece.to_owned()))
    };
    let mut axes = Vec::new();
    for piece in text.split(',') {
        let (first, last) = match piece.split_once('-') {
            Some((first, last)) => (axis(first)?, axis(last)?),
            None => (axis(piece)?, axis(piece)?),
        };
        if last < first {
            return Err(AxisListError::Backwards(piece.to_owned()));
        }
        for id in (first.get()..=last.get()).filter_map(AxisId::new) {
            if axes.contains(&id) {
                return Err(AxisListError::Doubled(id));
            }
            axes.push(id);
        }
    }
    Ok(axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists() {
        let ids = |text: &str| {
            parse_axes(text).map(|axes| axes.into_iter().map(AxisId::get).collect::<Vec<_>>())
        };
        assert_eq!(ids("1-3,7"), Ok(vec![1, 2, 3, 7]));
        assert_eq!("all".parse(), Ok(AxisList::All));
        for bad in ["", "0", "64", "a", "1-", "1,,2", "1 2", "-1", "1.0"] {
            assert!(
                matches!(ids(bad), Err(AxisListError::NotAnAxis(_))),
                "{bad}"
            );
        }
        assert!(matches!(ids("3-1"), Err(AxisListError::Backwards(_))));
        assert!(matches!(ids("1-3,2"), Err(AxisListError::Doubled(_))));
    }
}
