//! The host's side of canter: what the command `canter` is made of.

pub mod bus;
