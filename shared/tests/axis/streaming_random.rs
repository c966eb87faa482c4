//! Random streams: knots inside the limits and wild ones, lost, doubled, out of order; stopped at
//! any tick by anything, with a planner that is late; shaped or not. Whatever comes, the setpoints
//! keep the promise, go evenly, and the axis comes to rest in time.

use super::bench::{Bench, SESSION, frame};
use super::planner::{Planner, STOP};
use super::random::{limits, planner};
use super::streams::evenly;
use canter_shared::axis::Outcome;
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::limits::Limits;
use canter_shared::motion::Setpoint;
use canter_shared::motion::shaping::{ShaperKind, Shaping};
use canter_shared::units::{Position, Velocity};
use canter_shared::wire::command::{Action, Command, wire_position, wire_velocity};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// What becomes of a knot on its way.
#[derive(Debug, Clone, Copy)]
enum Fate {
    Arrives,
    Lost,
    Doubled,
    /// After the next one.
    Late,
}

/// What a knot asks for.
#[derive(Debug, Clone, Copy)]
enum Wish {
    /// A part of the velocity that can be reached, and a bend of the way there.
    Gentle(f64, f64),
    /// Slow down towards rest.
    Slower,
    /// Parts of the travel and of the velocity limit.
    Wild(f64, f64),
}

/// What ends the stream.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    /// Nothing but that no knots come any more.
    Dry,
    Stop,
    EmergencyStop,
    Disable,
    DriveLost,
    HostSilent,
}

#[derive(Debug, Clone)]
struct Case {
    limits: Limits,
    /// A part of the travel to begin at.
    place: f64,
    period: u8,
    /// Ticks from the frame to the start.
    ahead: u64,
    /// Knots that are sent ahead.
    look_ahead: u64,
    knots: Vec<(Wish, Fate)>,
    end: End,
    /// Ticks after the start.
    when: u64,
    planner: Planner,
    shaped: bool,
}

fn wish() -> impl Strategy<Value = Wish> {
    prop_oneof![
        12 => (-1.0..1.0f64, -1.0..1.0f64).prop_map(|(change, bend)| Wish::Gentle(change, bend)),
        3 => Just(Wish::Slower),
        1 => (-0.1..1.1f64, -1.0..1.0f64).prop_map(|(place, rate)| Wish::Wild(place, rate)),
    ]
}

fn fate() -> impl Strategy<Value = Fate> {
    prop_oneof![
        14 => Just(Fate::Arrives),
        2 => Just(Fate::Lost),
        2 => Just(Fate::Doubled),
        1 => Just(Fate::Late),
    ]
}

fn case() -> impl Strategy<Value = Case> {
    let end = prop::sample::select(vec![
        End::Dry,
        End::Dry,
        End::Stop,
        End::Stop,
        End::EmergencyStop,
        End::Disable,
        End::DriveLost,
        End::HostSilent,
    ]);
    (
        (limits(), 0.05..0.95f64, 1u8..40, 1u64..30, 1u64..6),
        prop::collection::vec((wish(), fate()), 1..80),
        (end, 0u64..1_500, planner(), prop::bool::weighted(0.3)),
    )
        .prop_map(
            |((limits, place, period, ahead, look_ahead), knots, (end, when, planner, shaped))| {
                Case {
                    limits,
                    place,
                    period,
                    ahead,
                    look_ahead,
                    knots,
                    end,
                    when,
                    planner,
                    shaped,
                }
            },
        )
}

/// The host's part: what it believes the axis has.
struct Host {
    number: u8,
    /// The last knot that was taken, its place in rad and its velocity in rad/s.
    last: (f64, f64),
    /// How many periods after the start it is.
    due: u64,
    late: Option<Command>,
}

struct Run {
    bench: Bench,
    trace: Vec<Setpoint>,
    accepted: usize,
    missing: usize,
    /// Whether it was stopped or ran dry in motion.
    cut_short: bool,
    shaped: bool,
}

impl Run {
    fn step(&mut self) {
        let last = self.bench.setpoint;
        let before = self.bench.axis.state();
        self.bench.step();
        // A drive that is gone is not led: its setpoint stops at once.
        let led = before.drives() && self.bench.axis.state().drives();
        if led && before != State::ReadyToSwitchOn {
            evenly(last, self.bench.setpoint, self.bench.axis.limits());
            self.keeps_both_limits_of_acceleration();
        }
        self.trace.push(self.bench.setpoint);
    }

    /// The bench looks for the greater of both.
    fn keeps_both_limits_of_acceleration(&self) {
        let (now, limits) = (self.bench.setpoint, self.bench.axis.limits());
        let slows = now.velocity.counts().signum() == -now.acceleration.counts().signum();
        let limit = match slows {
            _ if self.shaped => limits.slower_acceleration(),
            true => limits.deceleration(),
            false => limits.acceleration(),
        };
        assert!(now.acceleration.abs() <= limit, "{now:?}");
    }

    fn send(&mut self, command: Command) -> Outcome {
        let missing = self.bench.knot_answers().len();
        let outcome = self.bench.handle(&frame(command));
        let answers = self.bench.knot_answers().len() - missing;
        match outcome {
            Outcome::Rejected(_) => assert_eq!(answers, 1),
            Outcome::Repeated => assert_eq!(answers, 0),
            _ => {
                assert!(answers <= 1);
                self.accepted += 1;
                self.missing += answers;
            }
        }
        outcome
    }
}

impl Case {
    fn knot(&self, host: &Host, wish: Wish, skipped: u64) -> (f64, f64) {
        let limits = &self.limits;
        let seconds = f64::from(self.period) * (1 + skipped) as f64 / 1e3;
        let strength = limits.slower_acceleration().radians();
        let fastest = limits.velocity().radians();
        let (from, to) = (
            limits.position_minimum().radians(),
            limits.position_maximum().radians(),
        );
        let (place, speed) = host.last;
        let bent = |velocity: f64, bend: f64| {
            let mean = (speed + velocity) / 2.0;
            let bend = bend * strength * seconds * seconds / 12.0;
            (place + mean * seconds + bend, velocity)
        };
        match wish {
            Wish::Gentle(change, bend) => {
                let velocity = speed + change * strength * seconds;
                bent(velocity.clamp(-0.9 * fastest, 0.9 * fastest), 0.5 * bend)
            }
            Wish::Slower => {
                let least = (speed.abs() - 0.9 * strength * seconds).max(0.0);
                bent(least.copysign(speed), 0.0)
            }
            Wish::Wild(part, rate) => (from + part * (to - from), rate * fastest),
        }
    }

    fn run(&self) -> Run {
        let limits = self.limits;
        let (from, to) = (
            limits.position_minimum().counts(),
            limits.position_maximum().counts(),
        );
        let place = from + ((to - from) as f64 * self.place) as i64;
        let turns = place as f64 / canter_shared::units::COUNTS_PER_TURN as f64;
        let mut bench = Bench::enabled(limits, turns);
        if self.shaped {
            let shaping = Shaping::new(ShaperKind::Zvd, 15.0, 0.05).expect("in range");
            assert_eq!(bench.axis.shape(Some(&shaping)), Ok(()));
        }
        bench.planner = self.planner.clone();
        assert_eq!(bench.begin(self.ahead, self.period, 7), Outcome::Accepted);
        let mut host = Host {
            number: 7,
            last: (bench.setpoint.position.radians(), 0.0),
            due: 0,
            late: None,
        };
        let mut run = Run {
            bench,
            trace: Vec::new(),
            accepted: 0,
            missing: 0,
            cut_short: false,
            shaped: self.shaped,
        };
        let mut left = self.knots.iter();
        let mut skipped = 0;
        for tick in 0..self.when {
            let ahead = self.look_ahead + tick.saturating_sub(self.ahead) / u64::from(self.period);
            while host.due + skipped < ahead
                && let Some((wish, fate)) = left.next()
            {
                self.say(&mut run, &mut host, *wish, *fate, &mut skipped);
            }
            run.step();
        }
        self.end(&mut run);
        run
    }

    fn say(&self, run: &mut Run, host: &mut Host, wish: Wish, fate: Fate, skipped: &mut u64) {
        let (place, speed) = self.knot(host, wish, *skipped);
        let number = host.number.wrapping_add(1 + *skipped as u8);
        let position = Position::from_radians(place.clamp(-6_400.0, 6_400.0)).expect("in range");
        let velocity = Velocity::from_radians(speed).expect("in range");
        let (position, velocity) = (wire_position(position), wire_velocity(velocity));
        let knot = Command::Knot {
            position,
            velocity,
            number: number % 64,
        };
        let taken = match fate {
            Fate::Lost => false,
            Fate::Late => {
                host.late = Some(knot);
                false
            }
            Fate::Arrives | Fate::Doubled => run.send(knot) == Outcome::Accepted,
        };
        if let Fate::Doubled = fate
            && taken
        {
            assert_eq!(run.send(knot), Outcome::Repeated);
        }
        if taken {
            host.due += 1 + *skipped;
            host.number = number;
            host.last = (position.radians(), velocity.radians());
            *skipped = 0;
            if let Some(late) = host.late.take() {
                assert_eq!(run.send(late), Outcome::Repeated);
            }
        } else {
            *skipped += 1;
        }
    }

    fn end(&self, run: &mut Run) {
        let before = run.bench.axis.clone();
        let moving = run.bench.setpoint.velocity != Velocity::ZERO;
        let (place, speed) = (run.bench.place(), run.bench.velocity());
        match self.end {
            End::Dry => {}
            End::Stop => assert_eq!(run.bench.send(STOP), Outcome::Accepted),
            End::EmergencyStop => {
                assert_eq!(run.bench.send(Command::EmergencyStop), Outcome::Accepted);
            }
            End::Disable => {
                let sequence = run.bench.next();
                let disable = Command::Control {
                    action: Action::Disable,
                    sequence,
                    session: SESSION,
                };
                let _: Outcome = run.bench.send(disable);
            }
            End::DriveLost => {
                run.bench.condition = Some(canter_shared::drive::Condition::Lost);
            }
            End::HostSilent => run.bench.beats = false,
        }
        // The knots that it has, the brake, seven plans that come too late, the shaper, a time-out.
        let strength = self.limits.slower_acceleration().radians();
        let fastest = self.limits.velocity().radians();
        let ramp = strength / self.limits.jerk().radians();
        let brake = (fastest / strength + 3.0 * ramp) * 1e3;
        let knots = 6 * 8 * u64::from(self.period);
        let most = brake as u64 + knots + 7 * 256 + 192 + 300 + 30;
        let mut left = most;
        while run.bench.axis.is_moving() {
            run.step();
            left -= 1;
            assert!(left > 0, "{} ticks, then {}", most, run.bench.velocity());
        }
        run.cut_short = moving && before.fault().is_none();
        for _ in 0..300 {
            run.step();
        }
        let (state, fault) = (run.bench.axis.state(), run.bench.axis.fault());
        match self.end {
            End::Dry if fault.is_none() => assert_eq!(state, State::OperationEnabled),
            End::Dry => assert_eq!((state, fault), (State::Fault, Some(Fault::StreamUnderrun))),
            End::Stop if fault.is_none() => assert_eq!(state, State::OperationEnabled),
            End::Stop => assert_eq!(fault, before.fault()),
            End::Disable if fault.is_none() => assert_eq!(state, State::SwitchOnDisabled),
            _ => assert_eq!(state, State::Fault, "{fault:?} from {place} at {speed}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn no_stream_makes_a_setpoint_leave_its_limits_or_jump(case in case()) {
        let run = case.run();
        // The same frames at the same ticks give the same setpoints.
        prop_assert_eq!(run.trace, case.run().trace);
    }

    /// A host that ends its knots in motion: the axis rests v^2 / 2 d after the last one.
    #[test]
    fn a_stream_that_runs_dry_rests_where_its_last_knot_says(mut case in case()) {
        case.end = End::Dry;
        case.shaped = false;
        let run = case.run();
        let Some(at) = run.bench.reports.iter().find_map(|report| match report {
            canter_shared::wire::report::Report::Fault { time, .. } => Some(time.0 / 1_000),
            _ => None,
        }) else {
            return Ok(());
        };
        // The trace ends with now; the last knot is the tick before the fault.
        let back = (run.bench.tick - (at - 1)) as usize;
        let knot = run.trace[run.trace.len() - 1 - back];
        let speed = knot.velocity.counts() as f64;
        let deceleration = run.bench.axis.limits().deceleration().counts() as f64;
        let way = speed * speed / (2.0 * deceleration);
        let moved = (run.bench.setpoint.position - knot.position).counts().abs() as f64;
        prop_assert!((moved - way).abs() <= 1.0, "{} {}", moved, way);
    }
}

/// Random streams that never move or are always refused prove nothing.
#[test]
fn the_random_streams_are_taken_and_cut_short() {
    let mut runner = TestRunner::deterministic();
    let (mut accepted, mut missing, mut dry, mut cut) = (0, 0, 0, 0);
    for _ in 0..200 {
        let case = case().new_tree(&mut runner).expect("a case").current();
        let run = case.run();
        accepted += run.accepted;
        missing += run.missing;
        dry += usize::from(run.bench.axis.fault() == Some(Fault::StreamUnderrun));
        cut += usize::from(run.cut_short);
    }
    assert!(accepted > 2_000, "{accepted}");
    assert!(missing > 200, "{missing}");
    assert!(dry > 30, "{dry}");
    assert!(cut > 30, "{cut}");
}
