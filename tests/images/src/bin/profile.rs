//! tmp
#![no_std]
#![no_main]
use core::hint::black_box;
use canter_images::{count, finish, report};
use canter_shared::limits::Limits;
use canter_shared::motion::*;
use canter_shared::time::{Tick, Ticks};
use canter_shared::units::Position;
use cortex_m_rt::entry;
#[inline(never)]
#[unsafe(no_mangle)]
fn the_retarget(m: &mut Motion, now: Tick, go: Move, limits: &Limits) -> bool { m.start(now, now, go, limits).is_ok() }
#[entry]
fn main() -> ! {
    let limits = Limits::default();
    let p = match option_env!("PROFILE_KIND") { Some("trap") => Profile::Trapezoid, Some("scurve") => Profile::SCurve, _ => Profile::Beta };
    let mut m = Motion::at_rest(Position::ZERO);
    let go = Move { target: Position::from_counts(20_000_000_000), duration: Ticks(4000), profile: p };
    let _ = m.start(Tick(0), Tick(0), black_box(go), &limits);
    let go = Move { target: Position::from_counts(-9_000_000_000), duration: Ticks(1000), profile: p };
    report("n", count(|| the_retarget(&mut m, black_box(Tick(1800)), black_box(go), &limits)));
    finish()
}
