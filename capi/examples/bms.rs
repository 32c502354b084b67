//! What `example/bms.c` does, on the BMS itself: says the same hash.

use plant_core::ParamError;
use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use voltstep_bms::contactor::{Coils, Feedback, Phase};
use voltstep_bms::limit::Request;
use voltstep_bms::manage::{Asked, Bms, BmsParams, BmsState, Board, Description, Report};
use voltstep_bms::protect::{CellSheet, Clear, Currents, EXAMPLE, Faults, Layout, PackSheet};
use voltstep_bms::store::record::Record;
use voltstep_bms::{Measurements, Reading, must};

const CELLS: usize = 18;
const SENSORS: usize = 4;
const DRIVEN_MS: u32 = 16_000;
const AGAIN_MS: u32 = 6000;
const PARALLEL: f32 = 20.0;
const PRECHARGE_OHM: f32 = 33.0;
const LINK_F: f32 = 0.0012;
const BLEEDER_OHM: f32 = 5000.0;
const DT_S: f32 = 0.001;

const SHEET: PackSheet = PackSheet {
    cell: CellSheet {
        discharge: Currents { continuous_a: 5.8, ten_seconds_a: 8.7 },
        charge: Currents { continuous_a: 1.5, ten_seconds_a: 3.0 },
        capacity_ah: 2.9,
        ..EXAMPLE.cell
    },
    layout: Layout { series: 18, ..EXAMPLE.layout },
    ..EXAMPLE
};
static PACK: Description = must!(Description::new(BmsParams::typical(SHEET, CELL, PRECHARGE_OHM)));
static BMS: Bms<CELLS, SENSORS> = must!(Bms::new(&PACK));

/// FNV-1a.
struct Hash(u64);

impl Hash {
    fn bytes(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn floats(&mut self, values: &[f32]) {
        self.bytes(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    fn known(&mut self, report: &Report, pack: &Simulated) {
        self.floats(&[
            report.soc,
            report.soc_sd,
            report.cells.min,
            report.cells.max,
            report.health.resistance_factor,
            report.limits.discharge.current_a,
            report.limits.charge.current_a,
            report.energy.map_or(f32::NAN, |left| left.remaining_energy_wh),
            report.current_a,
            report.link_v,
        ]);
        let words = |rows: Faults| rows.bits().to_le_bytes();
        let (tripped, latched) = (words(report.verdict.tripped), words(report.verdict.latched));
        for word in 0..3 {
            self.bytes(tripped.into_iter().skip(4 * word).take(4));
            self.bytes(latched.into_iter().skip(4 * word).take(4));
        }
        self.bytes([report.phase as u8, report.cause.code()]);
        let Coils { minus, precharge, plus } = pack.coils;
        self.bytes([minus, precharge, plus].map(u8::from));
        self.bytes(pack.bleed.map(u8::from));
    }
}

/// What is behind the sensors, and what they show.
struct Simulated {
    soc: f32,
    link_v: f32,
    noise: u32,
    coils: Coils,
    bleed: [bool; CELLS],
    discharge_limit_a: f32,
    charge_limit_a: f32,
    uptime_us: u64,
    cells_new: bool,
    cell_v: [f32; CELLS],
    temperature_c: [f32; SENSORS],
    current_a: f32,
    pack_v: f32,
    seen_link_v: f32,
    feedback: [Feedback; 3],
}

impl Simulated {
    fn draw(&mut self) -> f32 {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        #[expect(clippy::cast_precision_loss, reason = "24 bits")]
        let high = (self.noise >> 8) as f32;
        high / 8_388_608.0 - 1.0
    }

    fn load_a(&self, ms: u32) -> f32 {
        let wanted_a = [80.0, 20.0, -20.0, 0.0][(ms / 2000 % 4) as usize];
        if wanted_a > self.discharge_limit_a {
            self.discharge_limit_a
        } else if wanted_a < -self.charge_limit_a {
            -self.charge_limit_a
        } else {
            wanted_a
        }
    }

    /// A millisecond of cells, link and sensors, contactors as they were told.
    fn pass(&mut self, ms: u32, drift_v: f32) {
        let Coils { minus, precharge, plus } = self.coils;
        let (rest_v, closed) = (CELL.open_circuit.at(self.soc), minus && plus);
        let current_a = if closed {
            self.load_a(ms)
        } else if minus && precharge {
            (18.0 * rest_v - self.link_v) / PRECHARGE_OHM
        } else {
            0.0
        };
        let cell_a = current_a / PARALLEL;
        self.soc -= cell_a * (DT_S / 3600.0) / CELL.capacity_ah;
        self.cells_new = ms.is_multiple_of(20);
        let mut pack_v = 0.0;
        for i in 0..CELLS {
            let index = f32::from(u8::try_from(i).unwrap_or(0));
            let ohm = 0.035 + 0.001 * index;
            let off_v = 0.0005 * (index - 9.0);
            let cell_v = rest_v + off_v - ohm * cell_a;
            pack_v += cell_v;
            let seen_v = cell_v + if i == 9 { drift_v } else { -drift_v / 17.0 };
            self.cell_v[i] = seen_v + 0.0005 * self.draw();
        }
        if closed {
            self.link_v = pack_v;
        } else {
            self.link_v += (current_a / LINK_F - self.link_v / (BLEEDER_OHM * LINK_F)) * DT_S;
        }
        for sensor in 0..SENSORS {
            self.temperature_c[sensor] = 25.0 + 0.05 * self.draw();
        }
        self.current_a = current_a + 0.2 * self.draw();
        self.pack_v = pack_v + 0.02 * self.draw();
        self.seen_link_v = self.link_v + 0.02 * self.draw();
        self.feedback = [minus, precharge, plus]
            .map(|closed| if closed { Feedback::Closed } else { Feedback::Open });
        self.uptime_us += 1000;
    }
}

impl Board<CELLS, SENSORS> for Simulated {
    fn uptime_us(&mut self) -> u64 {
        self.uptime_us
    }
    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        if self.cells_new {
            into.cell_v = self.cell_v.map(Reading::new);
            into.temperature_c = self.temperature_c.map(Reading::new);
        }
        into.current_a = Reading::new(self.current_a);
        into.pack_v = Reading::new(self.pack_v);
        into.link_v = Reading::new(self.seen_link_v);
    }
    fn feedback(&mut self) -> [Feedback; 3] {
        self.feedback
    }
    fn drive(&mut self, coils: Coils) -> bool {
        self.coils = coils;
        true
    }
    fn bleed(&mut self, cells: &[bool; CELLS]) {
        self.bleed = *cells;
    }
}

/// So many milliseconds; one reading drifts by so much in each after the first twelve seconds.
fn run(
    (state, pack, hash): (&mut BmsState<CELLS, SENSORS>, &mut Simulated, &mut Hash),
    duration_ms: u32,
    drift_v_per_ms: f32,
    clear: Clear,
) -> Report {
    let mut asked = Asked { vehicle: Request::Off, clear, ..Asked::NOTHING };
    for ms in 0..duration_ms {
        #[expect(clippy::cast_precision_loss, reason = "a few thousand")]
        let drift_v = drift_v_per_ms * ms.saturating_sub(12_000) as f32;
        pack.pass(ms, drift_v);
        BMS.request(state, asked);
        let vehicle = if ms >= 500 { Request::Drive } else { Request::Off };
        asked = Asked { vehicle, ..Asked::NOTHING };
        BMS.tick(state, pack);
        let report = BMS.report(state);
        pack.discharge_limit_a = report.limits.discharge.current_a;
        pack.charge_limit_a = report.limits.charge.current_a;
        hash.known(&report, pack);
        if let Some(record) = BMS.record(state, Some(ms)) {
            hash.floats(&[record.soc, record.resistor_heat_j]);
        }
    }
    BMS.report(state)
}

fn main() -> Result<(), ParamError> {
    let mut pack = Simulated {
        soc: 0.6,
        link_v: 0.0,
        noise: 1,
        coils: Coils::default(),
        bleed: [false; CELLS],
        discharge_limit_a: 0.0,
        charge_limit_a: 0.0,
        uptime_us: 0,
        cells_new: false,
        cell_v: [0.0; CELLS],
        temperature_c: [0.0; SENSORS],
        current_a: 0.0,
        pack_v: 0.0,
        seen_link_v: 0.0,
        feedback: [Feedback::Unknown; 3],
    };
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let mut state = BMS.start(None, None, 25.0)?;
    let opened = run((&mut state, &mut pack, &mut hash), DRIVEN_MS, 2e-4, Clear::No);
    println!("bms {:?}, {:?}, soc {} truly {}", opened.phase, opened.cause, opened.soc, pack.soc);
    assert_eq!(opened.phase, Phase::Fault);
    // The power goes, and comes again after ten minutes.
    let kept = BMS.worth_keeping(&state, Some(100));
    let bytes = kept.encode(1)?;
    hash.bytes(bytes);
    let (record, _) = Record::decode(&bytes).expect("what was just encoded");
    state = BMS.start(Some(&record), Some(700), 25.0)?;
    (pack.coils, pack.bleed) = (Coils::default(), [false; CELLS]);
    let again = run((&mut state, &mut pack, &mut hash), AGAIN_MS, 0.0, Clear::Service);
    println!("bms {:?}, soc {} truly {}", again.phase, again.soc, pack.soc);
    assert_eq!(again.phase, Phase::Closed);
    println!("bms hash {:016x}", hash.0);
    Ok(())
}
