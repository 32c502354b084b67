//! A drive in which all cells seem to rise, recorded until half a second after the contactors opened.

use voltstep_bms::contactor::{Coils, Feedback};
use voltstep_bms::limit::Request;
use voltstep_bms::manage::recorder::{Call, Recorder};
use voltstep_bms::manage::{Asked, Board};
use voltstep_bms::protect::Trip;
use voltstep_bms::{Measurements, ParamError};

use super::hardware::Hardware;
use super::pack::BMS;

/// The pack of the example with a reference that drifts: every voltage is read too high alike.
struct Drifting {
    hardware: Hardware,
    by_v: f32,
}

impl Board<14, 4> for Drifting {
    fn uptime_us(&mut self) -> u64 {
        self.hardware.uptime_us()
    }
    fn measure(&mut self, into: &mut Measurements<14, 4>) {
        self.hardware.measure(into);
        if self.hardware.front_end_is_ready() {
            for cell_v in &mut into.cell_v {
                cell_v.value += self.by_v;
            }
        }
        into.pack_v.value += 14.0 * self.by_v;
        into.link_v.value += 14.0 * self.by_v;
    }
    fn feedback(&mut self) -> [Feedback; 3] {
        self.hardware.feedback()
    }
    fn drive(&mut self, coils: Coils) -> bool {
        self.hardware.drive(coils)
    }
    fn bleed(&mut self, cells: &[bool; 14]) {
        Board::bleed(&mut self.hardware, cells);
    }
}

/// Gives the bytes of the recording; whether there is one.
pub fn drive(memory: &mut [u8], sink: impl FnMut(&[u8])) -> Result<bool, ParamError> {
    let mut board = Drifting { hardware: Hardware::at(0.93)?, by_v: 0.0 };
    let mut state = BMS.start(None, None, 25.0)?;
    let mut recorder = Recorder::new(&BMS, memory)?;
    let mut since_trip = 0;
    for now in 0..10_000_u16 {
        let vehicle = if now > 500 { Request::Drive } else { Request::Off };
        BMS.request(&mut state, Asked { vehicle, ..Asked::NOTHING });
        board.by_v = 2e-4 * f32::from(now.saturating_sub(2000));
        recorder.call(Call::Tick, &BMS, &mut state, &mut board);
        board.hardware.wait_for_the_next_millisecond(state.limits());
        since_trip += u16::from(since_trip > 0 || state.verdict().trip > Trip::None);
        if since_trip == 500 {
            break;
        }
    }
    recorder.freeze(&state);
    Ok(recorder.write(&BMS, sink))
}
