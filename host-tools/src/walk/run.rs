//! A walk on a client: preflight, up, orders, down.

/// Where orders come from: a person's keys, lines of a file, a script.
pub trait Orders {
    /// The next order that is there at `time`, in s of the motion, while the robot is in `phase`. It
    /// is asked until there is none, once for each knot, and must answer at once.
    fn next(&mut self, time: f64, phase: Phase) -> Option<Order>;

    /// Hears that an order was refused, and why. The robot goes on as before.
    fn refused(&mut self, order: &Order, why: &WalkError);
}

/// How a walk came out.
#[derive(Debug, Clone)]
pub struct Walked {
    /// When the axes passed the motion's time 0: the tick that all of them began at.
    pub start: Tick,
    /// Each axis at the end.
    pub ends: Vec<StreamEnd>,
    /// What it was.
    pub replay: Replay,
}

/// Checks all that can be checked before anything moves; see [`Preflight`]. Changes nothing but what
/// the client knows.
pub fn preflight<B: Bus>(client: &mut Client<B>, robot: &Robot, settings: &Settings, bitrate: Bitrate, ...) -> Result<Preflight, WalkError>;

/// Walks a robot whose axes the client holds and has enabled: a synchronised move of the joints to
/// where the motion begins, then one stream until the robot sits.
///
/// # Errors
/// Whatever stops it. All axes are then stopped together.
pub fn walk<B: Bus>(
    client: &mut Client<B>,
    robot: &Robot,
    settings: &Settings,
    orders: &mut dyn Orders,
) -> Result<Walked, WalkError>;
