//! Streams: a motion that is made up as it goes, sent to several axes as knots.
//!
//! All axes begin at one tick. From then on each gets one knot for each period, somewhat ahead of
//! its time. Knots are not answered unless something is wrong with them, so nothing is waited for;
//! what an axis does say is looked at between two periods. The last knot is at rest, and so the
//! stream ends; it is sent again until it is due, since no later knot would tell that it was lost.
//!
//! | file | what it holds |
//! |---|---|
//! | `under_way` | the knots that are out, and when each is due |
//! | `answers` | what axes say to their knots, and what is sent again |
//! | `losses` | how many knots an axis may lose until that is too many |

mod answers;
mod losses;
mod under_way;

use super::link::{MILLISECOND, after};
use super::{Client, ClientError};
use crate::bus::Bus;
use canter_shared::motion::stream::LOOK_AHEAD;
use canter_shared::time::{BusTime, Tick, Ticks};
use canter_shared::wire::command::Command;
use canter_shared::wire::id::AxisId;
use losses::Losses;
use std::collections::VecDeque;
use std::num::NonZeroU8;
use under_way::{Sent, Stream, Timing};

/// Between the command that begins a stream and the first knot: time for the command to be asked
/// for again where it was lost.
const LEAD: u64 = 150 * MILLISECOND;

/// How long a knot may be on its way: through a serial adapter, or behind a host that is busy.
const LATENCY: u64 = 20 * MILLISECOND;

/// How much later than its last knot a stream may end until it counts as lost.
const GRACE: u64 = 2_000 * MILLISECOND;

/// Where an axis is to be at a knot's time, and how fast it is to pass there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamKnot {
    /// In rad.
    pub position: f64,
    /// In rad/s.
    pub velocity: f64,
}

/// How quickly knots follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pace {
    /// From knot to knot, 1 to 255 ms.
    pub period: NonZeroU8,
    /// How long before its time a knot is sent: more where it would come after the one before it has
    /// passed, less where an axis could not hold as many.
    pub look_ahead: Ticks,
}

impl Default for Pace {
    /// A knot every 20 ms, 100 ms ahead.
    fn default() -> Self {
        Self {
            period: NonZeroU8::MIN.saturating_add(19),
            look_ahead: Ticks(100),
        }
    }
}

impl Pace {
    fn period(&self) -> u64 {
        u64::from(self.period.get()) * MILLISECOND
    }

    fn look_ahead(&self) -> u64 {
        let asked = u64::from(self.look_ahead.0) * MILLISECOND;
        // A knot must be there when the one before it passes.
        let least = self.period() + LATENCY;
        // An axis holds so many pieces between knots, the one under way among them. One less, for
        // a node whose clock is a little behind.
        let most = (LOOK_AHEAD as u64 - 1) * self.period();
        asked.max(least).min(most)
    }
}

/// How a stream came out for one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamEnd {
    /// Which axis.
    pub axis: AxisId,
    /// Where its drive is, in rad.
    pub position: f64,
    /// The tick that it was told to leave at, as all axes of the stream.
    pub leaves: Tick,
    /// The start that the axis measured.
    pub start: BusTime,
    /// How much later it measured its start than the earliest axis of the stream.
    pub skew_microseconds: u64,
    /// Knots that were lost on their way and bridged by the axis.
    pub missing: u32,
}

impl<B: Bus> Client<B> {
    /// Leads `axes`, which this session holds and which rest, along knots: `knots` gives one for each
    /// axis, in their order, for each period. The first ones are due a period after the start; from
    /// the place where each axis rests they must be within its reach. The last ones must be at
    /// rest. Comes back when all axes rest there.
    ///
    /// Each next item is asked for just before it has to be sent, and must come at once: while it
    /// is waited for, no heartbeat goes out.
    ///
    /// # Errors
    /// A knot that an axis refuses, an axis that faults, is lost or is stopped by somebody else, an
    /// interrupt, or knots that end in motion: all axes are stopped.
    pub fn stream(
        &mut self,
        axes: &[AxisId],
        pace: Pace,
        knots: impl IntoIterator<Item = Vec<StreamKnot>>,
    ) -> Result<Vec<StreamEnd>, ClientError> {
        if axes.is_empty() {
            return Err(ClientError::NoGoals);
        }
        self.check_enabled(axes)?;
        self.wait_for_rest(axes)?;
        let result = self.run_stream(axes, pace, &mut knots.into_iter());
        if result.is_err() {
            // Whatever went wrong: the others must not go on alone. The flag is taken back, or
            // the stop itself would be interrupted.
            self.interrupt
                .store(false, std::sync::atomic::Ordering::Relaxed);
            let _ = self.stop(axes);
        }
        result
    }

    fn run_stream(
        &mut self,
        axes: &[AxisId],
        pace: Pace,
        knots: &mut dyn Iterator<Item = Vec<StreamKnot>>,
    ) -> Result<Vec<StreamEnd>, ClientError> {
        let mut stream = self.begin_stream(axes, pace)?;
        loop {
            self.send_knots(&mut stream, knots)?;
            let all_sent = |sent: &Sent| sent.next == stream.following();
            if stream.complete && stream.sent.iter().all(all_sent) {
                break;
            }
            let mut wake = stream.timing.departs(stream.following());
            for sent in &stream.sent {
                wake = wake.min(after(stream.timing.departs(sent.next), sent.delay));
            }
            let wake = wake.max(after(self.bus.now(), MILLISECOND));
            self.wait(wake, |_| false)?;
            self.hear_answers(&mut stream)?;
        }
        if let Some(sent) = stream.sent.iter().find(|sent| !sent.last.1) {
            return Err(ClientError::EndsInMotion { axis: sent.axis });
        }
        self.finish_stream(&mut stream)
    }

    fn begin_stream(&mut self, axes: &[AxisId], pace: Pace) -> Result<Stream, ClientError> {
        let start = after(self.bus.now(), LEAD + pace.look_ahead()).next_tick();
        let sequence = self.next_sequence();
        for axis in axes {
            if let Some(known) = self.axes.get_mut(axis) {
                known.started = None;
                known.moving = Some(true);
            }
        }
        let begin = Command::StreamBegin {
            start,
            period: pace.period.get(),
            number: 0,
            sequence,
        };
        let questions: Vec<_> = axes.iter().map(|axis| (*axis, begin)).collect();
        self.demand(sequence, &questions)?;
        let position = |axis| self.axes.get(axis).and_then(|known| known.position);
        let sent = axes.iter().map(|axis| Sent {
            axis: *axis,
            next: 1,
            delay: 0,
            missing: 0,
            losses: Losses::default(),
            asked_again: (0, 0),
            last: (position(axis).unwrap_or_default(), true),
        });
        Ok(Stream {
            sequence,
            timing: Timing { start, pace },
            sent: sent.collect(),
            window: VecDeque::new(),
            first: 1,
            complete: false,
        })
    }

    /// Sends what is due.
    fn send_knots(
        &mut self,
        stream: &mut Stream,
        knots: &mut dyn Iterator<Item = Vec<StreamKnot>>,
    ) -> Result<(), ClientError> {
        while !stream.complete && stream.timing.departs(stream.following()) <= self.bus.now() {
            match knots.next() {
                Some(knots) => stream.take(&knots)?,
                None => stream.complete = true,
            }
        }
        stream.forget(self.bus.now());
        // In the order of their times, so that no axis runs dry for the sake of another.
        for (place, commands) in stream.window.iter().enumerate() {
            let number = stream.first + place as u64;
            let departs = stream.timing.departs(number);
            for (sent, command) in stream.sent.iter_mut().zip(commands) {
                if sent.next == number && after(departs, sent.delay) <= self.bus.now() {
                    self.tell(sent.axis.into(), *command)?;
                    sent.next += 1;
                }
            }
        }
        Ok(())
    }

    /// Waits until all axes rest at their last knots.
    fn finish_stream(&mut self, stream: &mut Stream) -> Result<Vec<StreamEnd>, ClientError> {
        let end = stream.timing.due(stream.following() - 1);
        let deadline = after(end, GRACE);
        while after(self.bus.now(), LATENCY) < end {
            if let Some(last) = stream.window.back() {
                for (sent, command) in stream.sent.iter().zip(last) {
                    self.tell(sent.axis.into(), *command)?;
                }
            }
            let next = after(self.bus.now(), stream.timing.pace.period());
            self.wait(next.min(end), |_| false)?;
            self.hear_answers(stream)?;
        }
        loop {
            let next = after(self.bus.now(), 50 * MILLISECOND).min(deadline);
            let over = self.wait(next, |known| {
                stream.sent.iter().all(|sent| {
                    let known = known.get(&sent.axis);
                    known.is_some_and(|known| known.moving == Some(false))
                })
            })?;
            self.hear_answers(stream)?;
            if over {
                break;
            }
            if self.bus.now() >= deadline {
                let moving = |sent: &&Sent| {
                    let known = self.axes.get(&sent.axis);
                    known.is_none_or(|known| known.moving != Some(false))
                };
                let late = stream.sent.iter().find(moving).or(stream.sent.first());
                let axis = late.map(|sent| sent.axis).ok_or(ClientError::NoGoals)?;
                return Err(ClientError::TooSlow {
                    axis,
                    what: "come to the end of its stream",
                    seconds: (end.0 - stream.timing.start.time().0) as f64 / 1e6,
                });
            }
        }
        self.settle(stream.sent.iter().map(|sent| (sent.axis, sent.last.0)))?;
        self.stream_ends(stream)
    }

    fn stream_ends(&self, stream: &Stream) -> Result<Vec<StreamEnd>, ClientError> {
        let start = |axis: &AxisId| {
            let started = self.axes.get(axis).and_then(|known| known.started);
            let own = started.filter(|(sequence, _)| *sequence == stream.sequence);
            // A report that was lost: when it was to leave.
            own.map_or(stream.timing.start.time(), |(_, time)| time)
        };
        let earliest = stream.sent.iter().map(|sent| start(&sent.axis)).min();
        let earliest = earliest.unwrap_or_default();
        let end = |sent: &Sent| {
            let position = self.rests_at(sent.axis, sent.last.0)?;
            let start = start(&sent.axis);
            Ok(StreamEnd {
                axis: sent.axis,
                position: position.radians(),
                leaves: stream.timing.start,
                start,
                skew_microseconds: start.0 - earliest.0,
                missing: sent.missing,
            })
        };
        stream.sent.iter().map(end).collect()
    }
}
