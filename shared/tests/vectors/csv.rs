//! Reading the tables of tests/vectors by the names of their columns.

use std::collections::HashMap;
use std::path::Path;

/// One row: its cells by column.
#[derive(Debug)]
pub struct Row(HashMap<String, String>);

impl Row {
    /// The cell as it stands there.
    pub fn text(&self, column: &str) -> &str {
        self.0
            .get(column)
            .unwrap_or_else(|| panic!("no column {column}"))
    }

    /// The cell as a number.
    #[track_caller]
    pub fn number(&self, column: &str) -> f64 {
        let cell = self.text(column);
        cell.parse()
            .unwrap_or_else(|_| panic!("{column} is {cell:?}"))
    }

    /// The cell as a number, `None` where it is empty.
    pub fn optional(&self, column: &str) -> Option<f64> {
        (!self.text(column).is_empty()).then(|| self.number(column))
    }

    /// Several cells as numbers.
    #[track_caller]
    pub fn numbers<const N: usize>(&self, columns: [&str; N]) -> [f64; N] {
        columns.map(|column| self.number(column))
    }
}

/// A file of the folder, as it stands.
pub fn text(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/vectors")
        .join(name);
    std::fs::read_to_string(&path).expect("the vectors are part of the project")
}

/// The rows of a table, of which there is at least one.
pub fn rows(name: &str) -> Vec<Row> {
    let text = text(name);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let columns: Vec<_> = lines.next().expect("a heading").split(',').collect();
    let rows: Vec<_> = lines
        .map(|line| {
            let cells = line.split(',').map(str::to_owned);
            Row(columns
                .iter()
                .map(|&name| name.to_owned())
                .zip(cells)
                .collect())
        })
        .collect();
    assert!(!rows.is_empty());
    rows
}
