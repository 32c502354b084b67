//! Lines on standard input and output.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufWriter, ErrorKind, StdoutLock, Write};
use std::sync::mpsc::{self, Receiver};
use std::thread;

use anyhow::Context;
use voltstep_bms::comm::can::Message;

use super::candump::{EXPECTED, line, parse};
use super::{BUS, Wire};

/// Speaks on standard output, hears standard input.
pub(super) struct Standard {
    out: BufWriter<StdoutLock<'static>>,
    heard: Receiver<(f64, Message)>,
    waiting: VecDeque<(f64, Message)>,
}

impl Standard {
    pub(super) fn open() -> Self {
        let out = BufWriter::new(io::stdout().lock());
        Self { out, heard: listen(), waiting: VecDeque::new() }
    }
}

impl Wire for Standard {
    /// Each line at its time, so that a log can be played.
    fn hear(&mut self, now_s: f64) -> anyhow::Result<Vec<Message>> {
        self.waiting.extend(self.heard.try_iter());
        let mut messages = Vec::new();
        while let Some((_, message)) = self.waiting.pop_front_if(|(at_s, _)| *at_s <= now_s) {
            messages.push(message);
        }
        Ok(messages)
    }

    fn send(&mut self, now_s: f64, messages: &[Message]) -> anyhow::Result<bool> {
        let mut write = || {
            for message in messages {
                writeln!(self.out, "({now_s:.6}) {BUS} {}", line(message))?;
            }
            self.out.flush()
        };
        match write() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
            other => other.context("standard output").map(|()| true),
        }
    }
}

/// The messages on standard input, each with its time \[s\], or at once; a line that is none is told
/// and left out.
fn listen() -> Receiver<(f64, Message)> {
    let (send, heard) = mpsc::channel();
    thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            match parse(&line) {
                Some(message) if send.send(message).is_err() => break,
                Some(_) => {}
                None if line.trim().is_empty() => {}
                None => eprintln!("voltstep: {EXPECTED}: {line}"),
            }
        }
    });
    heard
}
