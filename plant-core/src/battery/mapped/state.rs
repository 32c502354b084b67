//! What a battery with maps remembers, takes and tells.

use crate::num::{Accum, Real};

/// The resistances at an operating point \[Ω\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Resistances {
    /// In series.
    pub series_ohm: Real,
    /// Of the RC branches, the faster first.
    pub polarisation_ohm: [Real; 2],
}

/// The state of a [`MappedBattery`](super::MappedBattery); [`MappedBattery::rested`](super::MappedBattery::rested) makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MappedBatteryState {
    /// State of charge, 0..1. May be set from an estimate; what lies outside is held at the end.
    pub soc: Accum,
    /// Voltage across the RC branches, positive when discharging \[V\].
    pub polarisation_v: [Accum; 2],
    /// Where between the curves of discharge (−1) and charge (1) the open-circuit voltage lies.
    pub hysteresis: Accum,
    /// Temperature \[°C\]; may be set between steps where it is measured.
    pub temperature_c: Accum,
    /// Temperature of the surroundings \[°C\]; may be set between steps. One that is not finite or
    /// absurd is ignored: the last good one holds.
    pub ambient_c: Real,
    /// The last good one \[°C\].
    pub(in crate::battery) surroundings_c: Real,
    /// Heat since the last refresh \[J\].
    pub(in crate::battery) heat_j: Real,
    /// The resistances since then.
    pub(in crate::battery) now: Resistances,
    /// The part of the battery that acts as a resistance within one step \[Ω\].
    pub(in crate::battery) source_ohm: Real,
    pub(in crate::battery) steps_left: u32,
    pub(in crate::battery) outside: bool,
}

impl MappedBatteryState {
    /// The sum of the magnitudes of what a step changes beside the state of charge.
    #[inline]
    pub(in crate::battery) const fn magnitude(&self) -> Real {
        let [fast_v, slow_v] = &self.polarisation_v;
        fast_v.get().abs() + slow_v.get().abs() + self.heat_j.abs()
    }
}

/// Input of a [`MappedBattery`](super::MappedBattery) that steps on its own: the current imposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedBatteryInput {
    /// Current \[A\], positive when discharging.
    pub current_a: Real,
}

/// Output of one step of a [`MappedBattery`](super::MappedBattery).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct MappedBatteryOutput {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Voltage at the terminals \[V\].
    pub terminal_v: Real,
    /// Open-circuit voltage over the step, without hysteresis \[V\].
    pub open_circuit_v: Real,
    /// The current that flowed \[A\], positive when discharging.
    pub current_a: Real,
    /// Charge of this step that the limits or the state of charge refused \[C\]; positive where
    /// discharge was refused, negative where charge was.
    pub refused_charge_c: Real,
    /// Heat, `(OCV − V)·I` \[W\]; it includes what the RC branches store for a while.
    pub heat_w: Real,
    /// Temperature \[°C\].
    pub temperature_c: Real,
    /// Nothing is left to discharge.
    pub depleted: bool,
    /// Nothing more can be charged.
    pub full: bool,
    /// State of charge or temperature lie outside what the parameters were identified for: those
    /// of the nearest end hold.
    pub outside_identified: bool,
    /// The input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}
