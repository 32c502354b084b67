//! From bytes to a [`Trip`].

use super::Trip;
use crate::read::error::{self, InputError};
use crate::read::table::{Column, Needed, Sheet, Table, has};
use crate::read::unit::Dimension;

/// What a trip may have, in the order of [`Trip`].
pub(crate) const COLUMNS: [Column; 14] = {
    use Dimension::{Current, Length, Power, Ratio, Speed, Temperature, Time, Torque, Voltage};
    use Needed::{Nothing, Samples};
    let percent = (-5.0, 105.0);
    [
        Column::new("Time", &["time"], Time, "s", Samples, (0.0, 0.0)),
        Column::new(
            "Velocity",
            &["velocity", "speed", "vehicle_speed"],
            Speed,
            "km/h",
            Samples,
            (-400.0, 400.0),
        ),
        Column::new(
            "Elevation",
            &["elevation", "altitude", "height"],
            Length,
            "m",
            Samples,
            (-1000.0, 10_000.0),
        ),
        Column::new("Motor Torque", &["motor_torque"], Torque, "Nm", Nothing, (-1e5, 1e5)),
        Column::new(
            "Battery Voltage",
            &["battery_voltage", "voltage"],
            Voltage,
            "V",
            Samples,
            (-2000.0, 2000.0),
        ),
        Column::new(
            "Battery Current",
            &["battery_current", "current"],
            Current,
            "A",
            Samples,
            (-5000.0, 5000.0),
        ),
        Column::new(
            "Battery Temperature",
            &["battery_temperature"],
            Temperature,
            "°C",
            Nothing,
            (-200.0, 1000.0),
        ),
        Column::new("SoC", &["soc", "state_of_charge"], Ratio, "%", Needed::Column, percent),
        Column::new("Heating Power CAN", &["heating_power_can"], Power, "kW", Nothing, (-1e3, 1e3)),
        Column::new("AirCon Power", &["aircon_power"], Power, "kW", Nothing, (-1e3, 1e3)),
        Column::new(
            "Ambient Temperature",
            &["ambient_temperature"],
            Temperature,
            "°C",
            Nothing,
            (-200.0, 200.0),
        ),
        Column::new("Throttle", &["throttle"], Ratio, "%", Nothing, (-100.0, 1000.0)),
        Column::new("Heating Power LIN", &["heating_power_lin"], Power, "W", Nothing, (-1e6, 1e6)),
        Column::new(
            "Requested Heating Power",
            &["requested_heating_power"],
            Power,
            "W",
            Nothing,
            (-1e6, 1e6),
        ),
    ]
};
/// Few files have the columns from here on: that they are not there is no news.
const SPARE: usize = 11;
const SOC: usize = 7;
/// These are 0 where they are not there.
const HEATING: usize = 8;
const AIRCON: usize = 9;

/// Reads a trip from the bytes of a file called `file`.
///
/// # Errors
/// [`InputError`] with the line, and for a field the column: characters from 1 to where the field
/// starts. Refused are an empty file, a missing column, an unknown unit, fewer than two rows, a row
/// with another number of fields than the header, text or NaN or infinity for a number, an empty
/// field where every sample is needed, absurd values, and time that falls.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Trip, InputError> {
    let sheet = open(file, bytes)?;
    let table = sheet.read(&COLUMNS)?;
    Ok(of_table(&sheet, table))
}

/// A trip's table before it is read.
pub(crate) fn open<'a>(file: &'a str, bytes: &'a [u8]) -> Result<Sheet<'a>, InputError> {
    Sheet::open(file, bytes, |header| [0, 1, 4].iter().all(|k| has(&COLUMNS[*k], header)))
}

/// A trip from its table as read.
pub(crate) fn of_table(sheet: &Sheet<'_>, table: Table) -> Trip {
    let mut notes = Vec::new();
    let rows = table.columns.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let mut found = table.columns.into_iter().enumerate().map(|(k, found)| {
        let column = &COLUMNS[k];
        let assumed = if k == HEATING || k == AIRCON { ", taken as 0" } else { "" };
        match &found {
            None if k < SPARE => notes.push(format!("no column `{}`{assumed}", column.label())),
            Some(values) if k < SPARE && values.iter().all(|x| x.is_nan()) => {
                notes.push(format!("column `{}` is empty{assumed}", column.label()));
            }
            _ => {}
        }
        let absent = if assumed.is_empty() { f64::NAN } else { 0.0 };
        let mut values = found.unwrap_or_else(|| vec![absent; rows]);
        if k == SOC {
            let outside = values.iter().filter(|s| **s < 0.0 || **s > 1.0).count();
            if outside > 0 {
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                notes.push(format!(
                    "state of charge from {:.2} to {:.2} %: {outside} samples taken as 0 or 100 %",
                    100.0 * low,
                    100.0 * high
                ));
            }
            for s in &mut values {
                *s = s.clamp(0.0, 1.0);
            }
        }
        values
    });
    let mut next = || found.next().unwrap_or_default();
    // In the order of the columns.
    let mut trip = Trip {
        name: error::stem(sheet.file),
        time_s: next(),
        speed_m_s: next(),
        elevation_m: next(),
        motor_torque_nm: next(),
        battery_v: next(),
        battery_a: next(),
        battery_c: next(),
        soc: next(),
        heating_w: next(),
        aircon_w: next(),
        ambient_c: next(),
        throttle: next(),
        heating_lin_w: next(),
        heating_requested_w: next(),
        notes: Vec::new(),
    };
    drop(found);
    // Charging is positive in the file.
    trip.battery_a.iter_mut().for_each(|a| *a = -*a);
    notes.extend(table.notes);
    trip.notes = notes;
    trip
}
