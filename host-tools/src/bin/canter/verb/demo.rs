//! `canter demo`: the main job on a simulated robot, with files to look at.

use crate::arguments::Demo;
use crate::context::Context;
use anyhow::{Context as _, Result, ensure};
use canter::demo::{Measurements, page, perform, promises, rows};
use canter::log::{SetpointsCsv, candump};
use serde_json::json;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

pub fn run(context: &Context, arguments: &Demo) -> Result<()> {
    let out = &arguments.out;
    std::fs::create_dir_all(out)
        .with_context(|| format!("cannot make the directory {}", out.display()))?;
    let configuration = canter::sim::Configuration {
        seed: arguments.seed,
        ..canter::sim::Configuration::of(&context.robot)
    };
    let performance = perform(&context.robot, &configuration, |words| eprintln!("{words}"))?;
    let measurements = performance.measure(&context.robot);

    write(&out.join("setpoints.csv"), |file| {
        let mut csv = SetpointsCsv::new(file)?;
        for sample in performance.samples.all() {
            csv.write(&sample.setpoint)?;
        }
        csv.finish().map(|_| ())
    })?;
    write(&out.join("bus.log"), |file| {
        for sent in &performance.frames {
            candump::write(file, sent.end.bus_time(), &sent.frame)?;
        }
        Ok(())
    })?;
    let html = page(&performance, &measurements, &context.robot)?.html()?;
    write(&out.join("report.html"), |file| {
        file.write_all(html.as_bytes())
    })?;

    print(context, &measurements, out);
    let promises = promises(&measurements);
    let broken = promises.iter().filter(|promise| !promise.is_kept());
    let broken: Vec<&str> = broken.map(|promise| promise.what).collect();
    ensure!(
        broken.is_empty(),
        "the demonstration broke its own promises ({}): see {}",
        broken.join("; "),
        out.join("report.html").display()
    );
    Ok(())
}

fn write(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<()> {
    File::create(path)
        .and_then(|file| {
            let mut file = BufWriter::new(file);
            fill(&mut file)?;
            file.flush()
        })
        .with_context(|| format!("cannot write {}", path.display()))
}

fn print(context: &Context, measurements: &Measurements, out: &Path) {
    let documents: Vec<_> = rows(measurements)
        .into_iter()
        .map(|(what, value, note)| json!({ "what": what, "value": value, "note": note }))
        .collect();
    let promises: Vec<_> = promises(measurements)
        .into_iter()
        .map(|promise| {
            json!({
                "what": promise.what,
                "value": promise.value,
                "at_most": promise.most,
                "unit": promise.unit,
                "kept": promise.is_kept(),
            })
        })
        .collect();
    context.print_json(&json!({ "out": out, "measured": documents, "promises": promises }));
    if !context.json {
        for (what, value, note) in rows(measurements) {
            println!("{what:<44}  {value:>22}  {note}");
        }
    }
    eprintln!(
        "report.html, setpoints.csv and bus.log are in {}",
        out.display()
    );
}
