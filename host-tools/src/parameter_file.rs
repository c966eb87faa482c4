//! Parameters in a file, as `canter param export` writes and `import` reads them.
//!
//! ```toml
//! [axis.1]
//! limits.velocity = 20        # rad/s
//! limits.position_max = "90deg"
//! bus.reaction = "quick_stop"
//! ```
//!
//! What is not named stays as it is. A value is a number in the parameter's unit, or a text such as
//! the command line takes.

use crate::client::Change;
use crate::notation::{ParameterTextError, parameter_named, parameter_raw, parameter_text};
use canter_shared::parameter::{Kind, Parameter};
use canter_shared::wire::id::{AxisId, LAST_AXIS};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Why a file of parameters cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ParameterFileError {
    /// It cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not TOML.
    #[error("{path} is not valid: {source}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: Box<toml::de::Error>,
    },
    /// Something stands where it cannot.
    #[error("{path}: `{key}` {why}")]
    Shape {
        /// The file.
        path: PathBuf,
        /// Where.
        key: String,
        /// What is wrong with it, and what would be right.
        why: &'static str,
    },
    /// A value is none of its parameter.
    #[error("{path}, axis {axis}: {source}")]
    Value {
        /// The file.
        path: PathBuf,
        /// Of which axis.
        axis: AxisId,
        /// Which parameter, and what it takes.
        source: ParameterTextError,
    },
}

/// Reads a file.
///
/// # Errors
/// The file's name, and what is wrong in it.
pub fn read(path: &Path) -> Result<Vec<Change>, ParameterFileError> {
    let text = std::fs::read_to_string(path).map_err(|source| ParameterFileError::Read {
        path: path.to_owned(),
        source,
    })?;
    parse(&text, path)
}

/// Reads the text of a file; `path` is for the errors.
///
/// # Errors
/// As of [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Vec<Change>, ParameterFileError> {
    let shape = |key: &str, why| ParameterFileError::Shape {
        path: path.to_owned(),
        key: key.to_owned(),
        why,
    };
    let file: Table = toml::from_str(text).map_err(|source| ParameterFileError::Syntax {
        path: path.to_owned(),
        source: Box::new(source),
    })?;
    if let Some(other) = file.keys().find(|key| *key != "axis") {
        return Err(shape(other, "has no place here: write [axis.1]"));
    }
    let Some(Value::Table(axes)) = file.get("axis") else {
        return Err(shape(
            "axis",
            "is missing: write [axis.1] and what it is to have",
        ));
    };
    let mut changes = Vec::new();
    for (id, values) in axes {
        let key = format!("axis.{id}");
        let axis = id.parse().ok().and_then(AxisId::new);
        let axis = axis.ok_or_else(|| shape(&key, "is no axis: ids are from 1 to 63"))?;
        const _: () = assert!(LAST_AXIS == 63);
        let Value::Table(values) = values else {
            return Err(shape(&key, "is no section: write [axis.1]"));
        };
        for (name, value) in flat(values, "") {
            let value_error = |source| ParameterFileError::Value {
                path: path.to_owned(),
                axis,
                source,
            };
            let parameter = parameter_named(&name).map_err(value_error)?;
            let text = match value {
                Value::String(text) => text.clone(),
                Value::Integer(number) => number.to_string(),
                Value::Float(number) => number.to_string(),
                _ => return Err(shape(&name, "is neither a number nor a text")),
            };
            let raw = parameter_raw(parameter, &text).map_err(value_error)?;
            changes.push(Change {
                axis,
                parameter,
                raw,
            });
        }
    }
    // In the order of the tables, not of the letters.
    changes.sort_by_key(|change| (change.axis, change.parameter));
    Ok(changes)
}

/// The values of a table and of those in it, by their dotted names.
fn flat<'table>(table: &'table Table, before: &str) -> Vec<(String, &'table Value)> {
    let mut values = Vec::new();
    for (key, value) in table {
        let name = format!("{before}{key}");
        match value {
            Value::Table(inner) => values.extend(flat(inner, &format!("{name}."))),
            _ => values.push((name, value)),
        }
    }
    values
}

/// The text of a file that says these values.
pub fn format(axes: &[(AxisId, Vec<(Parameter, i64)>)]) -> String {
    let mut text = String::from("# Parameters of canter's axes: `canter param import FILE`\n");
    for (axis, values) in axes {
        // Writing to a text does not fail.
        let _ = writeln!(text, "\n[axis.{axis}]");
        for (parameter, raw) in values {
            let entry = parameter.entry();
            let value = parameter_text(*parameter, *raw);
            let _ = match entry.kind {
                Kind::Choice(_) => writeln!(text, "{} = \"{value}\"", entry.name),
                Kind::Number { .. } if entry.unit.is_empty() => {
                    writeln!(text, "{} = {value}", entry.name)
                }
                Kind::Number { .. } => {
                    writeln!(text, "{} = {value} # {}", entry.name, entry.unit)
                }
            };
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use canter_shared::parameter::Values;

    fn parsed(text: &str) -> Result<Vec<Change>, ParameterFileError> {
        parse(text, Path::new("p.toml"))
    }

    #[test]
    fn what_is_written_reads_back() {
        let axes: Vec<_> = [1, 63]
            .into_iter()
            .filter_map(AxisId::new)
            .map(|axis| {
                let values = Values::defaults(axis.get());
                let values = Parameter::ALL.map(|parameter| (parameter, values.get(parameter)));
                (axis, values.to_vec())
            })
            .collect();
        let read = parsed(&format(&axes)).expect("it is valid");
        assert_eq!(read.len(), 2 * Parameter::COUNT);
        for (axis, values) in axes {
            for (parameter, raw) in values {
                let change = Change {
                    axis,
                    parameter,
                    raw,
                };
                assert!(read.contains(&change), "{change:?}");
            }
        }
    }

    #[test]
    fn a_bad_file_says_what_is_wrong() {
        for (text, words) in [
            ("", "`axis` is missing"),
            ("axis = 3\n", "`axis` is missing"),
            ("[axes.1]\n", "`axes` has no place here"),
            ("[axis.64]\n", "`axis.64` is no axis"),
            ("[axis.all]\n", "`axis.all` is no axis"),
            ("[axis]\n1 = 3\n", "`axis.1` is no section"),
            (
                "[axis.1]\nlimits.speed = 3\n",
                "axis 1: `limits.speed` is no parameter",
            ),
            ("[axis.1]\nlimits.velocity = true\n", "neither a number nor"),
            (
                "[axis.1]\nlimits.velocity = 1e9\n",
                "from 0.0001 to 10000 rad/s",
            ),
            ("[axis.1]\nbus.reaction = \"no\"\n", "controlled_stop"),
            (
                "[axis.1]\nlimits.velocity = 1\nlimits.velocity = 2\n",
                "duplicate key",
            ),
            ("[axis.1\n", "not valid"),
        ] {
            let error = parsed(text).expect_err(text).to_string();
            assert!(error.contains(words), "{text}: {error}");
            assert!(error.contains("p.toml"), "{error}");
        }
    }
}
