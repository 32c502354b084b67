//! The whole BMS, of 18 cells as in a light vehicle and of 96 as in a car, on a pack that drives.

use plant_core::must;
use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use voltstep_bms::contactor::{Coils, Feedback, Phase};
use voltstep_bms::limit::Request;
use voltstep_bms::manage::{Asked, Bms, BmsParams, BmsState, Board, Description, Report};
use voltstep_bms::protect::{Actuators, EXAMPLE, Faults, Layout, PackSheet, Sensing, Sensor};
use voltstep_bms::store::record::Record;
use voltstep_bms::{Measurements, Reading};

use crate::stack::Stack;
use crate::{call, hprintln};

/// Deeper than others: it is a whole system.
const WORDS: usize = 2048;
/// How long it drives. Chosen: every row, slice and sample comes many times.
const MILLISECONDS: u32 = 12_000;
const SENSORS: usize = 4;

const fn sheet(series: u16, pack_v: f32) -> PackSheet {
    let voltage = Sensor { highest: 1.5 * pack_v, ..EXAMPLE.sensing.pack_v };
    PackSheet {
        layout: Layout { series, ..EXAMPLE.layout },
        sensing: Sensing { pack_v: voltage, link_v: voltage, ..EXAMPLE.sensing },
        actuators: Actuators { break_a: 300.0, ..EXAMPLE.actuators },
        ..EXAMPLE
    }
}

static LIGHT: Description =
    must!(Description::new(BmsParams::typical(sheet(18, 66.0), CELL, 33.0)));
static CAR: Description = must!(Description::new(BmsParams::typical(sheet(96, 350.0), CELL, 33.0)));
const OF_18: Bms<18, SENSORS> = must!(Bms::new(&LIGHT));
const OF_96: Bms<96, SENSORS> = must!(Bms::new(&CAR));

/// What a pack shows, new in each call where a sensor of its kind would have it.
pub struct Bench<const CELLS: usize> {
    ms: u32,
    coils: Coils,
    cell_v: [f32; CELLS],
    current_a: f32,
    link_v: f32,
}

impl<const CELLS: usize> Bench<CELLS> {
    const NEW: Self = Self {
        ms: 0,
        coils: Coils { minus: false, precharge: false, plus: false },
        cell_v: [3.7; CELLS],
        current_a: 0.0,
        link_v: 0.0,
    };

    #[allow(clippy::cast_precision_loss, reason = "small")]
    fn pass(&mut self) {
        self.ms += 1;
        let closed = self.coils.minus && self.coils.plus;
        let half_a = ((self.ms / 1500) % 7) as f32 - 2.0;
        self.current_a = if closed { 20.0 * half_a } else { 0.0 };
        for (index, cell_v) in self.cell_v.iter_mut().enumerate() {
            let alike = 0.0002 * ((index * 7 + self.ms as usize) % 11) as f32;
            *cell_v = 3.7 - 0.0015 * self.current_a + alike;
        }
        let pack_v = self.pack_v();
        if self.coils.minus && (self.coils.precharge || self.coils.plus) {
            self.link_v += (pack_v - self.link_v) * if closed { 1.0 } else { 0.025 };
        }
    }

    #[allow(clippy::cast_precision_loss, reason = "small")]
    fn pack_v(&self) -> f32 {
        CELLS as f32 * self.cell_v[0]
    }
}

impl<const CELLS: usize> Board<CELLS, SENSORS> for Bench<CELLS> {
    fn uptime_us(&mut self) -> u64 {
        u64::from(self.ms) * 1000
    }

    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        // A front end that gives a fifth of the cells a millisecond.
        let (from, to) =
            (CELLS * (self.ms as usize % 5) / 5, CELLS * (self.ms as usize % 5 + 1) / 5);
        for (reading, cell_v) in into.cell_v.iter_mut().zip(self.cell_v).take(to).skip(from) {
            *reading = Reading::new(cell_v);
        }
        into.temperature_c = [Reading::new(25.0); SENSORS];
        into.current_a = Reading::new(self.current_a);
        into.pack_v = Reading::new(self.pack_v());
        into.link_v = Reading::new(self.link_v);
    }

    fn feedback(&mut self) -> [Feedback; 3] {
        let Coils { minus, precharge, plus } = self.coils;
        [minus, precharge, plus].map(|on| if on { Feedback::Closed } else { Feedback::Open })
    }

    fn drive(&mut self, coils: Coils) -> bool {
        self.coils = coils;
        true
    }

    fn bleed(&mut self, _: &[bool; CELLS]) {}
}

/// A BMS and its board.
pub type System<const CELLS: usize> = (BmsState<CELLS, SENSORS>, Bench<CELLS>);

macro_rules! items {
    ($($cells:literal $bms:ident $fast:ident $filter:ident $slow:ident;)+) => { $(
        /// Every millisecond.
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $fast((state, board): &mut System<$cells>, _: &(), _: &mut ()) {
            $bms.fast(state, board);
        }

        /// Each sample.
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $filter((state, board): &mut System<$cells>, _: &(), _: &mut ()) {
            $bms.filter(state, board);
        }

        /// A slice.
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $slow((state, _): &mut System<$cells>, _: &(), out: &mut bool) {
            *out = $bms.slow(state);
        }
    )+ };
}

items! {
    18 OF_18 bench_bms_fast bench_bms_filter bench_bms_slow;
    96 OF_96 bench_bms_fast_96 bench_bms_filter_96 bench_bms_slow_96;
}

/// All that a firmware calls, for its size.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_bms(
    (state, board): &mut System<18>,
    asked: &Asked,
    (report, record): &mut (Report, Option<Record>),
) {
    OF_18.request(state, *asked);
    OF_18.tick(state, board);
    *report = OF_18.report(state);
    *record = OF_18.record(state, None);
}

/// Drives both for a while; nothing where they do not.
pub fn run() -> Option<()> {
    const PAINTED: Stack<WORDS> = Stack::PAINTED;
    let (mut bms, mut bms_fast, mut bms_filter, mut bms_slow) =
        (PAINTED, PAINTED, PAINTED, PAINTED);
    let mut system: System<18> = (OF_18.start(None, None, 25.0).ok()?, Bench::NEW);
    let asked = |ms| Asked {
        vehicle: if ms > 100 { Request::Drive } else { Request::Off },
        ..Asked::NOTHING
    };
    for ms in 0..MILLISECONDS {
        system.1.pass();
        OF_18.request(&mut system.0, asked(ms));
        call!(bms_fast, bench_bms_fast, &mut system, &());
        if ms % 100 == 99 {
            call!(bms_filter, bench_bms_filter, &mut system, &());
        } else if ms % 4 == 0 {
            call!(bms_slow, bench_bms_slow, &mut system, &());
        }
    }
    drives(&OF_18.report(&system.0))?;
    call!(bms, bench_bms, &mut system, &asked(MILLISECONDS));
    crate::report!(bms: system.0, bms_fast: system.0, bms_filter: system.0, bms_slow: system.0,);

    let (mut bms_fast_96, mut bms_filter_96, mut bms_slow_96) = (PAINTED, PAINTED, PAINTED);
    let mut system: System<96> = (OF_96.start(None, None, 25.0).ok()?, Bench::NEW);
    for ms in 0..MILLISECONDS {
        system.1.pass();
        OF_96.request(&mut system.0, asked(ms));
        call!(bms_fast_96, bench_bms_fast_96, &mut system, &());
        if ms % 100 == 99 {
            call!(bms_filter_96, bench_bms_filter_96, &mut system, &());
        } else if ms % 4 == 0 {
            call!(bms_slow_96, bench_bms_slow_96, &mut system, &());
        }
    }
    drives(&OF_96.report(&system.0))?;
    crate::report!(
        bms_fast_96: system.0, bms_filter_96: system.0, bms_slow_96: system.0,
    );
    Some(())
}

/// It closed its contactors, nothing tripped, and everything has come.
fn drives(report: &Report) -> Option<()> {
    let drives = report.phase == Phase::Closed
        && report.verdict.tripped == Faults::NONE
        && report.energy.is_some()
        && report.limits.discharge.current_a > 0.0;
    if !drives {
        hprintln!("{:?}", report);
    }
    drives.then_some(())
}
