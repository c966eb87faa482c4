//! The worked example of docs/protocol.md, frame by frame, on a node.

use super::documents;
use super::golden;
use canter_shared::axis::state::State;
use canter_shared::drive::simulated::Simulated;
use canter_shared::limits::Limits;
use canter_shared::node::{Board, Identity, Node};
use canter_shared::time::{LocalTime, MICROSECONDS_PER_TICK};
use canter_shared::units::Position;
use canter_shared::wire::frame::Frame;
use canter_shared::wire::id::AxisId;

/// One step of a shell example: what it sends, what it sends from then on every 0.1 s, or how long
/// it sleeps.
#[derive(Debug)]
enum Step {
    Send(Frame),
    Beat(Frame),
    Silence,
    Sleep(u64),
}

/// Reads the first `sh` block that uses cansend. Only what such an example needs is understood.
fn steps(document: &str) -> Vec<Step> {
    let mut blocks = document.split("```sh\n").skip(1);
    let block = blocks
        .find_map(|block| {
            let block = block.split("```").next()?;
            block.contains("cansend").then_some(block)
        })
        .expect("the document has an example with cansend");
    let lines = block.lines().map(|line| {
        let code = line.split(" # ").next().unwrap_or_default();
        code.split_whitespace().collect::<Vec<_>>()
    });
    let frame = |text: &str| {
        let text = text.trim_end_matches(';');
        golden::parse(text).unwrap_or_else(|| panic!("no frame: {text}"))
    };
    let read = lines.filter_map(|words| {
        Some(match words[..] {
            ["cansend", "can0", text] => Step::Send(frame(text)),
            [
                "while",
                "cansend",
                "can0",
                text,
                "do",
                "sleep",
                "0.1;",
                "done",
                "&",
            ] => Step::Beat(frame(text)),
            ["sleep", seconds] => {
                let seconds: f64 = seconds.parse().expect("seconds are a number");
                Step::Sleep((seconds * 1e3) as u64)
            }
            ["kill", "$!"] => Step::Silence,
            [] | ["#", ..] => return None,
            _ => panic!("not understood: {words:?}"),
        })
    });
    read.collect()
}

struct Bench {
    node: Node<Simulated, 1>,
    milliseconds: u64,
    beat: Option<Frame>,
    answers: Vec<String>,
}

impl Bench {
    fn send(&mut self, frame: &Frame) {
        let now = LocalTime(self.milliseconds * MICROSECONDS_PER_TICK);
        self.node.handle_frame(now, frame);
        self.node.plan();
        self.listen(now);
    }

    fn listen(&mut self, now: LocalTime) {
        while let Some(frame) = self.node.poll_transmit(now) {
            self.answers.push(golden::text(&frame));
        }
    }

    fn wait(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.milliseconds += 1;
            let now = LocalTime(self.milliseconds * MICROSECONDS_PER_TICK);
            while self.node.next_tick() <= now {
                self.node.tick(now);
                self.node.plan();
            }
            self.listen(now);
            if let Some(beat) = self.beat.filter(|_| self.milliseconds.is_multiple_of(100)) {
                self.send(&beat);
            }
        }
    }
}

#[test]
fn the_example_by_hand_moves_an_axis() {
    let document = documents::read("docs/protocol.md");
    let mut node = Node::new(Identity {
        chip: [0; 12],
        firmware: [0; 3],
        board: Board::Simulated,
    });
    let axis = AxisId::new(7).expect("7 is an axis");
    node.add_axis(axis, Limits::default(), Simulated::new(Position::ZERO))
        .expect("there is room for one");
    let mut bench = Bench {
        node,
        milliseconds: 0,
        beat: None,
        answers: Vec::new(),
    };
    bench.wait(10);
    let mut targets = Vec::new();
    for step in steps(&document) {
        match step {
            Step::Send(frame) => bench.send(&frame),
            Step::Beat(frame) => {
                bench.send(&frame);
                bench.beat = Some(frame);
            }
            Step::Silence => bench.beat = None,
            Step::Sleep(milliseconds) => {
                bench.wait(milliseconds);
                let now = LocalTime(bench.milliseconds * MICROSECONDS_PER_TICK);
                let setpoints = bench.node.tick(now);
                targets.extend(setpoints.iter().map(|at| at.setpoint.position));
            }
        }
    }
    let quarter = Position::from_counts(1 << 30);
    assert!(targets.contains(&quarter), "{targets:?}");
    for told in document.lines().filter_map(|line| {
        // The answers that the example promises stand behind its commands.
        line.starts_with("cansend")
            .then(|| line.split_once("answer "))?
            .map(|(_, answer)| answer.trim())
    }) {
        let heard = bench.answers.iter().any(|answer| answer == told);
        assert!(heard, "{told} in {:?}", bench.answers);
    }
    // Long after the session's last beat: it gave its axis back, so nothing times out.
    bench.wait(1_000);
    let states: Vec<_> = bench.node.axes().map(|axis| axis.state()).collect();
    assert_eq!(states, [State::SwitchOnDisabled]);
}
