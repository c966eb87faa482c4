//! Parameters in a node's flash, and power that fails while they get there.

use canter_shared::parameter::Parameter;
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;

use super::*;

const NODE: usize = 2;

/// In the parameter's own steps: 20 rad/s by default.
const VALUES: [i64; 3] = [5_000_000_000, 6_000_000_000, 7_000_000_000];

fn axis() -> AxisId {
    AxisId::new(3).expect("in range")
}

fn value(host: &Host) -> i64 {
    let axis = host.bus.axis(NODE).expect("it has power");
    axis.values().get(Parameter::VelocityLimit)
}

fn accepted(host: &Host, wanted: u8) -> bool {
    host.heard.iter().any(|(_, from, report)| {
        matches!(report, Report::Acknowledgement { sequence, function: Function::Control, reason: Reason::Accepted, .. }
            if *from == axis() && *sequence == wanted)
    })
}

/// Holds, writes and asks for a save.
fn save(host: &mut Host, sequence: u8, raw: i64) {
    let control = |action, sequence| Command::Control {
        action,
        sequence,
        session: SESSION,
    };
    host.say(axis().into(), control(Action::Hold, sequence));
    host.say(axis().into(), control(Action::Configure, sequence + 1));
    let write = Command::ParameterWrite {
        parameter: Parameter::VelocityLimit.into(),
        value: raw,
        sequence: sequence + 2,
    };
    host.say(axis().into(), write);
    host.wait(5_000);
    host.say(axis().into(), control(Action::Save, sequence + 3));
    host.wait(100_000);
}

#[test]
fn what_is_saved_is_there_after_a_reset_and_what_is_not_is_gone() {
    let mut host = Host::seeded(1);
    host.wait(100_000);
    save(&mut host, 10, VALUES[0]);
    assert!(accepted(&host, 13));
    let write = Command::ParameterWrite {
        parameter: Parameter::VelocityLimit.into(),
        value: VALUES[1],
        sequence: 14,
    };
    host.say(axis().into(), write);
    host.wait(5_000);
    assert_eq!(value(&host), VALUES[1]);
    host.bus.disturb(Disturbance::CutPower {
        node: NODE,
        time: Duration::ZERO,
    });
    host.wait(5_000);
    assert_eq!(value(&host), VALUES[0]);
}

/// Every place at which the power may fail, in the first save and in a later one.
#[test]
fn a_save_that_is_cut_short_leaves_the_old_or_the_new() {
    let (mut old, mut new) = (0, 0);
    for before in [0, 1, 2] {
        // A save is some 40 writes of a word; the last ones are beyond its end.
        for after in 0..60 {
            let mut host = Host::seeded(u64::from(after));
            host.wait(50_000);
            let mut was = value(&host);
            for (saved, raw) in (0..before).zip(VALUES) {
                save(&mut host, 10 + 4 * saved, raw);
                was = raw;
            }
            host.bus.disturb(Disturbance::CutPowerWhileSaving {
                node: NODE,
                after,
                time: Duration::from_millis(20),
            });
            let raw = VALUES[2];
            save(&mut host, 50, raw);
            let cut = !accepted(&host, 53);
            let now = value(&host);
            assert!(now == was || now == raw, "after {after}: {now}");
            let fault = host.bus.axis(NODE).and_then(|axis| axis.fault());
            // A first save that was cut short leaves a slot that cannot be read, and no other.
            let name = fault.map(|fault| fault.name());
            assert!(before == 0 || name.is_none(), "after {after}: {name:?}");
            if cut {
                old += u32::from(now == was);
            } else {
                assert_eq!(now, raw, "after {after}");
                new += 1;
            }
        }
    }
    assert!(old > 30 && new > 30, "{old} old, {new} new");
}
