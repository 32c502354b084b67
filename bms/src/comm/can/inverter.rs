//! The messages 0x351 to 0x35E that inverters of stationary batteries understand.
//!
//! | Identifier | Signals, little-endian |
//! |---|---|
//! | 0x351 | charge voltage, 0.1 V; charge and discharge current, signed, 0.1 A; discharge voltage, 0.1 V |
//! | 0x355 | state of charge and of health, 1 %; state of charge, 0.01 % |
//! | 0x356 | voltage, 0.01 V; current into the battery, 0.1 A; temperature, 0.1 °C; all signed |
//! | 0x35A | alarms, then warnings: two bits each, 1 where there is one, 2 where not |
//! | 0x35C | may be charged, may be discharged, must be charged, wants to be full |
//! | 0x35E | a name, eight letters |
//!
//! Identifiers, fields and scaling are those of \[RecBmsSma\] (0x351 to 0x35E) and \[DiyBms\] (the
//! places of alarms, and 0x35C as Pylontech batteries send it). Every second, as both do. What to
//! know of them:
//!
//! - Nobody has written a standard. Some implementations of 0x351 and 0x356 send the high byte first,
//!   for another inverter; those of \[DiyBms\] list low voltage before high among the warnings, and
//!   after it among the alarms. Here warnings lie as alarms do.
//! - No signal can be missing. A message of which a value is not known is not sent: the inverter
//!   notices that; limits that are not known are zero.
//! - Currents are rounded down, and so is the charge voltage.
//!
//! Tests: `tests` of the module above.

use plant_core::Real;

use super::field::{Field, Layout, Message};
use crate::protect::{Flow, Id, Level, Side, Table, Verdict};

const CHARGE_V: Field = Field::value("ChargeVoltage", 0, 16, 0.1, 0.0).down();
const CHARGE_A: Field = Field::value("ChargeCurrent", 16, 16, 0.1, 0.0).signed().down();
const DISCHARGE_A: Field = Field::value("DischargeCurrent", 32, 16, 0.1, 0.0).signed().down();
const DISCHARGE_V: Field = Field::value("DischargeVoltage", 48, 16, 0.1, 0.0);
pub(super) const LIMITS: Layout = Layout {
    id: 0x351,
    length: 8,
    name: "InverterLimits",
    fields: &[CHARGE_V, CHARGE_A, DISCHARGE_A, DISCHARGE_V],
};

const SOC: Field = Field::value("Soc", 0, 16, 1.0, 0.0);
const SOH: Field = Field::value("Soh", 16, 16, 1.0, 0.0);
const SOC_FINE: Field = Field::value("SocFine", 32, 16, 0.01, 0.0);
pub(super) const CHARGE: Layout =
    Layout { id: 0x355, length: 6, name: "InverterCharge", fields: &[SOC, SOH, SOC_FINE] };

const VOLTAGE: Field = Field::value("Voltage", 0, 16, 0.01, 0.0).signed();
const CURRENT: Field = Field::value("Current", 16, 16, 0.1, 0.0).signed();
const TEMPERATURE: Field = Field::value("Temperature", 32, 16, 0.1, 0.0).signed();
pub(super) const MEASURED: Layout = Layout {
    id: 0x356,
    length: 6,
    name: "InverterMeasured",
    fields: &[VOLTAGE, CURRENT, TEMPERATURE],
};

const ALARM_BITS: Field = Field::raw("Alarms", 0, 32);
const WARNING_BITS: Field = Field::raw("Warnings", 32, 32);
pub(super) const ALARMS: Layout =
    Layout { id: 0x35a, length: 8, name: "InverterAlarms", fields: &[ALARM_BITS, WARNING_BITS] };

const FULL_CHARGE: Field = Field::raw("FullCharge", 3, 1);
const FORCE_CHARGE: Field = Field::raw("ForceCharge", 5, 1);
const MAY_DISCHARGE: Field = Field::raw("MayDischarge", 6, 1);
const MAY_CHARGE: Field = Field::raw("MayCharge", 7, 1);
pub(super) const PERMITS: Layout = Layout {
    id: 0x35c,
    length: 2,
    name: "InverterPermits",
    fields: &[FULL_CHARGE, FORCE_CHARGE, MAY_DISCHARGE, MAY_CHARGE],
};

const NAME: Field = Field::raw("Name", 0, 64);
pub(super) const MAKER: Layout =
    Layout { id: 0x35e, length: 8, name: "InverterName", fields: &[NAME] };

/// An alarm, or a warning; its number is its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Alarm {
    /// Any at all.
    General,
    /// Cells or pack above their voltage.
    HighVoltage,
    /// Below it.
    LowVoltage,
    /// Too hot to discharge.
    HighTemperature,
    /// Too cold to discharge.
    LowTemperature,
    /// Too hot to charge.
    HighTemperatureCharge,
    /// Too cold to charge.
    LowTemperatureCharge,
    /// Too much is drawn.
    HighCurrent,
    /// Too much is fed.
    HighCurrentCharge,
    /// A contactor, or the precharge.
    Contactor,
    /// A short circuit.
    ShortCircuit,
    /// Sensors, wires, memory, and whatever has no place of its own.
    Internal,
    /// Cells are apart.
    Imbalance,
}

impl Alarm {
    /// Every one, in the order of their places.
    pub const ALL: [Self; 13] = [
        Self::General,
        Self::HighVoltage,
        Self::LowVoltage,
        Self::HighTemperature,
        Self::LowTemperature,
        Self::HighTemperatureCharge,
        Self::LowTemperatureCharge,
        Self::HighCurrent,
        Self::HighCurrentCharge,
        Self::Contactor,
        Self::ShortCircuit,
        Self::Internal,
        Self::Imbalance,
    ];

    /// The one that a row belongs to.
    #[must_use]
    pub const fn of(id: Id) -> Self {
        match id {
            Id::CellVoltage(Side::High, _) | Id::PackVoltage(Side::High) => Self::HighVoltage,
            Id::CellVoltage(Side::Low, _) | Id::PackVoltage(Side::Low) | Id::DeepDischarge => {
                Self::LowVoltage
            }
            Id::Temperature(Flow::Discharge, Side::High, _) => Self::HighTemperature,
            Id::Temperature(Flow::Discharge, Side::Low, _) => Self::LowTemperature,
            Id::Temperature(Flow::Charge, Side::High, _) => Self::HighTemperatureCharge,
            Id::Temperature(Flow::Charge, Side::Low, _) => Self::LowTemperatureCharge,
            Id::Current(Flow::Discharge, _)
            | Id::Surge(Flow::Discharge)
            | Id::Heat(Flow::Discharge) => Self::HighCurrent,
            Id::Current(Flow::Charge, _) | Id::Surge(Flow::Charge) | Id::Heat(Flow::Charge) => {
                Self::HighCurrentCharge
            }
            Id::Feedback(_) | Id::Weld(_) | Id::Pin | Id::Bypassed | Id::Precharge(_) => {
                Self::Contactor
            }
            Id::ShortCircuit => Self::ShortCircuit,
            Id::Imbalance => Self::Imbalance,
            _ => Self::Internal,
        }
    }
}

/// A set of alarms, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Alarms(u16);

impl Alarms {
    /// None.
    pub const NONE: Self = Self(0);

    /// The set with one more, and with the general one.
    #[must_use]
    pub const fn with(self, alarm: Alarm) -> Self {
        Self(self.0 | 1 << alarm as u8 | 1 << Alarm::General as u8)
    }

    /// Whether one is in it.
    #[must_use]
    pub const fn has(self, alarm: Alarm) -> bool {
        self.0 >> alarm as u8 & 1 == 1
    }

    /// Two bits each; those without a meaning stay zero, as what is not supported.
    fn pairs(self) -> u64 {
        let pair = |alarm| if self.has(alarm) { 1 } else { 2 };
        Alarm::ALL.into_iter().fold(0, |bits, alarm| bits | pair(alarm) << shift(alarm))
    }

    /// What is not supported, 0 or 3, is no alarm.
    fn of_pairs(bits: u64) -> Self {
        let raised = |alarm: &Alarm| bits >> shift(*alarm) & 3 == 1;
        Self(Alarm::ALL.into_iter().filter(raised).fold(0, |set, alarm| set | 1 << alarm as u8))
    }
}

/// Where its two bits begin.
const fn shift(alarm: Alarm) -> u8 {
    2 * alarm as u8
}

/// Everything that an inverter is told.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(clippy::struct_excessive_bools, reason = "each is a bit of 0x35C")]
pub struct InverterView {
    /// The voltage to charge up to \[V\], 0 to 6553.5; NaN where it is not known.
    pub charge_v: Real,
    /// The voltage to discharge down to \[V\], 0 to 6553.5; NaN where it is not known.
    pub discharge_v: Real,
    /// What may be fed \[A\], 0 to 3276.7; NaN is zero.
    pub charge_a: Real,
    /// What may be drawn \[A\], 0 to 3276.7; NaN is zero.
    pub discharge_a: Real,
    /// State of charge, 0..1; NaN where it is not known.
    pub soc: Real,
    /// State of health, 0..1; NaN where it is not known.
    pub soh: Real,
    /// Voltage of the pack \[V\], up to 327.67; NaN where it is not usable.
    pub pack_v: Real,
    /// Current \[A\], positive when discharging as everywhere here, turned around on the bus, up to
    /// 3276.7; NaN where it is not usable.
    pub current_a: Real,
    /// Temperature \[°C\]; NaN where it is not usable.
    pub temperature_c: Real,
    /// What has led, or leads, to opening.
    pub alarms: Alarms,
    /// What may.
    pub warnings: Alarms,
    /// It may be charged.
    pub may_charge: bool,
    /// It may be discharged.
    pub may_discharge: bool,
    /// It must be charged at once.
    pub force_charge: bool,
    /// It wants to be charged in full, to be balanced or counted anew.
    pub full_charge: bool,
    /// The name that the inverter shows, in ASCII, filled with blanks.
    pub name: [u8; 8],
}

impl InverterView {
    /// Alarms and warnings of the rows that have tripped or are latched: those at a safety limit
    /// (MSL) are alarms.
    #[must_use]
    pub fn alarms_of(table: &Table, verdict: &Verdict) -> (Alarms, Alarms) {
        let rows = verdict.tripped.union(verdict.latched);
        rows.iter().fold((Alarms::NONE, Alarms::NONE), |(alarms, warnings), id| {
            match table.row(id).level {
                Level::Msl => (alarms.with(Alarm::of(id)), warnings),
                Level::Mol | Level::Rsl => (alarms, warnings.with(Alarm::of(id))),
            }
        })
    }

    /// As messages, in the order of their identifiers; `None` where a value of one is not known.
    #[must_use]
    pub fn encode(&self) -> [Option<Message>; 6] {
        let known = |values: &[Real], layout: &Layout, bits: u64| {
            values.iter().all(|value| !value.is_nan()).then(|| layout.message(bits))
        };
        // No inverter is told a negative limit: to some it is the other direction.
        let limit = |bits, field: &Field, value: Real| {
            field.with(bits, if value > 0.0 { value } else { 0.0 })
        };
        let bits = CHARGE_V.with(0, self.charge_v);
        let bits = limit(bits, &CHARGE_A, self.charge_a);
        let bits = limit(bits, &DISCHARGE_A, self.discharge_a);
        let bits = DISCHARGE_V.with(bits, self.discharge_v);
        let limits = known(&[self.charge_v, self.discharge_v], &LIMITS, bits);

        let bits = SOC.with(0, 100.0 * self.soc);
        let bits = SOH.with(bits, 100.0 * self.soh);
        let bits = SOC_FINE.with(bits, 100.0 * self.soc);
        let charge = known(&[self.soc, self.soh], &CHARGE, bits);

        let bits = VOLTAGE.with(0, self.pack_v);
        let bits = CURRENT.with(bits, -self.current_a);
        let bits = TEMPERATURE.with(bits, self.temperature_c);
        let measured = [self.pack_v, self.current_a, self.temperature_c];
        let measured = known(&measured, &MEASURED, bits);

        let bits = ALARM_BITS.with_raw(0, self.alarms.pairs());
        let alarms = ALARMS.message(WARNING_BITS.with_raw(bits, self.warnings.pairs()));

        let bits = MAY_CHARGE.with_raw(0, u64::from(self.may_charge));
        let bits = MAY_DISCHARGE.with_raw(bits, u64::from(self.may_discharge));
        let bits = FORCE_CHARGE.with_raw(bits, u64::from(self.force_charge));
        let permits = PERMITS.message(FULL_CHARGE.with_raw(bits, u64::from(self.full_charge)));

        let name = MAKER.message(u64::from_le_bytes(self.name));
        [limits, charge, measured, Some(alarms), Some(permits), Some(name)]
    }

    /// Nothing is known, nothing is allowed.
    pub const NONE: Self = Self {
        charge_v: Real::NAN,
        discharge_v: Real::NAN,
        charge_a: 0.0,
        discharge_a: 0.0,
        soc: Real::NAN,
        soh: Real::NAN,
        pack_v: Real::NAN,
        current_a: Real::NAN,
        temperature_c: Real::NAN,
        alarms: Alarms::NONE,
        warnings: Alarms::NONE,
        may_charge: false,
        may_discharge: false,
        force_charge: false,
        full_charge: false,
        name: [b' '; 8],
    };

    /// Takes over what a message says; whether it was one of these.
    pub fn hear(&mut self, message: &Message) -> bool {
        if let Some(bits) = message.bits(&LIMITS) {
            self.charge_v = CHARGE_V.of(bits);
            self.charge_a = CHARGE_A.of(bits);
            self.discharge_a = DISCHARGE_A.of(bits);
            self.discharge_v = DISCHARGE_V.of(bits);
        } else if let Some(bits) = message.bits(&CHARGE) {
            self.soc = SOC_FINE.of(bits) / 100.0;
            self.soh = SOH.of(bits) / 100.0;
        } else if let Some(bits) = message.bits(&MEASURED) {
            self.pack_v = VOLTAGE.of(bits);
            self.current_a = -CURRENT.of(bits);
            self.temperature_c = TEMPERATURE.of(bits);
        } else if let Some(bits) = message.bits(&ALARMS) {
            self.alarms = Alarms::of_pairs(ALARM_BITS.raw_of(bits));
            self.warnings = Alarms::of_pairs(WARNING_BITS.raw_of(bits));
        } else if let Some(bits) = message.bits(&PERMITS) {
            self.may_charge = MAY_CHARGE.raw_of(bits) == 1;
            self.may_discharge = MAY_DISCHARGE.raw_of(bits) == 1;
            self.force_charge = FORCE_CHARGE.raw_of(bits) == 1;
            self.full_charge = FULL_CHARGE.raw_of(bits) == 1;
        } else if let Some(bits) = message.bits(&MAKER) {
            self.name = bits.to_le_bytes();
        } else {
            return false;
        }
        true
    }
}
