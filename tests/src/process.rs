//! A program under test: its lines as they come, its end, killed when dropped.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::PATIENCE;

/// Where a line came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// The program's data.
    Stdout,
    /// The program's words.
    Stderr,
}

/// A line that a program wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Where it came from.
    pub stream: Stream,
    /// What it says, without the line's end.
    pub text: String,
}

/// How a program ended and all that it wrote.
#[derive(Debug)]
pub struct Finished {
    /// The exit status.
    pub status: ExitStatus,
    /// All lines of standard output.
    pub stdout: String,
    /// All lines of standard error.
    pub stderr: String,
}

impl Finished {
    /// The same, of a program that must have succeeded.
    ///
    /// # Panics
    /// When it failed; the message has all that it wrote.
    #[track_caller]
    pub fn success(self) -> Self {
        assert!(self.status.success(), "{self:#?}");
        self
    }

    /// Standard output as one JSON document.
    ///
    /// # Panics
    /// When it is none.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {self:#?}"))
    }
}

/// A running program. Dropping it kills it, so that a failed test leaves nothing behind.
#[derive(Debug)]
pub struct Process {
    name: String,
    child: Child,
    lines: Receiver<Line>,
    unread: VecDeque<Line>,
    seen: Vec<Line>,
}

impl Process {
    /// Starts `command` and listens to both of its outputs.
    ///
    /// # Panics
    /// When it cannot be started.
    #[track_caller]
    pub fn spawn(command: &mut Command) -> Self {
        let name = format!("{command:?}");
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let (sender, lines) = channel();
        listen(child.stdout.take(), Stream::Stdout, sender.clone());
        listen(child.stderr.take(), Stream::Stderr, sender);
        let (unread, seen) = (VecDeque::new(), Vec::new());
        Self {
            name,
            child,
            lines,
            unread,
            seen,
        }
    }

    /// The next line on either output; None when `limit` has passed.
    ///
    /// # Panics
    /// When the program has closed both outputs.
    #[track_caller]
    pub fn next_line(&mut self, limit: Duration) -> Option<Line> {
        if let Some(line) = self.unread.pop_front() {
            return Some(line);
        }
        match self.lines.recv_timeout(limit) {
            Ok(line) => {
                self.seen.push(line.clone());
                Some(line)
            }
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                panic!("{} has ended: {:#?}", self.name, self.seen)
            }
        }
    }

    /// Waits for the next line that `wanted` accepts, passing over the others.
    ///
    /// # Panics
    /// When the program ends first, or after [`PATIENCE`].
    #[track_caller]
    pub fn wait_for(&mut self, what: &str, mut wanted: impl FnMut(&Line) -> bool) -> Line {
        let deadline = Instant::now() + PATIENCE;
        loop {
            // A program that never falls silent is not waited for without an end either.
            let left = deadline.saturating_duration_since(Instant::now());
            match self.next_line(left) {
                Some(line) if wanted(&line) => return line,
                Some(_) if !left.is_zero() => {}
                _ => panic!("{}: no {what} in {PATIENCE:?}: {:#?}", self.name, self.seen),
            }
        }
    }

    /// Puts a line back, to be read next.
    pub fn unread(&mut self, line: Line) {
        self.unread.push_front(line);
    }

    /// Writes to the program's standard input.
    ///
    /// # Panics
    /// When it no longer reads.
    #[track_caller]
    pub fn write(&mut self, text: &str) {
        let input = self
            .child
            .stdin
            .as_mut()
            .expect("standard input is piped and still open");
        input
            .write_all(text.as_bytes())
            .unwrap_or_else(|error| panic!("{}: {error}", self.name));
    }

    /// The process's number.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Sends a signal by its name, as `INT` (a user's Ctrl-C) or `KILL`.
    ///
    /// # Panics
    /// When the program has already been waited for.
    #[track_caller]
    pub fn signal(&self, name: &str) {
        // The shell's own `kill`: a system call of our own would need unsafe code.
        let script = format!("kill -{name} {}", self.child.id());
        let status = Command::new("sh").args(["-c", &script]).status();
        assert!(
            status.is_ok_and(|status| status.success()),
            "{script}: {}",
            self.name
        );
    }

    /// Closes standard input, waits for the program's own end and gives all that it wrote.
    ///
    /// # Panics
    /// After [`PATIENCE`].
    #[track_caller]
    pub fn finish(mut self) -> Finished {
        drop(self.child.stdin.take());
        let deadline = Instant::now() + PATIENCE;
        loop {
            match self
                .lines
                .recv_timeout(deadline.saturating_duration_since(Instant::now()))
            {
                Ok(line) => self.seen.push(line),
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {
                    panic!("{} runs on after {PATIENCE:?}: {:#?}", self.name, self.seen)
                }
            }
        }
        // Both outputs are closed, which a program does by ending.
        let status = self
            .child
            .wait()
            .unwrap_or_else(|error| panic!("{}: {error}", self.name));
        let text = |stream| {
            let lines = self.seen.iter().filter(|line| line.stream == stream);
            lines
                .map(|line| format!("{}\n", line.text))
                .collect::<String>()
        };
        Finished {
            status,
            stdout: text(Stream::Stdout),
            stderr: text(Stream::Stderr),
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Both fail when it has already ended and been waited for.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Sends each line of `output` on; ends, and so hangs up, with it.
fn listen(output: Option<impl Read + Send + 'static>, stream: Stream, lines: Sender<Line>) {
    let mut output = BufReader::new(output.expect("the outputs are piped"));
    thread::spawn(move || {
        let mut bytes = Vec::new();
        while output
            .read_until(b'\n', &mut bytes)
            .is_ok_and(|count| count > 0)
        {
            let text = String::from_utf8_lossy(&bytes);
            let text = text.strip_suffix('\n').unwrap_or(&text).to_owned();
            if lines.send(Line { stream, text }).is_err() {
                break;
            }
            bytes.clear();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Process {
        Process::spawn(Command::new("sh").args(["-c", script]))
    }

    #[test]
    fn both_outputs_and_the_status_are_told_apart() {
        let finished = shell("echo data; echo words >&2; exit 3").finish();
        assert_eq!(finished.status.code(), Some(3));
        assert_eq!(
            (&*finished.stdout, &*finished.stderr),
            ("data\n", "words\n")
        );
    }

    #[test]
    fn a_line_is_seen_while_the_program_runs_and_input_reaches_it() {
        let mut process = shell("echo ready; read answer; echo \"got $answer\"");
        process.wait_for("greeting", |line| line.text == "ready");
        process.write("this\n");
        assert_eq!(
            process
                .wait_for("answer", |line| line.text.starts_with("got"))
                .text,
            "got this"
        );
        assert!(process.finish().status.success());
    }

    #[test]
    fn a_signal_reaches_the_program() {
        let mut process = shell("trap 'echo caught; exit 0' INT; echo ready; read x");
        process.wait_for("greeting", |line| line.text == "ready");
        process.signal("INT");
        // Before its input ends, which ends it too.
        process.wait_for("the trap", |line| line.text == "caught");
        process.finish().success();
    }

    #[test]
    fn a_dropped_program_is_killed() {
        let mut process = shell("echo $$; exec sleep 1000");
        let pid = process.wait_for("process id", |_| true).text;
        drop(process);
        assert!(!std::path::Path::new("/proc").join(pid).exists());
    }

    #[test]
    #[should_panic(expected = "has ended")]
    fn waiting_for_a_line_that_never_comes_ends_with_the_program() {
        shell("echo other").wait_for("line", |line| line.text == "mine");
    }
}
