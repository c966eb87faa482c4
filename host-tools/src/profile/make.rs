//! From a request to a curve.

use super::curve::Curve;
use super::error::PlanError;
use super::request::{AskedLimits, Kind, Request};
use canter_shared::motion::beta::{exact, general};
use canter_shared::motion::bounds::{Bounds, LARGEST, SMALLEST};
use canter_shared::motion::error::ProfileError;
use canter_shared::motion::polynomial::{Cubic, Quintic, Septic};
use canter_shared::motion::s_curve::{self, SignedBounds};
use canter_shared::motion::trajectory::{Peaks, Sample, Trajectory};
use canter_shared::motion::trapezoid;

/// The exponent of the product's beta curve.
const USUAL_EXPONENT: f64 = 2.5;

/// How far limits that were made from a duration lie above what it needs, so that rounding does
/// not find the duration too short.
const ROOM: f64 = 1.0 + 1e-9;

/// A request and the curve that it got.
#[derive(Debug, Clone)]
pub struct Planned {
    /// What was asked.
    pub request: Request,
    /// What came of it.
    pub curve: Curve,
}

/// Makes the curve that was asked for.
///
/// With limits the move is as quick as they allow, with a duration it lasts that long, with both it
/// lasts that long if the limits allow it. A trapezoid of a duration alone speeds up for a third of
/// it and slows down for a third; an s-curve of a duration alone has seven pieces of one length.
///
/// # Errors
/// A value that this profile cannot have or lacks, named as on the command line.
pub fn plan(request: &Request) -> Result<Planned, PlanError> {
    refuse_what_it_has_not(request)?;
    let curve = match request.kind {
        Kind::Beta => beta(request),
        Kind::Trapezoid => plan_trapezoid(request),
        Kind::SCurve => plan_s_curve(request),
        Kind::Cubic | Kind::Quintic | Kind::Septic => polynomial(request),
    }?;
    Ok(Planned {
        request: *request,
        curve,
    })
}

fn refuse_what_it_has_not(request: &Request) -> Result<(), PlanError> {
    let profile = request.kind;
    let refuse = |flag, cure| {
        Err(PlanError::NotOfProfile {
            flag,
            profile,
            cure,
        })
    };
    if request.exponent.is_some() && profile != Kind::Beta {
        return refuse("--p", "only the beta curve has an exponent");
    }
    let passes = "the trapezoid, s-curve, cubic, quintic and septic can start and stop in motion";
    let velocities = [
        ("--v0", request.start_velocity),
        ("--v1", request.stop_velocity),
    ];
    for (flag, velocity) in velocities {
        if velocity != 0.0 && profile == Kind::Beta {
            return refuse(flag, passes);
        }
    }
    let start = match profile {
        Kind::Beta | Kind::Trapezoid | Kind::Cubic => {
            Some("the s-curve, quintic and septic can start with an acceleration")
        }
        Kind::SCurve | Kind::Quintic | Kind::Septic => None,
    };
    let stop = match profile {
        Kind::Quintic | Kind::Septic => None,
        _ => Some("the quintic and septic can stop with an acceleration"),
    };
    for (flag, acceleration, cure) in [
        ("--a0", request.start_acceleration, start),
        ("--a1", request.stop_acceleration, stop),
    ] {
        if let Some(cure) = cure.filter(|_| acceleration != 0.0) {
            return refuse(flag, cure);
        }
    }
    Ok(())
}

/// The limits, where those that were not named do not limit.
fn bounds(limits: &AskedLimits) -> Result<Bounds, ProfileError> {
    Bounds::new(
        limits.velocity.unwrap_or(LARGEST),
        limits.acceleration.unwrap_or(LARGEST),
        limits.meant_deceleration().unwrap_or(LARGEST),
        limits.jerk.unwrap_or(f64::INFINITY),
    )
}

fn missing(request: &Request, flags: &'static str) -> PlanError {
    PlanError::Missing {
        subject: format!("profile {}", request.kind),
        flags,
    }
}

/// The duration that was asked for, or else the shortest; never less than that.
fn chosen(request: &Request, shortest: Option<f64>) -> Result<f64, PlanError> {
    match (request.duration, shortest) {
        (Some(duration), Some(shortest)) if duration < shortest => {
            Err(ProfileError::TooShort { duration, shortest }.into())
        }
        (Some(duration), _) => Ok(duration),
        (None, Some(shortest)) => Ok(shortest),
        (None, None) => Err(missing(
            request,
            "--vmax, --amax or --jmax, or else --duration",
        )),
    }
}

fn beta(request: &Request) -> Result<Curve, PlanError> {
    let Request { from, to, .. } = *request;
    let limits = (!request.limits.are_none())
        .then(|| bounds(&request.limits))
        .transpose()?;
    match request.exponent.filter(|p| *p != USUAL_EXPONENT) {
        None => {
            let quickest = limits.map(|limits| exact::Profile::within(from, to, &limits));
            let quickest = quickest.transpose()?;
            let duration = chosen(request, quickest.map(|profile| profile.duration()))?;
            match quickest.filter(|profile| profile.duration() == duration) {
                Some(quickest) => Ok(Curve::Beta(quickest)),
                None => Ok(Curve::Beta(exact::Profile::lasting(from, to, duration)?)),
            }
        }
        Some(p) => {
            let quickest = limits.map(|limits| general::Profile::within(p, from, to, &limits));
            let quickest = quickest.transpose()?;
            let duration = chosen(request, quickest.map(|profile| profile.duration()))?;
            match quickest.filter(|profile| profile.duration() == duration) {
                Some(quickest) => Ok(Curve::General(quickest)),
                None => Ok(Curve::General(general::Profile::lasting(
                    p, from, to, duration,
                )?)),
            }
        }
    }
}

fn ends(request: &Request) -> (Sample, Sample) {
    let from = Sample {
        acceleration: request.start_acceleration,
        ..Sample::coasting(request.from, request.start_velocity)
    };
    let to = Sample {
        acceleration: request.stop_acceleration,
        ..Sample::coasting(request.to, request.stop_velocity)
    };
    (from, to)
}

/// Whether the duration alone says how fast the move is to be: a move from rest to rest.
fn by_duration_alone(request: &Request) -> Option<f64> {
    let rests = [
        request.start_velocity,
        request.stop_velocity,
        request.start_acceleration,
    ];
    let alone = request.limits.are_none() && rests == [0.0; 3];
    request.duration.filter(|_| alone)
}

/// A limit made from a duration, kept in the range of limits; a move of no range needs none.
fn made(value: f64) -> f64 {
    (value * ROOM).clamp(SMALLEST, LARGEST)
}

fn plan_trapezoid(request: &Request) -> Result<Curve, PlanError> {
    let (from, to) = ends(request);
    if let Some(duration) = by_duration_alone(request) {
        // Over thirds of T the velocity reaches 3/2 R / T, in T / 3.
        let velocity = 1.5 * (request.to - request.from).abs() / duration;
        let acceleration = velocity / (duration / 3.0);
        let acceleration = made(acceleration);
        let limits = Bounds::new(made(velocity), acceleration, acceleration, f64::INFINITY)?;
        let segments = trapezoid::exact::lasting(from, to, duration, &limits)?;
        return Ok(Curve::Pieces(Box::new(segments)));
    }
    if request.limits.acceleration.is_none() {
        return Err(missing(
            request,
            "--vmax and --amax, or else --duration alone",
        ));
    }
    let limits = bounds(&request.limits)?;
    let segments = match request.duration {
        Some(duration) => trapezoid::exact::lasting(from, to, duration, &limits)?,
        None if request.limits.velocity.is_none() => {
            return Err(missing(
                request,
                "--vmax and --amax, or else --duration alone",
            ));
        }
        None => trapezoid::exact::plan(from, to, &limits)?,
    };
    Ok(Curve::Pieces(Box::new(segments)))
}

fn plan_s_curve(request: &Request) -> Result<Curve, PlanError> {
    let (from, to) = ends(request);
    let signed = |limits: &Bounds| {
        if request.to >= request.from {
            SignedBounds::forward(limits)
        } else {
            SignedBounds::backward(limits)
        }
    };
    if let Some(duration) = by_duration_alone(request) {
        // Seven pieces of T / 7: the velocity reaches R / (4 T / 7), in two of them.
        let piece = duration / 7.0;
        let velocity = (request.to - request.from).abs() / (4.0 * piece);
        let acceleration = velocity / (2.0 * piece);
        let jerk = made(acceleration / piece);
        let acceleration = made(acceleration);
        let limits = Bounds::new(made(velocity), acceleration, acceleration, jerk)?;
        let segments = s_curve::lasting(from, request.to, duration, &signed(&limits)?)?;
        return Ok(Curve::Pieces(Box::new(segments)));
    }
    let asked = &request.limits;
    if asked.acceleration.is_none() || asked.jerk.is_none() {
        return Err(missing(
            request,
            "--vmax, --amax and --jmax, or else --duration alone",
        ));
    }
    let limits = bounds(asked)?;
    let segments = match request.duration {
        Some(_) if request.stop_velocity != 0.0 => {
            return Err(PlanError::NotOfProfile {
                flag: "--duration with --v1",
                profile: request.kind,
                cure: "it lasts a chosen time only where it ends at rest; leave one of them out",
            });
        }
        Some(duration) => s_curve::lasting(from, request.to, duration, &signed(&limits)?)?,
        None if asked.velocity.is_none() => {
            return Err(missing(
                request,
                "--vmax, --amax and --jmax, or else --duration alone",
            ));
        }
        None => s_curve::plan(from, to, &limits)?,
    };
    Ok(Curve::Pieces(Box::new(segments)))
}

fn polynomial(request: &Request) -> Result<Curve, PlanError> {
    let (from, to) = ends(request);
    let limits = (!request.limits.are_none())
        .then(|| bounds(&request.limits))
        .transpose()?;
    let quickest = limits.map(|limits| {
        Ok::<Curve, ProfileError>(match request.kind {
            Kind::Cubic => Curve::Cubic(Cubic::within(from, to, &limits)?),
            Kind::Quintic => Curve::Quintic(Quintic::within(from, to, &limits)?),
            _ => Curve::Septic(Septic::within(from, to, &limits)?),
        })
    });
    let quickest = quickest.transpose()?;
    let shortest = quickest.as_ref().map(Trajectory::duration);
    let duration = chosen(request, shortest)?;
    if let Some(quickest) = quickest.filter(|curve| curve.duration() == duration) {
        return Ok(quickest);
    }
    let curve = match request.kind {
        Kind::Cubic => Curve::Cubic(Cubic::new(from, to, duration)?),
        Kind::Quintic => Curve::Quintic(Quintic::new(from, to, duration)?),
        _ => Curve::Septic(Septic::new(from, to, duration)?),
    };
    keeps(&curve, request)?;
    Ok(curve)
}

/// A polynomial that starts or stops in motion may swing farther where it has more time.
fn keeps(curve: &Curve, request: &Request) -> Result<(), PlanError> {
    let Peaks {
        velocity,
        acceleration,
        jerk,
    } = curve.peaks();
    let limits = &request.limits;
    // A cubic's acceleration steps whatever its limits.
    let jerk_limit = limits.jerk.filter(|_| request.kind != Kind::Cubic);
    for (flag, reached, limit) in [
        ("--vmax", velocity, limits.velocity),
        ("--amax", acceleration, limits.acceleration),
        ("--dmax", acceleration, limits.deceleration),
        ("--jmax", jerk, jerk_limit),
    ] {
        if let Some(limit) = limit.filter(|limit| reached > limit * ROOM) {
            return Err(PlanError::BreaksLimit {
                profile: request.kind,
                flag,
                reached,
                limit,
            });
        }
    }
    Ok(())
}
