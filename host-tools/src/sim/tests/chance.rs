//! What goes wrong at random.

use super::observed::Observed;
use super::*;

const MILLISECOND: Duration = Duration::from_millis(1);

/// Everything that can recur, far more often than on any real machine.
fn wild() -> Rates {
    let recurring = |every, longest| {
        Some(Recurring {
            every: every * MILLISECOND,
            longest: longest * MILLISECOND,
        })
    };
    Rates {
        corrupted: 2_000,
        misread: 2_000,
        doubled: 2_000,
        lost: 2_000,
        delays: recurring(200, 10),
        babbling: recurring(400, 20),
        power_cuts: recurring(500, 100),
        host_stalls: recurring(500, 50),
        sync_losses: recurring(500, 100),
        drive_troubles: recurring(500, 50),
    }
}

fn disturbed(seed: u64, disturbances: Rates) -> Observed {
    let mut host = Host::new(&Configuration {
        seed,
        disturbances,
        ..Configuration::default()
    });
    let observed = Rc::new(RefCell::new(Observed::default()));
    host.bus.observe(Rc::clone(&observed));
    host.move_all();
    host.wait(4_000_000);
    observed.take()
}

#[test]
fn one_seed_gives_the_same_disturbances_and_another_does_not() {
    let first = disturbed(1, wild());
    assert!(first == disturbed(1, wild()));
    let other = disturbed(2, wild());
    assert!(first.frames != other.frames);
    assert_ne!(first.disturbances[0], other.disturbances[0]);
}

#[test]
fn chance_has_a_stream_of_its_own() {
    // Rates whose faults never come up change nothing.
    let harmless = Rates {
        corrupted: 1,
        power_cuts: Some(Recurring {
            every: Duration::from_secs(1_000_000),
            longest: MILLISECOND,
        }),
        ..Rates::default()
    };
    assert!(disturbed(3, harmless) == disturbed(3, Rates::default()));
}

type Kind = fn(&Disturbance) -> bool;

#[test]
fn every_rate_is_kept_about() {
    let observed = disturbed(4, wild());
    let frames = observed.frames.len() as f64;
    let because = |wanted: fn(&Destruction) -> bool| {
        let destroyed = observed.destroyed.iter();
        destroyed.filter(|one| wanted(&one.cause)).count() as f64
    };
    // 2 in 1000; misread and doubled look the same here.
    let disturbed = because(|cause| *cause == Destruction::Disturbed);
    assert!(
        (0.001..0.004).contains(&(disturbed / frames)),
        "{disturbed} of {frames}"
    );
    let misread = because(|cause| matches!(cause, Destruction::Misread(_)));
    assert!(
        (0.002..0.008).contains(&(misread / frames)),
        "{misread} of {frames}"
    );
    let seconds = observed.ticks.last().expect("ticks").time.0 as f64 / 1e9;
    let kinds: [(Kind, f64); 6] = [
        (|what| matches!(what, Disturbance::Delay { .. }), 5.0),
        (|what| matches!(what, Disturbance::Babble { .. }), 2.5),
        (|what| matches!(what, Disturbance::CutPower { .. }), 2.0),
        (|what| matches!(what, Disturbance::StallHost { .. }), 2.0),
        (|what| matches!(what, Disturbance::LoseSync { .. }), 2.0),
        (|what| matches!(what, Disturbance::Drive { .. }), 2.0),
    ];
    for (at, (kind, a_second)) in kinds.into_iter().enumerate() {
        let count = observed
            .disturbances
            .iter()
            .filter(|(_, what)| kind(what))
            .count();
        let wanted = a_second * seconds;
        assert!(
            (0.4 * wanted..2.0 * wanted).contains(&(count as f64)),
            "kind {at}: {count} instead of {wanted}"
        );
    }
}
