//! What axes say to their knots, and what is sent again.

use super::under_way::{Sent, Stream};
use crate::bus::Bus;
use crate::client::known::{Answer, KnownAxis};
use crate::client::link::{MILLISECOND, after};
use crate::client::{Client, ClientError};
use canter_shared::motion::stream::LONGEST_GAP;
use canter_shared::time::BusTime;
use canter_shared::wire::id::Function;
use canter_shared::wire::reason::Reason;

/// How often a refused knot is sent again: what was sent again may be lost too.
const MOST_ASKED: u32 = 3;

impl<B: Bus> Client<B> {
    /// Looks at what the axes said about their knots, and for trouble.
    pub(super) fn hear_answers(&mut self, stream: &mut Stream) -> Result<(), ClientError> {
        let now = self.bus.now();
        let is_silent = |known: &KnownAxis| now > after(known.heard, known.silence());
        let mut led = stream.sent.iter();
        if led.any(|sent| self.axes.get(&sent.axis).is_some_and(is_silent)) {
            // This host may have been held up, and what they said waits to be read.
            self.catch_up()?;
        }
        for index in 0..stream.sent.len() {
            let axis = stream.sent[index].axis;
            let Some(known) = self.axes.get_mut(&axis) else {
                continue;
            };
            if is_silent(known) {
                let bus = self.bus.description();
                return Err(ClientError::NoAnswer { axis, bus });
            }
            if let Some(fault) = known.fault {
                return Err(ClientError::Faulted { axis, fault });
            }
            for answer in answers(known) {
                stream.hear(index, answer, now)?;
            }
        }
        Ok(())
    }
}

/// What it said of knots since the last look.
fn answers(known: &mut KnownAxis) -> Vec<Answer> {
    let of_knots = |answer: &mut Answer| answer.function == Function::Knot;
    known.answers.extract_if(.., of_knots).collect()
}

impl Stream {
    /// Takes what an axis said of one knot.
    fn hear(&mut self, index: usize, answer: Answer, now: BusTime) -> Result<(), ClientError> {
        let number = self.latest(answer.sequence);
        let (first, departs) = (self.first, self.timing.departs(number.max(self.first)));
        let Some(sent) = self.sent.get_mut(index) else {
            return Ok(());
        };
        match answer.reason {
            Reason::Accepted => {
                sent.missing += answer.detail;
                sent.losses.note(number, answer.detail.into());
            }
            Reason::StreamFull => {
                // From that one on again, and all of them later.
                sent.next = sent.next.min(number.max(first));
                let room = after(now, u64::from(answer.detail + 1) * MILLISECOND);
                sent.delay = sent.delay.max(room.0.saturating_sub(departs.0));
            }
            // A longer curve over knots that were lost may be too much where the knots are not.
            Reason::TooFast | Reason::TooStrong | Reason::KnotsMissing if sent.may_ask(number) => {
                let lost = u64::from(answer.detail).max(u64::from(LONGEST_GAP) - 1);
                sent.next = sent.next.min(number.saturating_sub(lost).max(first));
                sent.losses.note(number, 1);
            }
            reason => {
                return Err(ClientError::Refused {
                    axis: sent.axis,
                    function: Function::Knot,
                    reason,
                    detail: answer.detail,
                });
            }
        }
        match sent.losses.too_many() {
            Some(lost) => Err(ClientError::Lossy {
                axis: sent.axis,
                lost,
                of: super::losses::LOOKED_AT,
            }),
            None => Ok(()),
        }
    }
}

impl Sent {
    /// Whether a refused knot may be sent once more with those before it: what an axis has already
    /// it passes over, and what it lost comes first then.
    fn may_ask(&mut self, number: u64) -> bool {
        let (last, times) = self.asked_again;
        self.asked_again = if number > last {
            (number, 1)
        } else {
            (last, times + 1)
        };
        self.asked_again.1 <= MOST_ASKED
    }
}
