//! Tests on real SocketCAN buses. The `vcan` part of tests/run makes vcan0 to vcan23 for them, in
//! the kernel that runs or in an emulated machine; each test has a bus of its own.

mod vcan {
    mod double;
    mod drives;
    mod flood;
    mod logs;
    mod moves;
    mod paths;
    mod refusals;
    mod robot;
    mod store;
    mod trouble;
    mod two_hosts;
    mod walking;
    mod zero;
}

use std::time::Duration;

use canter_tests::PATIENCE;
use canter_tests::candump::{Candump, cansend};
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, Frame, Socket, StandardId};

/// The bus itself: what one program sends, another program and candump see, unchanged.
#[test]
fn a_frame_goes_round_between_cansend_a_socket_and_candump() {
    let bus = "vcan0";
    let mut candump = Candump::start(bus);
    let socket = CanSocket::open(bus).expect("the bus is up");
    socket
        .set_read_timeout(PATIENCE)
        .expect("a socket takes a time-out");

    cansend(bus, "123#DEADBEEF");
    let received = socket.read_frame().expect("the frame arrives");
    assert_eq!(
        (received.raw_id(), received.data()),
        (0x123, &[0xDE, 0xAD, 0xBE, 0xEF][..])
    );

    let id = StandardId::new(0x7FF).expect("the last id of 11 bits");
    let answer = CanFrame::new(id, &[1, 2, 3, 4, 5, 6, 7, 8]).expect("8 bytes fit");
    socket
        .write_frame(&answer)
        .expect("the bus takes the frame");

    let first = candump.wait_for("frame from cansend", |_| true);
    assert_eq!(
        (first.id, &*first.data),
        (0x123, &[0xDE, 0xAD, 0xBE, 0xEF][..])
    );
    let second = candump.wait_for("frame from the socket", |_| true);
    assert_eq!(
        (second.id, &*second.data),
        (0x7FF, &[1, 2, 3, 4, 5, 6, 7, 8][..])
    );
    assert_eq!((&*second.interface, second.extended), (bus, false));
    assert!(second.time_us >= first.time_us);
    assert_eq!(candump.next(Duration::ZERO), None);
}
