//! The stored parameters: whatever a flash holds, what is read from it is in range, and what is saved
//! over it is what is read next.

use canter_shared::parameter::flash::{ERASED, MemoryFlash};
use canter_shared::parameter::store::{Image, Loaded, Store, StoredAxis};
use canter_shared::parameter::{Parameter, Values};

const AXES: usize = 3;
const PAGE: usize = 512;
const SLOT: usize = 2 * PAGE;

/// Bytes of a slot's header, as `parameter::store` describes it.
const HEADER: usize = 32;

type Flash = MemoryFlash<{ 2 * SLOT }, PAGE>;

/// Takes the bytes as what the slots hold: as they are, or as the bodies of slots that are whole, since
/// no chance finds a check of 32 bits.
pub fn run(data: &[u8]) {
    let [how, data @ ..] = data else {
        return;
    };
    let mut flash = Flash::new();
    match how % 4 {
        0 => put(&mut flash, 0, data),
        1 => put(&mut flash, 0, &whole(0, data)),
        2 => {
            let (first, second) = data.split_at(data.len() / 2);
            put(&mut flash, 0, &whole(u32::from(*how), first));
            put(&mut flash, SLOT, &whole(0, second));
        }
        _ => {
            // The newer one is broken in one byte.
            let [place, other, data @ ..] = data else {
                return;
            };
            put(&mut flash, SLOT, &whole(0, data));
            let older = load(&mut Store::new(flash.clone(), 0, SLOT as u32));
            let mut slot = whole(1, data);
            let place = usize::from(*place) % slot.len();
            slot[place] ^= *other;
            put(&mut flash, 0, &slot);
            let kept = load(&mut Store::new(flash.clone(), 0, SLOT as u32));
            // A slot that is not whole counts for nothing, and that of this body is the same.
            assert_eq!(kept, older);
        }
    }
    check(flash);
}

fn put(flash: &mut Flash, at: usize, bytes: &[u8]) {
    let slot = &mut flash.bytes_mut()[at..at + SLOT];
    for (place, byte) in slot.iter_mut().zip(bytes) {
        *place = *byte;
    }
}

fn load(store: &mut Store<Flash>) -> Loaded<AXES> {
    store.load()
}

fn check(flash: Flash) {
    let mut store = Store::new(flash, 0, SLOT as u32);
    let mut image = match load(&mut store) {
        Loaded::Image(image) => image,
        Loaded::Empty | Loaded::Lost => Image::new(),
    };
    for (index, stored) in image.iter().enumerate() {
        assert_ne!(stored.axis, 0);
        assert!(image[..index].iter().all(|other| other.axis != stored.axis));
        // They make settings, and each of them could be set as it is.
        let _ = stored.values.settings();
        for parameter in Parameter::ALL {
            let raw = stored.values.get(parameter);
            let again = stored.values.with(parameter, raw);
            assert_eq!(again.map(|(values, _)| values), Ok(stored.values), "{raw}");
        }
    }
    if image.is_empty() {
        let values = Values::defaults(1);
        image.push(StoredAxis { axis: 1, values }).expect("room");
    }
    store.save(&image).expect("a flash in memory keeps it");
    assert_eq!(load(&mut store), Loaded::Image(image.clone()));
    let before = *store.flash().bytes();
    store.save(&image).expect("it is there already");
    assert_eq!(before, *store.flash().bytes(), "it was written again");
}

/// A slot with a header that fits its body.
fn whole(generation: u32, body: &[u8]) -> Vec<u8> {
    let body = &body[..body.len().min(SLOT - HEADER)];
    let mut slot = b"cntr\x01\0\xFF\xFF".to_vec();
    slot.extend(generation.to_le_bytes());
    slot.extend((body.len() as u32).to_le_bytes());
    let check = crc(slot.iter().chain(body));
    slot.extend(check.to_le_bytes());
    slot.resize(HEADER, ERASED);
    slot.extend(body);
    slot
}

/// CRC-32 as of ISO-HDLC.
fn crc<'a>(bytes: impl Iterator<Item = &'a u8>) -> u32 {
    !bytes.fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg())
        })
    })
}
