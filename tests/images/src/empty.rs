//! What a tick takes of a node without any axis, to tell an axis's own from.

use core::hint::black_box;

use canter_shared::drive::simulated::Simulated;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::LocalTime;

use crate::{count, report};

/// Reports it as `node.tick_empty`: the first tick, which divides for its number, left out.
pub fn measure() {
    let mut node: Node<Simulated, 1> = Node::new(Identity {
        chip: [0; 12],
        firmware: [0; 3],
        board: Board::Emulated,
    });
    node.tick(LocalTime(0));
    let now = black_box(node.next_tick());
    report("node.tick_empty", count(|| node.tick(now).len()));
}
