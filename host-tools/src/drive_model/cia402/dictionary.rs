//! The object dictionary of a CANopen drive, as far as it can be set.

use std::collections::BTreeMap;

/// A PDO that is off.
const OFF: u32 = 1 << 31;

/// Abort codes (CiA 301, 7.2.4.3.17).
const NO_OBJECT: u32 = 0x0602_0000;
const NO_SUBINDEX: u32 = 0x0609_0011;
const WRONG_LENGTH: u32 = 0x0607_0010;
const NOT_NOW: u32 = 0x0800_0022;
const CANNOT_MAP: u32 = 0x0604_0041;
const OUT_OF_RANGE: u32 = 0x0609_0030;

/// What can be mapped into a PDO: object, subindex and bits.
const RECEIVABLE: [u32; 3] = [0x6040_0010, 0x607A_0020, 0x60B2_0010];
const TRANSMITTABLE: [u32; 2] = [0x6041_0010, 0x6064_0020];

/// Objects by index and subindex, each with its bytes and its value.
#[derive(Debug)]
pub(super) struct Dictionary {
    objects: BTreeMap<(u16, u8), (u8, u32)>,
}

impl Dictionary {
    /// As it is after a start: PDOs with the mapping of CiA 402-3, sent when something changes.
    pub(super) fn new(node: u8) -> Self {
        let node = u32::from(node);
        let objects = [
            ((0x1017, 0), (2, 0)),
            ((0x1400, 1), (4, 0x200 + node)),
            ((0x1400, 2), (1, 255)),
            ((0x1600, 0), (1, 1)),
            ((0x1600, 1), (4, RECEIVABLE[0])),
            ((0x1600, 2), (4, 0)),
            ((0x1600, 3), (4, 0)),
            ((0x1800, 1), (4, 0x180 + node)),
            ((0x1800, 2), (1, 255)),
            ((0x1A00, 0), (1, 1)),
            ((0x1A00, 1), (4, TRANSMITTABLE[0])),
            ((0x1A00, 2), (4, 0)),
            ((0x6040, 0), (2, 0)),
            ((0x6060, 0), (1, 0)),
            ((0x60C2, 1), (1, 0)),
            ((0x60C2, 2), (1, 0xFD)),
        ];
        Self {
            objects: objects.into_iter().collect(),
        }
    }

    fn get(&self, index: u16, subindex: u8) -> u32 {
        let object = self.objects.get(&(index, subindex));
        object.map_or(0, |(_, value)| *value)
    }

    /// Writes an object of so many bytes.
    ///
    /// # Errors
    /// The abort code.
    pub(super) fn write(
        &mut self,
        index: u16,
        subindex: u8,
        bytes: u8,
        value: u32,
    ) -> Result<(), u32> {
        let Some((length, _)) = self.objects.get(&(index, subindex)) else {
            let known = self.objects.keys().any(|(known, _)| *known == index);
            return Err(if known { NO_SUBINDEX } else { NO_OBJECT });
        };
        if *length != bytes {
            return Err(WRONG_LENGTH);
        }
        let is_off = |index| self.get(index, 1) & OFF != 0;
        match (index, subindex) {
            // A mapping changes only while its PDO is off, and its entries only while they are none.
            (0x1600, _) if !is_off(0x1400) => return Err(NOT_NOW),
            (0x1A00, _) if !is_off(0x1800) => return Err(NOT_NOW),
            (0x1600 | 0x1A00, 1..) if self.get(index, 0) != 0 => return Err(NOT_NOW),
            (0x1600, 1..) if !RECEIVABLE.contains(&value) => return Err(CANNOT_MAP),
            (0x1A00, 1..) if !TRANSMITTABLE.contains(&value) => return Err(CANNOT_MAP),
            (0x6060, 0) if value != 8 => return Err(OUT_OF_RANGE),
            (0x60C2, 1) if value == 0 => return Err(OUT_OF_RANGE),
            _ => {}
        }
        self.objects.insert((index, subindex), (bytes, value));
        Ok(())
    }

    /// Whether it is in cyclic synchronous position mode, with a period.
    pub(super) fn is_synchronous(&self) -> bool {
        self.get(0x6060, 0) == 8 && self.get(0x60C2, 1) > 0 && self.get(0x60C2, 2) == 0xFD
    }

    /// How many bytes of controlword, target and perhaps torque offset come in RPDO1 and are taken at the
    /// SYNC; `None` where it is not so.
    pub(super) fn listens_at_sync(&self) -> Option<usize> {
        let objects = if self.get(0x1600, 0) == 3 { 3 } else { 2 };
        let mapped = RECEIVABLE.get(..objects)?;
        let bits: u32 = mapped.iter().map(|object| object & 0xFF).sum();
        self.is_set_up(0x1400, 0x1600, mapped)
            .then_some(bits as usize / 8)
    }

    /// Whether statusword and place go out in TPDO1 at the SYNC.
    pub(super) fn tells_at_sync(&self) -> bool {
        self.is_set_up(0x1800, 0x1A00, &TRANSMITTABLE)
    }

    fn is_set_up(&self, communication: u16, mapping: u16, wanted: &[u32]) -> bool {
        self.get(communication, 1) & OFF == 0
            && self.get(communication, 2) == 1
            && self.get(mapping, 0) as usize == wanted.len()
            && (1..)
                .zip(wanted)
                .all(|(entry, object)| self.get(mapping, entry) == *object)
    }

    /// Ticks between two setpoints.
    pub(super) fn period(&self) -> u32 {
        self.get(0x60C2, 1).max(1)
    }

    /// Ticks between two heartbeats.
    pub(super) fn heartbeat_period(&self) -> Option<u32> {
        Some(self.get(0x1017, 0)).filter(|period| *period > 0)
    }
}
