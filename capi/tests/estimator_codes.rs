//! Every bad parameter, every bad field of a record and every bad slot has a code of its own.

use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod memory;
use memory::{DT_S, blank, get, known, preset};

/// Codes that were not seen before.
#[derive(Default)]
struct Codes(Vec<u32>);

impl Codes {
    fn add(&mut self, status: Status) {
        let code = status as u32;
        assert!(code > 19 && status != Status::Parameter, "{status:?}");
        assert!(!self.0.contains(&code), "{status:?} twice");
        self.0.push(code);
    }
}

fn refusal(params: VoltstepEstimatorParams, dt_s: f32) -> Status {
    let mut estimators = blank();
    // SAFETY: both are references.
    unsafe { voltstep_estimators_init(&raw mut *estimators, &raw const params, dt_s) }
}

#[test]
fn every_bad_parameter_has_a_code_of_its_own() {
    let good = preset();
    assert_eq!(refusal(good, DT_S), Status::Ok);
    let mut codes = Codes::default();
    /// Refuses the parameters with each of these fields not a number.
    macro_rules! each_nan {
        ($($group:ident { $($field:ident)+ })+) => {
            $($({
                let mut bad = good;
                bad.$group.$field = f32::NAN;
                codes.add(refusal(bad, DT_S));
            })+)+
        };
    }
    each_nan!(
        cell {
            capacity_ah discharge_limit_a charge_limit_a refresh_s hysteresis_half_gap_v
            hysteresis_rate_per_soc polarisation_time_constant_s
            second_polarisation_time_constant_s heat_capacity_j_per_k cooling_w_per_k ambient_c
            identified_soc_min identified_soc_max identified_temperature_min_c
            identified_temperature_max_c
        }
        filter {
            open_circuit_sd_v resistance_sd activation_sd_k capacity_sd current_offset_sd_a
            standby_sd_a voltage_sd_v polarisation_sd_v correlation_soc outside_factor
            flat_v_per_soc converged_sd unseen_current_a
        }
        counter {
            capacity_sd_ah charge_efficiency offset_sd_a gain_sd largest_current_a
            rest_voltage_sd_v rest_current_a rest_s
        }
        cells {
            noise_sd_v offset_sd_v resistance_sd_ohm capacity_sd soc_sd drift_sd_per_day
            pack_soc_sd_max voltage_min_v voltage_max_v
        }
        cell_resistances { resistance_ohm spread_sd noise_sd_v least_step_a memory_steps }
        resistance {
            voltage_sd_v current_sd_a least_step_a memory_steps initial_sd skew_s
        }
        capacity {
            nominal_sd_ah current_noise_sd_a current_offset_sd_a current_gain_sd least_soc_change
            least_soc_change_sds memory_pairs
        }
        power { voltage_min_v voltage_max_v soc_min soc_max margin_sds }
        energy { empty_soc full_soc empty_v least_a }
    );

    // Refuses the parameters changed in one place.
    let mut changed = |change: fn(&mut VoltstepEstimatorParams)| {
        let mut bad = good;
        change(&mut bad);
        codes.add(refusal(bad, DT_S));
    };
    changed(|p| p.cell.open_circuit_v[3] = f32::NAN);
    changed(|p| p.cell.open_circuit_v[64] = 1.0);
    changed(|p| p.cell.open_circuit_v[0] = -1.0);
    changed(|p| p.cell.open_circuit_v = [200.0; VOLTSTEP_SOC_POINTS]);
    changed(|p| p.cell.series.ohm[5] = -0.1);
    changed(|p| p.cell.series.activation_k = f32::NAN);
    changed(|p| p.cell.series.activation_k = 3e4);
    changed(|p| p.cell.polarisation.ohm[5] = f32::NAN);
    changed(|p| p.cell.polarisation.activation_k = -1.0);
    changed(|p| p.cell.polarisation.activation_k = 3e4);
    changed(|p| p.cell.second_polarisation.ohm[64] = -0.1);
    changed(|p| p.cell.second_polarisation.activation_k = -1.0);
    changed(|p| p.cell.second_polarisation.activation_k = 3e4);
    changed(|p| p.cell.identified_soc_max = p.cell.identified_soc_min);
    changed(|p| p.cell.identified_temperature_max_c = -50.0);
    changed(|p| p.filter.correlation_soc = 1.5);
    changed(|p| p.filter.outside_factor = 0.5);
    changed(|p| p.filter.converged_sd = 1.5);
    changed(|p| p.cells.noise_sd_v = 1e-7);
    changed(|p| p.cells.soc_sd = 1.5);
    changed(|p| p.cells.voltage_max_v = p.cells.voltage_min_v);
    changed(|p| p.cell_resistances.memory_steps = 1.0);
    changed(|p| p.resistance.memory_steps = 1.0);
    changed(|p| p.capacity.memory_pairs = 1.0);
    changed(|p| p.power.voltage_max_v = p.power.voltage_min_v);
    changed(|p| p.power.soc_max = p.power.soc_min);
    changed(|p| p.power.horizons_s = [2.0, 2.0, 3.0]);
    changed(|p| p.power.horizons_s = [0.0, 2.0, 3.0]);
    changed(|p| p.energy.full_soc = p.energy.empty_soc);
    changed(|p| p.power.discharge_window.none_below_c = f32::NAN);
    changed(|p| p.power.discharge_window.all_from_c = f32::NAN);
    changed(|p| p.power.discharge_window.all_from_c = -99.0);
    changed(|p| p.power.discharge_window.all_to_c = f32::NAN);
    changed(|p| p.power.discharge_window.all_to_c = -99.0);
    changed(|p| p.power.discharge_window.none_above_c = f32::NAN);
    changed(|p| p.power.discharge_window.none_above_c = -99.0);
    changed(|p| p.power.charge_window.none_below_c = f32::NAN);
    changed(|p| p.power.charge_window.all_from_c = f32::NAN);
    changed(|p| p.power.charge_window.all_from_c = -99.0);
    changed(|p| p.power.charge_window.all_to_c = f32::NAN);
    changed(|p| p.power.charge_window.all_to_c = -99.0);
    changed(|p| p.power.charge_window.none_above_c = f32::NAN);
    changed(|p| p.power.charge_window.none_above_c = -99.0);
    codes.add(refusal(good, 0.0));
    assert_eq!(refusal(VoltstepEstimatorParams { abi: 0, ..good }, DT_S), Status::AbiMismatch);

    let mut params = good;
    // SAFETY: the pointer comes from a reference.
    let status = unsafe { voltstep_estimator_params_preset(99, &raw mut params) };
    assert_eq!(status, Status::UnknownCellPreset);
}

#[test]
fn every_bad_field_of_a_record_has_a_code_of_its_own() {
    let mut codes = Codes::default();
    let mut refused = |change: fn(&mut VoltstepRecord)| {
        let (mut record, mut bytes) = (known(), [0; VOLTSTEP_RECORD_BYTES]);
        record.polarised = 1;
        change(&mut record);
        // SAFETY: both come from references.
        codes.add(unsafe { voltstep_record_encode(&raw const record, 1, bytes.as_mut_ptr()) });
        assert_eq!(bytes, [0; VOLTSTEP_RECORD_BYTES]);
    };
    refused(|r| r.soc = 1.1);
    refused(|r| r.soc_sd = f32::NAN);
    refused(|r| r.capacity_ah = f32::NAN);
    refused(|r| r.capacity_ah = 1e7);
    refused(|r| r.capacity_sd_ah = f32::NAN);
    refused(|r| r.capacity_sd_ah = 3.0);
    refused(|r| r.resistance_factor = f32::NAN);
    refused(|r| r.resistance_factor = 101.0);
    refused(|r| r.resistance_factor_sd = -1.0);
    refused(|r| r.resistance_factor_sd = 101.0);
    refused(|r| r.current_offset_a = f32::NAN);
    refused(|r| r.current_offset_a = -2e4);
    refused(|r| r.current_offset_sd_a = f32::NAN);
    refused(|r| r.current_offset_sd_a = 2e4);
    refused(|r| r.throughput_ah = -1.0);
    refused(|r| r.throughput_ah = 2e9);
    refused(|r| r.polarisation_v[1] = f32::NAN);
    refused(|r| r.polarisation_v[0] = 2e4);
    refused(|r| r.load_a = -1.0);
    refused(|r| r.load_a = 2e5);
    refused(|r| r.hysteresis = f32::NAN);
    refused(|r| r.hysteresis = 2.0);
    refused(|r| r.resistor_heat_j = f32::NAN);
    refused(|r| r.resistor_heat_j = 2e6);
}

#[test]
fn records_survive_and_say_why_there_is_none() {
    let mut record = known();
    (record.polarised, record.polarisation_v, record.load_a) = (1, [0.01, -0.02], 3.0);
    let mut bytes = [0; VOLTSTEP_RECORD_BYTES];
    let blank = [0xff; VOLTSTEP_RECORD_BYTES];
    let decode = |bytes: &[u8; VOLTSTEP_RECORD_BYTES]| {
        let (mut found, mut sequence) = (known(), 0);
        // SAFETY: every pointer comes from a reference.
        let status =
            unsafe { voltstep_record_decode(bytes.as_ptr(), &raw mut found, &raw mut sequence) };
        (status, found, sequence)
    };
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let status = voltstep_record_encode(&raw const record, 7, bytes.as_mut_ptr());
        assert_eq!(status, Status::Ok);
        assert_eq!(decode(&bytes), (Status::Ok, record, 7));
        assert_eq!(decode(&blank).0, Status::RecordBlank);
        assert_eq!(decode(&[0; VOLTSTEP_RECORD_BYTES]).0, Status::RecordUnknown);
        let mut torn = bytes;
        torn[20] ^= 1;
        assert_eq!(decode(&torn).0, Status::RecordCorrupted);

        let stored: VoltstepStored =
            get(|stored| voltstep_record_newest(bytes.as_ptr(), torn.as_ptr(), stored));
        assert_eq!((stored.record, stored.sequence, stored.damaged), (record, 7, true));
        assert_eq!((stored.next_slot, stored.next_sequence), (1, 8));
        let mut none = stored;
        let status = voltstep_record_newest(blank.as_ptr(), blank.as_ptr(), &raw mut none);
        assert_eq!((status, none.next_slot, none.damaged), (Status::RecordBlank, 0, false));
        assert_eq!((none.next_sequence, none.record.capacity_ah), (0, 0.0));
    }
}
