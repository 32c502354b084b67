//! The batteries that are simulated, and what may be wrong in them.

use plant_core::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OpenCircuit, OverSoc,
    ResistanceMap,
};
use plant_core::must;
use plant_core::num::{SOC_POINTS, SocTable};
use plant_core::presets::{BMW_I3_60AH_PACK, PANASONIC_NCR18650PF};
use serde::Serialize;

/// A kind of battery.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Chemistry {
    /// A Panasonic NCR18650PF, whose curve rises everywhere.
    Cell,
    /// A cell as flat as lithium iron phosphate, with hysteresis.
    Flat,
    /// The 96 cells of a BMW i3 as one.
    Pack,
}

const FLAT: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 2.5,
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "open_circuit",
        &[
            (0.0, 2.60),
            (0.02, 2.90),
            (0.05, 3.10),
            (0.10, 3.20),
            (0.20, 3.25),
            (0.30, 3.285),
            (0.40, 3.295),
            (0.50, 3.298),
            (0.60, 3.305),
            (0.65, 3.325),
            (0.70, 3.330),
            (0.80, 3.332),
            (0.90, 3.335),
            (0.95, 3.345),
            (0.98, 3.38),
            (1.0, 3.45),
        ]
    ))),
    hysteresis: HysteresisParams { half_gap_v: 0.012, rate_per_soc: 30.0 },
    series: ResistanceMap { resistance_ohm: OverSoc::Constant(0.010), activation_k: 2200.0 },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Constant(0.006),
        activation_k: 3000.0,
        time_constant_s: 10.0,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Constant(0.008),
        activation_k: 3000.0,
        time_constant_s: 300.0,
    },
    identified: IdentifiedRange::ALL,
    ..PANASONIC_NCR18650PF
};

impl Chemistry {
    /// All.
    pub const ALL: [Self; 3] = [Self::Cell, Self::Flat, Self::Pack];

    /// In a word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Cell => "cell",
            Self::Flat => "flat cell",
            Self::Pack => "pack",
        }
    }

    /// Its parameters, with no limits of the current: a truth has none.
    pub(super) const fn params(self) -> MappedBatteryParams {
        match self {
            Self::Cell => PANASONIC_NCR18650PF,
            Self::Flat => FLAT,
            Self::Pack => BMW_I3_60AH_PACK,
        }
    }
}

impl Chemistry {
    /// How many cells in series.
    pub(super) const fn cells(self) -> f32 {
        match self {
            Self::Cell | Self::Flat => 1.0,
            Self::Pack => 96.0,
        }
    }

    /// One of its cells.
    pub(super) fn cell(self) -> MappedBatteryParams {
        let mut battery = self.params();
        in_series(&mut battery, 1.0 / self.cells());
        battery
    }

    /// Where a cell counts as empty \[V\].
    pub(super) const fn empty_v(self) -> f32 {
        match self {
            Self::Cell | Self::Pack => 2.7,
            Self::Flat => 2.5,
        }
    }

    /// Other cells in its place: their curve and resistances, its capacity.
    pub(super) fn other(self) -> MappedBatteryParams {
        let (own, other) =
            (self.params(), if self == Self::Flat { Self::Cell } else { Self::Flat });
        let mut battery = other.params();
        in_series(&mut battery, self.cells());
        battery.capacity_ah = own.capacity_ah;
        scale_resistances(&mut battery, other.params().capacity_ah / own.capacity_ah);
        battery
    }
}

/// So many times the cells in series.
pub(super) fn in_series(battery: &mut MappedBatteryParams, times: f32) {
    scale_resistances(battery, times);
    battery.hysteresis.half_gap_v *= times;
    if let OpenCircuit::Table(table) = battery.open_circuit
        && let Ok(table) = SocTable::new("open_circuit", table.values().map(|v| v * times))
    {
        battery.open_circuit = OpenCircuit::Table(table);
    }
}

/// Every resistance larger by a factor.
pub(super) fn scale_resistances(battery: &mut MappedBatteryParams, factor: f32) {
    for over in [
        &mut battery.series.resistance_ohm,
        &mut battery.polarisation.resistance_ohm,
        &mut battery.second_polarisation.resistance_ohm,
    ] {
        *over = match over {
            OverSoc::Constant(ohm) => OverSoc::Constant(*ohm * factor),
            OverSoc::Table(table) => {
                let values: [f32; SOC_POINTS] = table.values().map(|ohm| ohm * factor);
                SocTable::new("resistance_ohm", values).map_or(*over, OverSoc::Table)
            }
        };
    }
}

/// The open-circuit curve higher by what is given over the state of charge \[V\], where it still
/// rises.
pub(super) fn bend(battery: &mut MappedBatteryParams, by_v: impl Fn(f32) -> f32) {
    if let OpenCircuit::Table(table) = battery.open_circuit {
        let mut values = *table.values();
        let (mut soc, mut least_v) = (0.0, f32::MIN);
        for value in &mut values {
            *value = (*value + by_v(soc)).max(least_v);
            (soc, least_v) = (soc + 1.0 / 64.0, *value);
        }
        if let Ok(table) = SocTable::new("open_circuit", values) {
            battery.open_circuit = OpenCircuit::Table(table);
        }
    }
}
