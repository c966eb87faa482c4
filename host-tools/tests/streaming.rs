//! Twelve axes of the simulated robot are led along knots, and what happens when the bus or the
//! host does not keep up.

/// Here so that the file lies in a folder of its own.
mod streaming {
    mod losses;
}

use canter::bus::{Bus, BusError, Received};
use canter::client::{Client, ClientError, Pace, StreamKnot};
use canter::sim::{Configuration, Record, SimulatedBus};
use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::wire::command::Command;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::reason::Reason;
use std::cell::RefCell;
use std::num::NonZeroU8;
use std::rc::Rc;

/// What becomes of a command of the host; `None` where it is lost.
type Passes = Box<dyn FnMut(Address, Command) -> Option<Command>>;

/// The simulated robot, and a say in which frames of the host get through.
struct Filtered {
    bus: SimulatedBus,
    passes: Passes,
}

impl Bus for Filtered {
    fn now(&self) -> BusTime {
        self.bus.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        let decoded = Command::decode(frame).ok().flatten();
        let (address, command) = decoded.expect("the host speaks the protocol");
        match (self.passes)(address, command) {
            Some(command) => self.bus.send(&command.encode(address).expect("it fits")),
            None => Ok(()),
        }
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        self.bus.receive(until)
    }

    fn description(&self) -> String {
        self.bus.description()
    }
}

struct Robot {
    client: Client<Filtered>,
    axes: Vec<AxisId>,
    record: Rc<RefCell<Record>>,
}

/// Twelve axes, held and enabled.
fn robot(passes: impl FnMut(Address, Command) -> Option<Command> + 'static) -> Robot {
    let mut bus = SimulatedBus::new(&Configuration::default());
    let record = Rc::new(RefCell::new(Record::default()));
    bus.observe(record.clone());
    let passes = Box::new(passes);
    let mut client = Client::new(Filtered { bus, passes }, 0xCA27);
    let axes: Vec<AxisId> = (1..=12).filter_map(AxisId::new).collect();
    client.check(&axes).expect("all are there");
    client.hold(&axes).expect("nobody else is there");
    client.enable(&axes).expect("well");
    Robot {
        client,
        axes,
        record,
    }
}

/// How far axis `index` goes, in rad.
fn way(index: usize) -> f64 {
    0.5 * (index as f64 - 5.3)
}

const SECONDS: f64 = 2.0;

/// A quintic from rest to rest in 2 s: rad and rad/s.
fn ideal(index: usize, seconds: f64) -> StreamKnot {
    let u = (seconds / SECONDS).clamp(0.0, 1.0);
    StreamKnot {
        position: way(index) * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u),
        velocity: way(index) * 30.0 * u * u * (1.0 - u) * (1.0 - u) / SECONDS,
    }
}

/// The knots of all axes, every 20 ms, up to `end` s.
fn knots(end: f64) -> impl Iterator<Item = Vec<StreamKnot>> {
    let count = (end / 0.02).round() as u32;
    (1..=count).map(|number| {
        let seconds = f64::from(number) * 0.02;
        (0..12).map(|index| ideal(index, seconds)).collect()
    })
}

fn all_faults(robot: &mut Robot) -> Vec<Option<Fault>> {
    robot.client.listen().expect("the bus is up");
    let axes = robot.client.axes();
    robot.axes.iter().map(|axis| axes[axis].fault).collect()
}

#[test]
fn twelve_axes_follow_their_knots_together() {
    let mut robot = robot(|_, command| Some(command));
    let axes = robot.axes.clone();
    let ends = robot
        .client
        .stream(&axes, Pace::default(), knots(SECONDS))
        .expect("arrives");
    assert_eq!(ends.len(), 12);
    for (index, end) in ends.iter().enumerate() {
        assert!((end.position - way(index)).abs() < 1e-5, "{end:?}");
        assert_eq!(end.missing, 0);
        assert!(end.skew_microseconds < 100, "{end:?}");
    }
    let began = ends.iter().map(|end| end.start).min().expect("twelve");
    let start = Tick((began.0 + 500) / 1_000);
    let record = robot.record.borrow();
    let mut farthest = 0.0f64;
    for (_, setpoint) in &record.setpoints {
        let index = axes.iter().position(|axis| *axis == setpoint.axis);
        let seconds = setpoint.tick.since(start).seconds();
        let ideal = ideal(index.expect("one of them"), seconds);
        let error = setpoint.setpoint.position.radians() - ideal.position;
        farthest = farthest.max(error.abs());
    }
    println!("farthest from the ideal: {farthest:e} rad");
    // A cubic over 20 ms is off by T^4 / 384 of the fourth derivative, 360 / 2^4 of 3.35 rad: 3e-8
    // rad. The wire rounds positions to half a step of 2^-23 turn, 3.8e-7 rad, and velocities to
    // half a step of 2^-14 turn/s, over a quarter of 20 ms 9.6e-7 rad.
    assert!(farthest < 1.4e-6, "{farthest}");
    drop(record);
    assert_eq!(all_faults(&mut robot), [None; 12]);
    // Nothing was refused, and the axes take moves and streams again.
    let axes = robot.client.axes();
    assert!(axes.values().all(|known| known.counters.rejected == 0));
    let rest = |index: usize| StreamKnot {
        position: way(index),
        velocity: 0.0,
    };
    let stay = (0..12).map(rest).collect::<Vec<_>>();
    let held = robot.axes.clone();
    let again = robot.client.stream(&held, Pace::default(), vec![stay; 3]);
    assert!(again.is_ok(), "{again:?}");
}

#[test]
fn other_paces_do_as_well() {
    for (period, look_ahead) in [(5, 100), (10, 100), (50, 20), (255, 1_000)] {
        let mut robot = robot(|_, command| Some(command));
        let axes = robot.axes.clone();
        let pace = Pace {
            period: NonZeroU8::new(period).expect("not zero"),
            look_ahead: Ticks(look_ahead),
        };
        let seconds = f64::from(period) / 1e3;
        let count = (SECONDS / seconds).ceil() as u32;
        let knots = (1..=count).map(|number| {
            let seconds = f64::from(number) * seconds;
            (0..12).map(|index| ideal(index, seconds)).collect()
        });
        let ends = robot.client.stream(&axes, pace, knots);
        let ends = ends.unwrap_or_else(|error| panic!("{period}: {error}"));
        assert!(ends.iter().all(|end| end.missing == 0));
    }
}

#[test]
fn a_knot_that_is_lost_is_noticed_and_bridged() {
    let third = AxisId::new(3).expect("an axis");
    let lost = move |address, command| match command {
        Command::Knot { number, .. }
            if address == Address::Axis(third) && [20, 40, 41].contains(&number) =>
        {
            None
        }
        _ => Some(command),
    };
    let mut robot = robot(lost);
    let axes = robot.axes.clone();
    let ends = robot
        .client
        .stream(&axes, Pace::default(), knots(SECONDS))
        .expect("arrives");
    for end in ends {
        // Number 20 comes twice in 100 knots, 40 and 41 once.
        let missing = if end.axis == third { 4 } else { 0 };
        assert_eq!(end.missing, missing, "{end:?}");
    }
    assert_eq!(all_faults(&mut robot), [None; 12]);
}

#[test]
fn a_host_that_sends_no_more_knots_stops_all_axes_with_a_fault() {
    let count = Rc::new(RefCell::new(0));
    let counted = count.clone();
    let silent = move |_, command| {
        let is_knot = matches!(command, Command::Knot { .. });
        *counted.borrow_mut() += u32::from(is_knot);
        // Forty knots for each axis, then none.
        (!is_knot || *counted.borrow() <= 40 * 12).then_some(command)
    };
    let mut robot = robot(silent);
    let axes = robot.axes.clone();
    let error = robot
        .client
        .stream(&axes, Pace::default(), knots(SECONDS))
        .expect_err("runs dry");
    let fault = Fault::StreamUnderrun;
    assert!(
        matches!(error, ClientError::Faulted { fault: told, .. } if told == fault),
        "{error}"
    );
    assert_eq!(all_faults(&mut robot), [Some(fault); 12]);
    let states = robot.client.axes().values().map(|known| known.state);
    assert!(states.into_iter().all(|state| state == Some(State::Fault)));
    // They rest v^2 / 2 d after their last knots.
    let record = robot.record.borrow();
    for (index, axis) in axes.iter().enumerate() {
        let mut setpoints = record.setpoints.iter().rev();
        let last = setpoints.find(|(_, setpoint)| setpoint.axis == *axis);
        let rest = last.expect("some").1.setpoint.position.radians();
        let knot = ideal(index, 40.0 * 0.02);
        let brake = knot.velocity * knot.velocity.abs() / (2.0 * 200.0);
        assert!((rest - knot.position - brake).abs() < 1e-5, "{axis}");
    }
}

#[test]
fn knots_that_end_in_motion_or_are_refused_stop_all_axes() {
    let mut robot = robot(|_, command| Some(command));
    let axes = robot.axes.clone();
    let error = robot
        .client
        .stream(&axes, Pace::default(), knots(0.8))
        .expect_err("ends in motion");
    assert!(matches!(error, ClientError::EndsInMotion { .. }), "{error}");
    assert_eq!(all_faults(&mut robot), [None; 12]);
    let at_rest = |robot: &Robot| {
        let mut axes = robot.client.axes().values();
        axes.all(|known| known.moving == Some(false))
    };
    assert!(at_rest(&robot));
    // From where they are this is too far for one period.
    let far = StreamKnot {
        position: 9.0,
        velocity: 0.0,
    };
    let error = robot
        .client
        .stream(&axes, Pace::default(), [vec![far; 12]])
        .expect_err("too far");
    assert!(
        matches!(
            error,
            ClientError::Refused {
                reason: Reason::TooFast,
                ..
            }
        ),
        "{error}"
    );
    assert!(at_rest(&robot));
    let few = robot.client.stream(&axes, Pace::default(), [vec![far; 11]]);
    assert!(matches!(few, Err(ClientError::KnotCount { .. })), "{few:?}");
}

/// The axes begin three periods later than their host believes: they have no room for its knots.
#[test]
fn an_axis_without_room_is_sent_the_knot_again() {
    let late = |_, command| match command {
        Command::StreamBegin {
            start,
            period,
            number,
            sequence,
        } => Some(Command::StreamBegin {
            start: start.after(Ticks(60)),
            period,
            number,
            sequence,
        }),
        _ => Some(command),
    };
    let mut robot = robot(late);
    let axes = robot.axes.clone();
    // As far ahead as they could hold.
    let pace = Pace {
        look_ahead: Ticks(1_000),
        ..Pace::default()
    };
    let ends = robot
        .client
        .stream(&axes, pace, knots(SECONDS))
        .expect("arrives");
    assert!(ends.iter().all(|end| end.missing == 0), "{ends:?}");
    // They were full once; from then on their knots were sent later.
    let known = robot.client.axes().values();
    let rejected: Vec<u8> = known.map(|known| known.counters.rejected).collect();
    assert!(
        rejected.iter().all(|count| (1..4).contains(count)),
        "{rejected:?}"
    );
}

#[test]
fn a_stream_without_knots_leaves_the_axes_where_they_are() {
    let mut robot = robot(|_, command| Some(command));
    let axes = robot.axes.clone();
    let ends = robot.client.stream(&axes, Pace::default(), []);
    assert_eq!(ends.expect("nothing to do").len(), 12);
    assert_eq!(all_faults(&mut robot), [None; 12]);
}
