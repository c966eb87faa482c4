//! Who is on the bus.

/// Somebody with a CAN controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Station {
    /// The host.
    Host,
    /// The node of this number, counted from 0 in the order of the configuration.
    Node(usize),
    /// A device that is not ours: it sends what is forged and what a babbler babbles, and
    /// acknowledges nothing until it has sent its first frame.
    Stranger,
}
