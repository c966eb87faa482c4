//! `canter soak`: random robots and faults against the invariants, or one bad log again.

use crate::arguments::Soak;
use crate::context::{Context, on_signal};
use anyhow::{Context as _, Result, bail};
use canter::soak::{
    Campaign, EPISODE, Ending, Options, Progress, Recording, ReplayError, Statistics, Violation,
    replay,
};
use serde_json::json;
use std::fs::File;
use std::io::{BufWriter, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Seconds from one word on the progress to the next where nobody looks at a terminal.
const QUIET: u64 = 10;

pub fn run(context: &Context, arguments: &Soak) -> Result<()> {
    match &arguments.replay {
        Some(path) => play_again(context, path),
        None => soak(context, arguments),
    }
}

fn soak(context: &Context, arguments: &Soak) -> Result<()> {
    let stop = Arc::new(AtomicBool::new(false));
    on_signal(Arc::clone(&stop))?;
    let seeds = (arguments.hours * 3_600.0 / EPISODE.as_secs_f64()).ceil() as u64;
    let threads = arguments
        .threads
        .or_else(|| std::thread::available_parallelism().ok());
    let campaign = Campaign {
        first: arguments.seed,
        count: seeds,
        threads: threads.map_or(1, usize::from),
        options: Options {
            faults: arguments.faults,
            axes: arguments.axes,
            sabotage: None,
        },
    };
    let told = AtomicU64::new(0);
    let report = campaign.run(&stop, |progress| tell(progress, seeds, &told));
    if std::io::stderr().is_terminal() {
        eprintln!();
    }
    print(
        context,
        arguments,
        &report.progress,
        report.violation.as_ref(),
    );
    if let Some((violation, recording)) = report.violation.and_then(|ending| ending.violation) {
        write(&arguments.log, &recording)?;
        bail!(
            "{violation}; {} plays it again: canter soak --replay {0}",
            arguments.log.display()
        );
    }
    if stop.load(Ordering::Relaxed) {
        bail!(
            "interrupted after {} of {seeds} seeds",
            report.progress.seeds
        );
    }
    Ok(())
}

fn play_again(context: &Context, path: &Path) -> Result<()> {
    let text = std::fs::read_to_string(path).map_err(|source| ReplayError::Read {
        path: path.to_owned(),
        source,
    })?;
    let recording = Recording::read(&text).with_context(|| path.display().to_string())?;
    let ending = replay(&recording, None);
    context.print_json(&json!({
        "lasted": ending.lasted.as_secs_f64(),
        "violation": ending.violation.as_ref().map(|(violation, _)| document(violation)),
    }));
    match ending.violation {
        Some((violation, _)) => bail!("{violation}"),
        None => {
            eprintln!(
                "nothing was wrong in {:.3} s: the log was changed, or what it shows is mended",
                ending.lasted.as_secs_f64()
            );
            Ok(())
        }
    }
}

fn tell(progress: &Progress, seeds: u64, told: &AtomicU64) {
    let seconds = progress.elapsed.as_secs();
    let terminal = std::io::stderr().is_terminal();
    let due = told.load(Ordering::Relaxed) + if terminal { 1 } else { QUIET };
    if seconds < due {
        return;
    }
    told.store(seconds, Ordering::Relaxed);
    let words = format!(
        "{} of {seeds} seeds, {:.2} h simulated, {:.0} simulated seconds per second",
        progress.seeds,
        progress.simulated.as_secs_f64() / 3_600.0,
        progress.speed()
    );
    if terminal {
        eprint!("\r{words}\x1b[K");
    } else {
        eprintln!("{words}");
    }
}

fn document(violation: &Violation) -> serde_json::Value {
    json!({
        "seed": violation.seed,
        "invariant": violation.invariant.name(),
        "axis": violation.axis.map(|axis| axis.get()),
        "tick": violation.tick.0,
        "time": violation.time.0 as f64 / 1e9,
        "detail": violation.detail,
    })
}

fn print(context: &Context, arguments: &Soak, progress: &Progress, ending: Option<&Ending>) {
    let violation = ending.and_then(|ending| ending.violation.as_ref());
    let hours = |time: std::time::Duration| time.as_secs_f64() / 3_600.0;
    let Statistics {
        ticks,
        moving,
        frames,
        starts,
        faults,
        stops,
        changes,
        resets,
        disturbances,
        slowest_stop,
    } = progress.statistics;
    context.print_json(&json!({
        "seed": arguments.seed,
        "faults": arguments.faults.to_string(),
        "seeds": progress.seeds,
        "robot_hours": hours(progress.simulated),
        "axis_hours": hours(progress.axes),
        "speed": progress.speed(),
        "setpoints": ticks,
        "setpoints_in_motion": moving,
        "frames": frames,
        "moves": starts,
        "faults_latched": faults,
        "stops": stops,
        "slowest_stop": slowest_stop,
        "parameter_changes": changes,
        "resets": resets,
        "disturbances": disturbances,
        "violation": violation.map(|(violation, _)| document(violation)),
    }));
    if context.json {
        return;
    }
    for (what, value) in [
        ("seeds without a violation", progress.seeds.to_string()),
        ("robot hours", format!("{:.3}", hours(progress.simulated))),
        ("axis hours", format!("{:.3}", hours(progress.axes))),
        (
            "simulated seconds per second",
            format!("{:.0}", progress.speed()),
        ),
        ("setpoints", ticks.to_string()),
        ("setpoints in motion", moving.to_string()),
        ("frames", frames.to_string()),
        ("moves begun", starts.to_string()),
        ("faults latched", faults.to_string()),
        ("stops", stops.to_string()),
        (
            "slowest stop, of its bound",
            format!("{:.1} %", slowest_stop * 100.0),
        ),
        ("changes of parameters", changes.to_string()),
        ("resets of nodes", resets.to_string()),
        ("other disturbances", disturbances.to_string()),
    ] {
        println!("{what:<30}  {value:>16}");
    }
}

fn write(path: &Path, recording: &Recording) -> Result<()> {
    File::create(path)
        .and_then(|file| {
            let mut file = BufWriter::new(file);
            recording.write(&mut file)?;
            file.flush()
        })
        .with_context(|| format!("cannot write {}", path.display()))
}
