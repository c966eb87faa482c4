//! What each frame, field and value is called and means.

use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::parameter::Parameter;
use canter_shared::wire::command::{Action, Item};
use canter_shared::wire::id::Function;
use canter_shared::wire::layout::{Choices, LAYOUTS};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::Board;

/// What a frame is for.
pub(super) fn of(function: Function) -> &'static str {
    match function {
        Function::EmergencyStop => "Stop now and latch a fault; from anybody",
        Function::Sync => "The commander's clock",
        Function::Trigger => "Start what was staged, all at one bus time",
        Function::Knot => "Where to be next in a stream, and how fast",
        Function::Stop => "Controlled stop; from anybody",
        Function::HostHeartbeat => "The session is alive",
        Function::Control => "Hold, release, enable, disable, clear, configure, save, restore",
        Function::TrapezoidShape => "The ramps of the next trapezoid",
        Function::MoveBeta => "Move along a beta S-curve, now",
        Function::MoveTrapezoid => "Move along a trapezoid, now",
        Function::MoveSCurve => "Move along a jerk-limited s-curve, now",
        Function::RampLimits => "The largest acceleration and deceleration of the next s-curve",
        Function::StageBeta => "Move along a beta S-curve, at the trigger",
        Function::StageTrapezoid => "Move along a trapezoid, at the trigger",
        Function::StageSCurve => "Move along a jerk-limited s-curve, at the trigger",
        Function::PeakLimits => "The largest velocity and jerk of the next s-curve",
        Function::Acknowledgement => "The answer to a command",
        Function::Started => "A move began",
        Function::Fault => "A fault was latched",
        Function::StreamBegin => "Begin a stream of knots, from rest",
        Function::Feedback => "Where the axis is",
        Function::Heartbeat => "State, holder and counters",
        Function::ParameterRead => "What is the value of a parameter?",
        Function::ParameterWrite => "Change a parameter",
        Function::Parameter => "The value of a parameter",
        Function::IdentityRequest => "Who is there?",
        Function::Identity => "Who the node is, in three parts",
        Function::Assign => "Give an axis of a chip another id, in three parts",
    }
}

/// What a field says; `None` where nobody has written it down yet, which a test finds.
pub(super) fn of_field(function: Function, field: &str) -> Option<&'static str> {
    Some(match (function, field) {
        (Function::Sync, "counter") => "one more with each SYNC",
        (Function::Sync, "time") => "bus time when the frame was sent",
        (Function::Trigger, "group") => "the sequence number that the moves were staged with",
        (Function::Trigger, "session") => "the session that staged them",
        (Function::Trigger, "start") => "bus time to leave at, a whole millisecond",
        (Function::Stop, "sequence") => "comes back in the answer; any number will do",
        (Function::HostHeartbeat, "session") => "the session whose axes it keeps",
        (Function::Control, "action") => "what is asked for",
        (Function::Control, "session") => "the session that asks, not 0",
        (Function::TrapezoidShape, "acceleration") => "how long to speed up",
        (Function::TrapezoidShape, "deceleration") => "how long to slow down",
        (Function::RampLimits, "acceleration") => "the most to speed up with, not 0",
        (Function::RampLimits, "deceleration") => "the most to slow down with, not 0",
        (Function::PeakLimits, "velocity") => "the most to move with, not 0",
        (Function::PeakLimits, "jerk") => "the most to change the acceleration with, not 0",
        (Function::Knot, "position") => "where to be",
        (Function::Knot, "velocity") => "how fast to pass through there",
        (Function::Knot, "number") => "one more than that of the knot before; 0 follows 63",
        (Function::StreamBegin, "start") => "bus time to leave at, a whole millisecond",
        (Function::StreamBegin, "period") => "from knot to knot, not 0",
        (Function::StreamBegin, "number") => "the number of the place where the axis leaves from",
        (_, "parameter") => "which parameter",
        (_, "item") => "what is asked about it",
        (Function::ParameterWrite | Function::Parameter, "value") => {
            "in the steps of the table of parameters"
        }
        (Function::Assign, "axis") => "the axis's id until now",
        (Function::Assign, "new_axis") => "its id from now on",
        (Function::Assign, "sequence") => "comes back in the answer, which is from the new id",
        // One table serves all the moves.
        (Function::MoveBeta, "sequence") => "the command's number; of a staged move also its group",
        (_, "target") => "where to come to rest",
        (_, "duration") => "from leaving to rest",
        (Function::Acknowledgement, "sequence") => "the command's number; a trigger's group",
        (Function::Acknowledgement, "function") => "the command's function",
        (Function::Acknowledgement, "reason") => "accepted, or why not",
        (Function::Acknowledgement, "detail") => "as the table of reasons says",
        (Function::Started, "time") => "bus time of the first setpoint",
        (Function::Fault, "time") => "bus time when it was latched",
        (_, "sequence") => "the command's number",
        (_, "fault") => "the latched fault, 0 for none",
        (Function::Feedback, "position") => "where the drive is, cut to the field's range",
        (Function::Feedback, "velocity") => "how fast it is, cut to the field's range",
        (_, "state") => "the axis's state",
        (Function::Feedback, "moving") => "1 while the setpoint changes, or will by itself",
        (Function::Feedback, "target_reached") => {
            "1 while the setpoint rests where the last move or stream led: nothing stopped it before"
        }
        (Function::Heartbeat, "session") => "the session that holds the axis, 0 for none",
        (Function::Heartbeat, "bus_off") => "times that the node was off the bus; wraps",
        (Function::Heartbeat, "error_frames") => "error frames seen; wraps",
        (Function::Heartbeat, "lost") => "receptions lost; wraps",
        (Function::Heartbeat, "rejected") => "commands refused; wraps",
        (_, "part") => "which part this is",
        (Function::Identity, "protocol_major") => "differs where two cannot talk to each other",
        (Function::Identity, "protocol_minor") => "grows with each addition",
        (Function::Identity, "board") => "what the node runs on",
        (Function::Identity, "firmware_major") => "the firmware's version",
        (Function::Identity, "firmware_minor") => "its second number",
        (Function::Identity, "firmware_patch") => "its third number",
        (_, "chip_first") => "the chip's id, first six bytes in turn",
        (_, "chip_last") => "the chip's id, last six bytes in turn",
        _ => return None,
    })
}

/// What the detail of an acknowledgement says, for each reason.
pub(super) fn detail(reason: Reason) -> &'static str {
    match reason {
        Reason::Accepted => {
            "of a move or a trigger: ticks until it has arrived; of a staged move: ticks from its \
             start until it has arrived; of a knot: how many before it are missing; else 0"
        }
        Reason::HeldByOther => "that session",
        Reason::NotEnabled => "the state",
        Reason::FaultLatched => "the fault's number",
        Reason::TooFast => "the least duration in ticks; of a knot 0",
        Reason::StaleSequence => "the last number",
        Reason::TooLate => "by how many ticks",
        Reason::Overtaken => "the newer number",
        Reason::UnknownParameter | Reason::OutOfRange => "the parameter's number",
        Reason::NotDisabled => "the state",
        Reason::StreamFull => "ticks until there is room",
        Reason::KnotsMissing => "how many",
        Reason::IdTaken => "that id",
        Reason::NotHeld
        | Reason::OutsideTravel
        | Reason::TooLong
        | Reason::DriveNotReady
        | Reason::Moving
        | Reason::BadValue
        | Reason::Stopped
        | Reason::SaveFailed
        | Reason::NotStreaming
        | Reason::TooStrong
        | Reason::CannotStop
        | Reason::Locked => "",
    }
}

/// The numbers that have names, in their order.
pub(super) fn names(choices: Choices) -> Vec<(u8, String)> {
    match choices {
        Choices::None => Vec::new(),
        Choices::Action => named(&Action::ALL, |action| snake_case(&format!("{action:?}"))),
        Choices::State => named(&State::ALL, |state| state.name().to_owned()),
        Choices::Fault => {
            let mut names = vec![(0, "none".to_owned())];
            names.extend(named(&Fault::ALL, |fault| fault.name().to_owned()));
            names
        }
        Choices::Reason => named(&Reason::ALL, |reason| snake_case(&format!("{reason:?}"))),
        Choices::Function => {
            let functions = LAYOUTS.map(|layout| layout.function);
            named(&functions, |function| format!("{function:?}"))
        }
        Choices::Parameter => named(&Parameter::ALL, |parameter| {
            parameter.entry().name.to_owned()
        }),
        Choices::Item => named(&Item::ALL, |item| snake_case(&format!("{item:?}"))),
        Choices::Board => named(&Board::ALL, |board| board.name().to_owned()),
    }
}

fn named<T: Copy + Into<u8>>(values: &[T], name: impl Fn(T) -> String) -> Vec<(u8, String)> {
    let pair = |value: &T| ((*value).into(), name(*value));
    values.iter().map(pair).collect()
}

/// `HeldByOther` as `held_by_other`, the way faults are written.
pub(super) fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for character in name.chars() {
        if character.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(character.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_has_a_meaning() {
        for layout in &LAYOUTS {
            for field in layout.fields {
                let meaning = of_field(layout.function, field.name);
                assert!(meaning.is_some(), "{:?} {}", layout.function, field.name);
            }
        }
    }

    #[test]
    fn names_are_told_apart_and_fit_a_dbc() {
        use Choices::{Action, Board, Fault, Function, Item, Parameter, Reason, State};
        for choices in [
            Action, State, Fault, Reason, Function, Board, Parameter, Item,
        ] {
            let names = names(choices);
            for (index, (number, name)) in names.iter().enumerate() {
                assert!(!name.is_empty() && !name.contains(['"', '\\']), "{name}");
                let others = &names[..index];
                let unique = others.iter().all(|(n, other)| n < number && other != name);
                assert!(unique, "{choices:?} {number} {name}");
            }
        }
        assert_eq!(snake_case("HeldByOther"), "held_by_other");
    }
}
