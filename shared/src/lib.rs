//! What canter's host and device must agree on.
//!
//! | module | what it holds |
//! |---|---|
//! | [`units`] | position, velocity, acceleration, jerk in integers |
//! | [`time`] | bus time, the 1 ms tick, the clock that SYNC disciplines |
//! | [`limits`] | what an axis may do; only valid values can be held |
//! | [`parameter`] | the table of parameters, what they set, and how they are kept |
//! | [`motion`] | from limits to setpoints: beta S-curve, trapezoid, stop, retarget |
//! | [`wire`] | bytes to meaning: CAN frames, ids, commands, reports |
//! | [`drive`] | the servo drive behind an axis, and the links that speak its language |
//! | [`axis`] | who may move, and when to stop |
//! | [`node`] | one device on the bus: a clock, an identity, some axes |
//!
//! The crate is sans-IO: it never reads a clock, never allocates and never blocks. Time comes in
//! as an argument and frames go out through `poll_transmit`. It is `no_std` without condition:
//! `std`'s float functions are not the same bits everywhere, `libm`'s are, and so the host can
//! predict every setpoint that a device will send.
//!
//! Arrows go one way: units, time <- limits <- motion <- parameter <- axis <- node; units, time <- wire <-
//! drive <- parameter. `motion` never sees `wire`. A test in `tests/` holds this.
#![no_std]
#![forbid(unsafe_code)]

pub mod axis;
pub mod drive;
pub mod limits;
pub mod motion;
pub mod node;
pub mod parameter;
pub mod time;
pub mod units;
pub mod wire;
