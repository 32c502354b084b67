//! The words of every refusal that a description of a pack can meet.

use core::ffi::c_char;

use plant_core::ParamError;

use crate::refusals::{rule, voltstep_error_message};
use crate::status::VoltstepStatus;

/// `field rule`, for C.
macro_rules! words {
    ($($rule:ident $field:literal,)+) => {
        const WORDS: &[(ParamError, &str)] =
            &[$((ParamError::$rule($field), concat!($field, " ", rule!($rule), "\0")),)+];
    };
}

words! {
    NotPositive "sheet.voltage.deep_v",
    NotAbove "sheet.voltage.absolute_min_v",
    NotAbove "sheet.voltage.operating_min_v",
    NotAbove "sheet.voltage.operating_max_v",
    NotAbove "sheet.voltage.absolute_max_v",
    NotFinite "sheet.voltage.absolute_max_v",
    OutOfRange "sheet.voltage.absolute_min_v",
    OutOfRange "sheet.voltage.absolute_max_v",
    NotPositive "sheet.discharge.continuous_a",
    NotPositive "sheet.discharge.ten_seconds_a",
    NotAbove "sheet.discharge.ten_seconds_a",
    OutOfRange "sheet.discharge.ten_seconds_a",
    NotPositive "sheet.charge.continuous_a",
    NotPositive "sheet.charge.ten_seconds_a",
    NotAbove "sheet.charge.ten_seconds_a",
    OutOfRange "sheet.charge.ten_seconds_a",
    NotFinite "sheet.discharge_window.none_below_c",
    OutOfRange "sheet.discharge_window.none_below_c",
    NotAbove "sheet.discharge_window.all_from_c",
    NotAbove "sheet.discharge_window.all_to_c",
    NotAbove "sheet.discharge_window.none_above_c",
    NotFinite "sheet.discharge_window.none_above_c",
    OutOfRange "sheet.discharge_window.none_above_c",
    NotFinite "sheet.charge_window.none_below_c",
    OutOfRange "sheet.charge_window.none_below_c",
    NotAbove "sheet.charge_window.all_from_c",
    NotAbove "sheet.charge_window.all_to_c",
    NotAbove "sheet.charge_window.none_above_c",
    NotFinite "sheet.charge_window.none_above_c",
    OutOfRange "sheet.charge_window.none_above_c",
    NotPositive "sheet.capacity_ah",
    NotPositive "sheet.resistance_ohm",
    NotPositive "sheet.heat_capacity_j_per_k",
    OutOfRange "layout.parallel",
    Negative "sensing.cell_v",
    NotPositive "sensing.cell_v",
    NotFinite "sensing.cell_v",
    NotAbove "sensing.cell_v",
    Negative "sensing.temperature_c",
    NotPositive "sensing.temperature_c",
    NotFinite "sensing.temperature_c",
    NotAbove "sensing.temperature_c",
    Negative "sensing.current_a",
    NotPositive "sensing.current_a",
    NotFinite "sensing.current_a",
    NotAbove "sensing.current_a",
    Negative "sensing.pack_v",
    NotPositive "sensing.pack_v",
    NotFinite "sensing.pack_v",
    NotAbove "sensing.pack_v",
    Negative "sensing.link_v",
    NotPositive "sensing.link_v",
    NotFinite "sensing.link_v",
    NotAbove "sensing.link_v",
    OutOfRange "sensing.current_a",
    NotPositive "actuators.open_s",
    Negative "actuators.wait_s",
    NotPositive "actuators.break_a",
    OutOfRange "tick_s",
    OutOfRange "sweep_ticks",
    NotFinite "row.threshold",
    Negative "row.hysteresis",
    OutOfRange "row.debounce.count",
    OutOfRange "row.debounce.delay",
    OutOfRange "row.debounce.heal",
    NotPositive "bms.alike.resistance_ohm",
    NotPositive "bms.alike.resistance_sd",
    Negative "bms.current_offset_sd_a",
    NotARatio "bms.current_gain_sd",
    Negative "bms.skew_s",
    NotFinite "bms.sample_s",
    OutOfRange "bms.sample_s",
    NotPositive "contactor.start_limit_s",
    OutOfRange "contactor.start_limit_s",
    NotPositive "contactor.settle_s",
    OutOfRange "contactor.settle_s",
    NotPositive "contactor.close_limit_s",
    OutOfRange "contactor.close_limit_s",
    NotPositive "contactor.precharge_limit_s",
    OutOfRange "contactor.precharge_limit_s",
    NotPositive "contactor.open_limit_s",
    OutOfRange "contactor.open_limit_s",
    NotPositive "contactor.shed_limit_s",
    OutOfRange "contactor.shed_limit_s",
    NotPositive "contactor.hard_limit_s",
    OutOfRange "contactor.hard_limit_s",
    NotPositive "contactor.weld_limit_s",
    OutOfRange "contactor.weld_limit_s",
    NotPositive "contactor.cooldown_s",
    OutOfRange "contactor.cooldown_s",
    NotAbove "contactor.close_limit_s",
    NotAbove "contactor.shed_limit_s",
    OutOfRange "contactor.tries",
    NotPositive "precharge.resistor_ohm",
    NotPositive "precharge.link_f",
    NotPositive "precharge.tau_factor",
    NotPositive "precharge.done_v",
    NotPositive "precharge.short_j",
    NotPositive "precharge.budget_j",
    NotPositive "precharge.cooling_s",
    OutOfRange "precharge.link_f",
    NotAbove "precharge.tau_factor",
    Negative "precharge.noise_v",
    Negative "precharge.noise_a",
    OutOfRange "precharge.count",
    Negative "precharge.lag_s",
    OutOfRange "precharge.lag_s",
    NotAbove "precharge.budget_j",
    Negative "link_trend.noise_v",
    NotPositive "balancer.bleed_ohm",
    NotPositive "balancer.capacity_ah",
    NotPositive "balancer.hysteresis_v",
    NotPositive "balancer.least_v",
    OutOfRange "balancer.channels",
    NotFinite "balancer.board_max_c",
    NotPositive "limiter.discharge_a",
    NotPositive "limiter.charge_a",
    NotFinite "limiter.charge_from_c",
    Negative "limiter.temperature_error_k",
    NotPositive "limiter.ending_s",
}

/// The words of a refused parameter: a static text that ends with a zero.
pub(super) fn words(error: ParamError) -> *const c_char {
    match WORDS.iter().find(|(refused, _)| *refused == error) {
        Some((_, text)) => text.as_ptr().cast(),
        None => voltstep_error_message(VoltstepStatus::from(error) as u32),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    #[test]
    fn the_words_are_those_of_the_models() {
        for (i, (error, text)) in WORDS.iter().enumerate() {
            assert_eq!(*text, format!("{error}\0"));
            assert_eq!(
                VoltstepStatus::from(*error),
                VoltstepStatus::Parameter,
                "{error} has a code"
            );
            assert!(WORDS[..i].iter().all(|(other, _)| other != error), "{error} twice");
        }
    }
}
