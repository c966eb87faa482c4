//! What may be asked of a robot under way, and how it is written.

use crate::gait::{Body, Gait, GaitError, Kind};
use crate::notation::{QuantityError, angle};

/// What is asked of a robot under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Other velocities, height or lean.
    Body(Body),
    /// Another gait.
    Gait(Gait),
    /// Settle and stand; a gait goes on from there.
    Stand,
    /// Settle, stand, sit down. Nothing is obeyed after it.
    Stop,
}

impl Order {
    /// Whether its numbers make sense.
    ///
    /// # Errors
    /// [`Body::check`], [`Gait::check`].
    pub fn check(&self) -> Result<(), GaitError> {
        match self {
            Self::Body(body) => body.check(),
            Self::Gait(gait) => gait.check(),
            Self::Stand | Self::Stop => Ok(()),
        }
    }
}

/// What one line of orders says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Line {
    /// An order.
    Order(Order),
    /// Nothing for so many s of the motion.
    Wait(f64),
    /// Nothing at all: it is empty, or a comment after `#`.
    Nothing,
}

/// What an order may be.
const POSSIBLE: &str = "write `vx 0.3`, `vy -0.1`, `yaw 20deg`, `height 0.28`, `roll 5deg`, `pitch -3deg`, \
     several of them on a line, or alone on a line `gait pace`, `wait 2` or `stop`";

/// Why a line is no order.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OrderError {
    /// A word that stands for nothing.
    #[error("`{0}` is no order: {POSSIBLE}")]
    Word(String),
    /// A word without what belongs behind it.
    #[error("`{0}` stands there without its value: {POSSIBLE}")]
    NoValue(String),
    /// A word that stands alone on a line.
    #[error("`{0}` must be alone on its line: {POSSIBLE}")]
    NotAlone(String),
    /// A value that is no number.
    #[error("`{word} {text}`: `{text}` is no number: {POSSIBLE}")]
    Number {
        /// The word before it.
        word: String,
        /// The value.
        text: String,
    },
    /// An angle that is none.
    #[error("{word}: {source}")]
    Angle {
        /// The word before it.
        word: String,
        /// What is wrong.
        source: QuantityError,
    },
    /// A gait that nobody knows.
    #[error("`{0}` is no gait: choose one of {list}", list = Kind::ALL.map(Kind::name).join(", "))]
    Gait(String),
    /// A time to wait that is none.
    #[error("`wait {0}`: a time is from 0 to {LONGEST_WAIT} s")]
    Wait(String),
    /// Numbers out of their ranges.
    #[error(transparent)]
    Range(#[from] GaitError),
}

/// For how long a line may wait, in s.
const LONGEST_WAIT: f64 = 86_400.0;

impl Line {
    /// What a line says to a robot that does `body` now.
    ///
    /// # Errors
    /// What is wrong with it, and what is possible.
    pub fn parse(text: &str, body: &Body) -> Result<Self, OrderError> {
        let text = text.split('#').next().unwrap_or_default();
        let mut words = text.split_whitespace();
        let Some(first) = words.next() else {
            return Ok(Self::Nothing);
        };
        let mut alone = |value: bool| {
            let value = if value {
                words
                    .next()
                    .ok_or_else(|| OrderError::NoValue(first.to_owned()))?
            } else {
                ""
            };
            match words.next() {
                None => Ok(value),
                Some(_) => Err(OrderError::NotAlone(first.to_owned())),
            }
        };
        match first {
            "stop" => return alone(false).map(|_| Self::Order(Order::Stop)),
            "wait" => return wait(alone(true)?),
            "gait" => return gait(alone(true)?),
            _ => {}
        }
        let mut body = *body;
        let mut words = text.split_whitespace();
        while let Some(word) = words.next() {
            let place = match word {
                "vx" => &mut body.vx,
                "vy" => &mut body.vy,
                "yaw" => &mut body.yaw_rate,
                "height" => &mut body.height,
                "roll" => &mut body.roll,
                "pitch" => &mut body.pitch,
                "stop" | "wait" | "gait" => return Err(OrderError::NotAlone(word.to_owned())),
                _ => return Err(OrderError::Word(word.to_owned())),
            };
            let value = words
                .next()
                .ok_or_else(|| OrderError::NoValue(word.to_owned()))?;
            *place = match word {
                "yaw" | "roll" | "pitch" => angle(value).map_err(|source| OrderError::Angle {
                    word: word.to_owned(),
                    source,
                })?,
                _ => value.parse().map_err(|_| OrderError::Number {
                    word: word.to_owned(),
                    text: value.to_owned(),
                })?,
            };
        }
        body.check()?;
        Ok(Self::Order(Order::Body(body)))
    }
}

fn wait(text: &str) -> Result<Line, OrderError> {
    let seconds = text.strip_suffix('s').unwrap_or(text).parse().ok();
    // A NaN is in no range.
    let seconds = seconds.filter(|seconds| (0.0..=LONGEST_WAIT).contains(seconds));
    seconds
        .map(Line::Wait)
        .ok_or_else(|| OrderError::Wait(text.to_owned()))
}

fn gait(name: &str) -> Result<Line, OrderError> {
    let kind = Kind::ALL.into_iter().find(|kind| kind.name() == name);
    let kind = kind.ok_or_else(|| OrderError::Gait(name.to_owned()))?;
    Ok(Line::Order(kind.gait().map_or(Order::Stand, Order::Gait)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: Body = Body {
        vx: 0.1,
        ..Body::standing(0.3)
    };

    #[test]
    fn lines_say_what_is_to_change_and_leave_the_rest() {
        for (text, line) in [
            ("", Line::Nothing),
            ("  # vx 3", Line::Nothing),
            ("wait 2", Line::Wait(2.0)),
            ("wait 0.5s", Line::Wait(0.5)),
            ("stop # at last", Line::Order(Order::Stop)),
            ("gait stand", Line::Order(Order::Stand)),
            (
                "vy -0.1 yaw 0.5turn",
                Line::Order(Order::Body(Body {
                    vy: -0.1,
                    yaw_rate: std::f64::consts::PI,
                    ..BODY
                })),
            ),
            (
                "height 0.28 roll 0.1 pitch -0.1 vx 0",
                Line::Order(Order::Body(Body {
                    vx: 0.0,
                    height: 0.28,
                    roll: 0.1,
                    pitch: -0.1,
                    ..BODY
                })),
            ),
        ] {
            assert_eq!(Line::parse(text, &BODY), Ok(line), "{text}");
        }
        let pace = Kind::Pace.gait().expect("it walks");
        let line = Line::parse("gait pace", &BODY);
        assert_eq!(line, Ok(Line::Order(Order::Gait(pace))));
    }

    #[test]
    fn bad_lines_say_what_is_possible() {
        for (text, words) in [
            ("forward", "`forward` is no order: write `vx 0.3`"),
            ("vx", "without its value"),
            ("vx fast", "`fast` is no number"),
            ("vx nan", "vx is NaN m/s"),
            ("vx 99", "from -10 to 10 m/s"),
            ("yaw 20grad", "write `1.5`"),
            ("vx 0.3 stop", "alone on its line"),
            ("stop vx 0.3", "alone on its line"),
            ("gait canter", "choose one of stand, walk"),
            ("gait", "without its value"),
            ("wait -1", "from 0 to 86400 s"),
            ("wait nan", "from 0 to 86400 s"),
        ] {
            let error = Line::parse(text, &BODY).expect_err(text).to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
