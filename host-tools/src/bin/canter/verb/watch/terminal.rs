//! The terminal: a screen that is left as it was found, and keys.

use super::Show;
use super::screen::{draw, page};
use super::view::{Rate, View};
use crate::context::AnyClient;
use anyhow::{Context as _, Result};
use crossterm::event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, poll, read};
use ratatui::DefaultTerminal;
use std::ops::ControlFlow;
use std::time::Duration;

/// What a key means.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    End,
    /// The list begins at this axis, counted from 0.
    From(usize),
    Nothing,
}

/// The terminal's other screen with its keys, until it is dropped.
pub struct Screen {
    terminal: DefaultTerminal,
    rate: Rate,
    complaint: Option<String>,
    first: usize,
    has_colours: bool,
}

impl Screen {
    /// Opens it. A panic closes it before it says its words.
    pub fn open(client: &AnyClient) -> Result<Self> {
        let terminal = ratatui::try_init().inspect_err(|_| {
            // It may have got half the way.
            let _ = ratatui::try_restore();
        });
        Ok(Self {
            terminal: terminal
                .context("the terminal cannot show a screen: use --json, or a pipe to `cat`")?,
            rate: Rate::new(client.now(), client.frames_heard()),
            complaint: None,
            first: 0,
            has_colours: std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()),
        })
    }

    fn view(&mut self, client: &mut AnyClient) -> View {
        if let Some(words) = client.take_complaints().pop() {
            self.complaint = Some(words);
        }
        View {
            rate: self.rate.at(client.now(), client.frames_heard()),
            complaint: self.complaint.clone(),
            first: self.first,
            has_colours: self.has_colours,
            ..View::of(client)
        }
    }
}

impl Show for Screen {
    fn show(&mut self, client: &mut AnyClient) -> Result<ControlFlow<()>> {
        let view = self.view(client);
        self.terminal
            .draw(|frame| draw(frame, &view))
            .context("cannot write to the terminal")?;
        Ok(ControlFlow::Continue(()))
    }

    fn glance(&mut self, client: &mut AnyClient) -> Result<ControlFlow<()>> {
        let mut has_changed = false;
        while poll(Duration::ZERO).context("the terminal gives no keys any more")? {
            let event = read().context("the terminal gives no keys any more")?;
            // Another size is drawn on at once.
            has_changed = true;
            if let Event::Key(key) = event {
                let size = self.terminal.size().context("the terminal has no size")?;
                let (shown, last) = page(&self.view(client), size.into());
                match meaning(key, self.first, shown, last) {
                    Meaning::End => return Ok(ControlFlow::Break(())),
                    Meaning::From(first) => self.first = first,
                    Meaning::Nothing => {}
                }
            }
        }
        if has_changed {
            return self.show(client);
        }
        Ok(ControlFlow::Continue(()))
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // A panic has closed it already: a second time would put its words under whatever comes next.
        if !std::thread::panicking() {
            // There is nobody left to tell.
            let _ = ratatui::try_restore();
        }
    }
}

/// What a key means while the list begins at `first`, shows so many axes, and begins at `last` at most.
fn meaning(key: KeyEvent, first: usize, shown: usize, last: usize) -> Meaning {
    if key.kind == KeyEventKind::Release {
        return Meaning::Nothing;
    }
    let first = first.min(last);
    let from = match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return Meaning::End,
        KeyCode::Char('q') | KeyCode::Esc => return Meaning::End,
        KeyCode::Up => first.saturating_sub(1),
        KeyCode::Down => first.saturating_add(1),
        KeyCode::PageUp => first.saturating_sub(shown),
        KeyCode::PageDown => first.saturating_add(shown),
        KeyCode::Home => 0,
        KeyCode::End => last,
        _ => return Meaning::Nothing,
    };
    Meaning::From(from.min(last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_scroll_as_far_as_there_are_axes_and_end_it() {
        let of = |code, first| {
            let key = KeyEvent::new(code, KeyModifiers::NONE);
            meaning(key, first, 20, 43)
        };
        for (code, first, from) in [
            (KeyCode::Down, 0, 1),
            (KeyCode::Down, 43, 43),
            (KeyCode::Up, 0, 0),
            // Axes do not go, but lines of the terminal may come.
            (KeyCode::Up, 60, 42),
            (KeyCode::PageDown, 10, 30),
            (KeyCode::PageDown, 30, 43),
            (KeyCode::PageUp, 43, 23),
            (KeyCode::PageUp, 5, 0),
            (KeyCode::End, 0, 43),
            (KeyCode::Home, 43, 0),
        ] {
            assert_eq!(of(code, first), Meaning::From(from), "{code:?} {first}");
        }
        for code in [KeyCode::Char('q'), KeyCode::Esc] {
            assert_eq!(of(code, 3), Meaning::End);
        }
        assert_eq!(of(KeyCode::Char('c'), 3), Meaning::Nothing);
        let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(meaning(interrupt, 3, 20, 43), Meaning::End);
    }
}
