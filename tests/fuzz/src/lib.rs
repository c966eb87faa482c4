//! What the fuzz targets do with the bytes that they are given: each panics where a promise is broken.

pub mod axis;
pub mod decode;
pub mod slcan;
