//! The 1 kHz task.

use canter_shared::node::{BusEvent, Node};
use canter_shared::time::{LocalTime, MICROSECONDS_PER_TICK, Ticks};
use embassy_futures::select::select;
use embassy_time::{Instant, Timer};
use heapless::Vec;

use crate::bus::Signals;
use crate::node::{AXES, SharedNode};
use crate::now;
use crate::port::{BusMonitor, SetpointSink, Watchdog};

/// How long a stop may wait for its plan: the leads of seven tries, 1 + 2 + 4 ... + 64 = 127 ticks.
const LONGEST_WAIT: Ticks = Ticks(127);

/// Ticks the node when it is due, hands out the setpoints, and wakes the transmit task.
///
/// The watchdog is fed only by a tick that began within its own millisecond, and only while stops
/// are planned. A loop that has stopped, one that cannot keep up, and a planner that does not get on
/// all end in a reset, and a reset means no setpoints.
pub async fn run(
    node: &SharedNode,
    signals: &Signals,
    mut monitor: impl BusMonitor,
    mut sink: impl SetpointSink,
    mut watchdog: impl Watchdog,
) -> ! {
    loop {
        let due = due(node, signals).await;
        let began = now();
        let counts = monitor.take();
        let (setpoints, plans, overdue): (Vec<_, AXES>, _, _) = node.lock(|node| {
            let mut node = node.borrow_mut();
            count(&mut node, BusEvent::BusOff, counts.bus_off);
            count(&mut node, BusEvent::ErrorFrame, counts.error_frames);
            count(&mut node, BusEvent::LostReception, counts.lost_receptions);
            let setpoints = node.tick(began).iter().copied().collect();
            (setpoints, node.has_plan(), node.stop_overdue())
        });
        sink.put(&setpoints);
        signals.drives.signal(());
        signals.transmit.signal(());
        if plans {
            signals.plan.signal(());
        }
        if began.since(due) < MICROSECONDS_PER_TICK && overdue <= LONGEST_WAIT {
            watchdog.feed();
        }
    }
}

/// Waits until a tick is due, and says when that was.
///
/// A SYNC can move the next tick while this waits, later or earlier, so it asks again after each.
async fn due(node: &SharedNode, signals: &Signals) -> LocalTime {
    loop {
        let due = node.lock(|node| node.borrow().next_tick());
        if due <= now() {
            return due;
        }
        select(
            Timer::at(Instant::from_micros(due.0)),
            signals.retimed.wait(),
        )
        .await;
    }
}

fn count<D: canter_shared::drive::Drive>(node: &mut Node<D, AXES>, event: BusEvent, times: u32) {
    for _ in 0..times {
        node.count(event);
    }
}
