//! The planning task: changes of motion, worked out outside of the node's lock.

use canter_shared::time::Ticks;

use crate::bus::Signals;
use crate::node::SharedNode;

/// How many ticks ahead a change of motion takes over. At the least one whole tick then lies between
/// taking a plan and the tick that needs it, at 170 MHz and about 1.3 cycles to an instruction:
///
/// ```text
/// one plan, at most                    80 000 instructions = 0.61 ms
/// three axes' tick                  3 x 1 500 instructions = 0.03 ms
/// frames: 1 Mbit/s brings 10 commands of 8 bytes in 1 ms,
///         to one axis each         10 x 2 000 instructions = 0.15 ms
///                                                            0.79 ms
/// ```
///
/// What makes it later still (three axes each deciding about a flood of broadcasts) makes a plan
/// late, and a late plan is made again for a later tick.
pub const LEAD: Ticks = Ticks(1);

/// Plans what waits, whenever a frame or a tick has left something.
pub async fn run(node: &SharedNode, signals: &Signals) -> ! {
    loop {
        // A plan is too large for a task's memory; it lives on the stack and never across an await.
        while let Some(plan) = node.lock(|node| node.borrow_mut().take_plan(LEAD)) {
            let finished = plan.work();
            node.lock(|node| node.borrow_mut().commit(&finished));
            signals.transmit.signal(());
        }
        signals.plan.wait().await;
    }
}
