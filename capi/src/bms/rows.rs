//! The rows of protection by name.

/// What the BMS watches: a row of its table is a bit in the sets of rows, row k in word k/32. Limits
/// are the field's three, each inside the next: maximum operating (MOL), recommended safety (RSL) and
/// maximum safety limit (MSL).
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsRow {
    /// The lowest cell against its MOL.
    CellVoltageLowMol = 0,
    /// The lowest cell against its RSL.
    CellVoltageLowRsl = 1,
    /// The lowest cell against its MSL.
    CellVoltageLowMsl = 2,
    /// The highest cell against its MOL.
    CellVoltageHighMol = 3,
    /// The highest cell against its RSL.
    CellVoltageHighRsl = 4,
    /// The highest cell against its MSL.
    CellVoltageHighMsl = 5,
    /// The coldest sensor against the MOL of discharging.
    TemperatureDischargeLowMol = 6,
    /// The coldest sensor against the RSL of discharging.
    TemperatureDischargeLowRsl = 7,
    /// The coldest sensor against the MSL of discharging.
    TemperatureDischargeLowMsl = 8,
    /// The hottest sensor against the MOL of discharging.
    TemperatureDischargeHighMol = 9,
    /// The hottest sensor against the RSL of discharging.
    TemperatureDischargeHighRsl = 10,
    /// The hottest sensor against the MSL of discharging.
    TemperatureDischargeHighMsl = 11,
    /// The coldest sensor against the MOL of charging.
    TemperatureChargeLowMol = 12,
    /// The coldest sensor against the RSL of charging.
    TemperatureChargeLowRsl = 13,
    /// The coldest sensor against the MSL of charging.
    TemperatureChargeLowMsl = 14,
    /// The hottest sensor against the MOL of charging.
    TemperatureChargeHighMol = 15,
    /// The hottest sensor against the RSL of charging.
    TemperatureChargeHighRsl = 16,
    /// The hottest sensor against the MSL of charging.
    TemperatureChargeHighMsl = 17,
    /// The pack's current against the MOL of discharging.
    CurrentDischargeMol = 18,
    /// The pack's current against the RSL of discharging.
    CurrentDischargeRsl = 19,
    /// The pack's current against the MSL of discharging.
    CurrentDischargeMsl = 20,
    /// The pack's current against the MOL of charging.
    CurrentChargeMol = 21,
    /// The pack's current against the RSL of charging.
    CurrentChargeRsl = 22,
    /// The pack's current against the MSL of charging.
    CurrentChargeMsl = 23,
    /// Twice the short-time current of discharging.
    SurgeDischarge = 24,
    /// Twice the short-time current of charging.
    SurgeCharge = 25,
    /// Charge of squared current beyond the continuous one of discharging.
    HeatDischarge = 26,
    /// Charge of squared current beyond the continuous one of charging.
    HeatCharge = 27,
    /// The pack's voltage is too low.
    PackVoltageLow = 28,
    /// The pack's voltage is too high.
    PackVoltageHigh = 29,
    /// No value of the cells' voltages, or an old one.
    StaleCell = 30,
    /// No value of temperatures, or an old one.
    StaleTemperature = 31,
    /// No value of the current, or an old one.
    StaleCurrent = 32,
    /// No value of the pack's voltage, or an old one.
    StalePack = 33,
    /// No value of the link's voltage, or an old one.
    StaleLink = 34,
    /// A value of the cells' voltages that the sensor cannot show.
    RangeCell = 35,
    /// A value of temperatures that the sensor cannot show.
    RangeTemperature = 36,
    /// A value of the current that the sensor cannot show.
    RangeCurrent = 37,
    /// A value of the pack's voltage that the sensor cannot show.
    RangePack = 38,
    /// A value of the link's voltage that the sensor cannot show.
    RangeLink = 39,
    /// The contactor minus does not show what it was told.
    FeedbackMinus = 40,
    /// The contactor precharge does not show what it was told.
    FeedbackPrecharge = 41,
    /// The contactor plus does not show what it was told.
    FeedbackPlus = 42,
    /// The contactor minus does not open.
    WeldMinus = 43,
    /// The contactor precharge does not open.
    WeldPrecharge = 44,
    /// The contactor plus does not open.
    WeldPlus = 45,
    /// Precharge: current flows, the link does not rise.
    PrechargeShort = 46,
    /// Precharge: no current flows.
    PrechargeOpen = 47,
    /// Precharge: the link rises too slowly.
    PrechargeSlow = 48,
    /// Precharge: the resistor is too warm for another try.
    PrechargeHot = 49,
    /// Resistance to the chassis against its MOL.
    InsulationMol = 50,
    /// Resistance to the chassis against its RSL.
    InsulationRsl = 51,
    /// Resistance to the chassis against its MSL.
    InsulationMsl = 52,
    /// A cell so far down that it must not be charged again without a look.
    DeepDischarge = 53,
    /// Current though every contactor is open.
    CurrentWhileOpen = 54,
    /// The current sensor is near its end, or a comparator says so.
    ShortCircuit = 55,
    /// The sum of the cells against the pack.
    CellSum = 56,
    /// The link against the pack while both mains are closed.
    LinkDiffers = 57,
    /// Two current sensors against each other.
    CurrentsDiffer = 58,
    /// The mean cell against its model.
    Residual = 59,
    /// The front end counts other cells than there are.
    CellCount = 60,
    /// A cell that does not move when the current does, or moves when nothing does.
    StuckCell = 61,
    /// A temperature that does not move when the others do, or falls faster than anything cools.
    StuckTemperature = 62,
    /// A current that does not move when the cells do, or moves and they do not.
    StuckCurrent = 63,
    /// Highest less lowest cell.
    Imbalance = 64,
    /// Hottest less coldest sensor.
    TemperatureSpread = 65,
    /// How fast the fastest sensor warms up beyond what the current explains.
    TemperatureRate = 66,
    /// A wire between cells and front end.
    OpenWire = 67,
    /// A pin that drives or reads a contactor fails.
    Pin = 68,
    /// The link rises before it is precharged, or a contactor shows closed that is not driven.
    Bypassed = 69,
    /// The loop through the connectors is open.
    Interlock = 70,
    /// The vehicle reports a crash.
    Crash = 71,
    /// The supply of the control unit is low.
    Supply = 72,
    /// The coolant pump or level is not as it should be.
    Coolant = 73,
    /// No valid request in time.
    RequestLost = 74,
    /// Requests whose checksum or counter is wrong.
    RequestCorrupt = 75,
    /// The charger is silent.
    ChargerLost = 76,
    /// The time between two calls.
    LateStep = 77,
    /// The record is damaged or cannot be written.
    Record = 78,
    /// The parameters are not those that were checked.
    Parameters = 79,
    /// The log cannot be written.
    LogStore = 80,
    /// The estimator says that it is lost.
    Estimator = 81,
    /// A bleed switch does not do what it was told.
    BleedStuck = 82,
    /// The balancing board is hot.
    BleedHot = 83,
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::format;
    use std::string::String;

    use voltstep_bms::protect::{Id, ROWS};

    #[test]
    fn rows_have_the_names_and_numbers_of_the_table() {
        let rows = include_str!("rows.rs");
        for id in Id::ALL {
            let name: String =
                format!("{id:?}").chars().filter(char::is_ascii_alphabetic).collect();
            let line = format!("\n    {name} = {},\n", id.index());
            assert!(rows.contains(&line), "{line}");
        }
        let listed = rows.lines().filter(|line| line.starts_with("    ") && line.contains(" = "));
        assert_eq!(listed.filter(|line| line.ends_with(',')).count(), ROWS);
    }
}
