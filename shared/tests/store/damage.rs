//! What is broken is not believed.

use super::cut::{Memory, SIZE, SLOT, START, image, store};
use canter_shared::parameter::store::{Image, Loaded, Store, StoreError};
use proptest::prelude::*;

/// Bytes of a slot that mean something: header without padding, and 3 axes of 142 bytes.
const HEADER: usize = 20;
const BODY: usize = 3 * 142;

/// The first slot's, where the first save goes.
fn meaningful() -> impl Iterator<Item = usize> {
    let start = START as usize;
    (start..start + HEADER).chain(start + 32..start + 32 + BODY)
}

fn saved(saves: u32) -> Memory {
    let mut store = store(Memory::new());
    for number in 0..saves {
        store.save(&image(number)).expect("it is kept");
    }
    store.flash().memory.clone()
}

fn load(memory: Memory) -> Loaded<3> {
    store(memory).load()
}

#[test]
fn every_flipped_bit_of_the_only_slot_is_noticed() {
    let memory = saved(1);
    assert_eq!(load(memory.clone()), Loaded::Image(image(0)));
    for byte in meaningful() {
        for bit in 0..8 {
            let mut flipped = memory.clone();
            flipped.bytes_mut()[byte] ^= 1 << bit;
            assert_eq!(load(flipped), Loaded::Lost, "byte {byte}, bit {bit}");
        }
    }
}

#[test]
fn with_the_newer_slot_broken_the_older_one_holds() {
    // The third save lies in the first slot again.
    let memory = saved(3);
    assert_eq!(load(memory.clone()), Loaded::Image(image(2)));
    for byte in meaningful() {
        let mut flipped = memory.clone();
        flipped.bytes_mut()[byte] ^= 0x10;
        assert_eq!(load(flipped), Loaded::Image(image(1)), "byte {byte}");
    }
}

#[test]
fn with_both_broken_it_is_said_and_a_save_mends_it() {
    let mut memory = saved(2);
    for slot in [START, START + SLOT] {
        memory.bytes_mut()[slot as usize + 40] ^= 1;
    }
    let mut store = store(memory);
    assert_eq!(store.load::<3>(), Loaded::Lost);
    store.save(&image(9)).expect("it is kept");
    assert_eq!(store.load(), Loaded::Image(image(9)));
}

#[test]
fn an_erased_flash_is_no_loss() {
    assert_eq!(load(Memory::new()), Loaded::Empty);
}

/// As a programmer leaves it that fills the gaps of an image.
#[test]
fn a_flash_of_zeros_is_no_loss_and_can_be_saved_to() {
    let mut memory = Memory::new();
    memory.bytes_mut().fill(0);
    let mut store = store(memory);
    assert_eq!(store.load::<3>(), Loaded::Empty);
    store.save(&image(9)).expect("it is kept");
    assert_eq!(store.load(), Loaded::Image(image(9)));
}

#[test]
fn what_does_not_fit_is_refused_and_what_was_there_stays() {
    let page = SLOT;
    let mut small = Store::new(saved(1), START, page);
    assert_eq!(small.load(), Loaded::Image(image(0)));
    let many: Image<4> = (1..=4)
        .map(|axis| canter_shared::parameter::store::StoredAxis {
            axis,
            ..image(5)[0]
        })
        .collect();
    let needed = Store::<Memory>::needed(4);
    assert_eq!(
        small.save(&many),
        Err(StoreError::TooLarge {
            needed,
            slot: page as usize
        })
    );
    assert_eq!(small.load(), Loaded::Image(image(0)));
}

/// Not an error: whoever asks again and again must not wear the flash out.
#[test]
fn what_is_saved_already_is_not_written_again() {
    let mut store = store(saved(2));
    store.save(&image(1)).expect("it is kept");
    assert_eq!(store.flash().done, 0);
    store.save(&image(2)).expect("it is kept");
    assert!(store.flash().done > 0);
}

proptest! {
    /// Whatever a flash holds, it is read without a panic, and nearly never believed.
    #[test]
    fn any_bytes_are_read(bytes in prop::collection::vec(any::<u8>(), SIZE)) {
        let mut memory = Memory::new();
        memory.bytes_mut().copy_from_slice(&bytes);
        prop_assert_eq!(load(memory), Loaded::Lost);
    }

    /// Some bytes of what was saved are overwritten.
    #[test]
    fn bytes_that_were_changed_never_make_other_values(
        place in 0usize..SIZE - 16, bytes in any::<[u8; 16]>(), saves in 1u32..4,
    ) {
        let mut memory = saved(saves);
        memory.bytes_mut()[place..place + 16].copy_from_slice(&bytes);
        let loaded = load(memory);
        let known = (0..saves).any(|number| loaded == Loaded::Image(image(number)));
        prop_assert!(known || loaded == Loaded::Lost, "{:?}", loaded);
    }
}
