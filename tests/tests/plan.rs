//! `canter plan` as other programs call it: the vectors through its flags, its output, its errors.

/// Here so that the files lie in a folder of their own.
mod plan {
    mod device;
    mod errors;
    mod hostile;
    mod output;
    mod vectors;

    use canter_tests::process::{Finished, Process};
    use std::process::Command;

    /// Runs `canter plan` with these arguments and this on its standard input.
    #[track_caller]
    fn canter_plan(arguments: &str, input: &str) -> Finished {
        let mut command = Command::new(canter_tests::canter());
        command.arg("plan").args(arguments.split_whitespace());
        let mut process = Process::spawn(&mut command);
        if !input.is_empty() {
            process.write(input);
        }
        process.finish()
    }

    /// The rows of a CSV that has the contract's header: t, position, velocity, acceleration, jerk.
    #[track_caller]
    fn rows(finished: &Finished) -> Vec<[f64; 5]> {
        let mut lines = finished.stdout.lines();
        let header = lines.next();
        assert_eq!(
            header,
            Some("t,position,velocity,acceleration,jerk"),
            "{finished:#?}"
        );
        lines
            .map(|line| {
                let cells = line.split(',').map(|cell| cell.parse().expect("a number"));
                let cells: Vec<f64> = cells.collect();
                cells.try_into().expect("five cells")
            })
            .collect()
    }

    /// The rows at these times.
    #[track_caller]
    fn rows_at(arguments: &str, times: impl IntoIterator<Item = f64>) -> Vec<[f64; 5]> {
        let times: Vec<f64> = times.into_iter().collect();
        let input: String = times.iter().map(|time| format!("{time}\n")).collect();
        let rows = rows(&canter_plan(&format!("{arguments} --at -"), &input).success());
        let answered: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        assert_eq!(answered, times, "the times in their order");
        rows
    }

    /// The summary as JSON.
    #[track_caller]
    fn summary(arguments: &str) -> serde_json::Value {
        canter_plan(&format!("{arguments} --format json"), "")
            .success()
            .json()
    }
}
