//! What must hold of every page, and each check seen to bite.

use canter_tests::browser::{Browser, View};
use canter_tests::measurement;
use std::path::Path;

use super::super::{DESKTOP, PHONE, REPORT, demo};

/// What is wrong with a page, as it is seen like this.
fn findings(browser: &mut Browser, page: &Path, view: View) -> Vec<String> {
    browser.open(page, view);
    browser
        .evaluate("document.querySelectorAll('details').forEach((more) => { more.open = true; })");
    let mut findings = browser.complaints();
    findings.extend(browser.requests());
    let told = browser.evaluate(include_str!("checks.js"));
    let told = told.as_array().expect("a list");
    findings.extend(told.iter().map(|finding| finding.to_string()));
    findings
}

#[test]
fn the_report_can_be_shown() {
    let (_, page) = &*REPORT;
    let bytes = std::fs::metadata(page).expect("it was written").len();
    measurement("fast", "report.html", &format!("{bytes} bytes"), "3000000");
    assert!(bytes < 3_000_000, "{bytes} bytes");
    let mut browser = Browser::start();
    for width in [PHONE, DESKTOP] {
        for dark in [false, true] {
            let view = View { dark, ..width };
            let findings = findings(&mut browser, page, view);
            assert!(findings.is_empty(), "{view:?}: {findings:#?}");
            let ground = browser.evaluate("getComputedStyle(document.body).backgroundColor");
            assert_eq!(ground == "rgb(255, 255, 255)", !dark, "{view:?}: {ground}");
        }
    }
    let figures = browser.evaluate("document.querySelectorAll('figure svg').length");
    assert!(
        figures.as_u64().is_some_and(|count| count >= 20),
        "{figures}"
    );
}

#[test]
fn so_can_that_of_a_robot_that_does_not_walk() {
    let (directory, _) = &*REPORT;
    let robot = directory.path().join("robot.toml");
    std::fs::write(&robot, "[[axis]]\nid = 7\n[[axis]]\nid = 63\n").expect("written");
    let robot = robot.to_str().expect("UTF-8");
    let page = demo(&["--robot", robot], &directory.path().join("two"));
    let mut browser = Browser::start();
    for view in [PHONE, DESKTOP] {
        let findings = findings(&mut browser, &page, view);
        assert!(findings.is_empty(), "{view:?}: {findings:#?}");
    }
}

/// Each fault, put into the page where it says, is found in words of its own.
#[test]
fn each_fault_is_found() {
    let (directory, page) = &*REPORT;
    let whole = std::fs::read_to_string(page).expect("it was written");
    let broken = directory.path().join("broken.html");
    let mut browser = Browser::start();
    for (at, instead, words) in [
        // A program that fails, and one that the page's policy does not know.
        ("\"frames\":[", "\"frames\":[,", "SyntaxError"),
        (
            "\"use strict\";",
            "\"use strict\"; ",
            "Content Security Policy",
        ),
        (
            "<main>",
            "<main><script>0</script>",
            "Content Security Policy",
        ),
        // Something from elsewhere.
        ("<main>", "<main><img src=\"data:x\">", "data:x"),
        ("<main>", "<main><img src=\"other.png\">", "other.png"),
        // Pictures of nothing, of too small text, of text over text.
        ("class=\"series\"", "class=\"none\"", "shows nothing"),
        ("font-size=\"52", "font-size=\"30", "too small"),
        (
            "</svg>",
            "<text x=\"500\" y=\"500\" font-size=\"64\">one</text><text x=\"510\" y=\"500\" font-size=\"64\">two</text></svg>",
            "overlaps",
        ),
        // Something too wide.
        (
            "<main>",
            "<main><p style=\"width: 1400px\">wide</p>",
            "wider than the page",
        ),
    ] {
        assert!(whole.contains(at), "{at}");
        std::fs::write(&broken, whole.replace(at, instead)).expect("written");
        for view in [PHONE, DESKTOP] {
            let findings = findings(&mut browser, &broken, view);
            let is_found = findings.iter().any(|finding| finding.contains(words));
            assert!(is_found, "{instead}, {view:?}: {findings:#?}");
        }
    }
}
