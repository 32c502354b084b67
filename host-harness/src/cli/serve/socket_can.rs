//! Frames on an interface of `SocketCAN`.

use std::io::{self, ErrorKind};

use anyhow::Context;
use socketcan::{CanFrame, CanSocket, Socket};
use voltstep_bms::comm::can::Message;

use super::Wire;

/// An interface, `can0` or `vcan0`.
pub(super) struct SocketCan {
    socket: CanSocket,
    interface: String,
}

impl SocketCan {
    pub(super) fn open(interface: &str) -> anyhow::Result<Self> {
        let name = || format!("--can {interface}");
        let socket = CanSocket::open(interface).with_context(name)?;
        socket.set_nonblocking(true).with_context(name)?;
        Ok(Self { socket, interface: interface.to_owned() })
    }
}

/// Nothing to read, or no room to write: the next millisecond will tell.
fn later(error: &io::Error) -> bool {
    // ENOBUFS: the interface's queue is full, as where nobody acknowledges.
    const NO_BUFFERS: i32 = 105;
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
        || error.raw_os_error() == Some(NO_BUFFERS)
}

impl Wire for SocketCan {
    fn hear(&mut self, _: f64) -> anyhow::Result<Vec<Message>> {
        /// A millisecond of a bus has no more.
        const MOST: usize = 64;
        let mut messages = Vec::new();
        for _ in 0..MOST {
            match self.socket.read_frame() {
                // Of an error frame nothing is a message.
                Ok(CanFrame::Error(_)) => {}
                Ok(frame) => messages.extend(Message::of(&frame)),
                Err(error) if later(&error) => break,
                Err(error) => return Err(error).with_context(|| self.interface.clone()),
            }
        }
        Ok(messages)
    }

    fn send(&mut self, _: f64, messages: &[Message]) -> anyhow::Result<bool> {
        for message in messages {
            if let Some(frame) = message.frame::<CanFrame>() {
                match self.socket.write_frame(&frame) {
                    Err(error) if !later(&error) => {
                        return Err(error).with_context(|| self.interface.clone());
                    }
                    _ => {}
                }
            }
        }
        Ok(true)
    }
}
