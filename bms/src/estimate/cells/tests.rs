use plant_core::battery::OpenCircuit;
use plant_core::num::{SocTable, sqrt};

use super::*;

const LINE: OpenCircuit = OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 };
const PARAMS: CellsParams = CellsParams {
    open_circuit: LINE,
    noise_sd_v: 0.002,
    offset_sd_v: 0.003,
    resistance_sd_ohm: 0.001,
    capacity_sd: 0.02,
    soc_sd: 0.05,
    drift_sd_per_day: 0.01,
    pack_soc_sd_max: 0.1,
    voltage_min_v: 2.0,
    voltage_max_v: 4.5,
};
/// What the mean of these is above the pack: nothing.
const APART: [Real; 4] = [0.03, -0.04, 0.0, 0.01];

fn cells(params: CellsParams) -> Cells {
    Cells::new(params, Dt::from_s(1.0).unwrap()).unwrap()
}

fn pack(soc: Real) -> Estimate {
    Estimate::rested(soc, 0.01, 25.0)
}

/// LFP-like: steep, flat between 25 % and 75 %, steep.
fn flat() -> OpenCircuit {
    let points = [(0.0, 2.8), (0.25, 3.3), (0.75, 3.3), (1.0, 3.6)];
    OpenCircuit::Table(SocTable::from_points("t", &points).unwrap())
}

/// Voltages of cells that lie `APART` of the pack, common drop included.
fn voltages(curve: &OpenCircuit, soc: Real) -> [Real; 4] {
    APART.map(|apart| curve.at(soc + apart) - 0.123)
}

fn run(
    cells: &Cells,
    state: &mut CellsState<4>,
    soc: Real,
    cell_v: [Real; 4],
    current_a: Real,
    steps: u32,
) -> CellsOutput {
    let input = CellsInput { pack: pack(soc), cell_v: &cell_v, current_a };
    (0..steps).fold(cells.step(state, input), |_, _| cells.step(state, input))
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn finds_what_each_cell_differs_by() {
    let c = cells(PARAMS);
    let mut s = c.start::<4>(pack(0.6));
    assert!(s.cell(0).unwrap().held && (s.cell(0).unwrap().soc_sd - 0.051).abs() < 1e-3);
    let out = run(&c, &mut s, 0.6, voltages(&LINE, 0.6), 0.0, 200);
    assert_eq!(out, CellsOutput { held: 0, rejected: false });
    for (i, apart) in APART.iter().enumerate() {
        let cell = s.cell(i).unwrap();
        assert!((cell.soc - 0.6 - apart).abs() < 1e-3 && !cell.held, "{i}: {cell:?}");
        // The offset leaves 3 mV over 1.2 V open, the pack 1 %.
        assert!((cell.soc_sd - 0.0103).abs() < 1e-4, "{i}: {cell:?}");
    }
    let spread = s.spread();
    assert_eq!((spread.min_index, spread.max_index), (1, 0));
    assert!((spread.min - 0.56).abs() < 1e-3 && (spread.max - 0.63).abs() < 1e-3);
    assert!((spread.mean - 0.6).abs() < 1e-3, "{spread:?}");
    assert_eq!(s.cell(4), None);
}

#[test]
fn holds_where_the_curve_is_flat() {
    let c = cells(CellsParams { open_circuit: flat(), ..PARAMS });
    let mut s = c.start::<4>(pack(0.5));
    let nonsense = [3.2, 3.3, 3.31, 3.35];
    run(&c, &mut s, 0.5, nonsense, 0.0, 10_000);
    for i in 0..4 {
        let cell = s.cell(i).unwrap();
        assert!(cell.soc == 0.5 && cell.soc_sd > 0.05, "{cell:?}");
    }
    run(&c, &mut s, 0.15, voltages(&flat(), 0.15), 0.0, 300);
    assert!((s.spread().min - 0.11).abs() < 2e-3 && (s.spread().max - 0.18).abs() < 2e-3);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn does_not_average_away_what_stays() {
    let sd = |params, current_a| {
        let c = cells(CellsParams { drift_sd_per_day: 0.0, ..params });
        let mut s = c.start::<4>(Estimate { soc_sd: 0.0, ..pack(0.5) });
        let input = CellsInput {
            pack: Estimate { soc_sd: 0.0, ..pack(0.5) },
            cell_v: &[3.6; 4],
            current_a,
        };
        for _ in 0..20_000 {
            c.step(&mut s, input);
        }
        s.cell(0).unwrap().soc_sd
    };
    assert!((sd(PARAMS, 0.0) - 0.003 / 1.2).abs() < 2e-4);
    // 1 mΩ · 30 A beside the offset, and what is known of the start.
    let open = 0.0301 / 1.2;
    let expected = open * 0.05 / sqrt(open * open + 0.05 * 0.05);
    assert!((sd(PARAMS, 30.0) - expected).abs() < 2e-4, "{}", sd(PARAMS, 30.0));
    let blind = CellsParams { offset_sd_v: 0.0, resistance_sd_ohm: 0.0, ..PARAMS };
    assert!(sd(blind, 30.0) < 2e-4, "only noise can be averaged away");
}

#[test]
fn grows_uncertain_with_the_charge_that_passes() {
    let c = cells(CellsParams { open_circuit: flat(), drift_sd_per_day: 0.0, ..PARAMS });
    let mut s = c.start::<4>(pack(0.75));
    let before = s.cell(0).unwrap().soc_sd;
    for i in 0..400_u16 {
        run(&c, &mut s, 0.74 - Real::from(i) * 0.001, [3.3; 4], 1.0, 1);
    }
    // Over 40 % of the charge, 2 % of it, in proportion however small the steps.
    let grown = sqrt(before * before + 0.0078 * 0.0078);
    assert!((s.cell(0).unwrap().soc_sd - grown).abs() < 2e-4, "{:?}", s.cell(0));
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn holds_a_cell_without_a_reading() {
    let c = cells(PARAMS);
    for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY, 1e30, 1.9, 4.6] {
        let mut s = c.start::<4>(pack(0.6));
        let mut cell_v = voltages(&LINE, 0.6);
        run(&c, &mut s, 0.6, cell_v, 0.0, 200);
        let before = s.cell(1).unwrap();
        cell_v[1] = bad;
        let out = run(&c, &mut s, 0.6, cell_v, 0.0, 20_000);
        let after = s.cell(1).unwrap();
        assert_eq!(out.held, 1);
        assert!(after.held && after.soc == before.soc && after.soc_sd > before.soc_sd + 1e-3);
        assert!([0, 2, 3].iter().all(|i| !s.cell(*i).unwrap().held));
        // Back again.
        cell_v = voltages(&LINE, 0.6);
        assert_eq!(run(&c, &mut s, 0.6, cell_v, 0.0, 500).held, 0);
        let back = s.cell(1).unwrap();
        assert!(!back.held && (back.soc - before.soc).abs() < 1e-3 && back.soc_sd < 0.0105);
    }
}

#[test]
fn holds_all_where_the_rest_is_not_known() {
    let c = cells(PARAMS);
    let mut s = c.start::<4>(pack(0.6));
    let cell_v = voltages(&LINE, 0.6);
    run(&c, &mut s, 0.6, cell_v, 0.0, 100);
    let before = s.spread();
    for (pack, current_a, rejected) in [
        (pack(0.6), Real::NAN, false),
        (pack(0.6), 1e30, false),
        (Estimate { soc_sd: 0.2, ..pack(0.6) }, 0.0, false),
        (pack(Real::NAN), 0.0, true),
        (pack(1.1), 0.0, true),
        (Estimate { soc_sd: Real::NAN, ..pack(0.6) }, 0.0, true),
        (Estimate { soc_sd: Real::INFINITY, ..pack(0.6) }, 0.0, true),
    ] {
        let out = c.step(&mut s, CellsInput { pack, cell_v: &[3.0, 3.5, 3.6, 3.7], current_a });
        assert_eq!(out, CellsOutput { held: 4, rejected });
        assert_eq!(s.spread(), before);
    }
    let out = run(&c, &mut s, 0.6, [Real::NAN; 4], 0.0, 1);
    assert_eq!((out.held, s.spread()), (4, before));
    let s = c.start::<4>(pack(Real::NAN));
    assert!(s.cell(0).unwrap().soc_sd > 0.99);
}

#[test]
fn stays_within_what_is_possible() {
    let almost_flat = OpenCircuit::Linear { empty_v: 3.3, full_v: 3.301 };
    let c = cells(CellsParams { open_circuit: almost_flat, noise_sd_v: 1e-6, ..PARAMS });
    let mut s = c.start::<4>(pack(0.6));
    run(&c, &mut s, 0.6, [2.0, 4.5, 2.0, 4.5], 0.0, 10);
    let spread = s.spread();
    assert!((0.0..=1.0).contains(&spread.min) && (0.0..=1.0).contains(&spread.max), "{spread:?}");
    assert!(s.cells.iter().all(|cell| cell.soc.abs() <= 1.0));
}

#[test]
fn takes_a_pack_without_cells() {
    let c = cells(PARAMS);
    let mut s = c.start::<0>(pack(0.6));
    let out = c.step(&mut s, CellsInput { pack: pack(0.5), cell_v: &[], current_a: 1.0 });
    assert_eq!(out.held, 0);
    assert_eq!((s.spread().min, s.spread().mean, s.spread().max), (0.5, 0.5, 0.5));
}

#[test]
fn cells_that_have_aged_differ_by_as_much_more() {
    let model = Cells::new(PARAMS, Dt::from_s(1.0).unwrap()).unwrap();
    let pack = Estimate::rested(0.5, 0.01, 25.0);
    let sd_after = |factor| {
        let mut state = model.start::<2>(pack);
        let health = Health {
            capacity_ah: 1.0,
            capacity_sd_ah: 0.0,
            resistance_factor: factor,
            resistance_factor_sd: 0.0,
        };
        model.adopt(&mut state, &health);
        for _ in 0..60 {
            let voltage_v = PARAMS.open_circuit.at(0.5);
            let cell_v = [voltage_v; 2];
            model.step(&mut state, CellsInput { pack, cell_v: &cell_v, current_a: 100.0 });
        }
        state.cell(0).unwrap().soc_sd
    };
    let (new, aged) = (sd_after(1.0), sd_after(3.0));
    assert!(aged > 1.1 * new, "{new} {aged}");
    for bad in [0.0, -1.0, Real::NAN] {
        assert_eq!(sd_after(bad), new);
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    use ParamError::{Decreasing, NotARatio, NotAbove, NotPositive, OutOfRange};
    let refused = |change: fn(&mut CellsParams), error| {
        let mut params = PARAMS;
        change(&mut params);
        assert_eq!(Cells::new(params, Dt::from_s(1.0).unwrap()), Err(error));
    };
    let line = |empty_v, full_v| OpenCircuit::Linear { empty_v, full_v };
    assert!(
        Cells::new(
            CellsParams { open_circuit: line(3.0, 3.0), ..PARAMS },
            Dt::from_s(1.0).unwrap()
        )
        .is_ok()
    );
    refused(
        |p| p.open_circuit = OpenCircuit::Linear { empty_v: 4.0, full_v: 3.0 },
        Decreasing("cells.open_circuit"),
    );
    refused(
        |p| p.open_circuit = OpenCircuit::Linear { empty_v: 3.0, full_v: 101.0 },
        OutOfRange("cells.open_circuit"),
    );
    refused(
        |p| p.open_circuit = OpenCircuit::Linear { empty_v: -101.0, full_v: 4.0 },
        OutOfRange("cells.open_circuit"),
    );
    refused(|p| p.noise_sd_v = Real::NAN, NotARatio("cells.noise_sd_v"));
    refused(|p| p.noise_sd_v = 0.0, OutOfRange("cells.noise_sd_v"));
    refused(|p| p.offset_sd_v = -0.1, NotARatio("cells.offset_sd_v"));
    refused(|p| p.resistance_sd_ohm = 1.1, NotARatio("cells.resistance_sd_ohm"));
    refused(|p| p.capacity_sd = -0.1, NotARatio("cells.capacity_sd"));
    refused(|p| p.soc_sd = 0.0, NotPositive("cells.soc_sd"));
    refused(|p| p.soc_sd = 1.1, NotARatio("cells.soc_sd"));
    refused(|p| p.drift_sd_per_day = 2.0, NotARatio("cells.drift_sd_per_day"));
    refused(|p| p.pack_soc_sd_max = Real::NAN, NotARatio("cells.pack_soc_sd_max"));
    refused(|p| p.voltage_min_v = Real::NAN, OutOfRange("cells.voltage_min_v"));
    refused(|p| p.voltage_max_v = 101.0, OutOfRange("cells.voltage_max_v"));
    refused(|p| p.voltage_max_v = 2.0, NotAbove("cells.voltage_max_v"));
}
