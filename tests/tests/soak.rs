//! The soak finds what is broken on purpose, names it, and its log plays it again; a robot that is
//! whole passes. `tests/run soak` runs this after an hour of soak.

use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;

use canter::soak::{
    Campaign, FaultKind, Faults, Invariant, Options, Recording, Sabotage, replay, run,
};
use canter_tests::root;

/// Seeds in which something planted must be found: each draws its own faults, and not all of them
/// bring out everything.
const SEEDS: std::ops::Range<u64> = 1..30;

/// What is found when `sabotage` is at work, first.
fn expected(sabotage: Sabotage) -> &'static [Invariant] {
    match sabotage {
        Sabotage::HigherLimits => &[Invariant::Limits],
        Sabotage::Jump | Sabotage::MissedTick => &[Invariant::Continuity],
        Sabotage::BeatsForTheDead => &[Invariant::Commander],
        // Seen by the motion, or by the answer where that is quicker.
        Sabotage::HiddenMove => &[Invariant::Commander, Invariant::Answers],
        Sabotage::DeafToStop => &[Invariant::Stop],
        Sabotage::ForgottenFault => &[Invariant::Latch],
        Sabotage::WornFlash | Sabotage::TornParameters => &[Invariant::Parameters],
        Sabotage::DoubledAnswer => &[Invariant::Answers],
        Sabotage::Panic => &[Invariant::Panic],
    }
}

fn faults(sabotage: Sabotage) -> Faults {
    match sabotage {
        Sabotage::BeatsForTheDead => Faults::NONE.with(FaultKind::HostKilled),
        Sabotage::TornParameters => Faults::NONE.with(FaultKind::Reset),
        _ => Faults::NONE,
    }
}

#[test]
fn what_is_planted_is_found_and_its_log_plays_it_again() {
    for sabotage in Sabotage::ALL {
        let options = Options {
            faults: faults(sabotage),
            axes: None,
            sabotage: Some(sabotage),
        };
        let found = SEEDS
            .map(|seed| run(seed, options))
            .find_map(|it| it.violation);
        let (violation, recording) = found.unwrap_or_else(|| panic!("{sabotage:?} is not found"));
        assert!(
            expected(sabotage).contains(&violation.invariant),
            "{sabotage:?}: {violation}"
        );

        // By way of the file, as somebody else would.
        let mut log = Vec::new();
        recording
            .write(&mut log)
            .expect("a vector takes everything");
        let log = String::from_utf8(log).expect("a log is text");
        assert!(log.contains(&violation.to_string()), "{sabotage:?}");
        let read = Recording::read(&log).expect("what was written can be read");
        let again = replay(&read, Some(sabotage)).violation;
        let (again, _) = again.unwrap_or_else(|| panic!("{sabotage:?} is not found again"));
        assert_eq!(again, violation, "{sabotage:?}");
        // The sabotage is what was found, and not something else.
        if sabotage != Sabotage::BeatsForTheDead {
            assert!(replay(&read, None).violation.is_none(), "{sabotage:?}");
        }
    }
}

#[test]
fn a_whole_robot_passes_with_all_faults_and_does_something() {
    let campaign = Campaign {
        first: 1,
        count: 4,
        threads: 2,
        options: Options::default(),
    };
    let report = campaign.run(&AtomicBool::new(false), |_| {});
    let violation = report.violation.and_then(|ending| ending.violation);
    assert!(
        violation.is_none(),
        "{:?}",
        violation.map(|(it, _)| it.to_string())
    );
    let statistics = report.progress.statistics;
    assert_eq!(report.progress.seeds, 4);
    assert!(statistics.moving > 10_000, "{statistics:?}");
    assert!(statistics.starts > 100, "{statistics:?}");
    assert!(statistics.faults > 10, "{statistics:?}");
    assert!(statistics.stops > 10, "{statistics:?}");
    assert!(statistics.disturbances > 10, "{statistics:?}");
}

/// 460 and 1104: a stop found no room by a fraction of a count, where a motion braked for the end of the
/// travel before it turned back, and let it run to its end. 20525: a stop from a strong acceleration
/// and with a low jerk limit passed the velocity limit.
#[test]
fn seeds_that_have_found_something_pass() {
    for seed in [460, 1_104, 20_525] {
        let found = run(seed, Options::default()).violation;
        assert!(found.is_none(), "{:?}", found.map(|(it, _)| it.to_string()));
    }
}

#[test]
fn the_same_seed_is_the_same_episode() {
    let options = Options::default();
    assert_eq!(run(7, options).statistics, run(7, options).statistics);
    assert_ne!(run(7, options).statistics, run(8, options).statistics);
}

#[test]
fn a_log_without_its_first_line_is_refused() {
    let error = Recording::read("(0000000000.000000) can0 040#00\n").expect_err("no seed");
    assert!(error.to_string().contains("# canter soak"), "{error}");
    let error = Recording::read("# canter soak --seed 1 --faults goblins\n").expect_err("no fault");
    assert!(error.to_string().contains("goblins"), "{error}");
    let text = "# canter soak --seed 1 --faults all\nnonsense\n";
    let error = Recording::read(text).expect_err("no line");
    assert!(error.to_string().contains("line 2"), "{error}");
}

/// The document names every invariant and every fault in the words of the tables.
#[test]
fn the_document_says_what_the_tables_say() {
    let document = std::fs::read_to_string(root().join("docs/soak.md")).expect("docs/soak.md");
    let rows: BTreeSet<&str> = document.lines().collect();
    let invariants = Invariant::ALL.map(|it| format!("| `{}` | {} |", it.name(), it.meaning()));
    let faults = FaultKind::ALL.map(|it| format!("| `{}` | {} |", it.name(), it.meaning()));
    for row in invariants.iter().chain(&faults) {
        assert!(rows.contains(row.as_str()), "docs/soak.md lacks: {row}");
    }
}
