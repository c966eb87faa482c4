//! Who is on the bus.

/// Somebody with a CAN controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Station {
    /// The host.
    Host,
    /// The node of this number, counted from 0 in the order of the configuration.
    Node(usize),
    /// A device that is not ours: it sends what is forged and what a babbler babbles, and is on
    /// the bus only while it has something to send.
    Stranger,
}

impl Station {
    /// Its place among `nodes` nodes, the host and the stranger; none for a node that is not there.
    pub(super) fn place(self, nodes: usize) -> Option<usize> {
        match self {
            Self::Host => Some(0),
            Self::Node(node) => (node < nodes).then_some(node + 1),
            Self::Stranger => Some(nodes + 1),
        }
    }

    /// Who has that place.
    pub(super) const fn at(place: usize, nodes: usize) -> Self {
        match place {
            0 => Self::Host,
            place if place <= nodes => Self::Node(place - 1),
            _ => Self::Stranger,
        }
    }
}
