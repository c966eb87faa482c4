//! The table of parameters. A new one is a line here, and one in `settings` that gives it meaning.

use crate::drive::mit::{DEFAULT_MODEL, KD_RANGE, KP_RANGE, MODELS};
use crate::limits::{
    DEFAULT_VALUES, FARTHEST_POSITION, LARGEST_ACCELERATION, LARGEST_JERK, LARGEST_VELOCITY,
    SMALLEST_RATE,
};
use crate::motion::shaping::{HIGHEST_FREQUENCY, LARGEST_DAMPING};
use num_enum::{IntoPrimitive, TryFromPrimitive};

/// When a parameter may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// While the axis rests and nothing is about to move it, enabled or not.
    AtRest,
    /// While the axis is disabled.
    Disabled,
}

/// What kind of value a parameter has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number of so many steps to one of the unit.
    Number {
        /// Raw steps in one of the unit.
        per_unit: i64,
    },
    /// One of these; the raw value is the place in the list.
    Choice(&'static [&'static str]),
}

/// The value that a parameter has until it is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Default {
    /// This raw value.
    Raw(i64),
    /// The axis's id.
    AxisId,
}

/// One parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Which.
    pub parameter: Parameter,
    /// Its name on the command line, in files and in the documents.
    pub name: &'static str,
    /// What kind of value.
    pub kind: Kind,
    /// The unit; empty for plain numbers and choices.
    pub unit: &'static str,
    /// The least raw value.
    pub minimum: i64,
    /// The greatest raw value.
    pub maximum: i64,
    /// The value until it is changed.
    pub default: Default,
    /// When it may change.
    pub change: Change,
    /// What it says, in a few words.
    pub meaning: &'static str,
}

/// The raw value of `value`, to the nearest step.
const fn raw(value: f64, per_unit: i64) -> i64 {
    let scaled = value * per_unit as f64;
    if scaled < 0.0 {
        (scaled - 0.5) as i64
    } else {
        (scaled + 0.5) as i64
    }
}

/// The raw value of a bound: towards zero, so that it is itself in range.
const fn bound(value: f64, per_unit: i64) -> i64 {
    (value * per_unit as f64) as i64
}

/// Steps of 10^-9: 48 bits hold +-140 737 of the unit.
const NANO: i64 = 1_000_000_000;
/// Steps of 10^-6: 48 bits hold +-1.4e8.
const MICRO: i64 = 1_000_000;
/// Steps of 10^-4: 48 bits hold +-1.4e10.
const TENTH_MILLI: i64 = 10_000;
/// Steps of 10^-3: a tick of time, in s.
const MILLI: i64 = 1_000;

/// How an axis comes to rest, in the order of [`super::Reaction`].
const REACTIONS: Kind = Kind::Choice(&["controlled_stop", "quick_stop", "disable"]);

macro_rules! parameters {
    ($($parameter:ident = $number:literal, $name:literal, $kind:expr, $unit:literal,
        $minimum:expr, $maximum:expr, $default:expr, $change:ident, $meaning:literal;)*) => {
        /// A parameter of an axis, by its number.
        #[derive(
            Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, IntoPrimitive,
            TryFromPrimitive,
        )]
        #[repr(u8)]
        pub enum Parameter {
            $(#[doc = concat!("`", $name, "`: ", $meaning, ".")] $parameter = $number,)*
        }

        impl Parameter {
            /// How many there are.
            pub const COUNT: usize = [$($number),*].len();

            /// Every parameter, in the order of their numbers, which count from 0.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$parameter),*];

            /// What the table says of it.
            #[inline(always)]
            pub const fn entry(self) -> Entry {
                match self {
                    $(Self::$parameter => Entry {
                        parameter: self,
                        name: $name,
                        kind: $kind,
                        unit: $unit,
                        minimum: $minimum,
                        maximum: $maximum,
                        default: $default,
                        change: Change::$change,
                        meaning: $meaning,
                    },)*
                }
            }
        }
    };
}

const fn number(per_unit: i64) -> Kind {
    Kind::Number { per_unit }
}

parameters! {
    VelocityLimit = 0, "limits.velocity", number(NANO), "rad/s",
        raw(SMALLEST_RATE, NANO), bound(LARGEST_VELOCITY, NANO),
        Default::Raw(raw(DEFAULT_VALUES.velocity, NANO)), AtRest,
        "the largest velocity";
    AccelerationLimit = 1, "limits.acceleration", number(MICRO), "rad/s^2",
        raw(SMALLEST_RATE, MICRO), bound(LARGEST_ACCELERATION, MICRO),
        Default::Raw(raw(DEFAULT_VALUES.acceleration, MICRO)), AtRest,
        "the largest acceleration";
    DecelerationLimit = 2, "limits.deceleration", number(MICRO), "rad/s^2",
        raw(SMALLEST_RATE, MICRO), bound(LARGEST_ACCELERATION, MICRO),
        Default::Raw(raw(DEFAULT_VALUES.deceleration, MICRO)), AtRest,
        "the largest deceleration";
    JerkLimit = 3, "limits.jerk", number(TENTH_MILLI), "rad/s^3",
        raw(SMALLEST_RATE, TENTH_MILLI), bound(LARGEST_JERK, TENTH_MILLI),
        Default::Raw(raw(DEFAULT_VALUES.jerk, TENTH_MILLI)), AtRest,
        "the largest jerk";
    PositionMinimum = 4, "limits.position_min", number(NANO), "rad",
        bound(-FARTHEST_POSITION, NANO), bound(FARTHEST_POSITION, NANO),
        Default::Raw(bound(DEFAULT_VALUES.position_minimum, NANO)), AtRest,
        "the least position";
    PositionMaximum = 5, "limits.position_max", number(NANO), "rad",
        bound(-FARTHEST_POSITION, NANO), bound(FARTHEST_POSITION, NANO),
        Default::Raw(bound(DEFAULT_VALUES.position_maximum, NANO)), AtRest,
        "the greatest position";
    HostTimeout = 6, "host.timeout", number(MILLI), "s",
        // Two beats of a host that sends 20 in a second, as canter does; a minute.
        raw(0.1, MILLI), raw(60.0, MILLI), Default::Raw(raw(0.25, MILLI)), AtRest,
        "silence of the session that holds the axis after which the axis stops";
    HostReaction = 7, "host.reaction", REACTIONS, "", 0, 2, Default::Raw(0), AtRest,
        "how the axis comes to rest when its host is silent";
    StreamReaction = 8, "stream.reaction", REACTIONS, "", 0, 2, Default::Raw(0), AtRest,
        "how the axis comes to rest when a stream runs dry";
    FollowingError = 9, "following.error", number(NANO), "rad",
        // From the encoder's noise to a turn and a half; 0 does not watch.
        0, raw(10.0, NANO), Default::Raw(raw(0.5, NANO)), AtRest,
        "how far the drive may be from its setpoint and outside the travel; 0 does not watch";
    FollowingTime = 10, "following.time", number(MILLI), "s",
        raw(0.001, MILLI), raw(10.0, MILLI), Default::Raw(raw(0.05, MILLI)), AtRest,
        "how long the drive may be farther away than that";
    OverspeedMargin = 11, "overspeed.margin", number(NANO), "rad/s",
        0, bound(LARGEST_VELOCITY, NANO), Default::Raw(raw(5.0, NANO)), AtRest,
        "by how much the drive may be faster than limits.velocity; 0 does not watch";
    FollowingReaction = 12, "following.reaction", REACTIONS, "", 0, 2, Default::Raw(2), AtRest,
        "how the axis comes to rest when the drive does not do what it is told";
    BusReaction = 13, "bus.reaction", REACTIONS, "", 0, 2, Default::Raw(0), AtRest,
        "how the axis comes to rest when its bus fails or another node has its id";
    ShaperKind = 14, "shaper.kind", Kind::Choice(&["none", "zv", "zvd", "ei"]), "", 0, 3,
        Default::Raw(0), AtRest,
        "which input shaper the setpoints go through";
    ShaperFrequency = 15, "shaper.frequency", number(MICRO), "Hz",
        raw(0.1, MICRO), bound(HIGHEST_FREQUENCY, MICRO), Default::Raw(raw(20.0, MICRO)), AtRest,
        "the frequency that the machine swings with";
    ShaperDamping = 16, "shaper.damping", number(NANO), "",
        0, bound(LARGEST_DAMPING, NANO), Default::Raw(0), AtRest,
        "the damping ratio of that swing";
    DriveNode = 17, "drive.node", number(1), "",
        // CANopen's node ids, which hold ODrive's and the others' of 6 bits.
        0, 127, Default::AxisId, Disabled,
        "the id of the axis's drive on the drives' bus";
    FeedbackPeriod = 18, "feedback.period", number(MILLI), "s",
        // A host that listens for a quarter of a second hears everybody.
        raw(0.001, MILLI), raw(0.2, MILLI), Default::Raw(raw(0.02, MILLI)), AtRest,
        "how often the axis reports where it is";
    HeartbeatPeriod = 19, "heartbeat.period", number(MILLI), "s",
        raw(0.01, MILLI), raw(0.2, MILLI), Default::Raw(raw(0.1, MILLI)), AtRest,
        "how often the axis reports its state";
    GearRatio = 20, "drive.gear_ratio", number(NANO), "",
        raw(0.001, NANO), raw(1_000.0, NANO), Default::Raw(NANO), Disabled,
        "turns of the drive's shaft in one of the axis; 1 where the drive counts behind its own gear";
    DriveDirection = 21, "drive.direction", Kind::Choice(&["forward", "reverse"]), "", 0, 1,
        Default::Raw(0), Disabled,
        "whether drive and axis turn the same way";
    DriveOffset = 22, "drive.offset", number(NANO), "rad",
        bound(-FARTHEST_POSITION, NANO), bound(FARTHEST_POSITION, NANO), Default::Raw(0), Disabled,
        "where the axis is when the drive reads zero";
    DriveInertia = 23, "drive.inertia", number(NANO), "kg m^2",
        0, raw(100.0, NANO), Default::Raw(0), Disabled,
        "what the drive accelerates, at the axis's shaft: the feed-forward of torque; 0 gives none";
    DriveTimeout = 24, "drive.timeout", number(MILLI), "s",
        // Shorter than the period at which a drive speaks by default would lose every one.
        raw(0.02, MILLI), raw(1.0, MILLI), Default::Raw(raw(0.05, MILLI)), Disabled,
        "silence of the drive after which it is lost";
    DrivePeriod = 25, "drive.period", number(MILLI), "s",
        raw(0.001, MILLI), raw(0.02, MILLI), Default::Raw(raw(0.001, MILLI)), Disabled,
        "how often the drive gets a setpoint";
    OdriveFirmware = 26, "drive.odrive_firmware", Kind::Choice(&["0.6", "0.5"]), "", 0, 1,
        Default::Raw(0), Disabled,
        "which generation of firmware an ODrive has";
    MitModel = 27, "drive.mit_model", Kind::Choice(MODELS), "", 0, MODELS.len() as i64 - 1,
        Default::Raw(DEFAULT_MODEL), Disabled,
        "whose ranges a drive in mini-cheetah mode has; custom takes the three that follow";
    MitPosition = 28, "drive.mit_position", number(MICRO), "rad",
        raw(0.1, MICRO), raw(1_000.0, MICRO), Default::Raw(raw(12.5, MICRO)), Disabled,
        "the end of a custom drive's range of position";
    MitVelocity = 29, "drive.mit_velocity", number(MICRO), "rad/s",
        raw(0.1, MICRO), raw(1_000.0, MICRO), Default::Raw(raw(50.0, MICRO)), Disabled,
        "the end of a custom drive's range of velocity";
    MitTorque = 30, "drive.mit_torque", number(MICRO), "Nm",
        raw(0.1, MICRO), raw(1_000.0, MICRO), Default::Raw(raw(18.0, MICRO)), Disabled,
        "the end of a custom drive's range of torque";
    MitKp = 31, "drive.mit_kp", number(MICRO), "Nm/rad",
        0, raw(KP_RANGE as f64, MICRO), Default::Raw(raw(50.0, MICRO)), Disabled,
        "how stiffly a drive in mini-cheetah mode holds its position";
    MitKd = 32, "drive.mit_kd", number(MICRO), "Nm s/rad",
        0, raw(KD_RANGE as f64, MICRO), Default::Raw(raw(1.0, MICRO)), Disabled,
        "how strongly it damps";
    MitMaster = 33, "drive.mit_master", number(1), "",
        0, 0x7FF, Default::Raw(0), Disabled,
        "the id that a bgkatz board answers to";
    DriveIncrements = 34, "drive.increments", number(1), "",
        // Encoders of up to 26 bits.
        1, 1 << 26, Default::Raw(1 << 16), Disabled,
        "increments in one turn of a CiA 402 drive's shaft";
    // After all that its link may contradict, so that a store that is read in order finds them in place.
    DriveKind = 35, "drive.kind", Kind::Choice(&["simulated", "odrive", "mit", "cia402"]), "", 0, 3,
        Default::Raw(0), Disabled,
        "which language the axis's drive speaks";
    RatedTorque = 36, "drive.rated_torque", number(MILLI), "Nm",
        0, raw(1_000.0, MILLI), Default::Raw(0), Disabled,
        "rated torque of a CiA 402 drive's motor, its object 6076h: torque is told in parts of it; 0 tells none";
}

impl Parameter {
    /// The parameter of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|parameter| parameter.entry().name == name)
    }

    // One of the table's columns each, apart from each other: a device asks for nothing else, so that
    // names and meanings take none of its flash.

    /// Its least and its greatest raw value.
    #[inline(never)]
    pub const fn range(self) -> (i64, i64) {
        let entry = self.entry();
        (entry.minimum, entry.maximum)
    }

    /// Raw steps in one of the unit; of a choice, one.
    #[inline(never)]
    pub const fn steps_per_unit(self) -> i64 {
        match self.entry().kind {
            Kind::Number { per_unit } => per_unit,
            Kind::Choice(_) => 1,
        }
    }

    /// When it may change.
    #[inline(never)]
    pub const fn change(self) -> Change {
        self.entry().change
    }

    /// Its raw value until it is changed, for the axis of this id.
    #[inline(never)]
    pub const fn default_raw(self, axis: u8) -> i64 {
        match self.entry().default {
            Default::Raw(raw) => raw,
            Default::AxisId => axis as i64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_from_zero_and_names_differ() {
        for (index, parameter) in Parameter::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(u8::from(parameter)), index);
            assert_eq!(Parameter::named(parameter.entry().name), Some(parameter));
        }
    }

    #[test]
    fn every_default_is_in_range_and_every_bound_fits_48_bits() {
        for parameter in Parameter::ALL {
            let entry = parameter.entry();
            for axis in [1, 63] {
                let default = parameter.default_raw(axis);
                assert!(
                    (entry.minimum..=entry.maximum).contains(&default),
                    "{}",
                    entry.name
                );
            }
            for raw in [entry.minimum, entry.maximum] {
                assert!(raw.unsigned_abs() < 1 << 47, "{}", entry.name);
            }
            if let Kind::Choice(names) = entry.kind {
                assert_eq!((entry.minimum, entry.maximum), (0, names.len() as i64 - 1));
            }
        }
    }
}
