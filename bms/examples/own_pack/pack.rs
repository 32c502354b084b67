//! An own pack: 14 groups of 20 cells. This is all that you write.

use plant_core::presets::PANASONIC_NCR18650PF;
use voltstep_bms::contactor::{Coils, Feedback};
use voltstep_bms::limit::Request;
use voltstep_bms::manage::{Asked, Bms, BmsParams, Board, Description, Report};
use voltstep_bms::protect::{CellSheet, Currents, EXAMPLE, PackSheet};
use voltstep_bms::{Measurements, ParamError, Reading, must};

use super::hardware::Hardware;

// From the data sheets of cell, sensors and contactors; here only some figures are one's own.
const SHEET: PackSheet = PackSheet {
    cell: CellSheet {
        discharge: Currents { continuous_a: 5.8, ten_seconds_a: 8.7 },
        charge: Currents { continuous_a: 1.5, ten_seconds_a: 3.0 },
        capacity_ah: 2.9,
        ..EXAMPLE.cell
    },
    ..EXAMPLE
};
// The map of the cell is one that `voltstep identify battery` has written.
static PACK: Description =
    must!(Description::new(BmsParams::typical(SHEET, PANASONIC_NCR18650PF, 33.0)));
pub const BMS: Bms<14, 4> = must!(Bms::new(&PACK));

impl Board<14, 4> for Hardware {
    fn uptime_us(&mut self) -> u64 {
        1000 * u64::from(self.milliseconds)
    }
    fn measure(&mut self, into: &mut Measurements<14, 4>) {
        if self.front_end_is_ready() {
            into.cell_v = self.cells_mv().map(|mv| Reading::new(0.001 * f32::from(mv)));
            into.temperature_c = self.temperatures_c().map(Reading::new);
        }
        into.current_a = Reading::new(self.current_a());
        into.pack_v = Reading::new(self.pack_v());
        into.link_v = Reading::new(self.link_v());
    }
    fn feedback(&mut self) -> [Feedback; 3] {
        self.pins().map(|high| if high { Feedback::Closed } else { Feedback::Open })
    }
    fn drive(&mut self, coils: Coils) -> bool {
        self.set_pins([coils.minus, coils.precharge, coils.plus])
    }
    fn bleed(&mut self, cells: &[bool; 14]) {
        self.bleed(cells);
    }
}

/// Drives for so many milliseconds, once each; `every` sees what is known.
pub fn run(
    hardware: &mut Hardware,
    ms: u32,
    mut every: impl FnMut(&Report),
) -> Result<(), ParamError> {
    let mut state = BMS.start(None, None, 25.0)?; // or from the record of `BMS.record`
    for now in 0..ms {
        let vehicle = if now > 500 { Request::Drive } else { Request::Off };
        BMS.request(&mut state, Asked { vehicle, ..Asked::NOTHING });
        BMS.tick(&mut state, hardware);
        hardware.wait_for_the_next_millisecond(state.limits());
        every(&BMS.report(&state));
    }
    Ok(())
}
