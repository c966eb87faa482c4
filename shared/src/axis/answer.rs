//! What a command is answered.

use crate::motion::PlanError;
use crate::wire::id::Function;
use crate::wire::reason::Reason;
use crate::wire::report::Report;

/// A refusal: its reason, and the detail that the reason's table promises.
pub(super) type Refusal = (Reason, u32);

/// The answer as it is sent.
pub(super) fn acknowledgement(
    function: Function,
    sequence: u8,
    answer: Result<u32, Refusal>,
) -> Report {
    let (reason, detail) = match answer {
        Ok(detail) => (Reason::Accepted, detail),
        Err(refusal) => refusal,
    };
    Report::Acknowledgement {
        sequence,
        function,
        reason,
        detail,
    }
}

/// Why a motion does not take a move on, in the words of the protocol.
pub(super) fn refusal(error: PlanError) -> Refusal {
    match error {
        PlanError::OutsideTravel { .. } => (Reason::OutsideTravel, 0),
        PlanError::TooFast { shortest } => (Reason::TooFast, shortest.0),
        PlanError::TooLong => (Reason::TooLong, 0),
    }
}
