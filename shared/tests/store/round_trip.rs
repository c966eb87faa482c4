//! What is saved comes back as it was.

use super::cut::{Memory, store};
use canter_shared::parameter::store::{Image, Loaded, StoredAxis};
use canter_shared::parameter::{Parameter, Values};
use proptest::prelude::*;

fn values(axis: u8) -> impl Strategy<Value = Values> {
    let parts = prop::collection::vec(0.0..=1.0f64, Parameter::COUNT);
    parts.prop_map(move |parts| {
        let mut values = Values::defaults(axis);
        for (parameter, part) in Parameter::ALL.into_iter().zip(parts) {
            let entry = parameter.entry();
            let raw = entry.minimum + ((entry.maximum - entry.minimum) as f64 * part) as i64;
            // What contradicts another one is left as it is.
            if let Ok((changed, _)) = values.with(parameter, raw) {
                values = changed;
            }
        }
        values
    })
}

proptest! {
    #[test]
    fn every_value_comes_back(
        (first, second, third) in (values(1), values(63), values(7)),
        saves in 1usize..5,
    ) {
        let mut store = store(Memory::new());
        let axes = [(1, first), (63, second), (7, third)];
        let image: Image<3> = axes
            .map(|(axis, values)| StoredAxis { axis, values })
            .into_iter()
            .collect();
        for count in 0..=saves {
            let mut other = image.clone();
            other.truncate(count % 3);
            store.save(&other).expect("it is kept");
            store.save(&image).expect("it is kept");
            prop_assert_eq!(store.load(), Loaded::Image(image.clone()));
        }
        // A node with room for fewer reads those that it has room for.
        let mut fewer: Image<2> = Image::new();
        fewer.extend(image.iter().take(2).copied());
        prop_assert_eq!(store.load(), Loaded::Image(fewer));
    }
}
