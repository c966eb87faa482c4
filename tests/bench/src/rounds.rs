//! Timing in turns: in each round every contestant runs once, so that whatever slows the machine
//! down for a while slows all of them.

use std::time::Instant;

/// What a contestant took in each round, in seconds.
pub struct Times {
    /// Who it is.
    pub name: &'static str,
    /// One number for each round.
    pub seconds: Vec<f64>,
}

/// Somebody who runs once in each round, and tells how many seconds it took.
pub struct Contestant<'a> {
    name: &'static str,
    run: Box<dyn FnMut() -> f64 + 'a>,
}

impl<'a> Contestant<'a> {
    /// One that is timed here.
    pub fn new(name: &'static str, mut run: impl FnMut() + 'a) -> Self {
        let timed = move || {
            let begin = Instant::now();
            run();
            begin.elapsed().as_secs_f64()
        };
        Self::that_times_itself(name, timed)
    }

    /// One that gives its own time, for a program that is only asked from here.
    pub fn that_times_itself(name: &'static str, run: impl FnMut() -> f64 + 'a) -> Self {
        Self {
            name,
            run: Box::new(run),
        }
    }
}

/// Lets all run in turns: twice to warm up, then `rounds` times, each round beginning with another.
pub fn race(rounds: usize, mut contestants: Vec<Contestant<'_>>) -> Vec<Times> {
    const WARM_UP: usize = 2;
    let count = contestants.len();
    let mut times: Vec<Times> = contestants
        .iter()
        .map(|contestant| Times {
            name: contestant.name,
            seconds: Vec::with_capacity(rounds),
        })
        .collect();
    for round in 0..rounds + WARM_UP {
        for turn in 0..count {
            let who = (round + turn) % count;
            let seconds = (contestants[who].run)();
            if round >= WARM_UP {
                times[who].seconds.push(seconds);
            }
        }
    }
    times
}

/// The median.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Prints what each took for one of `items`, and how the first compares with each other: the
/// median over the rounds of the ratio in one round. A bound is for the ratio to that peer. Who has
/// the first's name and more behind it is the first in another way, and no peer.
pub fn report(what: &str, items: usize, times: &[Times], bounds: &[(&str, f64)]) {
    let Some((own, peers)) = times.split_first() else {
        return;
    };
    for one in times {
        let each = median(one.seconds.iter().copied()) / items as f64;
        let value = format!("{:.1} ns", each * 1e9);
        canter_tests::measurement("bench", &format!("{what}, {}", one.name), &value, "-");
    }
    for peer in peers.iter().filter(|peer| !peer.name.starts_with(own.name)) {
        let pairs = own.seconds.iter().zip(&peer.seconds);
        let ratio = median(pairs.map(|(own, peer)| own / peer));
        let bound = bounds.iter().find(|(name, _)| *name == peer.name);
        let (value, bound) = match bound {
            Some((_, most)) if ratio > *most => {
                (format!("{ratio:.2} MISSED"), format!("at most {most}"))
            }
            Some((_, most)) => (format!("{ratio:.2}"), format!("at most {most}")),
            None => (format!("{ratio:.2}"), "-".to_owned()),
        };
        let what = format!("{what}, time as a share of {}'s", peer.name);
        canter_tests::measurement("bench", &what, &value, &bound);
    }
}
