//! Many seeds, one after the other or side by side.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::check::Statistics;
use super::episode::{Ending, Options, run};

/// Seeds to run.
#[derive(Debug, Clone, Copy)]
pub struct Campaign {
    /// The first seed.
    pub first: u64,
    /// How many, one after the other.
    pub count: u64,
    /// How many at once, at least one.
    pub threads: usize,
    /// What they have in common.
    pub options: Options,
}

/// How far a campaign is.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Seeds that came to their end without a violation.
    pub seeds: u64,
    /// Virtual time of all robots.
    pub simulated: Duration,
    /// Virtual time of all axes.
    pub axes: Duration,
    /// Real time since the beginning.
    pub elapsed: Duration,
    /// What happened.
    pub statistics: Statistics,
}

impl Progress {
    /// Virtual seconds in a real second.
    pub fn speed(&self) -> f64 {
        self.simulated.as_secs_f64() / self.elapsed.as_secs_f64().max(1e-9)
    }

    fn add(&mut self, ending: &Ending) {
        self.seeds += u64::from(ending.violation.is_none());
        self.simulated += ending.lasted;
        self.axes += ending.lasted * ending.axes as u32;
        self.statistics.add(&ending.statistics);
    }
}

/// What came of a campaign.
#[derive(Debug)]
pub struct Report {
    /// All that was run.
    pub progress: Progress,
    /// The violation of the lowest seed, with what makes it happen again.
    pub violation: Option<Ending>,
}

impl Campaign {
    /// Runs the seeds until all are done, one shows a violation, or `stop` is set; `tell` hears
    /// of each that is done. Which seeds are run beyond the first violation depends on the
    /// threads; which violation is reported does not, unless `stop` was set.
    pub fn run(&self, stop: &AtomicBool, tell: impl Fn(&Progress) + Sync) -> Report {
        let begin = Instant::now();
        let next = AtomicU64::new(0);
        // Seeds are given out in order, so all below the lowest bad one are run to their ends.
        let halt = AtomicBool::new(false);
        let shared = Mutex::new((Progress::default(), None::<Ending>));
        let work = || {
            while !halt.load(Ordering::Relaxed) && !stop.load(Ordering::Relaxed) {
                let at = next.fetch_add(1, Ordering::Relaxed);
                if at >= self.count {
                    return;
                }
                let ending = run(self.first.wrapping_add(at), self.options);
                let mut guard = shared
                    .lock()
                    .unwrap_or_else(|poisoned| poisoned.into_inner());
                let (progress, worst) = &mut *guard;
                progress.add(&ending);
                progress.elapsed = begin.elapsed();
                tell(progress);
                if ending.violation.is_some() {
                    halt.store(true, Ordering::Relaxed);
                    let lower = worst.as_ref().is_none_or(|worst| ending.seed < worst.seed);
                    if lower {
                        *worst = Some(ending);
                    }
                }
            }
        };
        thread::scope(|scope| {
            for _ in 0..self.threads.max(1) {
                scope.spawn(work);
            }
        });
        let shared = shared.into_inner();
        let (mut progress, violation) = shared.unwrap_or_else(|poisoned| poisoned.into_inner());
        progress.elapsed = begin.elapsed();
        Report {
            progress,
            violation,
        }
    }
}
