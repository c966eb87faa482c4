//! The storage task: parameters into flash, whenever the node has some to save.

use canter_shared::parameter::store::{Loaded, Store};
use embedded_storage::nor_flash::NorFlash;

use crate::bus::Signals;
use crate::node::{AXES, SharedNode};

/// Two slots of `slot` bytes each, from `start` on in a flash.
pub fn store<F: NorFlash>(flash: F, start: u32, slot: u32) -> Store<F> {
    assert!(
        Store::<F>::needed(AXES) <= slot as usize,
        "a slot must hold a node's parameters"
    );
    Store::new(flash, start, slot)
}

/// What the store held when the board started.
pub fn load<F: NorFlash>(store: &mut Store<F>) -> Loaded<AXES> {
    store.load()
}

/// Writes what is to be saved, and has those answered who asked for it.
///
/// To erase and to write takes tens of milliseconds, in which nothing else of this priority runs: so
/// nothing else has it. The node is saved only while all of its axes are without torque.
pub async fn run<F: NorFlash>(node: &SharedNode, signals: &Signals, mut store: Store<F>) -> ! {
    loop {
        // An image is too large for a task's memory; it lives on the stack and never across an await.
        while let Some(image) = node.lock(|node| node.borrow_mut().take_save()) {
            let kept = store.save(&image).is_ok();
            node.lock(|node| node.borrow_mut().saved(&image, kept));
            signals.transmit.signal(());
        }
        signals.save.wait().await;
    }
}
