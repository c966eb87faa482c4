//! `canter watch`: every axis that is heard, as it changes. It only listens.

mod screen;
mod terminal;
mod view;

use super::status;
use crate::arguments::Watch;
use crate::context::{AnyClient, Context};
use anyhow::{Context as _, Result};
use canter::bus::Bus;
use canter::client::ClientError;
use canter_shared::time::BusTime;
use serde_json::{Value, json};
use std::io::{ErrorKind, IsTerminal, Write};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use terminal::Screen;

/// How often it is shown, in s, where nothing was said: to a person, and to whatever reads lines.
const SCREEN_PERIOD: f64 = 0.1;
const LINES_PERIOD: f64 = 1.0;

/// How long nobody looks at keys and signals, in microseconds.
const GLANCE: u64 = 50_000;

/// How late it may be, in microseconds, until frames may have been lost meanwhile; and how long it then listens before
/// it says who is silent. Heartbeats come every 200 ms at the least.
const HELD_UP: u64 = 250_000;

pub fn run(context: &Context, wanted: &Watch) -> Result<()> {
    let is_screen = !context.json && std::io::stdout().is_terminal();
    let mut client = context.client()?;
    // Virtual time goes by itself only where something ends it, and not before a person's eyes.
    let is_paced = context.is_simulated() && (is_screen || wanted.span.is_none());
    let schedule = Schedule::new(wanted, is_screen, is_paced, client.now());
    let ended = if is_screen {
        let mut screen = Screen::open(&client)?;
        watch(&mut client, schedule, &mut screen)
    } else {
        watch(&mut client, schedule, &mut Lines::new(context.json))
    };
    // By here the screen is closed, so that words stay.
    match ended {
        Err(error) if is_interrupt(&error) => Ok(()),
        ended => ended,
    }
}

fn is_interrupt(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(ClientError::Interrupted))
}

/// Where it is shown.
trait Show {
    /// Shows what the client knows; says whether anybody still looks.
    fn show(&mut self, client: &mut AnyClient) -> Result<ControlFlow<()>>;

    /// Looks for keys; says whether anybody still looks.
    fn glance(&mut self, client: &mut AnyClient) -> Result<ControlFlow<()>>;
}

fn watch(client: &mut AnyClient, mut schedule: Schedule, show: &mut impl Show) -> Result<()> {
    loop {
        client.listen_until(schedule.next_glance(client.now()))?;
        schedule.pace(client.now());
        let mut going = show.glance(client)?;
        if going.is_continue() && schedule.is_due(client.now()) {
            going = show.show(client)?;
        }
        if going.is_break() || schedule.is_over(client.now()) {
            return Ok(());
        }
    }
}

/// When it is shown, in the bus's own time.
struct Schedule {
    start: BusTime,
    /// In microseconds.
    period: u64,
    due: BusTime,
    end: Option<BusTime>,
    /// When the start was, for virtual time that is not to run ahead of real time.
    origin: Option<Instant>,
}

impl Schedule {
    fn new(wanted: &Watch, is_screen: bool, is_paced: bool, now: BusTime) -> Self {
        let usual = if is_screen {
            SCREEN_PERIOD
        } else {
            LINES_PERIOD
        };
        let period = microseconds(wanted.period.unwrap_or(usual));
        Self {
            start: now,
            period,
            due: after(now, if is_screen { GLANCE } else { period }),
            end: wanted.span.map(|span| after(now, microseconds(span))),
            origin: is_paced.then(Instant::now),
        }
    }

    /// Until when can be listened now.
    fn next_glance(&self, now: BusTime) -> BusTime {
        let due = self.end.map_or(self.due, |end| end.min(self.due));
        due.min(after(now, GLANCE))
    }

    /// Whether it is to be shown now, as it is at last at the end.
    fn is_due(&mut self, now: BusTime) -> bool {
        if now < self.due || self.is_over(now) {
            return self.is_over(now);
        }
        if now >= after(self.due, HELD_UP) {
            self.due = after(now, HELD_UP);
            return false;
        }
        self.due = after(self.due, self.period);
        // What was missed meanwhile is not made up for.
        if self.due <= now {
            self.due = after(now, self.period);
        }
        true
    }

    fn is_over(&self, now: BusTime) -> bool {
        self.end.is_some_and(|end| now >= end)
    }

    /// Waits until as much real time has passed as virtual time; never longer than a glance takes.
    fn pace(&self, now: BusTime) {
        if let Some(origin) = self.origin {
            let passed = Duration::from_micros(now.0.saturating_sub(self.start.0));
            std::thread::sleep(passed.saturating_sub(origin.elapsed()));
        }
    }
}

fn microseconds(seconds: f64) -> u64 {
    (seconds * 1e6).round() as u64
}

fn after(time: BusTime, microseconds: u64) -> BusTime {
    BusTime(time.0.saturating_add(microseconds))
}

/// Lines on stdout.
struct Lines {
    json: bool,
    /// Whether anything was shown before.
    has_begun: bool,
    /// Whether it was said that nobody is heard.
    has_waited: bool,
    /// What was said last of the bus: some complaints come again and again.
    complaint: Option<String>,
}

impl Lines {
    fn new(json: bool) -> Self {
        Self {
            json,
            has_begun: false,
            has_waited: false,
            complaint: None,
        }
    }

    fn text(&mut self, client: &AnyClient) -> String {
        let now = client.now();
        if self.json {
            return format!("{}\n", document(client, now));
        }
        let axes = client.axes();
        if axes.is_empty() {
            return String::new();
        }
        let rows = axes.iter().map(|(axis, known)| {
            let state = if known.is_silent(now) {
                "silent"
            } else {
                status::state(known)
            };
            status::row(*axis, known, state)
        });
        let mut lines = Vec::from([status::HEAD.to_owned()]);
        lines.extend(rows);
        if std::mem::replace(&mut self.has_begun, true) {
            lines.insert(0, String::new());
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    fn tell(&mut self, client: &mut AnyClient) {
        if client.axes().is_empty() && !std::mem::replace(&mut self.has_waited, true) {
            eprintln!("{}", nobody(&client.bus().description()));
        }
        for words in client.take_complaints() {
            if self.complaint.as_ref() != Some(&words) {
                eprintln!("bus: {words}");
                self.complaint = Some(words);
            }
        }
    }
}

impl Show for Lines {
    fn show(&mut self, client: &mut AnyClient) -> Result<ControlFlow<()>> {
        self.tell(client);
        let text = self.text(client);
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            // A reader that has seen enough, such as `head`, is no error.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ControlFlow::Break(())),
            written => written
                .map(ControlFlow::Continue)
                .context("cannot write to stdout"),
        }
    }

    fn glance(&mut self, _client: &mut AnyClient) -> Result<ControlFlow<()>> {
        Ok(ControlFlow::Continue(()))
    }
}

/// What to say while there is nothing to show.
fn nobody(bus: &str) -> String {
    format!("no axis is heard on {bus} yet")
}

/// All axes at `now`.
fn document(client: &AnyClient, now: BusTime) -> Value {
    let axes = client.axes().iter().map(|(axis, known)| {
        let mut document = status::document(*axis, known);
        document["silent"] = known.is_silent(now).into();
        document
    });
    json!({ "time": now.0 as f64 / 1e6, "axes": axes.collect::<Value>() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WANTED: Watch = Watch {
        period: Some(0.1),
        span: Some(0.25),
    };

    #[test]
    fn it_is_shown_each_period_and_at_the_end() {
        let mut schedule = Schedule::new(&WANTED, false, false, BusTime(1_000_000));
        let mut shown = Vec::new();
        let mut now = BusTime(1_000_000);
        while !schedule.is_over(now) {
            now = schedule.next_glance(now);
            if schedule.is_due(now) {
                shown.push(now.0);
            }
        }
        assert_eq!(shown, [1_100_000, 1_200_000, 1_250_000]);
    }

    #[test]
    fn periods_that_were_missed_are_not_made_up_for() {
        let mut schedule = Schedule::new(&WANTED, false, false, BusTime(0));
        schedule.end = None;
        for (now, is_due) in [
            (320_000, true),
            (330_000, false),
            (419_999, false),
            (420_000, true),
            (520_000, true),
        ] {
            assert_eq!(schedule.is_due(BusTime(now)), is_due, "{now}");
        }
    }

    #[test]
    fn who_was_held_up_listens_before_it_calls_axes_silent() {
        let mut schedule = Schedule::new(&WANTED, false, false, BusTime(0));
        schedule.end = None;
        for (now, is_due) in [(5_000_000, false), (5_249_999, false), (5_250_000, true)] {
            assert_eq!(schedule.is_due(BusTime(now)), is_due, "{now}");
        }
    }
}
