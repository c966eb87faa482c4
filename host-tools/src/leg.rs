//! Legs: from a foot to its joints and back, with rates and accelerations in closed form.
//!
//! A foot is seen from its hip: x forward, y to the left, z up, so a standing foot has a negative z.
//! Lengths are in m, angles in rad.

/// Where a foot is, how it moves, and how that changes: m, m/s, m/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FootMotion {
    /// In m.
    pub position: [f64; 3],
    /// In m/s.
    pub velocity: [f64; 3],
    /// In m/s^2.
    pub acceleration: [f64; 3],
}

/// Where the three joints of a leg are, and how they move: rad, rad/s, rad/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMotion {
    /// In rad.
    pub position: [f64; 3],
    /// In rad/s.
    pub velocity: [f64; 3],
    /// In rad/s^2.
    pub acceleration: [f64; 3],
}
