//! The ranges that models of drives pack their numbers into.
//!
//! bgkatz: bgkatz/motorcontrol, Core/Src/can.c and the mini cheetah's torque constant. AK: CubeMars' AK
//! manual V1.0.8 p. 48-49 and neurobionics/TMotorCANControl, src/TMotorCANControl/mit_can.py. A drive's own
//! firmware may differ: then `custom` and the three parameters say what it has.

/// The ends of a drive's ranges: each goes from minus to plus this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MitRanges {
    /// In rad.
    pub position: f32,
    /// In rad/s.
    pub velocity: f32,
    /// In Nm.
    pub torque: f32,
}

const fn ranges(position: f32, velocity: f32, torque: f32) -> Option<MitRanges> {
    Some(MitRanges {
        position,
        velocity,
        torque,
    })
}

/// Names of the models, in the order of their ranges.
pub const MODELS: &[&str] = &[
    "custom",
    "bgkatz",
    "ak80-9",
    "ak10-9",
    "ak60-6",
    "ak70-10",
    "ak80-6-v1.0",
    "ak80-6-v1.1",
    "ak80-6-v2",
    "ak80-64",
];

/// What each model's ranges are; `None` where the parameters say it.
const PRESETS: [Option<MitRanges>; MODELS.len()] = [
    None,
    ranges(12.5, 65.0, 18.0),
    ranges(12.5, 50.0, 18.0),
    ranges(12.5, 50.0, 65.0),
    ranges(12.5, 50.0, 15.0),
    ranges(12.5, 50.0, 25.0),
    ranges(95.5, 45.0, 18.0),
    ranges(12.5, 22.5, 12.0),
    ranges(12.5, 76.0, 12.0),
    ranges(12.5, 8.0, 144.0),
];

/// The model that the ranges are of by default: its place in [`MODELS`].
pub const DEFAULT_MODEL: i64 = 2;

/// The ranges of the model at this place; `None` where its own are to be named.
pub fn preset(model: usize) -> Option<MitRanges> {
    PRESETS.get(model).copied().flatten()
}
