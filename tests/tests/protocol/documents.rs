//! canter.dbc and the tables of the documents are what the sources make them.

use super::golden;
use canter::dbc::{self, markdown};
use canter_tests::root;

const UPDATE: &str = "CANTER_UPDATE_SNAPSHOTS";

/// Compares a file of the repository with what it must be, or writes it where that is asked for.
#[track_caller]
fn keep(file: &str, wanted: &str) {
    let path = root().join(file);
    if std::env::var_os(UPDATE).is_some() {
        return std::fs::write(path, wanted).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
    let found = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{file}: {error}"));
    if found == wanted {
        return;
    }
    let (found, wanted): (Vec<_>, Vec<_>) = (found.lines().collect(), wanted.lines().collect());
    let most = found.len().max(wanted.len());
    let differs = (0..most).find(|line| found.get(*line) != wanted.get(*line));
    // None where only the last line's end differs.
    let line = differs.unwrap_or(most);
    panic!(
        "{file}:{}: not what the sources make it; {UPDATE}=1 tests/run fast writes it anew\n\
         found:  {:?}\nwanted: {:?}",
        line + 1,
        found.get(line),
        wanted.get(line)
    );
}

fn begin(name: &str) -> String {
    format!("<!-- begin {name}: generated, see tests/tests/protocol.rs -->\n")
}

fn end(name: &str) -> String {
    format!("<!-- end {name} -->\n")
}

/// `document` with the text between the markers of `name` replaced.
#[track_caller]
fn replaced(document: &str, name: &str, content: &str) -> String {
    let (begin, end) = (begin(name), end(name));
    let (before, rest) = document
        .split_once(&begin)
        .unwrap_or_else(|| panic!("no marker: {begin}"));
    let (_, after) = rest
        .split_once(&end)
        .unwrap_or_else(|| panic!("no marker: {end}"));
    format!("{before}{begin}\n{content}\n{end}{after}")
}

pub fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn examples() -> String {
    let rows = golden::read().into_iter().map(|golden| {
        let golden::Golden {
            message,
            text,
            meaning,
            ..
        } = golden;
        format!("| `{text}` | {message} | {meaning} |\n")
    });
    let rows: String = rows.collect();
    format!("| frame | name | meaning |\n|---|---|---|\n{rows}")
}

#[test]
fn the_dbc_is_what_the_table_of_frames_makes_it() {
    keep("canter.dbc", &dbc::generate());
}

#[test]
fn the_tables_of_the_protocol_are_up_to_date() {
    let file = "docs/protocol.md";
    let mut document = read(file);
    for (name, content) in [
        ("frames", markdown::frames()),
        ("examples", examples()),
        ("reasons", markdown::reasons()),
        ("parameters", markdown::parameters()),
    ] {
        document = replaced(&document, name, &content);
    }
    keep(file, &document);
}

#[test]
fn the_table_of_faults_is_up_to_date() {
    let file = "docs/faults.md";
    keep(file, &replaced(&read(file), "faults", &markdown::faults()));
}

#[test]
fn every_frame_that_the_protocol_shows_is_golden() {
    let document = read("docs/protocol.md");
    let shown = document
        .split(|character: char| !character.is_ascii_alphanumeric() && character != '#')
        .filter(|word| golden::parse(word).is_some());
    let golden: Vec<_> = golden::read()
        .into_iter()
        .map(|golden| golden.text)
        .collect();
    for word in shown {
        assert!(golden.iter().any(|text| text == word), "{word} is not");
    }
}

#[test]
fn only_what_is_between_the_markers_is_replaced() {
    let document = format!("a\n{}old\n{}b\n", begin("x"), end("x"));
    let wanted = format!("a\n{}\nnew\n\n{}b\n", begin("x"), end("x"));
    assert_eq!(replaced(&document, "x", "new\n"), wanted);
    assert_eq!(replaced(&wanted, "x", "new\n"), wanted);
}
