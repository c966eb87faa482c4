//! The tasks of the two buses: frames in, frames out.
//!
//! The host and the drives have a bus each: their ids would collide on one, and setpoints for three axes
//! at 1 kHz fill most of a bus.

use canter_shared::wire::frame::Frame;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;

use crate::node::SharedNode;
use crate::now;
use crate::port::{CanReceive, CanTransmit};

/// How the tasks wake each other.
#[derive(Default)]
pub struct Signals {
    /// For the transmit task: the node may have something to send.
    pub(crate) transmit: Signal<CriticalSectionRawMutex, ()>,
    /// For the drives' transmit task: a tick has left something to send.
    pub(crate) drives: Signal<CriticalSectionRawMutex, ()>,
    /// For the 1 kHz task: the next tick has moved.
    pub(crate) retimed: Signal<CriticalSectionRawMutex, ()>,
    /// For the planning task: there is something to plan.
    pub(crate) plan: Signal<CriticalSectionRawMutex, ()>,
    /// For the storage task: there is something to save.
    pub(crate) save: Signal<CriticalSectionRawMutex, ()>,
}

impl Signals {
    /// Nobody is woken.
    pub const fn new() -> Self {
        Self {
            transmit: Signal::new(),
            drives: Signal::new(),
            retimed: Signal::new(),
            plan: Signal::new(),
            save: Signal::new(),
        }
    }
}

/// Hands every frame to the node.
pub async fn receive(node: &SharedNode, signals: &Signals, mut port: impl CanReceive) -> ! {
    loop {
        let received = port.receive().await;
        let (retimed, plans, saves) = node.lock(|node| {
            let mut node = node.borrow_mut();
            let before = node.next_tick();
            node.handle_frame(received.at, &received.frame);
            let retimed = node.next_tick() != before;
            (retimed, node.has_plan(), node.has_save())
        });
        if retimed {
            signals.retimed.signal(());
        }
        if plans {
            signals.plan.signal(());
        }
        if saves {
            signals.save.signal(());
        }
        signals.transmit.signal(());
    }
}

/// Sends whatever the node wants to be sent.
pub async fn transmit(node: &SharedNode, signals: &Signals, mut port: impl CanTransmit) -> ! {
    loop {
        while let Some(frame) = next(node) {
            port.transmit(&frame).await;
        }
        signals.transmit.wait().await;
    }
}

/// The lock ends here, before anybody waits for the hardware.
fn next(node: &SharedNode) -> Option<Frame> {
    node.lock(|node| node.borrow_mut().poll_transmit(now()))
}

/// Hands every frame of the drives' bus to the node. It runs at the 1 kHz task's priority, so that the next
/// tick knows what the drives have said.
pub async fn receive_drives(node: &SharedNode, mut port: impl CanReceive) -> ! {
    loop {
        let received = port.receive().await;
        node.lock(|node| node.borrow_mut().handle_drive_frame(&received.frame));
    }
}

/// Sends what a tick has left for the drives. It runs at the 1 kHz task's priority and right after it: the
/// first setpoint leaves some 10 us after the tick, the others as the bus takes them.
pub async fn transmit_drives(
    node: &SharedNode,
    signals: &Signals,
    mut port: impl CanTransmit,
) -> ! {
    loop {
        while let Some(frame) = node.lock(|node| node.borrow_mut().poll_drive_transmit()) {
            port.transmit(&frame).await;
        }
        signals.drives.wait().await;
    }
}
