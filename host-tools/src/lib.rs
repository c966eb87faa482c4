//! The host's side of canter: what the command `canter` is made of.
//!
//! | module | what it holds |
//! |---|---|
//! | [`bus`] | SocketCAN, SLCAN: ways onto a CAN bus |
//! | [`sim`] | a simulated robot with a bus of its own, in virtual time |
//! | [`soak`] | random robots and faults against written invariants |
//! | [`client`] | a commander of axes: finds, holds, moves, stops |
//! | [`node`] | axis nodes in a host process |
//! | [`drive_model`] | drives that are not there |
//! | [`robot`] | the robot file |
//! | [`parameter_file`] | parameters in a file |
//! | [`profile`] | moves of one axis offline: planned, compared, drawn |
//! | [`path`] | ways through waypoints, timed within limits |
//! | [`foot`], [`leg`], [`gait`] | a foot's cycle, a leg's joints, a robot's steps |
//! | [`walk`] | a robot that walks on a bus |
//! | [`notation`] | how people write axes and quantities |
//! | [`demo`] | the demonstration |
//! | [`log`], [`plot`] | recordings and reports |
//! | [`dbc`] | the protocol for other people's tools |

pub mod bus;
pub mod client;
pub mod dbc;
pub mod demo;
pub mod drive_model;
pub mod foot;
pub mod gait;
pub mod leg;
pub mod log;
pub mod node;
pub mod notation;
pub mod parameter_file;
pub mod path;
pub mod plot;
pub mod profile;
pub mod robot;
pub mod sim;
pub mod soak;
pub mod walk;

/// The version of this crate: major, minor, patch.
pub fn version() -> [u8; 3] {
    let part = |text: &str| text.parse().unwrap_or(0);
    [
        part(env!("CARGO_PKG_VERSION_MAJOR")),
        part(env!("CARGO_PKG_VERSION_MINOR")),
        part(env!("CARGO_PKG_VERSION_PATCH")),
    ]
}
