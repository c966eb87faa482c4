//! Waypoints from CSV and TOML.
//!
//! CSV has a header: axis ids, and perhaps `speed` and a `heading_ID` for each axis. An empty cell
//! of `speed` or of all headings leaves those out. Lines that are empty or begin with `#` are passed
//! over. TOML says the same so:
//!
//! ```toml
//! axes = [1, 2]
//! [[waypoint]]
//! at = [0.0, "90deg"]      # rad, or text with deg, turn or rad
//! heading = [1.0, 0.0]     # optional: the direction in which the path passes
//! speed = 2.0              # optional: rad/s at most, along the path
//! ```

use super::error::PathError;
use super::waypoints::{MOST_WAYPOINTS, Waypoint, Waypoints};
use crate::notation::angle;
use canter_shared::wire::id::AxisId;
use serde::Deserialize;

/// Waypoints from the text of a file: TOML where a line begins with `axes`, else CSV.
///
/// # Errors
/// The line or waypoint that is wrong, and how.
pub fn parse(text: &str) -> Result<Waypoints, PathError> {
    let is_toml = |line: &str| {
        let key = line.trim_start().strip_prefix("axes");
        key.is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    if text.lines().any(is_toml) {
        parse_toml(text)
    } else {
        parse_csv(text)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    axes: Vec<u8>,
    #[serde(default)]
    waypoint: Vec<FileWaypoint>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileWaypoint {
    at: Vec<Angle>,
    heading: Option<Vec<f64>>,
    speed: Option<f64>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Angle {
    Number(f64),
    Text(String),
}

fn parse_toml(text: &str) -> Result<Waypoints, PathError> {
    let file: File = toml::from_str(text).map_err(|error| PathError::Toml(Box::new(error)))?;
    let mut axes = Vec::new();
    for id in &file.axes {
        let axis = AxisId::new(*id).ok_or_else(|| PathError::Axes(format!("{:?}", file.axes)))?;
        axes.push(axis);
    }
    let mut points = Vec::new();
    for (index, waypoint) in file.waypoint.into_iter().enumerate() {
        let angles = waypoint.at.into_iter().map(|value| match value {
            Angle::Number(radians) => Ok(radians),
            Angle::Text(text) => angle(&text).map_err(|source| PathError::Angle {
                waypoint: index + 1,
                source,
            }),
        });
        points.push(Waypoint {
            at: angles.collect::<Result<_, _>>()?,
            heading: waypoint.heading,
            speed: waypoint.speed,
        });
    }
    Waypoints::new(axes, points)
}

/// What a column of the CSV holds.
#[derive(Clone, Copy)]
enum Column {
    At,
    /// Of the axis with this place in the list.
    Heading(usize),
    Speed,
}

fn parse_csv(text: &str) -> Result<Waypoints, PathError> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((line, header)) = lines.next() else {
        return Err(wrong(
            1,
            "nothing here: begin with a header such as `1,2,speed`",
        ));
    };
    let (axes, columns) = columns(line, header)?;
    let mut points = Vec::new();
    for (line, text) in lines {
        if points.len() > MOST_WAYPOINTS {
            break;
        }
        points.push(waypoint(line, text, axes.len(), &columns)?);
    }
    Waypoints::new(axes, points)
}

fn wrong(line: usize, what: impl Into<String>) -> PathError {
    let what = what.into();
    PathError::Line { line, what }
}

fn columns(line: usize, header: &str) -> Result<(Vec<AxisId>, Vec<Column>), PathError> {
    let axis = |text: &str| text.parse().ok().and_then(AxisId::new);
    let names: Vec<_> = header.split(',').map(str::trim).collect();
    let axes: Vec<_> = names.iter().filter_map(|name| axis(name)).collect();
    let mut columns = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let heading = name.strip_prefix("heading_").and_then(axis);
        let place = heading.and_then(|id| axes.iter().position(|axis| *axis == id));
        let column = match (*name, place) {
            (_, Some(place)) => Column::Heading(place),
            ("speed", _) => Column::Speed,
            (name, _) if axis(name).is_some() => Column::At,
            (name, _) => {
                let words = format!(
                    "`{name}` is no column: write axis ids, `speed`, or `heading_ID` of an axis that has a column"
                );
                return Err(wrong(line, words));
            }
        };
        if names[..index].contains(name) {
            return Err(wrong(line, format!("the column `{name}` stands twice")));
        }
        columns.push(column);
    }
    Ok((axes, columns))
}

fn waypoint(
    line: usize,
    text: &str,
    axes: usize,
    columns: &[Column],
) -> Result<Waypoint, PathError> {
    let cells: Vec<_> = text.split(',').map(str::trim).collect();
    if cells.len() != columns.len() {
        let (is, should) = (cells.len(), columns.len());
        return Err(wrong(
            line,
            format!("{is} cells, but the header has {should}"),
        ));
    }
    let number = |cell: &str| match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(wrong(line, format!("`{cell}` is no number"))),
    };
    let mut point = Waypoint::default();
    let mut heading = vec![None; axes];
    for (cell, column) in cells.iter().zip(columns) {
        match column {
            Column::At => {
                let radians = angle(cell).map_err(|error| wrong(line, error.to_string()))?;
                point.at.push(radians);
            }
            Column::Heading(_) | Column::Speed if cell.is_empty() => {}
            Column::Heading(place) => heading[*place] = Some(number(cell)?),
            Column::Speed => point.speed = Some(number(cell)?),
        }
    }
    if heading.iter().any(Option::is_some) {
        // A direction of some axes is one in which the others rest.
        let parts = heading.iter().map(|part| part.unwrap_or_default());
        point.heading = Some(parts.collect());
    }
    Ok(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_formats_say_the_same() {
        let csv = parse("# a path\n1,2,speed,heading_2\n0,90deg,,\n1,2,0.5,1\n").expect("a path");
        let toml = parse(
            "axes = [1, 2]\n[[waypoint]]\nat = [0.0, \"90deg\"]\n[[waypoint]]\nat = [1, 2]\n\
             speed = 0.5\nheading = [0.0, 1.0]\n",
        )
        .expect("a path");
        assert_eq!(csv, toml);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (text, words) in [
            ("", "header"),
            ("1,1\n0,0\n1,1\n", "twice"),
            ("1,x\n0,0\n", "`x` is no column"),
            ("1,heading_2\n0,0\n", "heading_2"),
            ("1,2\n0,0\n1\n", "line 3: 1 cells"),
            ("1\n0\nnan\n", "line 3"),
            ("1,speed\n0,inf\n1,\n", "line 2: `inf`"),
            ("1\n0\n", "here are 1"),
            ("axes = [0]\n", "[0]"),
            ("axes = [1]\nwaypoints = 3\n", "waypoints"),
            (
                "axes = [1]\n[[waypoint]]\nat = [\"9x\"]\n",
                "waypoint 1: `9x`",
            ),
        ] {
            let error = parse(text).expect_err(text).to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
