//! A classic CAN data frame with an 11-bit id.

use embedded_can::StandardId;

/// The bytes that one classic CAN frame can carry.
pub const MAXIMUM_LENGTH: usize = 8;

/// A classic CAN data frame with an 11-bit id and up to 8 bytes.
///
/// canter sends nothing else: no remote frames, no 29-bit ids, no CAN FD. Whoever receives such
/// a frame from a bus drops it before it gets here.
///
/// Three whole words: those are copied as such.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(align(4))]
pub struct Frame {
    id: u16,
    length: u8,
    data: [u8; MAXIMUM_LENGTH],
}

impl Frame {
    /// A frame, or `None` where `data` is longer than 8 bytes or `id` wider than 11 bits.
    pub fn new(id: u16, data: &[u8]) -> Option<Self> {
        if id > StandardId::MAX.as_raw() {
            return None;
        }
        let mut bytes = [0; MAXIMUM_LENGTH];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id,
            length: data.len() as u8,
            data: bytes,
        })
    }

    /// The 11-bit id.
    pub const fn id(&self) -> u16 {
        self.id
    }

    /// The payload, 0 to 8 bytes.
    pub fn data(&self) -> &[u8] {
        self.data.get(..usize::from(self.length)).unwrap_or(&[])
    }

    /// The payload as one little-endian word; bytes that were not sent read as zero.
    pub const fn word(&self) -> u64 {
        u64::from_le_bytes(self.data)
    }

    /// A frame whose payload is the low `length` bytes of `word`, little-endian.
    ///
    /// `id` keeps its low 11 bits and `length` is cut to 8: both come from tables of ours, whose
    /// tests hold them to that.
    pub(crate) fn from_word(id: u16, word: u64, length: u8) -> Self {
        let length = length.min(MAXIMUM_LENGTH as u8);
        let mut data = word.to_le_bytes();
        for byte in data.iter_mut().skip(usize::from(length)) {
            *byte = 0;
        }
        Self {
            id: id & StandardId::MAX.as_raw(),
            length,
            data,
        }
    }
}

impl embedded_can::Frame for Frame {
    fn new(id: impl Into<embedded_can::Id>, data: &[u8]) -> Option<Self> {
        match id.into() {
            embedded_can::Id::Standard(id) => Frame::new(id.as_raw(), data),
            embedded_can::Id::Extended(_) => None,
        }
    }

    fn new_remote(_id: impl Into<embedded_can::Id>, _dlc: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        false
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> embedded_can::Id {
        embedded_can::Id::Standard(StandardId::new(self.id).unwrap_or(StandardId::ZERO))
    }

    fn dlc(&self) -> usize {
        usize::from(self.length)
    }

    fn data(&self) -> &[u8] {
        Frame::data(self)
    }
}
