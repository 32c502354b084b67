//! Cells in series that are not alike: in single precision as in double, and finite for any input.

use plant_core::Real;
use proptest::prelude::*;

/// How far both may be apart after an hour at 10 Hz: state of charge, voltage of a cell \[V\],
/// temperature \[K\].
const APART: [f64; 3] = [2e-7, 2e-6, 1e-5];

/// The same hour in one precision: state of charge, voltage and temperature of each cell, every
/// hundred seconds.
macro_rules! hour {
    ($core:ident, $real:ty) => {{
        use $core::battery::{CellSpread, SeriesPack, SeriesPackInput, SeriesPackParams};
        use $core::battery::{ThermalParams, VoltageLimits};
        use $core::presets::PANASONIC_NCR18650PF;
        let mut cell = PANASONIC_NCR18650PF;
        cell.thermal =
            ThermalParams { heat_capacity_j_per_k: 45.0, cooling_w_per_k: 0.05, ambient_c: 15.0 };
        cell.voltage_limits = VoltageLimits { lowest_v: 2.9, highest_v: 4.15 };
        let spread = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|number: $real| {
            let off = number - 2.5;
            CellSpread {
                capacity_ratio: 1.0 + 0.01 * off,
                resistance_ratio: 1.0 - 0.05 * off,
                cooling_ratio: 1.0 + 0.1 * off,
                self_discharge_a: 1e-4 * number,
                soc_offset: 0.01 * off,
                temperature_offset_k: 1.5 * off,
            }
        });
        let params = SeriesPackParams { cell, spread, neighbour_w_per_k: 0.1 };
        let pack = SeriesPack::new(params, $core::Dt::from_s(0.1).unwrap()).unwrap();
        let (mut state, mut seen) = (pack.rested(0.7).unwrap(), Vec::new());
        for k in 0..36_000_usize {
            let current_a = [4.0, -2.0, 0.0, 1.0, -4.5][k / 700 % 5];
            let bleed_a =
                core::array::from_fn(|i| if (k / 5000 + i) % 3 == 0 { 0.05 } else { 0.0 });
            let out = pack.step(&mut state, SeriesPackInput { current_a, bleed_a });
            if k % 1000 == 999 {
                for i in 0..6 {
                    seen.push([
                        f64::from(out.cell_soc[i]),
                        f64::from(out.cell_v[i]),
                        f64::from(out.cell_temperature_c[i]),
                    ]);
                }
            }
        }
        seen
    }};
}

#[test]
fn single_precision_is_as_good_as_double() {
    let (single, double) = (hour!(plant_core, f32), hour!(plant_core_f64, f64));
    let mut apart = [0.0_f64; 3];
    for (one, other) in single.iter().zip(&double) {
        for (k, apart) in apart.iter_mut().enumerate() {
            *apart = apart.max((one[k] - other[k]).abs());
        }
    }
    println!("apart: {apart:?}");
    assert_eq!((single.len(), double.len()), (216, 216));
    for (apart, allowed) in apart.into_iter().zip(APART) {
        assert!(apart > 0.0 && apart <= allowed, "{apart} of {allowed}");
    }
}

/// Any bits, the plausible ones often.
fn bits() -> impl Strategy<Value = Real> {
    prop_oneof![
        3 => -20.0..20.0_f32,
        1 => any::<u32>().prop_map(Real::from_bits),
        1 => prop::sample::select(vec![0.0, Real::NAN, Real::INFINITY, 1e9, -1e9, 1e38]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// No input makes a state infinite, what is rejected changes nothing, and no charge appears from
    /// nowhere, at any step.
    #[test]
    fn stays_finite_and_within_its_ends(
        dt_s in prop_oneof![Just(1e-6_f32), Just(0.01), Just(1.0), Just(1e6)],
        soc in 0.0..=1.0_f32,
        inputs in prop::collection::vec((bits(), prop::array::uniform4(bits())), 1..60),
    ) {
        use plant_core::battery::{CellSpread, SeriesPack, SeriesPackInput, SeriesPackParams};
        let weak = CellSpread { capacity_ratio: 0.5, resistance_ratio: 3.0, ..CellSpread::NONE };
        let params = SeriesPackParams {
            cell: plant_core::presets::PANASONIC_NCR18650PF,
            spread: [CellSpread::NONE, weak, CellSpread::NONE, weak],
            neighbour_w_per_k: 0.2,
        };
        let pack = SeriesPack::new(params, plant_core::Dt::from_s(dt_s).unwrap()).unwrap();
        let mut state = pack.rested(soc).unwrap();
        for (current_a, bleed_a) in inputs {
            let before = state;
            let out = pack.step(&mut state, SeriesPackInput { current_a, bleed_a });
            let sane = current_a.abs() <= 1e9 && bleed_a.iter().all(|a| a.abs() <= 1e9);
            prop_assert!(out.rejected || sane, "{out:?}");
            prop_assert!(!out.rejected || state == before, "{out:?}");
            for i in 0..4 {
                prop_assert!((0.0..=1.0).contains(&out.cell_soc[i]), "{out:?}");
                prop_assert!(out.cell_v[i].is_finite() && out.cell_temperature_c[i].is_finite());
            }
            prop_assert!((0.0..=1.0).contains(&out.soc) && out.terminal_v.is_finite(), "{out:?}");
        }
    }
}

/// A car on a row of cells that are not alike: the books close, what a cell lacks limits the pack, and
/// like cells drive it as the pack that is made of them.
#[test]
fn drives_a_vehicle() {
    use plant_core::battery::{CellSpread, MappedBattery, Pack, SeriesPack, SeriesPackParams};
    use plant_core::powertrain::{Powertrain, PowertrainInput};
    use plant_core::presets::{BMW_I3_60AH, PANASONIC_NCR18650PF};
    let dt = plant_core::Dt::from_s(0.01).unwrap();
    let cell = PANASONIC_NCR18650PF.pack(1, 20).unwrap();
    let mut spread = [CellSpread::NONE; 96];
    let row = |spread| SeriesPackParams { cell, spread, neighbour_w_per_k: 1.0 };
    let alike = SeriesPack::new(row(spread), dt).unwrap();
    spread[40].soc_offset = -0.3;
    spread[7].resistance_ratio = 2.0;
    let unlike = SeriesPack::new(row(spread), dt).unwrap();
    let whole = MappedBattery::new(cell.pack(96, 1).unwrap(), dt).unwrap();
    let i3 = BMW_I3_60AH.powertrain;
    let axles = i3.drives.on(i3.wheel, dt).unwrap();
    let duties = [0.3_f32, 0.5, 0.2, 0.0, 0.6];

    let car = Powertrain::of(alike, axles, &i3, dt).unwrap();
    let other = Powertrain::of(whole, axles, &i3, dt).unwrap();
    let (mut s, mut o) = (car.at_rest(0.6).unwrap(), other.at_rest(0.6).unwrap());
    for k in 0..3000 {
        let input = PowertrainInput::on(duties[k / 600]);
        let (one, two) = (car.step(&mut s, input), other.step(&mut o, input));
        assert!((one.battery_v - two.battery_v).abs() < 0.01, "{k}: {one:?} {two:?}");
        assert!((one.speed_m_s - two.speed_m_s).abs() < 1e-3, "{k}: {one:?} {two:?}");
    }

    let car = Powertrain::of(unlike, axles, &i3, dt).unwrap().with_ledger();
    let start = car.at_rest(0.301).unwrap();
    let (mut s, mut limited) = (start, false);
    for k in 0..3000 {
        let faded = car.battery().faded(&s.battery);
        let out = car.step(&mut s, PowertrainInput::on(duties[k / 600]));
        assert!(!out.rejected, "{out:?}");
        let over_a = out.battery_a - faded.discharge_a;
        assert!(over_a <= out.limit_exceeded_a + 0.01, "{k}: {out:?} {faded:?}");
        limited |= faded.discharge_a < 0.5 * cell.discharge_limit_a;
    }
    assert!(limited && s.battery.cells[40].soc.get() < 2e-3, "{:?}", s.battery.cells[40]);
    let energy = car.energy(&start, &s);
    assert!(energy.residual_rel() < 1e-5 && energy.throughput > 1e4, "{energy:?}");
    assert!(<SeriesPack<96> as Pack>::soc(&s.battery) < 0.01);
}
