//! The moving picture: it moves, it obeys, and it stands still for those who want it so.

use canter_tests::browser::{Browser, View};
use serde_json::Value;

use super::super::{DESKTOP, PHONE, REPORT};

/// Where all four legs are in the picture.
const LEGS: &str = "[...document.querySelectorAll('#scene .leg polyline')].map((leg) => leg.getAttribute('points')).join(';')";

const BUTTON: &str = "document.getElementById('scene-play')";

fn legs(browser: &mut Browser) -> Value {
    let legs = browser.evaluate(LEGS);
    let text = legs.as_str().expect("points");
    assert_eq!(
        text.split(';').filter(|leg| leg.contains(' ')).count(),
        4,
        "{text}"
    );
    legs
}

#[test]
fn it_moves_stops_and_goes_where_it_is_told() {
    let (_, page) = &*REPORT;
    let mut browser = Browser::start();
    for view in [PHONE, DESKTOP] {
        browser.open(page, view);
        assert_eq!(browser.evaluate(&format!("{BUTTON}.textContent")), "Pause");
        let first = legs(&mut browser);
        browser.wait_until(&format!("{LEGS} !== {first}"));
        // A pause holds, over some pictures.
        browser.evaluate(&format!("{BUTTON}.click()"));
        let paused = legs(&mut browser);
        browser.evaluate("new Promise((done) => { let left = 10; const next = () => left-- ? requestAnimationFrame(next) : done(); next(); })");
        assert_eq!(legs(&mut browser), paused);
        // The slider leads through the whole walk, and the trot lifts feet.
        let seen = browser.evaluate(
            "(() => {
                const slider = document.getElementById('scene-time');
                const seen = { feet: new Set(), texts: new Set() };
                for (let at = 0; at <= Number(slider.max); at += 3) {
                    slider.value = at;
                    slider.dispatchEvent(new Event('input'));
                    const feet = [...document.querySelectorAll('#scene .foot')];
                    seen.feet.add(feet.filter((foot) => foot.classList.contains('on')).length);
                    seen.texts.add(document.getElementById('scene-readout').textContent.split(/[:,]/)[1]);
                }
                return { feet: [...seen.feet].sort(), texts: [...seen.texts] };
            })()",
        );
        let feet: Vec<u64> = seen["feet"]
            .as_array()
            .expect("a list")
            .iter()
            .filter_map(Value::as_u64)
            .collect();
        assert!(feet.contains(&2) && feet.contains(&4), "{seen}");
        let texts = seen["texts"].to_string();
        for phase in ["standing up", "trotting", "last steps", "sitting down"] {
            assert!(texts.contains(phase), "{phase}: {texts}");
        }
        // And on from there.
        let there = legs(&mut browser);
        browser.evaluate(&format!("{BUTTON}.click()"));
        browser.wait_until(&format!("{LEGS} !== {there}"));
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
}

#[test]
fn it_waits_for_those_who_want_less_motion_and_is_there_without_scripts() {
    let (_, page) = &*REPORT;
    let mut browser = Browser::start();
    browser.open(
        page,
        View {
            still: true,
            ..PHONE
        },
    );
    assert_eq!(browser.evaluate(&format!("{BUTTON}.textContent")), "Play");
    let paused = legs(&mut browser);
    browser.evaluate("new Promise((done) => { let left = 10; const next = () => left-- ? requestAnimationFrame(next) : done(); next(); })");
    assert_eq!(legs(&mut browser), paused);
    browser.evaluate(&format!("{BUTTON}.click()"));
    browser.wait_until(&format!("{LEGS} !== {paused}"));

    browser.open(
        page,
        View {
            scripts: false,
            ..PHONE
        },
    );
    assert_eq!(legs(&mut browser), paused, "the same moment");
    let controls = "getComputedStyle(document.querySelector('#scene .controls')).display";
    assert_eq!(browser.evaluate(controls), "none");
}
