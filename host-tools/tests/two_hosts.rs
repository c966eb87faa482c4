//! A client beside another host that sends SYNC, on the simulated bus.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use canter::bus::{Bus, BusError, Event, Received};
use canter::client::{Client, Goal, MoveRequest, Overrides, Target};
use canter::robot::Robot;
use canter::sim::{Configuration, Record, SimulatedBus};
use canter_shared::time::{BusTime, MICROSECONDS_PER_TICK};
use canter_shared::wire::command::{Command, ProfileKind};
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::{Address, AxisId};

/// Between two SYNCs of the other host, in microseconds.
const PERIOD: u64 = 20_000;

/// About how long a SYNC takes to everybody.
const TRANSIT: u64 = 123;

/// The other host.
#[derive(Debug, Clone, Copy)]
struct Other {
    /// Whether it sends SYNC.
    speaks: bool,
    /// What its clock is ahead of the client's, in microseconds.
    ahead: u64,
    counter: u8,
    next: u64,
}

/// The simulated bus with another host on it, whose SYNCs the client hears and the nodes too.
struct Shared {
    bus: SimulatedBus,
    other: Rc<RefCell<Other>>,
    heard: VecDeque<(BusTime, Frame)>,
}

impl Shared {
    /// The other host's SYNC where it is due.
    fn speak(&mut self) -> Result<(), BusError> {
        let mut other = self.other.borrow_mut();
        let now = self.bus.now();
        if !other.speaks || now.0 < other.next {
            return Ok(());
        }
        other.next = now.0 + PERIOD;
        other.counter = other.counter.wrapping_add(1);
        let command = Command::Sync {
            counter: other.counter,
            time: BusTime(now.0 + other.ahead),
        };
        let frame = command.encode(Address::All).expect("values in range");
        self.heard.push_back((BusTime(now.0 + TRANSIT), frame));
        self.bus.send(&frame)
    }
}

impl Bus for Shared {
    fn now(&self) -> BusTime {
        self.bus.now()
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.bus.send(frame)
    }

    fn receive(&mut self, until: BusTime) -> Result<Option<Received>, BusError> {
        loop {
            self.speak()?;
            let other = *self.other.borrow();
            let mut wake = until;
            if other.speaks {
                wake = wake.min(BusTime(other.next));
            }
            if let Some((time, _)) = self.heard.front() {
                wake = wake.min(*time);
            }
            if let Some(received) = self.bus.receive(wake)? {
                return Ok(Some(received));
            }
            let now = self.bus.now();
            if let Some((time, frame)) = self.heard.pop_front_if(|(time, _)| *time <= now) {
                let event = Event::Frame(frame);
                return Ok(Some(Received { time, event }));
            }
            if now >= until {
                return Ok(None);
            }
        }
    }

    fn description(&self) -> String {
        self.bus.description()
    }
}

/// Twelve axes, a client, and the other host.
struct Scene {
    client: Client<Shared>,
    axes: Vec<AxisId>,
    other: Rc<RefCell<Other>>,
    record: Rc<RefCell<Record>>,
}

impl Scene {
    fn new(other: Other) -> Self {
        let configuration = Configuration::default();
        let mut bus = SimulatedBus::new(&configuration);
        let record = Rc::new(RefCell::new(Record::default()));
        bus.observe(Rc::clone(&record));
        let other = Rc::new(RefCell::new(other));
        let bus = Shared {
            bus,
            other: Rc::clone(&other),
            heard: VecDeque::new(),
        };
        let mut client = Client::new(bus, 0xCA27);
        let axes: Vec<_> = configuration.axes.iter().map(|axis| axis.id).collect();
        client.check(&axes).expect("all are there");
        client.hold(&axes).expect("all are free");
        client.enable(&axes).expect("the drives are well");
        Self {
            client,
            axes,
            other,
            record,
        }
    }

    /// Moves all axes, in which the other host may begin or fall silent, and gives the start
    /// as the nodes report it.
    fn go(&mut self, radians: f64, speaks: bool) -> Vec<BusTime> {
        let goals = self.axes.iter().map(|axis| Goal {
            axis: *axis,
            target: Target::Absolute(radians),
        });
        let request = MoveRequest {
            goals: goals.collect(),
            profile: ProfileKind::Beta,
            duration: Some(2.0),
            limits: Overrides::default(),
            independent: false,
        };
        let other = Rc::clone(&self.other);
        let moved = self
            .client
            .move_together(&Robot::default(), &request, |progress| {
                if progress.elapsed > 1.0 {
                    other.borrow_mut().speaks = speaks;
                }
            });
        let arrivals = moved.expect("the move arrives");
        arrivals.iter().map(|arrival| arrival.start).collect()
    }

    /// Every SYNC on the bus: its number, its time, and when it had been sent.
    fn syncs(&self) -> Vec<(u8, u64, u64)> {
        let record = self.record.borrow();
        let sync = |frame: &Frame| match Command::decode(frame) {
            Ok(Some((_, Command::Sync { counter, time }))) => Some((counter, time.0)),
            _ => None,
        };
        let frames = record.frames.iter();
        frames
            .filter_map(|sent| {
                sync(&sent.frame).map(|(counter, time)| (counter, time, sent.end.bus_time().0))
            })
            .collect()
    }

    /// The greatest distance of the axes from each other in true time in any tick, and how far any
    /// tick was from a millisecond after the one before, in microseconds; from some time on.
    fn skew_and_jump(&self, from: u64) -> (u64, u64) {
        let record = self.record.borrow();
        let (mut skew, mut jump) = (0, 0);
        let setpoints = record.setpoints.iter();
        let rows: Vec<_> = setpoints
            .filter(|(time, _)| time.0 >= from * 1_000)
            .collect();
        for axis in &self.axes {
            let own: Vec<_> = rows.iter().filter(|row| row.1.axis == *axis).collect();
            for pair in own.windows(2) {
                assert_eq!(pair[1].1.tick.0, pair[0].1.tick.0 + 1);
                jump = jump.max((pair[1].0.0 - pair[0].0.0).abs_diff(1_000_000));
            }
        }
        let mut ticks = std::collections::BTreeMap::new();
        for (time, setpoint) in rows {
            let (first, last) = ticks.entry(setpoint.tick).or_insert((time.0, time.0));
            *first = time.0.min(*first);
            *last = time.0.max(*last);
            skew = skew.max(*last - *first);
        }
        (skew / 1_000, jump / 1_000)
    }
}

const AHEAD: u64 = 3_600_000_000;

/// The client sends no SYNC where there is one, and its moves start at the other's time.
#[test]
fn a_client_follows_the_clock_that_is_there() {
    let mut scene = Scene::new(Other {
        speaks: true,
        ahead: AHEAD,
        counter: 200,
        next: 0,
    });
    let begin = scene.client.now().0;
    let starts = scene.go(0.5, true);
    for start in &starts {
        let off = start.0 % MICROSECONDS_PER_TICK;
        assert!(off <= 2, "{starts:?}");
        assert!(start.0 > AHEAD + begin, "{starts:?}");
    }
    let now = scene.client.now().0;
    let shown = scene.client.bus_time().0;
    assert!(shown.abs_diff(now + AHEAD - TRANSIT) <= 30, "{shown}");
    for pair in scene.syncs().windows(2) {
        assert_eq!(pair[1].0, pair[0].0.wrapping_add(1));
        assert!(pair[1].1 > AHEAD);
    }
    let (skew, _) = scene.skew_and_jump(begin);
    assert!(skew <= 25, "{skew} us apart");
}

/// In mid-move: nodes see the numbers and the time go on.
#[test]
fn a_client_takes_over_from_a_host_that_has_gone() {
    let mut scene = Scene::new(Other {
        speaks: true,
        ahead: AHEAD,
        counter: 200,
        next: 0,
    });
    scene.go(0.5, true);
    let begin = scene.client.now().0;
    scene.go(-0.5, false);
    scene.go(0.5, false);
    let syncs = scene.syncs();
    let longest = syncs.windows(2).map(|pair| pair[1].2 - pair[0].2).max();
    assert!((300_000..=450_000).contains(&longest.expect("SYNCs")));
    for pair in syncs.windows(2) {
        assert_eq!(pair[1].0, pair[0].0.wrapping_add(1), "the number goes on");
    }
    // A client that took over says the time of the arrival.
    let (_, time, end) = *syncs.last().expect("SYNCs");
    let late = (end + AHEAD - TRANSIT).abs_diff(time);
    assert!(late <= 30, "{late} us late");
    let (skew, jump) = scene.skew_and_jump(begin);
    assert!(skew <= 25, "{skew} us apart");
    assert!(jump <= 30, "a tick came {jump} us early or late");
    // And the other host comes back; it is heard no more, for it is the second one now.
    let before = scene.syncs().len();
    scene.other.borrow_mut().counter = 7;
    scene.other.borrow_mut().ahead = 77_000;
    scene.other.borrow_mut().next = 0;
    scene.other.borrow_mut().speaks = true;
    let begin = scene.client.now().0;
    scene.go(-0.5, true);
    let own = |(_, time, _): &&(u8, u64, u64)| *time > AHEAD;
    let sent = scene.syncs()[before..].iter().filter(own).count();
    assert!(sent > 50, "{sent} SYNCs of the client's");
    let (skew, jump) = scene.skew_and_jump(begin);
    assert!(skew <= 25, "{skew} us apart");
    assert!(jump <= 30, "a tick came {jump} us early or late");
    let told = scene.client.take_complaints();
    assert!(
        told.iter()
            .any(|words| words.contains("another host sends SYNC")),
        "{told:?}"
    );
}
