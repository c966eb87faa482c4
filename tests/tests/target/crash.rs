//! Panics and hard faults of the node's image: the chip resets itself, and the node comes back disabled and
//! says why.

use std::collections::BTreeMap;

use canter_shared::axis::fault::Fault;
use canter_shared::axis::state::State;
use canter_shared::wire::command::{Action, Command, Session};
use canter_shared::wire::id::{Address, AxisId};
use canter_shared::wire::report::Report;

use crate::emulated::Emulated;
use crate::emulated::debugger::{Debugger, Register};
use crate::image::{self, elf::Symbols};

/// The node's axes.
const AXES: u8 = 3;

/// The whole of what a crash keeps, in words.
const WORDS: usize = 4;

/// Nothing is there: neither flash nor RAM, nor a register.
const NOWHERE: u32 = 0x6000_0000;

const SESSION: Session = 4_711;

/// The image with all axes enabled and nobody who holds them, so that no time-out of a host's gets in between.
struct Enabled {
    node: Emulated,
    debugger: Debugger,
    symbols: Symbols,
    sequence: u8,
}

impl Enabled {
    fn start() -> Self {
        let (node, debugger) = Emulated::start_with_debugger();
        let mut enabled = Self {
            node,
            debugger,
            symbols: Symbols::read(&image::path("emulated")),
            sequence: 0,
        };
        enabled.node.write(b"O\r");
        enabled.enable();
        enabled
    }

    /// Clears and enables all axes and gives them back.
    fn enable(&mut self) {
        for action in [Action::Hold, Action::Clear, Action::Enable, Action::Release] {
            self.sequence = self.sequence.wrapping_add(1);
            let command = Command::Control {
                action,
                sequence: self.sequence,
                session: SESSION,
            };
            for axis in (1..=AXES).filter_map(AxisId::new) {
                self.node.say(Address::Axis(axis), command);
            }
        }
        self.until("an axis that is enabled", |state, fault| {
            state == u8::from(State::OperationEnabled) && fault == 0
        });
    }

    /// Waits for a heartbeat of each axis that `wanted` accepts by its state and its fault.
    #[track_caller]
    fn until(&mut self, what: &str, mut wanted: impl FnMut(u8, u8) -> bool) {
        let mut heard = BTreeMap::new();
        self.node.report_over_resets(what, |axis, report| {
            if let Report::Heartbeat { state, fault, .. } = report
                && wanted(state, fault)
            {
                heard.insert(axis.get(), (state, fault));
            }
            heard.len() == usize::from(AXES)
        });
    }

    /// The chip resets itself, and every axis comes back without torque and with this fault.
    #[track_caller]
    fn comes_back_with(&mut self, why: &str, expected: Option<Fault>) {
        let expected = match expected {
            Some(fault) => (State::Fault, u8::from(fault)),
            None => (State::SwitchOnDisabled, 0),
        };
        self.until("a node that has begun anew", |state, fault| {
            // Before its drive has spoken an axis is not ready, whatever it has been through.
            let begun = [State::OperationEnabled, State::NotReadyToSwitchOn];
            if begun.map(u8::from).contains(&state) {
                return false;
            }
            assert_eq!((state, fault), (u8::from(expected.0), expected.1), "{why}");
            true
        });
    }

    /// Makes the running processor panic, wherever it is.
    fn panic(&mut self) {
        let panic = self.symbols.address("9panicking9panic_fmt");
        // Whatever is passed as the message and the place: flash, so that it can be read.
        let flash = self.symbols.address("__vector_table");
        for argument in 0..4 {
            self.debugger.set(Register::general(argument), flash);
        }
        self.debugger.jump(panic);
    }
}

#[test]
fn a_panic_resets_the_chip_and_the_node_says_so() {
    let mut run = Enabled::start();
    run.debugger.stop();
    run.panic();
    run.debugger.go();
    run.comes_back_with("a panic", Some(Fault::NodePanic));

    // It is told once: a reset that somebody else asks for finds nothing.
    run.enable();
    run.debugger.stop();
    run.debugger.reset(run.symbols.address("Reset"));
    run.debugger.go();
    run.comes_back_with("a reset from outside", None);
}

/// The library's functions that panic only call each other: whoever called the first of them is meant.
#[test]
fn a_panic_keeps_where_it_was_called_from() {
    let mut run = Enabled::start();
    let kept = run.symbols.address("5crash4KEPT");
    let first = run.symbols.address("Reset");
    // A return address in code, as a call from there leaves it.
    let caller = (run.symbols.address("HardFault") + 4) | 1;
    run.debugger.stop();
    run.debugger.break_at(first);
    for panics in ["9panicking9panic_fmt", "4cell22panic_already_borrowed"] {
        run.debugger.set(Register::LINK, caller);
        let panics = run.symbols.address(panics);
        run.debugger.jump(panics);
        run.debugger.go();
        run.debugger.stopped();
        let words = run.debugger.words(kept, WORDS);
        assert_eq!(words[2], caller, "{panics:x}: {words:x?}");
    }
}

#[test]
fn a_hard_fault_resets_the_chip_and_the_node_says_so() {
    // `ldr r0, [r1]`, and behind it a loop, which is not come to.
    const LOAD: u32 = 0xE7FE_6808;
    let mut run = Enabled::start();

    run.debugger.stop();
    run.debugger.jump(NOWHERE);
    run.debugger.go();
    run.comes_back_with("code that is none", Some(Fault::NodeHardFault));

    run.enable();
    run.debugger.stop();
    let free = run.symbols.address("_stack_end");
    run.debugger.set_words(free, &[LOAD]);
    run.debugger.set(Register::general(1), NOWHERE);
    run.debugger.jump(free);
    run.debugger.go();
    run.comes_back_with("an address that is none", Some(Fault::NodeHardFault));
}

#[test]
fn a_record_that_a_reset_cut_short_is_no_crash() {
    let mut run = Enabled::start();
    let kept = run.symbols.address("5crash4KEPT");
    let first = run.symbols.address("Reset");
    for count in 1..=WORDS {
        run.debugger.stop();
        run.panic();
        // Word by word, as the image writes them.
        let mut steps = 0;
        let written = loop {
            let words = run.debugger.words(kept, WORDS);
            let written = words.iter().filter(|word| **word != 0).count();
            if written >= count {
                break written;
            }
            assert!(steps < 1_000, "nothing is kept: {words:x?}");
            run.debugger.step();
            steps += 1;
        };
        assert_eq!(written, count, "one instruction wrote more than a word");
        run.debugger.reset(first);
        run.debugger.go();
        // That the whole record is one shows that the others are looked at.
        let expected = (count == WORDS).then_some(Fault::NodePanic);
        run.comes_back_with(&format!("{count} of {WORDS} words"), expected);
        if expected.is_none() {
            run.enable();
        }
    }
}

/// However much of the last step still fits.
#[test]
fn an_overflow_of_the_stack_resets_the_chip_before_anything_is_overwritten() {
    // Of the configurable fault status register: an access that a region forbids, of the program's own or to
    // keep registers for an interrupt.
    const CFSR: u32 = 0xE000_ED28;
    const FORBIDDEN: u32 = 1 << 1 | 1 << 4 | 1 << 5;
    // `push {r0-r7, lr}`, and back to it.
    const RECURSE: u32 = 0xE7FD_B5FF;
    let mut run = Enabled::start();
    let kept = run.symbols.address("5crash4KEPT");
    let end = run.symbols.address("_stack_end");
    let handler = run.symbols.address("HardFault");
    let free = run.symbols.address("__euninit");
    for left in [0, 8, 16, 24, 40, 488] {
        run.debugger.stop();
        run.debugger.set_words(free, &[RECURSE]);
        run.debugger.jump(free);
        run.debugger.set(Register::STACK_POINTER, end + left);
        run.debugger.break_at(handler);
        run.debugger.go();
        run.debugger.stopped();
        let status = run.debugger.words(CFSR, 1)[0];
        assert!(status & FORBIDDEN != 0, "{left} bytes left: {status:x}");
        let record = run.debugger.words(kept, WORDS);
        assert_eq!(record, [0; WORDS], "{left} bytes left");
        run.debugger.break_no_more_at(handler);
        run.debugger.go();
        let why = format!("a stack of which {left} bytes were left");
        run.comes_back_with(&why, Some(Fault::NodeHardFault));
        run.enable();
    }
}
