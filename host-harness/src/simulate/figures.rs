//! Figures that a replay and a measurement have in common.

use serde::Serialize;

/// Joules in a kilowatt-hour.
pub const J_PER_KWH: f64 = 3.6e6;

/// Figures that a replay and a measurement have in common.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Distance \[km\].
    pub distance_km: f64,
    /// State of charge at the start, 0..1.
    pub soc_initial: f64,
    /// State of charge at the end, 0..1.
    pub soc_final: f64,
    /// Net energy at the battery's terminals \[kWh\].
    pub battery_energy_kwh: f64,
    /// The same per distance \[Wh/km\]; absent where nothing moved.
    pub consumption_wh_per_km: Option<f64>,
    /// Lowest motor torque \[N·m\]; absent where there was none to see.
    pub motor_torque_min_nm: Option<f64>,
    /// Highest motor torque \[N·m\].
    pub motor_torque_max_nm: Option<f64>,
    /// Lowest battery current \[A\], negative when charging.
    pub battery_current_min_a: f64,
    /// Highest battery current \[A\].
    pub battery_current_max_a: f64,
    /// Lowest battery voltage \[V\].
    pub battery_voltage_min_v: f64,
}

impl Figures {
    /// From sums and extremes.
    #[must_use]
    pub fn new(
        distance_km: f64,
        soc: (f64, f64),
        battery_energy_j: f64,
        motor_torque_nm: Option<(f64, f64)>,
        battery_current_a: (f64, f64),
        battery_voltage_min_v: f64,
    ) -> Self {
        let battery_energy_kwh = battery_energy_j / J_PER_KWH;
        Self {
            distance_km,
            soc_initial: soc.0,
            soc_final: soc.1,
            battery_energy_kwh,
            consumption_wh_per_km: (distance_km > 1e-3)
                .then(|| battery_energy_kwh * 1000.0 / distance_km),
            motor_torque_min_nm: motor_torque_nm.map(|t| t.0),
            motor_torque_max_nm: motor_torque_nm.map(|t| t.1),
            battery_current_min_a: battery_current_a.0,
            battery_current_max_a: battery_current_a.1,
            battery_voltage_min_v,
        }
    }
}
