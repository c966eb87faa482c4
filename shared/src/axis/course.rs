//! The motion under way, and the one that takes over from it.
//!
//! A motion is planned for a tick that is still to come, the splice: up to there the one under way
//! goes on, from there the other. At the splice both are in the same place at the same velocity. A
//! stream takes over in the same way, from rest.

use super::Departure;
use super::reaction::Stopping;
use crate::limits::Limits;
use crate::motion::stream::CubicStream;
use crate::motion::{Motion, Setpoint};
use crate::time::Tick;
use crate::units::Position;

/// What takes over, and when.
#[derive(Debug, Clone, Copy)]
struct Next {
    splice: Tick,
    /// How it brings the axis to rest; `None` where it leads to a target.
    stops: Option<Stopping>,
    departure: Option<Departure>,
}

/// What leads an axis. A stream needs no more room than a motion does.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "nothing is allocated here")]
enum Lead {
    Motion(Motion),
    Stream(CubicStream),
}

impl Lead {
    fn at(&self, tick: Tick) -> Setpoint {
        match self {
            Self::Motion(motion) => motion.at(tick),
            Self::Stream(stream) => stream.at(tick),
        }
    }

    /// Whether the setpoint changes after `tick`, or will.
    ///
    /// Asked in many places: a copy in each would be a kilobyte of flash.
    #[inline(never)]
    fn is_moving(&self, tick: Tick) -> bool {
        match self {
            Self::Motion(motion) => motion.is_moving(tick),
            Self::Stream(stream) => stream.is_moving(tick),
        }
    }
}

/// Where a stream stands at a tick, for whoever stops it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Streamed {
    pub(super) state: Setpoint,
    /// The first tick at rest if nobody does.
    pub(super) rests: Tick,
}

/// What a plan goes out from.
pub(super) enum Basis<'a> {
    Motion(&'a Motion),
    /// It can only be stopped, so that its state is enough.
    Stream(Streamed),
}

/// How a stream is brought to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StreamStop {
    /// By a motion that was planned.
    Planned,
    /// It rests sooner by itself.
    AsItIs,
    /// With the deceleration limit from the splice on: as a quick stop, and where no smoother one stays
    /// inside the travel.
    Brake,
}

impl Streamed {
    /// Plans a stop from `splice` on into `motion`, where the stream needs one.
    pub(super) fn stop(
        &self,
        splice: Tick,
        stopping: Stopping,
        limits: &Limits,
        motion: &mut Motion,
    ) -> StreamStop {
        if stopping == Stopping::Quick {
            return StreamStop::Brake;
        }
        let Some(stop) = Motion::stop_from(splice, self.state, limits) else {
            return StreamStop::Brake;
        };
        // One that stands for a moment would go on by itself: then the stop is to stand there.
        if stop.end().is_some_and(|end| self.rests <= end) {
            return StreamStop::AsItIs;
        }
        *motion = stop;
        StreamStop::Planned
    }
}

/// Two motions that are used by turns: taking over copies nothing, since it happens in a tick.
#[derive(Debug, Clone)]
pub(super) struct Course {
    first: Lead,
    second: Lead,
    turned: bool,
    /// Whether what leads the axis gets to where it was to lead.
    completes: bool,
    next: Option<Next>,
}

impl Course {
    pub(super) fn at_rest(position: Position) -> Self {
        Self {
            first: Lead::Motion(Motion::at_rest(position)),
            second: Lead::Motion(Motion::at_rest(position)),
            turned: false,
            completes: false,
            next: None,
        }
    }

    fn lead(&self) -> &Lead {
        if self.turned {
            &self.second
        } else {
            &self.first
        }
    }

    fn lead_mut(&mut self) -> &mut Lead {
        if self.turned {
            &mut self.second
        } else {
            &mut self.first
        }
    }

    fn idle(&self) -> &Lead {
        if self.turned {
            &self.first
        } else {
            &self.second
        }
    }

    fn idle_mut(&mut self) -> &mut Lead {
        if self.turned {
            &mut self.first
        } else {
            &mut self.second
        }
    }

    /// What a plan goes out from: the motion that waits for its splice, and that tick, or else what
    /// is under way, `ahead`.
    pub(super) fn basis(&self, ahead: Tick) -> (Basis<'_>, Tick) {
        let (lead, splice) = match self.next {
            Some(next) => (self.idle(), next.splice),
            None => (self.lead(), ahead),
        };
        match lead {
            Lead::Motion(motion) => (Basis::Motion(motion), splice),
            Lead::Stream(stream) => {
                let state = stream.at(splice);
                let rests = stream.rests();
                (Basis::Stream(Streamed { state, rests }), splice)
            }
        }
    }

    /// Whether a stop that is at least as hard waits for its splice.
    pub(super) fn is_about_to_stop(&self, stopping: Stopping) -> bool {
        self.next.is_some_and(|next| next.stops >= Some(stopping))
    }

    /// Whether the setpoint changes after `tick`, or will.
    pub(super) fn is_moving(&self, tick: Tick) -> bool {
        let waits = match (self.next, self.idle()) {
            (None, _) => false,
            // Its knots are still to come.
            (Some(_), Lead::Stream(_)) => true,
            (Some(_), lead) => lead.is_moving(tick),
        };
        waits || self.lead().is_moving(tick)
    }

    /// Whether the setpoint rests where the last motion was to lead: nothing stopped that.
    pub(super) fn is_complete(&self, tick: Tick) -> bool {
        self.completes && !self.is_moving(tick)
    }

    pub(super) fn at(&self, tick: Tick) -> Setpoint {
        self.lead().at(tick)
    }

    /// Forgets what has ended by `tick`, and says whether that was the end of all motion.
    #[inline(never)] // Its two callers would double an image's share of it.
    pub(super) fn fold(&mut self, tick: Tick) -> bool {
        let lead = self.lead_mut();
        match lead {
            Lead::Motion(motion) => {
                let moved = !motion.has_settled();
                motion.fold(tick);
                moved && motion.has_settled()
            }
            Lead::Stream(stream) if stream.is_moving(tick) => false,
            Lead::Stream(stream) => {
                *lead = Lead::Motion(Motion::at_rest(stream.at(tick).position));
                true
            }
        }
    }

    /// Ends everything at `position`.
    pub(super) fn rest(&mut self, position: Position) {
        self.next = None;
        self.completes = false;
        *self.lead_mut() = Lead::Motion(Motion::at_rest(position));
    }

    /// Ends what has ended whatever the tick; only where nothing moves.
    pub(super) fn settle(&mut self) {
        self.next = None;
        self.fold(Tick(u64::MAX));
    }

    /// Has `motion` take over at `splice`, in place of another that waits for that.
    pub(super) fn splice(
        &mut self,
        splice: Tick,
        motion: &Motion,
        stops: Option<Stopping>,
        departure: Option<Departure>,
    ) {
        *self.idle_mut() = Lead::Motion(motion.clone());
        self.next = Some(Next {
            splice,
            stops,
            departure,
        });
    }

    /// Has `stream` take over when it begins; only where nothing moves.
    pub(super) fn splice_stream(&mut self, stream: CubicStream, departure: Departure) {
        self.next = Some(Next {
            splice: departure.start,
            stops: None,
            departure: Some(departure),
        });
        *self.idle_mut() = Lead::Stream(stream);
    }

    /// The stream under way.
    pub(super) fn running_stream(&self) -> Option<&CubicStream> {
        match self.lead() {
            Lead::Stream(stream) => Some(stream),
            Lead::Motion(_) => None,
        }
    }

    /// The stream that waits for its start or is under way, to take knots on.
    pub(super) fn stream_mut(&mut self) -> Option<&mut CubicStream> {
        let lead = match self.next {
            Some(next) if next.stops.is_none() => self.idle_mut(),
            _ => self.lead_mut(),
        };
        match lead {
            Lead::Stream(stream) => Some(stream),
            Lead::Motion(_) => None,
        }
    }

    /// Whether a stream waits for its start or is under way.
    pub(super) fn streams(&self) -> bool {
        let waits = self.next.is_some() && matches!(self.idle(), Lead::Stream(_));
        waits || self.running_stream().is_some()
    }

    /// Takes no more knots for the stream under way, which is to be stopped. Says whether it brakes
    /// by itself already.
    pub(super) fn close_stream(&mut self, tick: Tick) -> bool {
        match self.lead_mut() {
            Lead::Motion(_) => false,
            Lead::Stream(stream) => {
                stream.close();
                let dry = stream.has_run_dry(tick);
                self.completes = false;
                dry
            }
        }
    }

    /// Has the stream under way brake from `tick` on, where it does not do so already.
    pub(super) fn cut_stream(&mut self, tick: Tick, limits: &Limits) {
        if let Lead::Stream(stream) = self.lead_mut() {
            stream.cut(tick, limits);
        }
    }

    /// Calls off what waits for its splice, unless it is a stop.
    pub(super) fn call_off_move(&mut self) {
        self.next = self.next.filter(|next| next.stops.is_some());
    }

    /// Calls off the stream that waits for its start.
    pub(super) fn call_off_stream(&mut self) {
        if matches!(self.idle(), Lead::Stream(_)) {
            self.call_off_move();
        }
    }

    /// Goes on to `tick`: where the other motion takes over, gives the departure that it brings.
    pub(super) fn advance(&mut self, tick: Tick) -> Option<Option<Departure>> {
        let next = self.next.take_if(|next| next.splice <= tick);
        if let Some(next) = next {
            self.turned = !self.turned;
            self.completes = next.stops.is_none();
        }
        if let Lead::Stream(stream) = self.lead_mut() {
            stream.advance(tick);
        }
        next.map(|next| next.departure)
    }
}
