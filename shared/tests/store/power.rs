//! The power goes at every operation of a save, and leaves every operation half done.

use super::cut::{Cut, Memory, SLOT, START, Torn, image, store};
use canter_shared::parameter::store::{Image, Loaded, Store};
use proptest::prelude::*;

/// How many operations a save is.
fn operations(memory: &Memory, number: u32) -> usize {
    let mut store = store(memory.clone());
    store.save(&image(number)).expect("it is kept");
    store.flash().done
}

/// What is read after the power has gone in operation `at` of saving `new`.
fn cut(memory: &Memory, new: &Image<3>, at: usize, torn: Torn) -> (Memory, Loaded<3>) {
    let mut store = store(memory.clone());
    store.flash_mut().left = Some(at);
    store.flash_mut().torn = torn;
    assert!(store.save(new).is_err(), "the power went in operation {at}");
    let memory = store.flash().memory.clone();
    let mut again = Store::new(Cut::new(memory.clone()), START, SLOT);
    (memory, again.load())
}

fn ways() -> impl Iterator<Item = Torn> {
    let patterns = [
        0x0000_0000_FFFF_FFFF,
        0x5555_5555_5555_5555,
        0xAAAA_AAAA_AAAA_AAAA,
        0x0123_4567_89AB_CDEF,
        0xFFFF_FFFF_FFFF_FFFE,
        1,
    ];
    [Torn::Nothing, Torn::All]
        .into_iter()
        .chain(patterns.map(Torn::Bits))
}

/// After several saves, so that both slots are in use, and with each of them the newest.
#[test]
fn a_power_cut_in_any_operation_leaves_the_old_or_the_new() {
    for before in 1..=4 {
        let mut saved = store(Memory::new());
        for number in 0..before {
            saved.save(&image(number)).expect("it is kept");
        }
        let memory = saved.flash().memory.clone();
        let (old, new) = (image(before - 1), image(before));
        let count = operations(&memory, before);
        // Two pages erased, 4 words of header and 100 of body: 3 axes of 261 bytes.
        assert_eq!(count, 2 + 4 + 100);
        let mut kept_old = 0;
        for at in 1..=count {
            for torn in ways() {
                let (_, loaded) = cut(&memory, &new, at, torn);
                assert!(
                    loaded == Loaded::Image(old.clone()) || loaded == Loaded::Image(new.clone()),
                    "{before} saves, operation {at}, {torn:?}: {loaded:?}"
                );
                kept_old += usize::from(loaded == Loaded::Image(old.clone()));
                // Only the last word of the header makes it the new one; what stands behind it in
                // the last word is padding, and is erased anyhow.
                let new_at = loaded == Loaded::Image(new.clone());
                assert!(!new_at || at >= count - 2, "operation {at}, {torn:?}");
            }
        }
        assert!(kept_old > 0);
    }
}

/// Nothing was saved before: then nothing is there, or it is said that something is lost, until
/// the first save is whole.
#[test]
fn a_power_cut_in_the_first_save_never_leaves_a_part_of_it() {
    let memory = Memory::new();
    for at in 1..=operations(&memory, 0) {
        for torn in ways() {
            let (_, loaded) = cut(&memory, &image(0), at, torn);
            let nothing = matches!(loaded, Loaded::Empty | Loaded::Lost);
            assert!(
                nothing || loaded == Loaded::Image(image(0)),
                "{at}: {loaded:?}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Saves of which any may be cut anywhere, one after another on the same flash.
    #[test]
    fn a_life_of_saves_and_power_cuts_never_mixes(
        saves in prop::collection::vec((any::<bool>(), 1usize..70, any::<u64>()), 1..40),
    ) {
        let mut memory = Memory::new();
        // The first is whole, so that there is something to lose.
        let mut first = store(memory.clone());
        first.save(&image(0)).expect("it is kept");
        memory.clone_from(&first.flash().memory);
        let mut kept = image(0);
        for (number, (whole, at, bits)) in (1u32..).zip(saves) {
            let new = image(number);
            let mut store = store(memory.clone());
            if !whole {
                store.flash_mut().left = Some(at);
                store.flash_mut().torn = Torn::Bits(bits);
            }
            let saved = store.save(&new);
            memory.clone_from(&store.flash().memory);
            let loaded = Store::new(Cut::new(memory.clone()), START, SLOT).load();
            if saved.is_ok() {
                prop_assert_eq!(&loaded, &Loaded::Image(new.clone()));
            }
            if loaded == Loaded::Image(new.clone()) {
                kept = new;
            } else {
                prop_assert_eq!(loaded, Loaded::Image(kept.clone()));
            }
        }
    }
}
