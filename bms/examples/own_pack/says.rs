//! What came of a drive, with a hash of all that was known in it.

use core::fmt::{self, Display};

use voltstep_bms::ParamError;
use voltstep_bms::contactor::Phase;
use voltstep_bms::manage::Report;

use super::hardware::Hardware;
use super::pack;

/// How a drive ended.
pub struct Said {
    /// FNV-1a of the report of every millisecond.
    hash: u64,
    /// The contactors are closed.
    pub closed: bool,
    /// State of charge, its standard deviation, and what it really is.
    pub soc: f32,
    pub soc_sd: f32,
    pub truth: f32,
    power_a: [f32; 2],
    left_wh: f32,
}

/// Drives for a while from 60 %, of which the BMS is told nothing.
pub fn drive(ms: u32) -> Result<Said, ParamError> {
    let mut hardware = Hardware::at(0.6)?;
    let mut last = None;
    let mut hash = 0xcbf2_9ce4_8422_2325;
    pack::run(&mut hardware, ms, |report| {
        take(&mut hash, report);
        last = Some(*report);
    })?;
    let truth = hardware.soc();
    let Some(report) = last else { return Err(ParamError::OutOfRange("ms")) };
    Ok(Said {
        hash,
        closed: report.phase == Phase::Closed,
        soc: report.soc,
        soc_sd: report.soc_sd,
        truth,
        power_a: [report.limits.discharge.current_a, report.limits.charge.current_a],
        left_wh: report.energy.map_or(0.0, |energy| energy.remaining_energy_wh),
    })
}

fn take(hash: &mut u64, report: &Report) {
    let rows = report.verdict.tripped.bits() | report.verdict.latched.bits() << 1;
    let words = [
        report.soc,
        report.soc_sd,
        report.cells.min,
        report.cells.max,
        report.health.resistance_factor,
        report.limits.discharge.current_a,
        report.limits.charge.current_a,
        report.energy.map_or(0.0, |energy| energy.remaining_energy_wh),
        report.current_a,
        report.link_v,
    ];
    for byte in words.iter().flat_map(|word| word.to_bits().to_le_bytes()).chain(rows.to_le_bytes())
    {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
}

impl Said {
    /// On one line.
    pub fn line(&self) -> impl Display {
        struct Line(u64, bool, [f32; 6]);
        impl Display for Line {
            fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
                let [soc, sd, truth, discharge_a, charge_a, left_wh] = self.2;
                write!(
                    f,
                    "hash {:016x} closed {} soc {soc} ± {sd}, truly {truth}; {discharge_a} A, \
                     {charge_a} A, {left_wh} Wh left",
                    self.0, self.1
                )
            }
        }
        let [discharge_a, charge_a] = self.power_a;
        Line(
            self.hash,
            self.closed,
            [self.soc, self.soc_sd, self.truth, discharge_a, charge_a, self.left_wh],
        )
    }
}
