//! `voltstep bms --serve`: a pack that is not there, in real time, as lines of `candump`.

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::io::{self, BufRead, BufWriter, ErrorKind, Write};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use voltstep_bms::comm::can::Message;

use crate::evaluate::campaign::VirtualPack;

/// What it calls its bus.
const BUS: &str = "vcan0";

/// Speaks on standard output and hears standard input, for so many seconds or until nobody reads.
///
/// # Errors
/// A figure out of its range; an output that fails.
pub fn serve(seconds: f64, soc: f64) -> anyhow::Result<bool> {
    ensure!(seconds > 0.0, "--seconds {seconds}: must be above zero");
    ensure!((0.0..=1.0).contains(&soc), "--soc {soc}: must lie in 0..1");
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let mut pack = VirtualPack::at(soc as f32).context("the pack")?;
    let heard = listen();
    let mut out = BufWriter::new(io::stdout().lock());
    let start = Instant::now();
    let mut waiting = VecDeque::new();
    for ms in 0_u64.. {
        let now_s = Duration::from_millis(ms).as_secs_f64();
        if now_s >= seconds {
            break;
        }
        waiting.extend(heard.try_iter());
        let mut messages = Vec::new();
        while let Some((_, message)) = waiting.pop_front_if(|(at_s, _)| *at_s <= now_s) {
            messages.push(message);
        }
        let mut written = Ok(());
        pack.millisecond(&messages, |message| {
            if written.is_ok() {
                written = writeln!(out, "({now_s:.6}) {BUS} {}", line(message));
            }
        });
        match written.and_then(|()| out.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => break,
            other => other.context("standard output")?,
        }
        thread::sleep(
            (start + Duration::from_millis(ms + 1)).saturating_duration_since(Instant::now()),
        );
    }
    Ok(true)
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
                None => {
                    eprintln!("voltstep: not a line of candump, `(seconds) bus id#data`: {line}");
                }
            }
        }
    });
    heard
}

/// `id#data`, as `candump -L` writes it.
fn line(message: &Message) -> String {
    let mut text = format!("{:03X}#", message.id());
    for byte in message.data() {
        let _ = write!(text, "{byte:02X}");
    }
    text
}

/// The message of a line, with or without time and bus before it; without a time, 0.
fn parse(line: &str) -> Option<(f64, Message)> {
    let (id, data) = line.split_whitespace().next_back()?.split_once('#')?;
    let bytes: Option<Vec<u8>> = (0..data.len())
        .step_by(2)
        .map(|at| u8::from_str_radix(data.get(at..at + 2)?, 16).ok())
        .collect();
    let time = line.trim_start().strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let at_s = time.map_or(Some(0.0), |(seconds, _)| seconds.parse().ok())?;
    Some((at_s, Message::new(u16::from_str_radix(id, 16).ok()?, &bytes?)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_back() {
        let message = Message::new(0x520, &[1, 0xab, 0]).unwrap();
        assert_eq!(line(&message), "520#01AB00");
        for (text, at_s) in
            [("520#01AB00", 0.0), ("(12.5) vcan0 520#01ab00", 12.5), ("(1e9) can1 520#01AB00", 1e9)]
        {
            assert_eq!(parse(text), Some((at_s, message)), "{text}");
        }
        assert_eq!(parse("0#").map(|(_, message)| message), Message::new(0, &[]));
        let long = "520#010203040506070809";
        for text in
            ["", "520", "(now) vcan0 520#01", "520#1", "520#0g", "xyz#00", "800#00", long, "1#é"]
        {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
