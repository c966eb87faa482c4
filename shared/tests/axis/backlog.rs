//! A node that is behind with its frames: their times are old, and ticks have gone on meanwhile.

use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::{BusTime, LocalTime};
use canter_shared::units::Position;
use canter_shared::wire::command::Command;
use canter_shared::wire::id::{Address, AxisId};

#[test]
fn a_clock_that_old_frames_set_again_and_again_runs_no_tick_twice() {
    let mut node: Node<Simulated, 1> = Node::new(Identity {
        chip: [0; 12],
        firmware: [0; 3],
        board: Board::Simulated,
    });
    let axis = AxisId::new(1).expect("1 is an axis");
    node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO))
        .expect("there is room for one");
    let mut now = 10_000_000;
    // Frames that waited for a second: each sets the clock to another hour.
    let mut ticks = 0;
    for hour in 1..=200 {
        let sync = Command::Sync {
            counter: hour as u8,
            time: BusTime(hour * 3_600_000_000),
        };
        let frame = sync.encode(Address::All).expect("it fits");
        node.handle_frame(LocalTime(now - 1_000_000), &frame);
        now += 1_000;
        while node.next_tick() <= LocalTime(now) {
            node.tick(LocalTime(now));
            ticks += 1;
        }
    }
    // One for each millisecond, and at most one more where a step comes between.
    assert!(ticks <= 2 * 200, "{ticks} ticks in 200 ms");
}
