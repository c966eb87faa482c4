//! What a person's Ctrl-C means.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// SIGINT, SIGTERM, SIGHUP, or Ctrl-C as a key: while the robot walks the first one asks it to settle
/// and sit. A second one, and one at any other time, stops whatever moves at once.
#[derive(Clone)]
pub struct Signals {
    walks: Arc<AtomicBool>,
    stops: Arc<AtomicBool>,
    interrupt: Arc<AtomicBool>,
}

impl Signals {
    /// `interrupt` is the client's.
    pub fn new(interrupt: Arc<AtomicBool>) -> Self {
        Self {
            walks: Arc::default(),
            stops: Arc::default(),
            interrupt,
        }
    }

    /// From here on a stop can be obeyed.
    pub fn walks(&self) {
        self.walks.store(true, Ordering::Relaxed);
    }

    /// Hears one.
    pub fn raise(&self) {
        let is_first =
            self.walks.load(Ordering::Relaxed) && !self.stops.swap(true, Ordering::Relaxed);
        if !is_first {
            self.interrupt.store(true, Ordering::Relaxed);
        }
    }

    /// The robot settles and sits, for whatever reason.
    pub fn stop(&self) {
        self.stops.store(true, Ordering::Relaxed);
    }

    /// Whether the robot is to settle and sit.
    pub fn has_stopped(&self) -> bool {
        self.stops.load(Ordering::Relaxed)
    }

    /// Whether all is to end at once.
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed)
    }
}
