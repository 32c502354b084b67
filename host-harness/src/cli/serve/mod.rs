//! `voltstep bms --serve`: a pack that is not there, in real time, on a bus: lines of `candump` on
//! standard input and output or over TCP, or frames of `SocketCAN`.

mod candump;
#[cfg(target_os = "linux")]
mod socket_can;
mod standard;
mod tcp;

use std::net::SocketAddr;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use voltstep_bms::comm::can::Message;

use crate::evaluate::campaign::VirtualPack;

/// What it calls its bus in lines.
const BUS: &str = "vcan0";

/// What the pack speaks on.
trait Wire {
    /// What was heard by now, at a time from the start \[s\].
    ///
    /// # Errors
    /// It is broken.
    fn hear(&mut self, now_s: f64) -> anyhow::Result<Vec<Message>>;

    /// Sends what is due; `false` where nobody will ever read again.
    ///
    /// # Errors
    /// It is broken.
    fn send(&mut self, now_s: f64, messages: &[Message]) -> anyhow::Result<bool>;
}

/// Which wire.
pub enum On {
    /// Lines on standard input and output.
    Standard,
    /// Lines over TCP, whoever connects to this address.
    Tcp(SocketAddr),
    /// Frames on an interface of `SocketCAN`.
    #[cfg(target_os = "linux")]
    Can(String),
}

/// Speaks and hears, for so many seconds or until nobody reads.
///
/// # Errors
/// A figure out of its range; an address or interface that cannot be had; an output that fails.
pub fn serve(on: &On, seconds: f64, soc: f64) -> anyhow::Result<bool> {
    ensure!(seconds > 0.0, "--seconds {seconds}: must be above zero");
    ensure!((0.0..=1.0).contains(&soc), "--soc {soc}: must lie in 0..1");
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let mut pack = VirtualPack::at(soc as f32).context("the pack")?;
    let mut wire: Box<dyn Wire> = match on {
        On::Standard => Box::new(standard::Standard::open()),
        On::Tcp(address) => Box::new(tcp::Tcp::open(*address)?),
        #[cfg(target_os = "linux")]
        On::Can(interface) => Box::new(socket_can::SocketCan::open(interface)?),
    };
    let start = Instant::now();
    for ms in 0_u64.. {
        let now_s = Duration::from_millis(ms).as_secs_f64();
        if now_s >= seconds {
            break;
        }
        let heard = wire.hear(now_s)?;
        let mut sent = Vec::new();
        pack.millisecond(&heard, |message| sent.push(*message));
        if !wire.send(now_s, &sent)? {
            break;
        }
        thread::sleep(
            (start + Duration::from_millis(ms + 1)).saturating_duration_since(Instant::now()),
        );
    }
    Ok(true)
}
