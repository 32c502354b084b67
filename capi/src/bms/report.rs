//! What a BMS knows, as one struct.

use voltstep_bms::contactor::{Cause, Phase};
use voltstep_bms::limit::{Limited, Mode};
use voltstep_bms::manage::{Report, SocSource};
use voltstep_bms::measure::Spread;
use voltstep_bms::protect::{Faults, Trip};

use crate::estimators::{VoltstepEnergyReport, VoltstepHealth};

/// A choice of the BMS with the number that C knows it by.
macro_rules! choice {
    ($name:ident of $of:ident { $($variant:ident)+ }) => {
        impl From<$of> for $name {
            fn from(of: $of) -> Self {
                match of { $($of::$variant => Self::$variant,)+ }
            }
        }
    };
}

/// Where the contactors are in their order.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsPhase {
    /// After a reset: nothing is known yet.
    Start = 0,
    /// All open, ready.
    Standby = 1,
    /// The main contactor at the negative pole closes.
    CloseMinus = 2,
    /// The link is charged through the resistor.
    Precharge = 3,
    /// The main contactor at the positive pole closes.
    ClosePlus = 4,
    /// The precharge contactor opens.
    OpenPrecharge = 5,
    /// Both mains are closed.
    Closed = 6,
    /// Both are closed still, and no power is allowed.
    Shed = 7,
    /// The main contactor at the positive pole opens.
    OpenFirst = 8,
    /// All open.
    OpenSecond = 9,
    /// All should be open: are they?
    WeldCheck = 10,
    /// A pause before the next try.
    Cooldown = 11,
    /// All open, until somebody clears it.
    Fault = 12,
}
choice!(VoltstepBmsPhase of Phase {
    Start Standby CloseMinus Precharge ClosePlus OpenPrecharge Closed Shed OpenFirst OpenSecond
    WeldCheck Cooldown Fault
});

/// Why the contactors opened, or may not close.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsCause {
    /// Nothing, or the request ended.
    None = 0,
    /// A trip that let the power be taken back first.
    Soft = 1,
    /// A trip at a safety limit.
    Hard = 2,
    /// A crash.
    Crash = 3,
    /// Data went missing while closing, or never came.
    Lost = 4,
    /// Minus does not show closed.
    MinusStuckOpen = 5,
    /// Plus does not show closed.
    PlusStuckOpen = 6,
    /// Precharge does not show closed.
    PrechargeStuckOpen = 7,
    /// Precharge does not show open.
    PrechargeStuckClosed = 8,
    /// Current flows, the link stays down.
    PrechargeShort = 9,
    /// No current flows into the link.
    PrechargeOpen = 10,
    /// The link rises too slowly.
    PrechargeSlow = 11,
    /// The link rises, or a contactor shows closed, before its turn.
    Bypassed = 12,
    /// A main that was closed shows open.
    Dropped = 13,
    /// One shows closed that should be open.
    Welded = 14,
}
choice!(VoltstepBmsCause of Cause {
    None Soft Hard Crash Lost MinusStuckOpen PlusStuckOpen PrechargeStuckOpen PrechargeStuckClosed
    PrechargeShort PrechargeOpen PrechargeSlow Bypassed Dropped Welded
});

/// What is done of what is asked for.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsMode {
    /// Open.
    Off = 0,
    /// Closed to drive.
    Drive = 1,
    /// Closed to charge.
    Charge = 2,
}
choice!(VoltstepBmsMode of Mode { Off Drive Charge });

/// What the rows tell the contactors.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsTrip {
    /// Nothing: go on.
    None = 0,
    /// Power is taken back over seconds, then they open.
    Soft = 1,
    /// They open after a short wait for the current.
    Hard = 2,
    /// They open at once.
    Crash = 3,
}
choice!(VoltstepBmsTrip of Trip { None Soft Hard Crash });

/// Why not more may be drawn or fed.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsLimited {
    /// By what the cells allow.
    Cells = 0,
    /// By the largest current of the pack.
    Pack = 1,
    /// A row takes back power.
    Derated = 2,
    /// A safety limit of this direction is broken.
    Barred = 3,
    /// Too cold to charge.
    Cold = 4,
    /// What the cells allow, or how warm they are, is not known.
    Unknown = 5,
    /// The contactors are about to open.
    Ending = 6,
    /// The contactors are not closed.
    Open = 7,
    /// It is still on its way from another limit.
    Rate = 8,
}
choice!(VoltstepBmsLimited of Limited {
    Cells Pack Derated Barred Cold Unknown Ending Open Rate
});

/// How far several readings of one quantity lie apart; NaN where none is usable.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsSpread {
    /// The lowest.
    pub min: f32,
    /// The mean.
    pub mean: f32,
    /// The highest.
    pub max: f32,
    /// Which reading is the lowest; the first where several are.
    pub min_index: u32,
    /// Which reading is the highest; the first where several are.
    pub max_index: u32,
    /// How many are usable.
    pub usable: u32,
}

/// What a BMS knows. Charge, energy and currents are those of the pack.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsReport {
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Its standard deviation, a ratio.
    pub soc_sd: f32,
    /// It comes from counting alone, which knows better than the filter, or the filter contradicts
    /// itself.
    pub soc_counted: bool,
    /// The filter's standard deviation is small enough to count as known.
    pub converged: bool,
    /// The model's error, and the mean residual beside it, are of the size that is expected.
    pub consistent: bool,
    /// The open-circuit curve is flat here: the voltage does not correct.
    pub flat: bool,
    /// State of charge or temperature lie outside the identified range.
    pub outside_identified: bool,
    /// The temperature is not known; the last one holds.
    pub temperature_missing: bool,
    /// Lowest state of charge of a cell, a ratio 0..1.
    pub soc_min: f32,
    /// Mean of the cells' states of charge, a ratio 0..1.
    pub soc_mean: f32,
    /// Highest state of charge of a cell, a ratio 0..1.
    pub soc_max: f32,
    /// Which cell has the lowest.
    pub soc_min_index: u32,
    /// Which cell has the highest.
    pub soc_max_index: u32,
    /// Capacity of the pack in A h.
    pub capacity_ah: f32,
    /// Health of the mean cell.
    pub health: VoltstepHealth,
    /// Energy and time left of the pack; NaN in the first second.
    pub energy: VoltstepEnergyReport,
    /// What may be drawn in A; zero or above.
    pub discharge_limit_a: f32,
    /// Why not more: one of `VoltstepBmsLimited`.
    pub discharge_limited: u32,
    /// What may be fed in A; zero or above.
    pub charge_limit_a: f32,
    /// Why not more: one of `VoltstepBmsLimited`.
    pub charge_limited: u32,
    /// Voltages of the cells in V.
    pub cell_v: VoltstepBmsSpread,
    /// Temperatures in degC.
    pub temperature_c: VoltstepBmsSpread,
    /// Current in A, positive when discharging; NaN where it is not known.
    pub current_a: f32,
    /// Voltage of the pack in V; NaN where it is not known.
    pub pack_v: f32,
    /// Voltage behind the contactors in V; NaN where it is not known.
    pub link_v: f32,
    /// What is done of what is asked for: one of `VoltstepBmsMode`.
    pub mode: u32,
    /// Where the contactors are: one of `VoltstepBmsPhase`.
    pub phase: u32,
    /// Why they opened, or may not close: one of `VoltstepBmsCause`.
    pub cause: u32,
    /// What the rows tell the contactors: one of `VoltstepBmsTrip`.
    pub trip: u32,
    /// Everything was seen, and nothing that forbids to close has tripped or is latched.
    pub permit: bool,
    /// Rows that have tripped and not healed, a bit for each of `VoltstepBmsRow`, row k in word k/32.
    pub tripped: [u32; 3],
    /// Rows that stay until somebody ends them, likewise.
    pub latched: [u32; 3],
    /// Charge that went through the pack over its life in A h.
    pub throughput_ah: f32,
}

#[expect(clippy::cast_possible_truncation, reason = "below the number of readings")]
fn spread(of: Option<Spread>) -> VoltstepBmsSpread {
    let Some(s) = of else {
        let (nan, none) = (f32::NAN, 0);
        return VoltstepBmsSpread {
            min: nan,
            mean: nan,
            max: nan,
            min_index: none,
            max_index: none,
            usable: none,
        };
    };
    VoltstepBmsSpread {
        min: s.min,
        mean: s.mean,
        max: s.max,
        min_index: s.min_index as u32,
        max_index: s.max_index as u32,
        usable: s.usable as u32,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a word of it")]
fn words(rows: Faults) -> [u32; 3] {
    let bits = rows.bits();
    [bits as u32, (bits >> 32) as u32, (bits >> 64) as u32]
}

impl From<&Report> for VoltstepBmsReport {
    fn from(r: &Report) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "below the number of cells")]
        let (soc_min_index, soc_max_index) = (r.cells.min_index as u32, r.cells.max_index as u32);
        Self {
            soc: r.soc,
            soc_sd: r.soc_sd,
            soc_counted: r.soc_from == SocSource::Counter,
            converged: r.status.converged,
            consistent: r.status.consistent,
            flat: r.status.flat,
            outside_identified: r.status.outside_identified,
            temperature_missing: r.status.temperature_missing,
            soc_min: r.cells.min,
            soc_mean: r.cells.mean,
            soc_max: r.cells.max,
            soc_min_index,
            soc_max_index,
            capacity_ah: r.capacity_ah,
            health: r.health.into(),
            energy: r.energy.map_or(VoltstepEnergyReport::UNKNOWN, Into::into),
            discharge_limit_a: r.limits.discharge.current_a,
            discharge_limited: VoltstepBmsLimited::from(r.limits.discharge.by) as u32,
            charge_limit_a: r.limits.charge.current_a,
            charge_limited: VoltstepBmsLimited::from(r.limits.charge.by) as u32,
            cell_v: spread(r.cell_v),
            temperature_c: spread(r.temperature_c),
            current_a: r.current_a,
            pack_v: r.pack_v,
            link_v: r.link_v,
            mode: VoltstepBmsMode::from(r.mode) as u32,
            phase: VoltstepBmsPhase::from(r.phase) as u32,
            cause: VoltstepBmsCause::from(r.cause) as u32,
            trip: VoltstepBmsTrip::from(r.verdict.trip) as u32,
            permit: r.verdict.permit,
            tripped: words(r.verdict.tripped),
            latched: words(r.verdict.latched),
            throughput_ah: r.throughput_ah,
        }
    }
}
