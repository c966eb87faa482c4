//! The node that the tasks share.

use core::cell::RefCell;
use core::sync::atomic::{Ordering, compiler_fence};

use canter_shared::drive::link::DriveLink;
use canter_shared::node::restart::Restart;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::parameter::Values;
use canter_shared::parameter::store::{Loaded, StoredAxis};
use canter_shared::wire::id::{AxisId, LAST_AXIS};
use cortex_m::register::{basepri, basepri_max};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use static_cell::StaticCell;

use crate::priority;

/// Axes of one node: a leg's worth.
pub const AXES: usize = 3;

/// The id of a node's first axis; the others follow it. `CANTER_FIRST_AXIS=4 cargo build ...`
/// builds the second leg's image.
pub const FIRST_AXIS: u8 = match option_env!("CANTER_FIRST_AXIS") {
    Some(text) => {
        let id = number(text);
        assert!(
            id >= 1 && id <= 64 - AXES as u8,
            "CANTER_FIRST_AXIS must be a number from 1 to 61: a node's three axes have ids up to 63"
        );
        id
    }
    None => 1,
};

/// This firmware's version, as the scan shows it.
pub const VERSION: [u8; 3] = [
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
];

/// A number of up to two decimal digits; 0 for anything else.
const fn number(text: &str) -> u8 {
    match *text.as_bytes() {
        [ones @ b'0'..=b'9'] => ones - b'0',
        [tens @ b'0'..=b'9', ones @ b'0'..=b'9'] => (tens - b'0') * 10 + (ones - b'0'),
        _ => 0,
    }
}

/// The node behind its lock.
///
/// Whoever holds the lock holds off the 1 kHz task, but neither the CAN interrupt nor the time
/// driver, so frames are still taken and stamped. Nobody holds it for long: motion is planned
/// outside of it (`planning`), and what is done inside is counted by `tests/run target`: at most
/// 2000 instructions for a frame to one axis and 4000 to copy a motion out or in, 30 us at 170 MHz
/// and about 1.3 cycles each. By so much a tick may be late, which is jitter on the drive port and
/// never a wrong position: a setpoint is evaluated for its tick, not for the instant of the call.
pub type SharedNode = Mutex<CeilingMutex, RefCell<Node<DriveLink, AXES>>>;

/// Makes the node in its place, with all axes disabled, with the ids, the parameters and the drives that
/// were saved; simulated drives at position zero where none were. Where nothing was, ids follow
/// [`FIRST_AXIS`]; where it is lost, that is a fault, and so is that the node began anew by itself.
///
/// In its place, and with one axis at a time on the stack: an axis has some 7 KiB, and copies of all of
/// them would be as large as the stack.
///
/// # Panics
/// Never: the axes fit by count, and no id is taken that another has.
pub fn begin(
    place: &'static StaticCell<SharedNode>,
    chip: [u8; 12],
    board: Board,
    loaded: &Loaded<AXES>,
    restart: Option<Restart>,
) -> &'static SharedNode {
    let shared = place.init_with(|| {
        Mutex::new(RefCell::new(Node::new(Identity {
            chip,
            firmware: VERSION,
            board,
        })))
    });
    let node = shared.get_mut().get_mut();
    let kept = match loaded {
        Loaded::Image(image) => image.as_slice(),
        Loaded::Empty | Loaded::Lost => &[],
    };
    for place in 0..AXES {
        match kept.get(place) {
            Some(stored) => add(node, stored.axis, &stored.values),
            // An image of an older firmware may have had fewer axes.
            None => {
                let id = free_id(FIRST_AXIS + place as u8, kept);
                add(node, id, &Values::defaults(id));
            }
        }
    }
    if let Some(restart) = restart {
        node.restart_after(restart);
    }
    if *loaded == Loaded::Lost {
        node.lose_parameters();
    }
    shared
}

/// Never inlined: what it takes of the stack is to be given back before the next one.
#[inline(never)]
fn add(node: &mut Node<DriveLink, AXES>, id: u8, values: &Values) {
    let drive = DriveLink::new(&values.drive());
    let added = AxisId::new(id).map(|axis| node.add_axis_with_values(axis, values, drive));
    assert!(matches!(added, Some(Ok(()))), "an axis was refused");
}

/// This id, or the next one that none of those kept has.
fn free_id(wanted: u8, kept: &[StoredAxis]) -> u8 {
    let mut ids = (wanted..=LAST_AXIS).chain(1..wanted);
    let is_free = |id: &u8| kept.iter().all(|stored| stored.axis != *id);
    ids.find(is_free).unwrap_or(wanted)
}

/// A lock that raises the processor's priority to the 1 kHz task's while it is held.
///
/// A critical section would do too, but it would also hold off the CAN interrupt: a SYNC that
/// comes meanwhile would be stamped late and bend the clock's discipline.
#[derive(Debug)]
pub struct CeilingMutex(());

// SAFETY: the lock excludes whoever runs at or below the ceiling, and nobody above it takes it:
// only `control::run` and the tasks of the drives' bus (at the ceiling) and `bus::receive`,
// `bus::transmit`, `planning::run` and `storage::run` (below it) do, at the priorities of `crate::priority`. A nested lock keeps the ceiling until the outer one ends.
unsafe impl RawMutex for CeilingMutex {
    const INIT: Self = Self(());

    fn lock<R>(&self, f: impl FnOnce() -> R) -> R {
        let before = basepri::read();
        basepri_max::write(priority::register(priority::CONTROL));
        // The register write is no memory access to the compiler: keep the accesses inside.
        compiler_fence(Ordering::SeqCst);
        let result = f();
        compiler_fence(Ordering::SeqCst);
        // SAFETY: this restores what this call found, so an outer lock stays in force.
        unsafe { basepri::write(before) };
        result
    }
}
