//! The axis of abduction, which swings the leg's plane sideways.
//!
//! The axis is parallel to x, and the leg's plane is as far from it as the hip is wide. A foot is
//! seen from where the plane's joints are at an abduction of zero.

use super::error::LegError;
use super::varying::Varying;

/// The foot in the leg's plane, and how far that is swung.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Swung {
    /// Forward.
    pub x: Varying,
    /// Down along the leg's plane, from 0.
    pub w: Varying,
    /// The abduction: positive brings the foot to the left.
    pub abduction: Varying,
    /// The angle at the axis between the foot and the hip: at zero the leg has no way sideways.
    pub freedom: f64,
}

/// Takes a foot apart; `hip` is how far the plane is to the left of the axis.
pub(super) fn swing(hip: f64, [x, y, z]: [Varying; 3]) -> Result<Swung, LegError> {
    let across = y + hip;
    let distance = across.hypot(z);
    let least = hip.abs();
    // A foot on the axis itself is at no angle.
    if distance.value < least || distance.value == 0.0 {
        return Err(LegError::NearHipAxis {
            distance: distance.value,
            least,
        });
    }
    let w = ((distance - hip) * (distance + hip)).sqrt();
    let mut abduction = across.atan2(-z) - Varying::constant(hip).atan2(w);
    abduction.value = wrap(abduction.value);
    Ok(Swung {
        x,
        w,
        abduction,
        freedom: w.value.atan2(least),
    })
}

/// Puts a point of the leg's plane into the room.
pub(super) fn unswing(hip: f64, [x, w]: [Varying; 2], abduction: Varying) -> [Varying; 3] {
    let (sin, cos) = (abduction.sin(), abduction.cos());
    [x, (cos - 1.0) * hip + w * sin, sin * hip - w * cos]
}

/// The same angle from minus to plus a half turn.
fn wrap(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}
