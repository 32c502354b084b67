//! What the pack is in, its voltages and current, and its limits.

use plant_core::Real;

use super::field::{Field, Layout, Message};
use super::guard::{ALIVE, CHECKSUM, opened, sealed};
use crate::contactor::{Cause, Phase};
use crate::limit::{Limit, Limited, Limits, Mode};
use crate::protect::Trip;

const PHASE: Field = Field::raw("Phase", 0, 4);
const CAUSE: Field = Field::raw("Cause", 4, 4);
const TRIP: Field = Field::raw("Trip", 8, 2);
const PERMIT: Field = Field::raw("Permit", 10, 1);
const MODE: Field = Field::raw("Mode", 11, 2);
const SOC: Field = Field::value("Soc", 16, 10, 0.1, 0.0).valid_at(13);
const SOC_SD: Field = Field::value("SocSd", 26, 10, 0.1, 0.0).valid_at(14);
pub(super) const STATUS: Layout = Layout {
    id: 0x510,
    length: 8,
    name: "Status",
    fields: &[PHASE, CAUSE, TRIP, PERMIT, MODE, SOC, SOC_SD, ALIVE, CHECKSUM],
};

const PACK_V: Field = Field::value("PackVoltage", 0, 16, 0.02, 0.0).valid_at(52);
const LINK_V: Field = Field::value("LinkVoltage", 16, 16, 0.02, 0.0).valid_at(53);
const CURRENT_A: Field = Field::value("Current", 32, 16, 0.05, -1638.4).valid_at(54);
pub(super) const PACK: Layout = Layout {
    id: 0x511,
    length: 8,
    name: "Pack",
    fields: &[PACK_V, LINK_V, CURRENT_A, ALIVE, CHECKSUM],
};

const DISCHARGE_A: Field = Field::value("DischargeCurrent", 0, 16, 0.1, 0.0).down();
const CHARGE_A: Field = Field::value("ChargeCurrent", 16, 16, 0.1, 0.0).down();
const DISCHARGE_BY: Field = Field::raw("DischargeBy", 32, 4);
const CHARGE_BY: Field = Field::raw("ChargeBy", 36, 4);
pub(super) const LIMITS: Layout = Layout {
    id: 0x512,
    length: 8,
    name: "Limits",
    fields: &[DISCHARGE_A, CHARGE_A, DISCHARGE_BY, CHARGE_BY, ALIVE, CHECKSUM],
};

/// In the order of their numbers on the bus.
pub(super) const PHASES: [Phase; 13] = [
    Phase::Start,
    Phase::Standby,
    Phase::CloseMinus,
    Phase::Precharge,
    Phase::ClosePlus,
    Phase::OpenPrecharge,
    Phase::Closed,
    Phase::Shed,
    Phase::OpenFirst,
    Phase::OpenSecond,
    Phase::WeldCheck,
    Phase::Cooldown,
    Phase::Fault,
];
pub(super) const TRIPS: [Trip; 4] = [Trip::None, Trip::Soft, Trip::Hard, Trip::Crash];
pub(super) const MODES: [Mode; 3] = [Mode::Off, Mode::Drive, Mode::Charge];
pub(super) const REASONS: [Limited; 9] = [
    Limited::Cells,
    Limited::Pack,
    Limited::Derated,
    Limited::Barred,
    Limited::Cold,
    Limited::Unknown,
    Limited::Ending,
    Limited::Open,
    Limited::Rate,
];

/// The one with this number.
fn at<T: Copy>(all: &[T], number: u64) -> Option<T> {
    all.get(usize::try_from(number).ok()?).copied()
}

/// What the pack is in.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// Where the contactors are.
    pub phase: Phase,
    /// Why they opened, or may not close.
    pub cause: Cause,
    /// What protection tells them.
    pub trip: Trip,
    /// They may close.
    pub permit: bool,
    /// What is done.
    pub mode: Mode,
    /// State of charge, 0..1, in steps of 0.001; NaN where it is not known.
    pub soc: Real,
    /// Its standard deviation, in steps of 0.001; NaN where it is not known.
    pub soc_sd: Real,
}

impl Status {
    /// As a message; `alive` is one more each time ([`alive_after`](super::alive_after)).
    #[must_use]
    pub fn encode(&self, alive: u8) -> Message {
        let mut bits = PHASE.with_raw(0, self.phase as u64);
        bits = CAUSE.with_raw(bits, u64::from(self.cause.code()));
        bits = TRIP.with_raw(bits, self.trip as u64);
        bits = PERMIT.with_raw(bits, u64::from(self.permit));
        bits = MODE.with_raw(bits, self.mode as u64);
        bits = SOC.with(bits, 100.0 * self.soc);
        bits = SOC_SD.with(bits, 100.0 * self.soc_sd);
        sealed(&STATUS, bits, alive)
    }

    /// That of a message; `None` where it is another, is harmed, or has a number without a meaning.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        let (bits, _) = opened(&STATUS, message)?;
        Some(Self {
            phase: at(&PHASES, PHASE.raw_of(bits))?,
            cause: at(&Cause::ALL, CAUSE.raw_of(bits))?,
            trip: at(&TRIPS, TRIP.raw_of(bits))?,
            permit: PERMIT.raw_of(bits) == 1,
            mode: at(&MODES, MODE.raw_of(bits))?,
            soc: SOC.of(bits) / 100.0,
            soc_sd: SOC_SD.of(bits) / 100.0,
        })
    }
}

/// What is measured on the pack; NaN where a value is not usable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pack {
    /// Voltage of the pack \[V\], 0 to 1310.68, in steps of 0.02.
    pub pack_v: Real,
    /// Voltage behind the contactors \[V\], as that of the pack.
    pub link_v: Real,
    /// Current \[A\], positive when discharging, −1638.4 to 1638.3, in steps of 0.05.
    pub current_a: Real,
}

impl Pack {
    /// As a message; `alive` is one more each time ([`alive_after`](super::alive_after)).
    #[must_use]
    pub fn encode(&self, alive: u8) -> Message {
        let bits = PACK_V.with(0, self.pack_v);
        let bits = LINK_V.with(bits, self.link_v);
        sealed(&PACK, CURRENT_A.with(bits, self.current_a), alive)
    }

    /// That of a message; `None` where it is another, or is harmed.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        let (bits, _) = opened(&PACK, message)?;
        Some(Self {
            pack_v: PACK_V.of(bits),
            link_v: LINK_V.of(bits),
            current_a: CURRENT_A.of(bits),
        })
    }
}

/// Limits as a message, in steps of 0.1 A, never more than they are: one that is not a number, or
/// below zero, allows nothing. `alive` is one more each time ([`alive_after`](super::alive_after)).
#[must_use]
pub fn encode_limits(limits: &Limits, alive: u8) -> Message {
    let Limits { discharge, charge } = limits;
    let bits = DISCHARGE_A.with(0, discharge.current_a);
    let bits = CHARGE_A.with(bits, charge.current_a);
    let bits = DISCHARGE_BY.with_raw(bits, discharge.by as u64);
    sealed(&LIMITS, CHARGE_BY.with_raw(bits, charge.by as u64), alive)
}

/// Those of a message; `None` where it is another, is harmed, or has a reason without a meaning.
#[must_use]
pub fn decode_limits(message: &Message) -> Option<Limits> {
    let (bits, _) = opened(&LIMITS, message)?;
    let limit = |current: &Field, by: &Field| {
        Some(Limit { current_a: current.of(bits), by: at(&REASONS, by.raw_of(bits))? })
    };
    Some(Limits {
        discharge: limit(&DISCHARGE_A, &DISCHARGE_BY)?,
        charge: limit(&CHARGE_A, &CHARGE_BY)?,
    })
}
