//! The objects of a CiA 402 drive that are set up, and the frames that carry them.
//!
//! Ids and mapping: CANopenNode, 301/CO_driver.h; ros2_canopen, canopen_tests/config/cia402; CiA 301 for
//! the SDO protocol (7.2.4), CiA 402-2 for the objects.

/// Network management, to all nodes.
pub const NMT: u16 = 0x000;
/// The frame at which setpoints are taken and places are told.
pub const SYNC: u16 = 0x080;
/// A drive's complaint: `EMCY + node`, and so on below.
pub const EMCY: u16 = 0x080;
/// Statusword and position.
pub const TPDO1: u16 = 0x180;
/// Controlword and target position.
pub const RPDO1: u16 = 0x200;
/// A drive's answer about an object.
pub const SDO_ANSWER: u16 = 0x580;
/// A word about an object.
pub const SDO_REQUEST: u16 = 0x600;
/// A drive's state, and at 0 that it has begun anew.
pub const HEARTBEAT: u16 = 0x700;

/// NMT: a node shall take and send PDOs.
pub const NMT_START: u8 = 0x01;
/// NMT: a node shall take SDOs only.
pub const NMT_PRE_OPERATIONAL: u8 = 0x80;
/// The state in a heartbeat of a node that began anew.
pub const BOOT_UP: u8 = 0x00;
/// The state in a heartbeat of a node that takes and sends PDOs.
pub const OPERATIONAL: u8 = 0x05;

/// The first byte of the answer to a write that was done.
pub const SDO_DONE: u8 = 0x60;
/// The first byte of a refusal.
pub const SDO_ABORT: u8 = 0x80;

/// A write to an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Write {
    index: u16,
    subindex: u8,
    bytes: u8,
    value: Value,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Value {
    Number(u32),
    /// This with the node's id added.
    WithNode(u32),
    /// The period of the setpoints, in ms.
    Period,
}

const fn write(index: u16, subindex: u8, bytes: u8, value: u32) -> Write {
    Write {
        index,
        subindex,
        bytes,
        value: Value::Number(value),
    }
}

const fn with_node(index: u16, subindex: u8, value: u32) -> Write {
    Write {
        index,
        subindex,
        bytes: 4,
        value: Value::WithNode(value),
    }
}

/// A PDO is off while its mapping changes.
const OFF: u32 = 1 << 31;

/// Transmission type: at each SYNC.
const EACH_SYNC: u32 = 1;

/// All that is set, in this order, while the drive takes SDOs only.
pub const SETUP: [Write; 19] = [
    // No torque, whatever was before.
    write(0x6040, 0, 2, 0),
    with_node(0x1400, 1, OFF | RPDO1 as u32),
    write(0x1600, 0, 1, 0),
    write(0x1600, 1, 4, 0x6040_0010),
    write(0x1600, 2, 4, 0x607A_0020),
    write(0x1600, 0, 1, 2),
    write(0x1400, 2, 1, EACH_SYNC),
    with_node(0x1400, 1, RPDO1 as u32),
    with_node(0x1800, 1, OFF | TPDO1 as u32),
    write(0x1A00, 0, 1, 0),
    write(0x1A00, 1, 4, 0x6041_0010),
    write(0x1A00, 2, 4, 0x6064_0020),
    write(0x1A00, 0, 1, 2),
    write(0x1800, 2, 1, EACH_SYNC),
    with_node(0x1800, 1, TPDO1 as u32),
    // 8: cyclic synchronous position.
    write(0x6060, 0, 1, 8),
    Write {
        index: 0x60C2,
        subindex: 1,
        bytes: 1,
        value: Value::Period,
    },
    // 10^-3 s.
    write(0x60C2, 2, 1, -3i8 as u8 as u32),
    // So that one that begins anew, or leaves the operational state, is noticed between two SYNCs.
    write(0x1017, 0, 2, 100),
];

impl Write {
    /// The payload of an expedited download, as a little-endian word.
    pub fn payload(&self, node: u8, period: u8) -> u64 {
        let value = match self.value {
            Value::Number(value) => value,
            Value::WithNode(value) => value | u32::from(node),
            Value::Period => u32::from(period),
        };
        // 0x23 for four bytes, 0x27, 0x2B, 0x2F for three to one.
        let specifier = 0x23 | (4 - self.bytes.clamp(1, 4)) << 2;
        u64::from(specifier) | self.place() << 8 | u64::from(value) << 32
    }

    /// Index and subindex, as they stand in bytes 1 to 3.
    pub fn place(&self) -> u64 {
        u64::from(self.index) | u64::from(self.subindex) << 16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_are_as_the_layout_says() {
        let payload = |step: usize| SETUP[step].payload(5, 2).to_le_bytes();
        assert_eq!(payload(0), [0x2B, 0x40, 0x60, 0x00, 0x00, 0x00, 0x00, 0x00]);
        assert_eq!(payload(1), [0x23, 0x00, 0x14, 0x01, 0x05, 0x02, 0x00, 0x80]);
        assert_eq!(payload(2), [0x2F, 0x00, 0x16, 0x00, 0x00, 0x00, 0x00, 0x00]);
        assert_eq!(payload(3), [0x23, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60]);
        assert_eq!(payload(4), [0x23, 0x00, 0x16, 0x02, 0x20, 0x00, 0x7A, 0x60]);
        assert_eq!(payload(7), [0x23, 0x00, 0x14, 0x01, 0x05, 0x02, 0x00, 0x00]);
        assert_eq!(
            payload(11),
            [0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60]
        );
        assert_eq!(
            payload(14),
            [0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x00]
        );
        assert_eq!(
            payload(15),
            [0x2F, 0x60, 0x60, 0x00, 0x08, 0x00, 0x00, 0x00]
        );
        assert_eq!(
            payload(16),
            [0x2F, 0xC2, 0x60, 0x01, 0x02, 0x00, 0x00, 0x00]
        );
        assert_eq!(
            payload(17),
            [0x2F, 0xC2, 0x60, 0x02, 0xFD, 0x00, 0x00, 0x00]
        );
        assert_eq!(
            payload(18),
            [0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0x00, 0x00]
        );
    }
}
