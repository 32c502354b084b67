//! Cells in series that are not alike.

extern crate std;
use super::*;
use crate::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryInput, OpenCircuit, OverSoc, Pack,
    ResistanceMap, ThermalParams, VoltageLimits,
};
use crate::presets::PANASONIC_NCR18650PF;

const THERMAL: ThermalParams =
    ThermalParams { heat_capacity_j_per_k: 45.0, cooling_w_per_k: 0.05, ambient_c: 20.0 };
const CELL: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 3.0,
    discharge_limit_a: 20.0,
    charge_limit_a: 10.0,
    voltage_limits: VoltageLimits { lowest_v: 3.1, highest_v: 4.15 },
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap { resistance_ohm: OverSoc::Constant(0.03), activation_k: 2000.0 },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Constant(0.02),
        activation_k: 0.0,
        time_constant_s: 10.0,
    },
    second_polarisation: BranchMap::NONE,
    thermal: THERMAL,
    identified: IdentifiedRange::ALL,
};
const NONE: CellSpread = CellSpread::NONE;

fn dt(dt_s: Real) -> Dt {
    Dt::from_s(dt_s).unwrap()
}

fn pack<const N: usize>(cell: MappedBatteryParams, spread: [CellSpread; N]) -> SeriesPack<N> {
    SeriesPack::new(SeriesPackParams { cell, spread, neighbour_w_per_k: 0.2 }, dt(0.1)).unwrap()
}

fn load<const N: usize>(current_a: Real) -> SeriesPackInput<N> {
    SeriesPackInput { current_a, bleed_a: [0.0; N] }
}

/// Six of them, each unlike the others in everything.
fn unlike() -> [CellSpread; 6] {
    core::array::from_fn(|i| {
        let off = i as Real - 2.5;
        CellSpread {
            capacity_ratio: 1.0 + 0.02 * off,
            resistance_ratio: 1.0 - 0.1 * off,
            cooling_ratio: 1.0 + 0.3 * off,
            self_discharge_a: 1e-4 * i as Real,
            soc_offset: 0.01 * off,
            temperature_offset_k: 2.0 * off,
        }
    })
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn like_cells_are_one_battery() {
    let cell = MappedBatteryParams { thermal: THERMAL, ..PANASONIC_NCR18650PF };
    let (row, one) = (pack(cell, [NONE; 8]), cell.pack(8, 1).unwrap());
    let one = MappedBattery::new(one, dt(0.1)).unwrap();
    let (mut r, mut o) = (row.rested(0.9).unwrap(), one.rested(0.9).unwrap());
    for k in 0..20_000 {
        let current_a = [6.0, -2.0, 0.0, 9.0][k / 500 % 4];
        let all = row.step(&mut r, load(current_a));
        let single = one.step(&mut o, MappedBatteryInput { current_a });
        assert!((all.terminal_v - single.terminal_v).abs() < 2e-4, "{k}: {all:?} {single:?}");
        assert!((all.current_a - single.current_a).abs() < 1e-3, "{k}: {all:?} {single:?}");
        assert!((all.soc - single.soc).abs() < 1e-5, "{k}: {all:?} {single:?}");
        assert!((all.heat_w - single.heat_w).abs() < 1e-3 * (1.0 + single.heat_w.abs()));
        for celsius in all.cell_temperature_c {
            assert!((celsius - single.temperature_c).abs() < 2e-3, "{k}: {all:?} {single:?}");
        }
    }
    assert!(o.temperature_c.get() > 25.0, "{o:?}");
}

/// Charge is counted cell by cell, voltages follow the resistances.
#[test]
fn cells_that_differ_drift_apart() {
    let weak = CellSpread { capacity_ratio: 0.8, resistance_ratio: 1.5, ..NONE };
    let ahead = CellSpread { soc_offset: 0.1, ..NONE };
    let cell = MappedBatteryParams { thermal: ThermalParams::FIXED, ..CELL };
    let row = pack(cell, [NONE, weak, ahead]);
    let mut s = row.rested(0.6).unwrap();
    let mut out = row.step(&mut s, load(3.0));
    for _ in 1..6000 {
        out = row.step(&mut s, load(3.0));
    }
    // 3 A for 600 s are 0.5 of 3 Ah.
    let exact = [0.6 - 1.0 / 6.0, 0.6 - 1.0 / 4.8, 0.7 - 1.0 / 6.0];
    for (i, soc) in exact.into_iter().enumerate() {
        assert!((out.cell_soc[i] - soc).abs() < 1e-5, "{out:?}");
        let drop_v = [0.05, 0.075, 0.05][i] * 3.0;
        assert!((out.cell_v[i] - (3.0 + 1.2 * soc - drop_v)).abs() < 1e-3, "{out:?}");
    }
    assert!((out.terminal_v - out.cell_v.iter().sum::<Real>()).abs() < 1e-5, "{out:?}");
    // 0.392 of 2.4 Ah can be taken out; 0.467 of 3 Ah fit into the one that is ahead.
    let (left, room) = (0.8 * exact[1], 1.0 - exact[2]);
    assert!((out.soc - left / (left + room)).abs() < 1e-5, "{out:?}");
}

/// Empty with the weakest, full with the one ahead; the voltage of a single cell limits.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_first_cell_at_its_end_is_the_packs_end() {
    let cell = MappedBatteryParams { voltage_limits: VoltageLimits::NONE, ..CELL };
    for (params, lowest_v, highest_v) in [(cell, 0.0, 9.0), (CELL, 3.1, 4.15)] {
        let row = pack(params, unlike());
        for (current_a, drains) in [(5.0, true), (-5.0, false)] {
            let mut s = row.rested(0.5).unwrap();
            let (mut refused_c, mut out) = (0.0, row.step(&mut s, load(current_a)));
            for _ in 0..40_000 {
                out = row.step(&mut s, load(current_a));
                refused_c += out.refused_charge_c;
                let soc = out.cell_soc.iter().all(|soc| (0.0..=1.0).contains(soc));
                let held = |v: &Real| *v >= lowest_v - 1e-4 && *v <= highest_v + 1e-4;
                assert!(soc && out.cell_v.iter().all(held), "{out:?}");
            }
            assert!(out.current_a.abs() < 0.2 && refused_c * current_a > 0.0, "{out:?}");
            let unlimited = highest_v > 5.0;
            assert!(!unlimited || (out.depleted, out.full) == (drains, !drains), "{out:?}");
            assert!(!unlimited || (out.soc - if drains { 0.0 } else { 1.0 }).abs() < 1e-5);
            let spare = out.cell_soc.iter().filter(|soc| (1e-4..0.9999).contains(*soc)).count();
            assert!(!unlimited || spare == 5, "the others are not at their ends: {out:?}");
        }
    }
}

/// What leaves the cells is what arrives at the terminals, is bled or becomes heat; it is stored
/// there as temperature or goes to the surroundings.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn energy_is_kept() {
    let cell = MappedBatteryParams {
        hysteresis: HysteresisParams { half_gap_v: 0.02, rate_per_soc: 50.0 },
        ..CELL
    };
    let row = pack(cell, unlike());
    let mut s = row.rested(0.55).unwrap();
    let start = s;
    let (mut out_j, mut bled_j, mut heat_j, mut turnover_j) = (0.0, 0.0, 0.0, 0.0_f64);
    for k in 0..20_000 {
        let current_a = [6.0, -4.0, 0.0, 3.0][k / 300 % 4];
        let bleed_a = core::array::from_fn(|i| if (k / 1000 + i) % 3 == 0 { 0.1 } else { 0.0 });
        let out = row.step(&mut s, SeriesPackInput { current_a, bleed_a });
        out_j += 0.1 * f64::from(out.terminal_v * out.current_a);
        bled_j += 0.1 * f64::from(out.bleed_w);
        heat_j += 0.1 * f64::from(out.heat_w);
        turnover_j += 0.1 * f64::from(out.terminal_v * out.current_a).abs();
    }
    let given_j = f64::from(row.discharged_energy_j(&start, &s));
    let off_j = given_j - out_j - bled_j - heat_j;
    // The open-circuit voltage is that of the step's start: first order, 0.1 s of 1.2 V/3 Ah.
    assert!(off_j.abs() < 2e-5 * turnover_j, "{off_j} of {turnover_j}: {given_j} {out_j} {heat_j}");
    assert!(bled_j > 100.0 && heat_j > 100.0 && turnover_j > 1e5, "{bled_j} {heat_j}");
}

#[test]
fn bleeding_takes_from_one_cell_and_lowers_its_voltage() {
    let cell = MappedBatteryParams { thermal: ThermalParams::FIXED, ..CELL };
    let row = pack(cell, [NONE; 3]);
    let (mut s, mut plain) = (row.rested(0.5).unwrap(), row.rested(0.5).unwrap());
    let input = SeriesPackInput { current_a: 1.0, bleed_a: [0.0, 0.2, -0.1] };
    let (mut out, mut other) = (row.step(&mut s, input), row.step(&mut plain, load(1.0)));
    for _ in 1..6000 {
        (out, other) = (row.step(&mut s, input), row.step(&mut plain, load(1.0)));
    }
    for (i, bleed_a) in input.bleed_a.into_iter().enumerate() {
        let more = other.cell_soc[i] - out.cell_soc[i];
        assert!((more - bleed_a * 600.0 / 10_800.0).abs() < 1e-6, "{out:?}");
        let lower_v = other.cell_v[i] - out.cell_v[i];
        assert!((lower_v - (1.2 * more + 0.05 * bleed_a)).abs() < 1e-5, "{out:?}");
    }
    let bled_w = 0.2 * out.cell_v[1] - 0.1 * out.cell_v[2];
    assert!((out.bleed_w - bled_w).abs() < 1e-6 && (out.current_a - 1.0).abs() < 1e-6);
    // What is not there cannot be bled.
    s.cells[1].soc = Accum::new(1e-6);
    for _ in 0..10 {
        out = row.step(&mut s, SeriesPackInput { current_a: 0.0, bleed_a: [0.0, 2.0, 0.0] });
    }
    assert!(out.cell_soc[1] == 0.0 && out.bleed_w == 0.0, "{out:?}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn cells_lose_by_themselves_and_no_more_than_they_have() {
    let leaky = CellSpread { self_discharge_a: 3e-3, ..NONE };
    let empty = CellSpread { self_discharge_a: 3.0, soc_offset: -0.499, ..NONE };
    let row = pack(CELL, [NONE, leaky, empty]);
    let mut s = row.rested(0.5).unwrap();
    let mut out = row.step(&mut s, load(0.0));
    for _ in 1..36_000 {
        out = row.step(&mut s, load(0.0));
    }
    // 3 mA for an hour of 3 Ah.
    assert_eq!(out.cell_soc[0], 0.5);
    assert!((out.cell_soc[1] - 0.499).abs() < 1e-6, "{out:?}");
    assert_eq!((out.cell_soc[2], out.heat_w > 0.0), (0.0, true));
    assert!(out.depleted && out.soc == 0.0);
}

/// Heat flows to the neighbours and to the surroundings; nothing is lost, nothing overshoots.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn neighbours_share_their_heat() {
    let cell =
        MappedBatteryParams { thermal: ThermalParams { cooling_w_per_k: 0.0, ..THERMAL }, ..CELL };
    for refresh_s in [0.1, 1.0, 100.0] {
        let row = pack(MappedBatteryParams { refresh_s, ..cell }, [NONE; 5]);
        let mut s = row.rested(0.5).unwrap();
        s.cells[1].temperature_c = Accum::new(70.0);
        let mut out = row.step(&mut s, load(0.0));
        for _ in 0..30_000 {
            out = row.step(&mut s, load(0.0));
            let sum: Real = out.cell_temperature_c.iter().sum();
            assert!((sum - 150.0).abs() < 1e-3, "{refresh_s}: {out:?}");
            let between = |c: &Real| (19.999..=70.001).contains(c);
            assert!(out.cell_temperature_c.iter().all(between), "{out:?}");
        }
        let [a, .., e] = out.cell_temperature_c;
        assert!((a - 30.0).abs() < 0.5 && (e - 30.0).abs() < 0.5, "{refresh_s}: {out:?}");
    }
}

/// A cell that is hotter resists less; so does one that was set.
#[test]
fn resistances_follow_each_cells_temperature() {
    let hot = CellSpread { temperature_offset_k: 20.0, ..NONE };
    let row = pack(CELL, [NONE, hot]);
    let mut s = row.rested(0.5).unwrap();
    let [cold_v, hot_v] = row.step(&mut s, load(5.0)).cell_v;
    assert!(hot_v > cold_v + 0.02, "{cold_v} {hot_v}");
    assert!(Pack::set_temperature(&row, &mut s, 20.0));
    let [one_v, other_v] = row.step(&mut s, load(5.0)).cell_v;
    assert!((one_v - other_v).abs() < 1e-6, "{one_v} {other_v}");
    assert!(!Pack::set_temperature(&row, &mut s, 293.15));
}

/// As a coupled plant sees it: a line within the step, and limits that say what `allows` says.
#[test]
fn the_plant_sees_the_same() {
    let row = pack(CELL, unlike());
    let mut s = row.rested(0.45).unwrap();
    s.bleed_a = [0.0, 0.1, 0.0, -0.05, 0.0, 0.2];
    for _ in 0..50 {
        row.settle(&mut s, 4.0);
    }
    let (source, open_circuit_v) = row.offer(&s);
    let faded = row.faded(&s);
    assert!(faded.discharge_a < 20.0 && faded.charge_a <= 10.0, "{faded:?}");
    for share in [0.3, 0.99, 1.01, 2.0] {
        for current_a in [share * faded.discharge_a, -share * faded.charge_a] {
            let next = row.next(&s, current_a);
            assert_eq!(
                row.allows(current_a, current_a, &next),
                share < 1.0,
                "{current_a} {faded:?}"
            );
            let terminal_v: Real = next.terminal_v.iter().sum();
            assert!((source.voltage_v(current_a) - terminal_v).abs() < 1e-4);
            // E·I less the losses is V·I.
            let losses = row.losses(&s, &next, current_a);
            let lost_w = losses.series + losses.polarisation;
            let off_w = (open_circuit_v - terminal_v) * current_a - lost_w;
            assert!(off_w.abs() < 1e-5 * (open_circuit_v * current_a).abs(), "{off_w}");
        }
    }
    // What one cell is overcharged with is lost at its own voltage.
    s.bleed_a = [0.0; 6];
    s.cells[2].soc = Accum::new(1.0);
    let (_, open_circuit_v) = row.offer(&s);
    let lost_c = row.settle(&mut s, -10.0);
    assert!((lost_c * open_circuit_v - 10.0 * 0.1 * 4.2).abs() < 1e-2, "{lost_c}");
    assert_eq!(s.cells[2].soc, Accum::new(1.0));
}

#[test]
fn bad_input_changes_nothing() {
    let row = pack(CELL, unlike());
    let mut s = row.rested(0.5).unwrap();
    row.step(&mut s, load(1.0));
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        let out = row.step(&mut s, load(bad));
        assert!(out.rejected && out.current_a == 0.0 && out.terminal_v.is_finite());
        let mut bleed_a = [0.0; 6];
        bleed_a[3] = bad;
        assert!(row.step(&mut s, SeriesPackInput { current_a: 1.0, bleed_a }).rejected);
    }
    assert_eq!(s, before);
    // In the plant it stands in the state, and counts as nothing.
    s.bleed_a[3] = Real::NAN;
    assert_eq!(row.next(&s, 1.0).cells, row.next(&before, 1.0).cells);
    let refused = [row.rested(1.1).err(), row.rested(Real::NAN).err()];
    assert_eq!(refused, [Some(ParamError::NotARatio("soc")); 2]);
}

#[test]
fn refuses_each_bad_field_by_name() {
    type Spoil = fn(&mut SeriesPackParams<2>);
    let good = SeriesPackParams { cell: CELL, spread: [NONE; 2], neighbour_w_per_k: 0.1 };
    let range = ParamError::OutOfRange;
    let spoilt: [(Spoil, ParamError); 9] = [
        (|p| p.cell.capacity_ah = 0.0, ParamError::NotPositive("battery.capacity_ah")),
        (|p| p.neighbour_w_per_k = -1.0, ParamError::Negative("pack.neighbour_w_per_k")),
        (|p| p.spread[1].capacity_ratio = 0.0, range("pack.spread.capacity_ratio")),
        (|p| p.spread[0].resistance_ratio = Real::NAN, range("pack.spread.resistance_ratio")),
        (|p| p.spread[1].cooling_ratio = -0.1, range("pack.spread.cooling_ratio")),
        (
            |p| p.spread[1].self_discharge_a = -1e-9,
            ParamError::Negative("pack.spread.self_discharge_a"),
        ),
        (|p| p.spread[0].soc_offset = 1.1, range("pack.spread.soc_offset")),
        (|p| p.spread[1].temperature_offset_k = 101.0, range("pack.spread.temperature_offset_k")),
        (|p| p.spread[0].capacity_ratio = Real::INFINITY, range("pack.spread.capacity_ratio")),
    ];
    assert!(SeriesPack::new(good, dt(0.1)).is_ok());
    for (spoil, error) in spoilt {
        let mut params = good;
        spoil(&mut params);
        assert_eq!(SeriesPack::new(params, dt(0.1)), Err(error));
    }
    let none = SeriesPackParams { cell: CELL, spread: [], neighbour_w_per_k: 0.1 };
    assert_eq!(SeriesPack::new(none, dt(0.1)), Err(ParamError::NotPositive("pack.series")));
}
