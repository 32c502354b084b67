//! Lines over TCP on this machine: one bus, and everybody who connects is on it.

use std::fmt::Write as _;
use std::io::{ErrorKind, Read, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};

use anyhow::{Context, ensure};
use voltstep_bms::comm::can::Message;

use super::candump::{EXPECTED, line, parse};
use super::{BUS, Wire};
use crate::read::error::shown;

/// Who has this much unread, or sends a line this long, is left alone \[bytes\].
const UNREAD_BYTES: usize = 1 << 20;
const LINE_BYTES: usize = 4096;
/// More are not served at a time.
const CLIENTS: usize = 16;

/// A port, and who is connected.
pub(super) struct Tcp {
    listener: TcpListener,
    clients: Vec<Client>,
}

struct Client {
    stream: TcpStream,
    heard: Vec<u8>,
    unsent: Vec<u8>,
}

impl Tcp {
    /// Listens, and prints the address, with the port that it became.
    pub(super) fn open(address: SocketAddr) -> anyhow::Result<Self> {
        ensure!(
            address.ip().is_loopback(),
            "--listen {address}: must be an address of this machine alone, such as 127.0.0.1"
        );
        let listener = TcpListener::bind(address).with_context(|| format!("--listen {address}"))?;
        listener.set_nonblocking(true).context("the port")?;
        crate::cli::print(&format!("listening on {}\n", listener.local_addr()?))?;
        Ok(Self { listener, clients: Vec::new() })
    }
}

impl Wire for Tcp {
    /// What anybody has sent, at once: clocks differ.
    fn hear(&mut self, _: f64) -> anyhow::Result<Vec<Message>> {
        while let Ok((stream, _)) = self.listener.accept() {
            // Who cannot be told apart from a blocking one would hold up the pack.
            let ready = stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true));
            if ready.is_ok() && self.clients.len() < CLIENTS {
                self.clients.push(Client { stream, heard: Vec::new(), unsent: Vec::new() });
            }
        }
        let mut messages = Vec::new();
        self.clients.retain_mut(|client| client.hear(&mut messages));
        Ok(messages)
    }

    fn send(&mut self, now_s: f64, messages: &[Message]) -> anyhow::Result<bool> {
        let mut text = String::new();
        for message in messages {
            let _ = writeln!(text, "({now_s:.6}) {BUS} {}", line(message));
        }
        self.clients.retain_mut(|client| client.send(text.as_bytes()));
        Ok(true)
    }
}

impl Client {
    /// Whether it is still there.
    fn hear(&mut self, messages: &mut Vec<Message>) -> bool {
        let mut bytes = [0; LINE_BYTES];
        let open = match self.stream.read(&mut bytes) {
            // It may still read.
            Ok(0) => true,
            Ok(count) => {
                self.heard.extend_from_slice(&bytes[..count]);
                true
            }
            Err(error) => matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        };
        while let Some(end) = self.heard.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.heard.drain(..=end).collect();
            let line = String::from_utf8_lossy(&line);
            match parse(&line) {
                Some((_, message)) => messages.push(message),
                None if line.trim().is_empty() => {}
                None => eprintln!("voltstep: {EXPECTED}: {}", shown(&line)),
            }
        }
        open && self.heard.len() < LINE_BYTES
    }

    /// Sends what is left and what is new, as far as it is taken; whether it is still there.
    fn send(&mut self, new: &[u8]) -> bool {
        self.unsent.extend_from_slice(new);
        while !self.unsent.is_empty() {
            match self.stream.write(&self.unsent) {
                Ok(count) if count > 0 => drop(self.unsent.drain(..count)),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                _ => return false,
            }
        }
        self.unsent.len() < UNREAD_BYTES
    }
}
