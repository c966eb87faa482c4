//! Gaits: the planner under random orders, and `canter gait` as people call it.

/// Here so that the files lie in a folder of their own.
mod gait {
    mod continuity;
    mod lossy;
    mod output;
    mod run;

    use canter_tests::process::{Finished, Process};
    use std::process::Command;

    /// Runs `canter gait` with these arguments.
    #[track_caller]
    fn canter_gait(arguments: &str) -> Finished {
        let mut command = Command::new(canter_tests::canter());
        command.arg("gait").args(arguments.split_whitespace());
        Process::spawn(&mut command).finish()
    }

    /// Runs `canter gait` with these arguments, which must print nothing on stdout, say these words and
    /// end with this status.
    #[track_caller]
    fn refuses(arguments: &str, status: i32, words: &str) -> Finished {
        let finished = canter_gait(arguments);
        let code = finished.status.code();
        assert_eq!(code, Some(status), "{arguments}: {finished:#?}");
        let said = finished.stderr.contains(words);
        assert!(said, "{arguments}: {finished:#?}");
        assert_eq!(finished.stdout, "", "{arguments}");
        finished
    }
}
