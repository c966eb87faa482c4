//! A program in Python that computes the same, and times itself when it is told to.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A script of this directory under way. Its first line in is what to compute. Each further line
/// lets it compute once, and it answers with the seconds. At the end of its input it gives what it
/// computed, as raw doubles.
pub struct Python {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Python {
    /// Starts a script with its first line.
    pub fn start(script: &str, what: &str) -> Self {
        let python = std::env::var_os("CANTER_BENCH_PYTHON")
            .expect("CANTER_BENCH_PYTHON names a Python: run tests/run bench");
        let mut child = Command::new(python)
            .arg(format!("{}/src/{script}", env!("CARGO_MANIFEST_DIR")))
            // Threads that wait for work would be in everybody's way.
            .env("OPENBLAS_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the Python of CANTER_BENCH_PYTHON starts");
        let mut input = child.stdin.take().expect("it is piped");
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        writeln!(input, "{what}").expect("it reads");
        Self {
            child,
            input: Some(input),
            output,
        }
    }

    /// Computes once; seconds.
    pub fn time(&mut self) -> f64 {
        let input = self.input.as_mut().expect("it was not closed yet");
        writeln!(input).expect("it reads");
        let mut line = String::new();
        self.output.read_line(&mut line).expect("it answers");
        line.trim().parse().expect("it answers with seconds")
    }

    /// What it computed, and the end of it.
    pub fn numbers(mut self) -> Vec<f64> {
        self.input = None;
        let mut bytes = Vec::new();
        self.output.read_to_end(&mut bytes).expect("it answers");
        let ended = self.child.wait().expect("it ends");
        assert!(ended.success(), "the Python peer ended with {ended}");
        let (numbers, _) = bytes.as_chunks::<8>();
        numbers
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes))
            .collect()
    }
}
