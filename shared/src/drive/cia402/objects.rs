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
/// Controlword and target position, and the torque offset where the drive takes one.
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

/// A write to an object: an expedited download.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Write {
    /// Specifier, index and subindex, as they stand in bytes 0 to 3.
    head: u32,
    value: u32,
    with: With,
}

/// What is set in a value besides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum With {
    Nothing,
    /// The drive's id.
    Node,
    /// The period of the setpoints, in ms.
    Period,
    /// A one where RPDO1 has a torque offset.
    Torque,
    /// Nothing, and only where RPDO1 has a torque offset is it written at all.
    TorqueOnly,
}

/// What of the set-up is not the same for every drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// The drive's id.
    pub node: u8,
    /// Between two setpoints, in ms.
    pub period: u8,
    /// Whether RPDO1 has the torque offset, which is optional in CiA 402.
    pub torque: bool,
}

const fn write(index: u16, subindex: u8, bytes: u32, value: u32) -> Write {
    write_with(With::Nothing, index, subindex, bytes, value)
}

const fn write_with(with: With, index: u16, subindex: u8, bytes: u32, value: u32) -> Write {
    // 0x23 for four bytes, 0x27, 0x2B, 0x2F for three to one.
    let specifier = 0x23 | (4 - bytes) << 2;
    Write {
        head: specifier | (index as u32) << 8 | (subindex as u32) << 24,
        value,
        with,
    }
}

/// A PDO is off while its mapping changes.
const OFF: u32 = 1 << 31;

/// Transmission type: at each SYNC.
const EACH_SYNC: u32 = 1;

/// All that is set, in this order, while the drive takes SDOs only.
pub const SETUP: [Write; 20] = [
    // No torque, whatever was before.
    write(0x6040, 0, 2, 0),
    write_with(With::Node, 0x1400, 1, 4, OFF | RPDO1 as u32),
    write(0x1600, 0, 1, 0),
    write(0x1600, 1, 4, 0x6040_0010),
    write(0x1600, 2, 4, 0x607A_0020),
    write_with(With::TorqueOnly, 0x1600, 3, 4, 0x60B2_0010),
    // Two objects, or three.
    write_with(With::Torque, 0x1600, 0, 1, 2),
    write(0x1400, 2, 1, EACH_SYNC),
    write_with(With::Node, 0x1400, 1, 4, RPDO1 as u32),
    write_with(With::Node, 0x1800, 1, 4, OFF | TPDO1 as u32),
    write(0x1A00, 0, 1, 0),
    write(0x1A00, 1, 4, 0x6041_0010),
    write(0x1A00, 2, 4, 0x6064_0020),
    write(0x1A00, 0, 1, 2),
    write(0x1800, 2, 1, EACH_SYNC),
    write_with(With::Node, 0x1800, 1, 4, TPDO1 as u32),
    // 8: cyclic synchronous position.
    write(0x6060, 0, 1, 8),
    write_with(With::Period, 0x60C2, 1, 1, 0),
    // 10^-3 s.
    write(0x60C2, 2, 1, -3i8 as u8 as u32),
    // So that one that begins anew, or leaves the operational state, is noticed between two SYNCs.
    write(0x1017, 0, 2, 100),
];

impl Write {
    /// Whether this drive gets it.
    pub fn is_for(&self, setup: Setup) -> bool {
        setup.torque || self.with != With::TorqueOnly
    }

    /// The payload, as a little-endian word.
    pub fn payload(&self, setup: Setup) -> u64 {
        let with = match self.with {
            With::Nothing | With::TorqueOnly => 0,
            With::Node => setup.node,
            With::Period => setup.period,
            With::Torque => u8::from(setup.torque),
        };
        u64::from(self.head) | u64::from(self.value | u32::from(with)) << 32
    }

    /// Index and subindex, as they stand in bytes 1 to 3 of a frame's first word.
    pub fn place(&self) -> u32 {
        self.head >> 8
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    /// The payloads that a drive gets, in their order.
    fn payloads(torque: bool) -> Vec<[u8; 8]> {
        let setup = Setup {
            node: 5,
            period: 2,
            torque,
        };
        SETUP
            .iter()
            .filter(|write| write.is_for(setup))
            .map(|write| write.payload(setup).to_le_bytes())
            .collect()
    }

    #[test]
    fn writes_are_as_the_layout_says() {
        let payloads = payloads(false);
        let wanted = [
            (0, [0x2B, 0x40, 0x60, 0x00, 0x00, 0x00, 0x00, 0x00]),
            (1, [0x23, 0x00, 0x14, 0x01, 0x05, 0x02, 0x00, 0x80]),
            (2, [0x2F, 0x00, 0x16, 0x00, 0x00, 0x00, 0x00, 0x00]),
            (3, [0x23, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60]),
            (4, [0x23, 0x00, 0x16, 0x02, 0x20, 0x00, 0x7A, 0x60]),
            (5, [0x2F, 0x00, 0x16, 0x00, 0x02, 0x00, 0x00, 0x00]),
            (7, [0x23, 0x00, 0x14, 0x01, 0x05, 0x02, 0x00, 0x00]),
            (11, [0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60]),
            (14, [0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x00]),
            (15, [0x2F, 0x60, 0x60, 0x00, 0x08, 0x00, 0x00, 0x00]),
            (16, [0x2F, 0xC2, 0x60, 0x01, 0x02, 0x00, 0x00, 0x00]),
            (17, [0x2F, 0xC2, 0x60, 0x02, 0xFD, 0x00, 0x00, 0x00]),
            (18, [0x2B, 0x17, 0x10, 0x00, 0x64, 0x00, 0x00, 0x00]),
        ];
        for (step, payload) in wanted {
            assert_eq!(payloads[step], payload, "{step}");
        }
        assert_eq!(payloads.len(), 19);
    }

    #[test]
    fn a_torque_offset_is_a_third_object_of_rpdo1_and_nothing_else() {
        let mut with = payloads(true);
        assert_eq!(
            with.remove(5),
            [0x23, 0x00, 0x16, 0x03, 0x10, 0x00, 0xB2, 0x60]
        );
        assert_eq!(with[5], [0x2F, 0x00, 0x16, 0x00, 0x03, 0x00, 0x00, 0x00]);
        with[5][4] = 2;
        assert_eq!(with, payloads(false));
    }
}
