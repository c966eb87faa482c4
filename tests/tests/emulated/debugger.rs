//! A debugger of the emulated processor: as much of GDB's remote serial protocol as tests need
//! (<https://sourceware.org/gdb/current/onlinedocs/gdb.html/Remote-Protocol.html>).

use std::fmt::Write as _;
use std::io::{BufReader, Read, Write};
use std::net::TcpStream;

/// The registers by the numbers that the protocol gives them on this processor.
#[derive(Clone, Copy)]
pub struct Register(u8);

impl Register {
    pub const STACK_POINTER: Self = Self(13);
    pub const LINK: Self = Self(14);
    pub const PROGRAM_COUNTER: Self = Self(15);
    const STATUS: Self = Self(25);

    /// One of the registers 0 to 12.
    pub fn general(number: u8) -> Self {
        assert!(number < 13, "register {number} is not one of 0 to 12");
        Self(number)
    }
}

/// xPSR: the processor is in Thumb state, the only one that it has, and in no conditional block.
const THUMB: u32 = 1 << 24;

/// A debugger. The processor stands still unless [`Debugger::go`] was the last call.
pub struct Debugger {
    stream: BufReader<TcpStream>,
}

impl Debugger {
    /// Takes over a processor, which stops for that.
    pub fn attach(stream: TcpStream) -> Self {
        let mut debugger = Self {
            stream: BufReader::new(stream),
        };
        // This begins a session; single registers QEMU gives only to those who have asked what they are called.
        debugger.ask("?");
        debugger.ask("qXfer:features:read:target.xml:0,ffb");
        debugger
    }

    /// Lets the processor run.
    pub fn go(&mut self) {
        self.send("c");
    }

    /// Stops the processor wherever it is.
    #[track_caller]
    pub fn stop(&mut self) {
        let stream = self.stream.get_mut();
        stream.write_all(b"\x03").expect("QEMU takes bytes");
        self.stopped();
    }

    /// Waits until the processor has come to a breakpoint.
    #[track_caller]
    pub fn stopped(&mut self) {
        let why = self.receive();
        assert!(why.starts_with('T'), "no stop but {why}");
    }

    /// Lets the processor do one instruction; interrupts wait.
    #[track_caller]
    pub fn step(&mut self) {
        self.send("s");
        self.stopped();
    }

    /// Stops the processor whenever it comes to `address`.
    #[track_caller]
    pub fn break_at(&mut self, address: u32) {
        self.order(&format!("Z0,{address:x},2"));
    }

    /// No longer stops it there.
    #[track_caller]
    pub fn break_no_more_at(&mut self, address: u32) {
        self.order(&format!("z0,{address:x},2"));
    }

    /// Resets the machine; it stands still at the first instruction, and memory is as it was.
    #[track_caller]
    pub fn reset(&mut self, first: u32) {
        self.break_at(first);
        // A command of QEMU's own, in hexadecimal digits: the protocol cannot reset a board.
        let mut digits = String::new();
        for byte in b"system_reset" {
            let _ = write!(digits, "{byte:02x}");
        }
        self.order(&format!("qRcmd,{digits}"));
        self.go();
        self.stopped();
        self.break_no_more_at(first);
    }

    /// Sets a register.
    #[track_caller]
    pub fn set(&mut self, register: Register, value: u32) {
        let value = value.swap_bytes();
        self.order(&format!("P{:x}={value:08x}", register.0));
    }

    /// Makes the processor go on at `address`.
    #[track_caller]
    pub fn jump(&mut self, address: u32) {
        // It may have been in the middle of a conditional block, which would leave out instructions there.
        self.set(Register::STATUS, THUMB);
        self.set(Register::PROGRAM_COUNTER, address);
    }

    /// The words in memory from `address` on, which may be a register of the chip.
    #[track_caller]
    pub fn words(&mut self, address: u32, count: usize) -> Vec<u32> {
        let answer = self.ask(&format!("m{address:x},{:x}", 4 * count));
        words(&answer)
    }

    /// Writes words to RAM. QEMU ignores what is written to a register of the chip.
    #[track_caller]
    pub fn set_words(&mut self, address: u32, words: &[u32]) {
        let mut digits = String::new();
        for word in words {
            let _ = write!(digits, "{:08x}", word.swap_bytes());
        }
        self.order(&format!("M{address:x},{:x}:{digits}", 4 * words.len()));
    }

    #[track_caller]
    fn order(&mut self, order: &str) {
        let answer = self.ask(order);
        assert_eq!(answer, "OK", "{order}");
    }

    #[track_caller]
    fn ask(&mut self, question: &str) -> String {
        self.send(question);
        self.receive()
    }

    fn send(&mut self, text: &str) {
        let sum = text.bytes().fold(0u8, u8::wrapping_add);
        let packet = format!("${text}#{sum:02x}");
        let stream = self.stream.get_mut();
        stream
            .write_all(packet.as_bytes())
            .expect("QEMU takes bytes");
    }

    /// The next packet, which is acknowledged; sums are not looked at, TCP loses nothing.
    #[track_caller]
    fn receive(&mut self) -> String {
        let mut text = String::new();
        while self.byte() != b'$' {}
        loop {
            match self.byte() {
                b'#' => break,
                byte => text.push(char::from(byte)),
            }
        }
        self.byte();
        self.byte();
        let stream = self.stream.get_mut();
        stream.write_all(b"+").expect("QEMU takes bytes");
        text
    }

    #[track_caller]
    fn byte(&mut self) -> u8 {
        let mut byte = [0];
        let read = self.stream.read_exact(&mut byte);
        read.expect("the debugger's connection lives and answers");
        byte[0]
    }
}

/// The little-endian words of an answer in hexadecimal digits.
#[track_caller]
fn words(digits: &str) -> Vec<u32> {
    let word = |at: usize| {
        let digits = digits.get(at..at + 8)?;
        u32::from_str_radix(digits, 16).ok().map(u32::swap_bytes)
    };
    let words: Option<Vec<_>> = (0..digits.len()).step_by(8).map(word).collect();
    match words {
        Some(words) if !words.is_empty() => words,
        _ => panic!("no words but {digits}"),
    }
}
