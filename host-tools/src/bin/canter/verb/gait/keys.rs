//! Orders by keys.

use super::pilot::Heard;
use super::signals::Signals;
use anyhow::{Context as _, Result};
use canter::gait::{Body, Kind};
use canter::walk::Order;
use crossterm::event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, poll, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use std::time::Duration;

/// What one key changes, in m/s and in rad/s.
const SPEED_STEP: f64 = 0.05;
const TURN_STEP: f64 = 0.1;

/// What the keys do, in a line.
pub const HELP: &str = "keys: up and down change the speed, left and right turn, `,` and `.` go sideways, 1 to 6 \
                        change the gait, 0 stands, space goes nowhere, q settles and sits";

/// What a key means.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    Order(Order),
    Interrupt,
    Nothing,
}

/// The terminal in raw mode, until it is dropped.
pub struct Keys {
    signals: Signals,
}

impl Keys {
    pub fn new(signals: Signals) -> Result<Self> {
        enable_raw_mode().context("the terminal gives no single keys: use --orders")?;
        Ok(Self { signals })
    }

    /// What was asked for since the last time, for a robot that does `body` now: several changes of
    /// the body are one order.
    pub fn next(&mut self, body: &Body) -> Heard {
        let mut heard = Heard::Nothing;
        let mut body = *body;
        loop {
            let key =
                match poll(Duration::ZERO).and_then(|is_there| is_there.then(read).transpose()) {
                    Ok(Some(Event::Key(key))) => key,
                    Ok(Some(_)) => continue,
                    Ok(None) => return heard,
                    // Whoever hung up leads no more.
                    Err(_) => return Heard::Over,
                };
            match meaning(key, &body) {
                Meaning::Order(Order::Body(changed)) => {
                    body = changed;
                    heard = Heard::Order(Order::Body(body));
                }
                Meaning::Order(order) => return Heard::Order(order),
                Meaning::Interrupt => self.signals.raise(),
                Meaning::Nothing => {}
            }
        }
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        // There is nobody left to tell.
        let _ = disable_raw_mode();
    }
}

fn meaning(key: KeyEvent, body: &Body) -> Meaning {
    if key.kind == KeyEventKind::Release {
        return Meaning::Nothing;
    }
    let mut body = *body;
    let sideways = key.modifiers.contains(KeyModifiers::SHIFT);
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => {
            return Meaning::Interrupt;
        }
        KeyCode::Char('q') | KeyCode::Esc => return Meaning::Order(Order::Stop),
        KeyCode::Char(digit @ '0'..='6') => {
            let kind = digit
                .to_digit(10)
                .and_then(|digit| Kind::ALL.get(digit as usize));
            let gait = kind.and_then(|kind| kind.gait());
            return Meaning::Order(gait.map_or(Order::Stand, Order::Gait));
        }
        KeyCode::Char(' ') => body = body.at_rest(),
        KeyCode::Up => body.vx += SPEED_STEP,
        KeyCode::Down => body.vx -= SPEED_STEP,
        KeyCode::Left if sideways => body.vy += SPEED_STEP,
        KeyCode::Right if sideways => body.vy -= SPEED_STEP,
        KeyCode::Char(',') => body.vy += SPEED_STEP,
        KeyCode::Char('.') => body.vy -= SPEED_STEP,
        KeyCode::Left => body.yaw_rate += TURN_STEP,
        KeyCode::Right => body.yaw_rate -= TURN_STEP,
        _ => return Meaning::Nothing,
    }
    for value in [&mut body.vx, &mut body.vy, &mut body.yaw_rate] {
        // Sums of steps are off by rounding, and there and back is where one began.
        *value = (*value * 1e6).round() / 1e6;
    }
    Meaning::Order(Order::Body(body))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: Body = Body::standing(0.3);

    fn after(keys: &[KeyCode], modifiers: KeyModifiers) -> Body {
        keys.iter().fold(BODY, |body, key| {
            match meaning(KeyEvent::new(*key, modifiers), &body) {
                Meaning::Order(Order::Body(body)) => body,
                other => panic!("{other:?}"),
            }
        })
    }

    #[test]
    fn keys_change_velocities_there_and_back() {
        use KeyCode::{Char, Down, Left, Right, Up};
        let plain = KeyModifiers::NONE;
        let fast = after(&[Up, Up, Up, Left, Char('.')], plain);
        assert_eq!((fast.vx, fast.vy, fast.yaw_rate), (0.15, -0.05, 0.1));
        let back = [
            Up,
            Up,
            Up,
            Left,
            Char('.'),
            Down,
            Down,
            Down,
            Right,
            Char(','),
        ];
        assert_eq!(after(&back, plain), BODY);
        assert_eq!(after(&[Left, Left], KeyModifiers::SHIFT).vy, 0.1);
        assert_eq!(after(&[Up, Right, Char(',')], plain).at_rest(), BODY);
        assert_eq!(after(&[Up, Right, Char(' ')], plain), BODY);
    }

    #[test]
    fn keys_change_gaits_and_end() {
        let of = |code, modifiers| meaning(KeyEvent::new(code, modifiers), &BODY);
        let plain = KeyModifiers::NONE;
        let trot = Kind::Trot.gait().expect("it walks");
        for (code, modifiers, meaning) in [
            (KeyCode::Char('2'), plain, Meaning::Order(Order::Gait(trot))),
            (KeyCode::Char('0'), plain, Meaning::Order(Order::Stand)),
            (KeyCode::Char('q'), plain, Meaning::Order(Order::Stop)),
            (KeyCode::Esc, plain, Meaning::Order(Order::Stop)),
            (
                KeyCode::Char('c'),
                KeyModifiers::CONTROL,
                Meaning::Interrupt,
            ),
            (KeyCode::Char('c'), plain, Meaning::Nothing),
        ] {
            assert_eq!(of(code, modifiers), meaning, "{code:?}");
        }
    }
}
