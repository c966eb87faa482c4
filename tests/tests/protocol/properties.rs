//! What holds for all frames, not only for golden ones.

use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::units::{Acceleration, Jerk, Position, Velocity};
use canter_shared::wire::ProtocolVersion;
use canter_shared::wire::command::{Action, Command, ProfileKind, wire_position};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId, split};
use canter_shared::wire::layout::{
    ACCELERATION_SHIFT, Addressing, JERK_SHIFT, LAYOUTS, Layout, POSITION_SHIFT,
    VELOCITY_LIMIT_SHIFT,
};
use canter_shared::wire::reason::Reason;
use canter_shared::wire::report::{IdentityPart, Report};
use proptest::prelude::*;
use proptest::sample::select;

/// Half of the farthest steps of a position on the wire.
const STEPS: i64 = 1 << 33;

fn any_frame() -> impl Strategy<Value = Frame> {
    let data = prop::collection::vec(any::<u8>(), 0..=8);
    (0u16..1 << 11, data).prop_map(|(id, data)| Frame::new(id, &data).expect("it fits"))
}

/// A frame of the right length with an id that is in use, so that most get past the first checks.
fn likely_frame() -> impl Strategy<Value = Frame> {
    let layout = select(LAYOUTS.as_slice());
    (layout, 0u16..64, any::<[u8; 8]>()).prop_map(|(layout, axis, data)| {
        let id = u16::from(u8::from(layout.function)) << 6 | axis;
        Frame::new(id, &data[..usize::from(layout.length)]).expect("it fits")
    })
}

fn any_axis() -> impl Strategy<Value = AxisId> {
    (1u8..64).prop_map(|id| AxisId::new(id).expect("1 to 63 are axes"))
}

/// A position that the wire can carry, exactly or not.
fn any_position() -> impl Strategy<Value = Position> {
    let edge = STEPS << POSITION_SHIFT;
    prop_oneof![
        Just(-edge),
        // Half a step below the edge is the last that does not round up to it.
        Just(edge - 257),
        -edge..edge - 256,
        -1_000_000i64..1_000_000,
    ]
    .prop_map(Position::from_counts)
}

/// A limit in steps of the wire, of this many bits.
fn any_limit(bits: u32) -> impl Strategy<Value = i64> {
    let edge = 1i64 << bits;
    prop_oneof![Just(0), Just(1), Just(edge - 1), 0..edge]
}

fn any_command() -> impl Strategy<Value = Command> {
    let ticks = || (0u32..1 << 22).prop_map(Ticks);
    prop_oneof![
        Just(Command::EmergencyStop),
        Just(Command::IdentityRequest),
        (any::<u8>(), 0u64..1 << 56).prop_map(|(counter, time)| Command::Sync {
            counter,
            time: BusTime(time)
        }),
        (any::<u8>(), any::<u16>(), 0u64..1 << 40).prop_map(|(group, session, start)| {
            Command::Trigger {
                group,
                session,
                start: Tick(start),
            }
        }),
        any::<u8>().prop_map(|sequence| Command::Stop { sequence }),
        any::<u16>().prop_map(|session| Command::HostHeartbeat { session }),
        (select(&Action::ALL[..]), any::<u8>(), any::<u16>()).prop_map(
            |(action, sequence, session)| Command::Control {
                action,
                sequence,
                session
            }
        ),
        (ticks(), ticks(), any::<u8>()).prop_map(|(acceleration, deceleration, sequence)| {
            Command::TrapezoidShape {
                acceleration,
                deceleration,
                sequence,
            }
        }),
        (any_limit(28), any_limit(28), any::<u8>()).prop_map(
            |(acceleration, deceleration, sequence)| Command::RampLimits {
                acceleration: Acceleration::from_counts(acceleration << ACCELERATION_SHIFT),
                deceleration: Acceleration::from_counts(deceleration << ACCELERATION_SHIFT),
                sequence,
            }
        ),
        (any_limit(24), any_limit(32), any::<u8>()).prop_map(|(velocity, jerk, sequence)| {
            Command::PeakLimits {
                velocity: Velocity::from_counts(velocity << VELOCITY_LIMIT_SHIFT),
                jerk: Jerk::from_counts(jerk << JERK_SHIFT),
                sequence,
            }
        }),
        (
            select(
                &[
                    ProfileKind::Beta,
                    ProfileKind::Trapezoid,
                    ProfileKind::SCurve
                ][..]
            ),
            any::<bool>(),
            any_position(),
            ticks(),
            any::<u8>()
        )
            .prop_map(
                |(profile, staged, target, duration, sequence)| Command::Move {
                    profile,
                    staged,
                    target,
                    duration,
                    sequence
                }
            ),
    ]
}

fn any_report() -> impl Strategy<Value = Report> {
    let time = || (0u64..1 << 56).prop_map(BusTime);
    let functions = LAYOUTS.map(|layout| layout.function);
    prop_oneof![
        (
            any::<u8>(),
            select(functions.to_vec()),
            select(&Reason::ALL[..]),
            any::<u32>()
        )
            .prop_map(|(sequence, function, reason, detail)| {
                Report::Acknowledgement {
                    sequence,
                    function,
                    reason,
                    detail,
                }
            }),
        (any::<u8>(), time()).prop_map(|(sequence, time)| Report::Started { sequence, time }),
        (any::<u8>(), time()).prop_map(|(fault, time)| Report::Fault { fault, time }),
        (
            any_position(),
            -(1i64 << 23)..1 << 23,
            0u8..16,
            any::<[bool; 2]>()
        )
            .prop_map(|(position, velocity, state, [moving, target_reached])| {
                Report::Feedback {
                    position: wire_position(position),
                    velocity: Velocity::from_counts(velocity << 18),
                    state,
                    moving,
                    target_reached,
                }
            }),
        (any::<[u8; 6]>(), any::<u16>()).prop_map(|(bytes, session)| {
            let [state, fault, bus_off, error_frames, lost, rejected] = bytes;
            Report::Heartbeat {
                state,
                fault,
                session,
                bus_off,
                error_frames,
                lost,
                rejected,
            }
        }),
        any::<[u8; 6]>().prop_map(|[major, minor, board, a, b, c]| {
            Report::Identity(IdentityPart::Version {
                protocol: ProtocolVersion { major, minor },
                board,
                firmware: [a, b, c],
            })
        }),
        any::<[u8; 6]>().prop_map(|half| Report::Identity(IdentityPart::ChipFirst(half))),
        any::<[u8; 6]>().prop_map(|half| Report::Identity(IdentityPart::ChipLast(half))),
    ]
}

/// The payload's bits that some field has, which are those that survive a trip through the codec.
fn used(frame: &Frame) -> u64 {
    let (function, _) = split(frame.id()).expect("a known function");
    let layout = Layout::of(function).expect("a known function");
    let part = layout.fields.first().map(|first| first.get(frame.word()));
    let present = |part_of: Option<u8>| part_of.is_none() || part_of.map(i64::from) == part;
    let fields = layout.fields.iter().filter(|field| present(field.part));
    // -1, cut to the field where it is unsigned, would be 0.
    fields.fold(0, |word, field| {
        let (least, greatest) = field.range();
        field.put(word, least) | field.put(word, greatest)
    })
}

fn check(frame: &Frame) -> Result<(), TestCaseError> {
    let command = Command::decode(frame);
    let report = Report::decode(frame);
    let again = match (command, report) {
        (Ok(Some((address, command))), Ok(None)) => command.encode(address),
        (Ok(None), Ok(Some((axis, report)))) => Ok(report.encode(axis)),
        (Err(error), _) | (_, Err(error)) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(());
        }
        both => return Err(TestCaseError::fail(format!("one side sends it: {both:?}"))),
    };
    let again = again.expect("what came off the wire fits it");
    prop_assert_eq!(again.id(), frame.id());
    prop_assert_eq!(again.data().len(), frame.data().len());
    prop_assert_eq!(again.word(), frame.word() & used(frame));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn any_frame_is_refused_or_means_one_thing(frame in any_frame()) {
        check(&frame)?;
    }

    #[test]
    fn a_frame_in_use_is_refused_or_means_one_thing(frame in likely_frame()) {
        check(&frame)?;
    }

    #[test]
    fn a_command_comes_back_as_it_was(command in any_command(), axis in any_axis(), all: bool) {
        let layout = Layout::of(command.function()).expect("each command has a layout");
        let address = match layout.addressing {
            Addressing::All => Address::All,
            Addressing::Any if all => Address::All,
            Addressing::Any | Addressing::One => Address::Axis(axis),
        };
        let frame = command.encode(address).expect("every value fits");
        let expected = match command {
            Command::Move { profile, staged, target, duration, sequence } => Command::Move {
                profile, staged, target: wire_position(target), duration, sequence,
            },
            other => other,
        };
        prop_assert_eq!(Command::decode(&frame), Ok(Some((address, expected))));
        prop_assert_eq!(Report::decode(&frame), Ok(None));
    }

    #[test]
    fn a_report_comes_back_as_it_was(report in any_report(), axis in any_axis()) {
        let frame = report.encode(axis);
        prop_assert_eq!(Report::decode(&frame), Ok(Some((axis, report))));
        prop_assert_eq!(Command::decode(&frame), Ok(None));
    }

    #[test]
    fn the_wire_keeps_a_position_to_half_a_microradian(position in any_position()) {
        let error = (wire_position(position) - position).radians().abs();
        prop_assert!(error < 0.5e-6, "{error}");
    }
}

#[test]
fn a_value_that_does_not_fit_is_refused_by_name() {
    let axis = Address::Axis(AxisId::new(1).expect("1 is an axis"));
    let moved = |target, duration| Command::Move {
        profile: ProfileKind::Beta,
        staged: false,
        target: Position::from_counts(target),
        duration: Ticks(duration),
        sequence: 1,
    };
    let edge = STEPS << POSITION_SHIFT;
    for (command, field) in [
        (moved(edge, 1), "target"),
        (moved(-edge - 257, 1), "target"),
        (moved(i64::MAX, 1), "target"),
        (moved(0, 1 << 22), "duration"),
    ] {
        let error = command.encode(axis).expect_err("it does not fit");
        assert_eq!(error.field, field, "{error}");
        assert!(error.to_string().starts_with(field), "{error}");
    }
    let late = Command::Sync {
        counter: 0,
        time: BusTime(u64::MAX),
    };
    assert_eq!(
        late.encode(Address::All).map_err(|error| error.field),
        Err("time")
    );
}
