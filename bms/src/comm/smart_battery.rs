//! The pack as a Smart Battery \[SmartBattery1998\], by the trait of the crate
//! `embedded-batteries`.
//!
//! The specification counts in integers of 16 bits: up to 65 V, 32 A in either direction, 65 A·h,
//! 655 W·h. What does not fit is an error, never a value cut short: a 400 V pack has a state of charge and times
//! here, and no voltage. Charging current is positive in the specification; here it is turned
//! around.
//!
//! Tests: `tests` below.

mod snapshot;

pub use snapshot::{Identity, Snapshot};

use embedded_batteries::smart_battery::{
    BatteryModeFields, BatteryStatusFields, CapacityModeSignedValue, CapacityModeValue, Cycles,
    DeciKelvin, ErrorCode, ErrorKind, ErrorType, ManufactureDate, Minutes, Percent, Revision,
    SmartBattery, SpecificationInfoFields, Version,
};
use embedded_batteries::{MilliAmps, MilliAmpsSigned, MilliVolts};
use plant_core::Real;
use plant_core::num::{floor, max, min};

use crate::estimate::energy::{EnergyGauge, EnergyReport, Left};

/// How many standard deviations of the state of charge the published margin of error spans.
const ERROR_SDS: Real = 3.0;
/// What a time says where there is none.
const NO_TIME: Minutes = u16::MAX;
/// 0 °C in kelvin.
const KELVIN_AT_0_C: Real = 273.15;

/// A pack that answers as a Smart Battery does.
///
/// [`show`](Self::show) gives it the newest [`Snapshot`]; before the first, every reading is
/// [`ErrorCode::Busy`].
///
/// ```
/// use embedded_batteries::smart_battery::{BatteryStatusFields, ManufactureDate, SmartBattery};
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use plant_core::{MappedBattery, must};
/// use voltstep_bms::comm::smart_battery::{Identity, SmartPack, Snapshot};
/// use voltstep_bms::estimate::energy::{EnergyGauge, EnergyParams, EnergyState};
/// use voltstep_bms::estimate::power::{Allowance, BoundBy};
/// use voltstep_bms::{Dt, Estimate, Health};
///
/// const DT: Dt = must!(Dt::from_s(1.0));
/// const CELL: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, DT));
/// const PARAMS: EnergyParams =
///     EnergyParams { empty_soc: 0.0, full_soc: 1.0, empty_v: 2.5, least_a: 0.01 };
/// const GAUGE: EnergyGauge = must!(EnergyGauge::new(PARAMS, &CELL, DT));
///
/// let mut pack = SmartPack::new(
///     Identity {
///         design_capacity_ah: 2.9,
///         design_voltage_v: 3.6,
///         manufacture_date: ManufactureDate::new(),
///         serial_number: 4711,
///         manufacturer_name: "Voltstep",
///         device_name: "18650PF",
///         device_chemistry: "LION",
///     },
///     GAUGE,
/// );
/// assert!(pack.voltage().is_err()); // nothing shown yet
///
/// pack.show(Snapshot {
///     voltage_v: 3.612,
///     current_a: 1.5,
///     estimate: Estimate::rested(0.5, 0.01, 25.0),
///     health: Health::as_new(&CELL),
///     averages: EnergyState::default(),
///     discharge: Allowance {
///         current_a: 10.0,
///         power_w: 30.0,
///         voltage_v: 3.0,
///         bound_by: BoundBy::Current,
///     },
///     charging_current_a: 1.5,
///     charging_voltage_v: 4.2,
///     cycles: 17.0,
///     status: BatteryStatusFields::new(),
/// })
/// .unwrap();
/// assert_eq!((pack.voltage(), pack.current()), (Ok(3612), Ok(-1500))); // mV, mA into the pack
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SmartPack<'b> {
    identity: Identity<'b>,
    gauge: EnergyGauge<'b>,
    shown: Option<(Snapshot, EnergyReport)>,
    mode: BatteryModeFields,
    at_rate: CapacityModeSignedValue,
    capacity_alarm: CapacityModeValue,
    time_alarm: Minutes,
}

/// The writable bits of the mode: from the specification's section 5.1.4.
const WRITABLE_MODE: u16 = 0b1110_0011_0000_0000;

impl<'b> SmartPack<'b> {
    /// A pack that has not shown anything yet; alarms at a tenth of the capacity and ten minutes,
    /// capacities in mA·h, as the specification wants it.
    #[must_use]
    pub fn new(identity: Identity<'b>, gauge: EnergyGauge<'b>) -> Self {
        let tenth = unsigned(100.0 * identity.design_capacity_ah).unwrap_or(0);
        Self {
            identity,
            gauge,
            shown: None,
            mode: BatteryModeFields::new(),
            at_rate: CapacityModeSignedValue::MilliAmpSigned(0),
            capacity_alarm: CapacityModeValue::MilliAmpUnsigned(tenth),
            time_alarm: 10,
        }
    }

    /// Takes the newest snapshot. Where its estimate is not finite, readings are
    /// [`ErrorCode::UnknownError`] until the next.
    ///
    /// # Errors
    /// The same.
    pub fn show(&mut self, snapshot: Snapshot) -> Result<(), ErrorKind> {
        self.shown = self
            .gauge
            .report(&snapshot.averages, &snapshot.estimate, &snapshot.health)
            .map(|report| (snapshot, report));
        if self.shown.is_some() { Ok(()) } else { Err(UNKNOWN) }
    }

    fn shown(&self) -> Result<&(Snapshot, EnergyReport), ErrorKind> {
        self.shown.as_ref().ok_or(ErrorKind::BatteryStatus(ErrorCode::Busy))
    }

    fn capacity(&self, ah: Real, wh: Real) -> Result<CapacityModeValue, ErrorKind> {
        if self.mode.capacity_mode() {
            unsigned(100.0 * wh).map(CapacityModeValue::CentiWattUnsigned)
        } else {
            unsigned(1000.0 * ah).map(CapacityModeValue::MilliAmpUnsigned)
        }
    }

    /// What is left at a power \[W\].
    fn left(&self, snapshot: &Snapshot, power_w: Real) -> Left {
        self.gauge.left(power_w, &snapshot.estimate, &snapshot.health)
    }
}

const UNKNOWN: ErrorKind = ErrorKind::BatteryStatus(ErrorCode::UnknownError);
const DOES_NOT_FIT: ErrorKind = ErrorKind::BatteryStatus(ErrorCode::UnderOverFlow);
const WRONG_SIZE: ErrorKind = ErrorKind::BatteryStatus(ErrorCode::BadSize);

/// The nearest whole number, where it fits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked first")]
fn unsigned(value: Real) -> Result<u16, ErrorKind> {
    let nearest = floor(value + 0.5);
    if (0.0..=65_535.0).contains(&nearest) { Ok(nearest as u16) } else { Err(DOES_NOT_FIT) }
}

#[expect(clippy::cast_possible_truncation, reason = "checked first")]
fn signed(value: Real) -> Result<i16, ErrorKind> {
    let nearest = floor(value + 0.5);
    if (-32_768.0..=32_767.0).contains(&nearest) { Ok(nearest as i16) } else { Err(DOES_NOT_FIT) }
}

fn percent(ratio: Real) -> Result<Percent, ErrorKind> {
    unsigned(100.0 * ratio)?.try_into().map_err(|_| DOES_NOT_FIT)
}

/// A time that may not be there.
fn minutes(seconds: Option<Real>) -> Result<Minutes, ErrorKind> {
    match seconds {
        None => Ok(NO_TIME),
        Some(seconds) => match unsigned(seconds / 60.0)? {
            NO_TIME => Err(DOES_NOT_FIT),
            minutes => Ok(minutes),
        },
    }
}

/// A text that ends with a zero.
fn write(text: &str, into: &mut [u8]) -> Result<(), ErrorKind> {
    let Some((start, [end, ..])) = into.split_at_mut_checked(text.len()) else {
        return Err(WRONG_SIZE);
    };
    for (to, from) in start.iter_mut().zip(text.bytes()) {
        *to = from;
    }
    *end = 0;
    Ok(())
}

impl ErrorType for SmartPack<'_> {
    type Error = ErrorKind;
}

impl SmartBattery for SmartPack<'_> {
    fn remaining_capacity_alarm(&mut self) -> Result<CapacityModeValue, ErrorKind> {
        Ok(self.capacity_alarm)
    }

    fn set_remaining_capacity_alarm(
        &mut self,
        capacity: CapacityModeValue,
    ) -> Result<(), ErrorKind> {
        self.capacity_alarm = capacity;
        Ok(())
    }

    fn remaining_time_alarm(&mut self) -> Result<Minutes, ErrorKind> {
        Ok(self.time_alarm)
    }

    fn set_remaining_time_alarm(&mut self, time: Minutes) -> Result<(), ErrorKind> {
        self.time_alarm = time;
        Ok(())
    }

    fn battery_mode(&mut self) -> Result<BatteryModeFields, ErrorKind> {
        Ok(self.mode)
    }

    fn set_battery_mode(&mut self, flags: BatteryModeFields) -> Result<(), ErrorKind> {
        self.mode = BatteryModeFields::from_bits(flags.into_bits() & WRITABLE_MODE);
        Ok(())
    }

    fn at_rate(&mut self) -> Result<CapacityModeSignedValue, ErrorKind> {
        Ok(self.at_rate)
    }

    fn set_at_rate(&mut self, rate: CapacityModeSignedValue) -> Result<(), ErrorKind> {
        self.at_rate = rate;
        Ok(())
    }

    fn at_rate_time_to_full(&mut self) -> Result<Minutes, ErrorKind> {
        let (_, report) = self.shown()?;
        let (missing, per_hour) = match self.at_rate {
            CapacityModeSignedValue::MilliAmpSigned(rate) => (
                report.full_charge_capacity_ah - report.remaining_capacity_ah,
                0.001 * Real::from(rate),
            ),
            CapacityModeSignedValue::CentiWattSigned(rate) => {
                (report.full_charge_energy_wh - report.remaining_energy_wh, 0.01 * Real::from(rate))
            }
        };
        minutes((per_hour > 0.0).then(|| 3600.0 * max(0.0, missing) / per_hour))
    }

    fn at_rate_time_to_empty(&mut self) -> Result<Minutes, ErrorKind> {
        let (snapshot, _) = self.shown()?;
        // At a current, at the voltage of now.
        let seconds = match self.at_rate {
            CapacityModeSignedValue::MilliAmpSigned(rate) if rate < 0 => {
                let current_a = -0.001 * Real::from(rate);
                let left = self.left(snapshot, current_a * snapshot.voltage_v);
                Some(3600.0 * left.charge_ah / current_a)
            }
            CapacityModeSignedValue::CentiWattSigned(rate) if rate < 0 => {
                let power_w = -0.01 * Real::from(rate);
                Some(3600.0 * self.left(snapshot, power_w).energy_wh / power_w)
            }
            _ => None,
        };
        minutes(seconds)
    }

    fn at_rate_ok(&mut self) -> Result<bool, ErrorKind> {
        let (snapshot, _) = self.shown()?;
        Ok(match self.at_rate {
            CapacityModeSignedValue::MilliAmpSigned(rate) => {
                rate >= 0 || -0.001 * Real::from(rate) <= snapshot.discharge.current_a
            }
            CapacityModeSignedValue::CentiWattSigned(rate) => {
                rate >= 0 || -0.01 * Real::from(rate) <= snapshot.discharge.power_w
            }
        })
    }

    fn temperature(&mut self) -> Result<DeciKelvin, ErrorKind> {
        let (snapshot, _) = self.shown()?;
        unsigned(10.0 * (snapshot.estimate.temperature_c + KELVIN_AT_0_C))
    }

    fn voltage(&mut self) -> Result<MilliVolts, ErrorKind> {
        unsigned(1000.0 * self.shown()?.0.voltage_v)
    }

    fn current(&mut self) -> Result<MilliAmpsSigned, ErrorKind> {
        signed(-1000.0 * self.shown()?.0.current_a)
    }

    fn average_current(&mut self) -> Result<MilliAmpsSigned, ErrorKind> {
        signed(-1000.0 * self.shown()?.0.averages.average_a.get())
    }

    fn max_error(&mut self) -> Result<Percent, ErrorKind> {
        percent(min(1.0, ERROR_SDS * self.shown()?.0.estimate.soc_sd))
    }

    fn relative_state_of_charge(&mut self) -> Result<Percent, ErrorKind> {
        percent(self.shown()?.1.relative_state_of_charge)
    }

    fn absolute_state_of_charge(&mut self) -> Result<Percent, ErrorKind> {
        let (_, report) = self.shown()?;
        percent(report.remaining_capacity_ah / self.identity.design_capacity_ah)
    }

    fn remaining_capacity(&mut self) -> Result<CapacityModeValue, ErrorKind> {
        let (_, report) = self.shown()?;
        self.capacity(report.remaining_capacity_ah, report.remaining_energy_wh)
    }

    fn full_charge_capacity(&mut self) -> Result<CapacityModeValue, ErrorKind> {
        let (_, report) = self.shown()?;
        self.capacity(report.full_charge_capacity_ah, report.full_charge_energy_wh)
    }

    fn run_time_to_empty(&mut self) -> Result<Minutes, ErrorKind> {
        let (snapshot, _) = self.shown()?;
        let power_w = snapshot.voltage_v * snapshot.current_a;
        let discharging = snapshot.current_a >= self.gauge.params().least_a && power_w > 0.0;
        minutes(discharging.then(|| 3600.0 * self.left(snapshot, power_w).energy_wh / power_w))
    }

    fn average_time_to_empty(&mut self) -> Result<Minutes, ErrorKind> {
        minutes(self.shown()?.1.average_time_to_empty_s)
    }

    fn average_time_to_full(&mut self) -> Result<Minutes, ErrorKind> {
        minutes(self.shown()?.1.average_time_to_full_s)
    }

    fn charging_current(&mut self) -> Result<MilliAmps, ErrorKind> {
        unsigned(1000.0 * self.shown()?.0.charging_current_a)
    }

    fn charging_voltage(&mut self) -> Result<MilliVolts, ErrorKind> {
        unsigned(1000.0 * self.shown()?.0.charging_voltage_v)
    }

    fn battery_status(&mut self) -> Result<BatteryStatusFields, ErrorKind> {
        let (snapshot, report) = self.shown()?;
        let low = match self.capacity_alarm {
            CapacityModeValue::MilliAmpUnsigned(alarm) => {
                1000.0 * report.remaining_capacity_ah < Real::from(alarm)
            }
            CapacityModeValue::CentiWattUnsigned(alarm) => {
                100.0 * report.remaining_energy_wh < Real::from(alarm)
            }
        };
        let soon = report
            .average_time_to_empty_s
            .is_some_and(|seconds| seconds < 60.0 * Real::from(self.time_alarm));
        Ok(snapshot
            .status
            .with_error_code(ErrorCode::Ok)
            .with_discharging(snapshot.current_a > -self.gauge.params().least_a)
            .with_remaining_capacity_alarm(low)
            .with_remaining_time_alarm(soon))
    }

    fn cycle_count(&mut self) -> Result<Cycles, ErrorKind> {
        unsigned(self.shown()?.0.cycles)
    }

    fn design_capacity(&mut self) -> Result<CapacityModeValue, ErrorKind> {
        let Identity { design_capacity_ah: ah, design_voltage_v, .. } = self.identity;
        self.capacity(ah, ah * design_voltage_v)
    }

    fn design_voltage(&mut self) -> Result<MilliVolts, ErrorKind> {
        unsigned(1000.0 * self.identity.design_voltage_v)
    }

    fn specification_info(&mut self) -> Result<SpecificationInfoFields, ErrorKind> {
        // `SpecificationInfoFields::new` panics in version 0.3.4: no revision has the number zero.
        let (revision, version) = (Revision::Version1And1Dot1 as u16, Version::Version1Dot1 as u16);
        Ok(SpecificationInfoFields::from_bits(version << 4 | revision))
    }

    fn manufacture_date(&mut self) -> Result<ManufactureDate, ErrorKind> {
        Ok(self.identity.manufacture_date)
    }

    fn serial_number(&mut self) -> Result<u16, ErrorKind> {
        Ok(self.identity.serial_number)
    }

    fn manufacturer_name(&mut self, name: &mut [u8]) -> Result<(), ErrorKind> {
        write(self.identity.manufacturer_name, name)
    }

    fn device_name(&mut self, name: &mut [u8]) -> Result<(), ErrorKind> {
        write(self.identity.device_name, name)
    }

    fn device_chemistry(&mut self, chemistry: &mut [u8]) -> Result<(), ErrorKind> {
        write(self.identity.device_chemistry, chemistry)
    }
}

#[cfg(test)]
mod tests;
