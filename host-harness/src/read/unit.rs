//! Units as people write them into headers.

/// What a column measures, and so which units it may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimension {
    Time,
    Speed,
    Length,
    Voltage,
    Current,
    Power,
    Charge,
    Temperature,
    Ratio,
    Torque,
    /// Which way a current without a sign flows: words that begin with D or C, and others.
    Direction,
}

/// A unit: its value in SI (charge in A·h, temperature in °C) is `factor` times the number, and
/// `offset` more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) dimension: Dimension,
    /// As it is written in messages.
    pub(crate) name: &'static str,
    /// Other ways to write it, in small letters and without blanks.
    also: &'static [&'static str],
    pub(crate) factor: f64,
    pub(crate) offset: f64,
}

const fn unit(
    dimension: Dimension,
    name: &'static str,
    also: &'static [&'static str],
    factor: f64,
) -> Unit {
    Unit { dimension, name, also, factor, offset: 0.0 }
}

/// Every unit that is converted.
const UNITS: [Unit; 30] = {
    use Dimension::{
        Charge, Current, Direction, Length, Power, Ratio, Speed, Temperature, Time, Torque, Voltage,
    };
    let fahrenheit = unit(Temperature, "°F", &["f", "degf", "deg_f", "fahrenheit"], 1.0 / 1.8);
    [
        unit(Time, "s", &["sec", "secs", "second", "seconds"], 1.0),
        unit(Time, "ms", &["msec", "millisecond", "milliseconds"], 1e-3),
        unit(Time, "min", &["mins", "minute", "minutes"], 60.0),
        unit(Time, "h", &["hr", "hrs", "hour", "hours"], 3600.0),
        unit(Speed, "m/s", &["m_s", "mps", "ms-1", "m*s-1", "m.s-1"], 1.0),
        unit(Speed, "km/h", &["km_h", "kmh", "kph", "kmph"], 1.0 / 3.6),
        unit(Speed, "mph", &["mi/h", "mi_h", "miles/h"], 0.447_04),
        unit(Length, "m", &["meter", "meters", "metre", "metres"], 1.0),
        unit(Length, "km", &["kilometer", "kilometers"], 1000.0),
        unit(Length, "ft", &["feet", "foot"], 0.3048),
        unit(Length, "mi", &["mile", "miles"], 1609.344),
        unit(Voltage, "V", &["volt", "volts"], 1.0),
        unit(Voltage, "mV", &["millivolt", "millivolts"], 1e-3),
        unit(Current, "A", &["amp", "amps", "ampere", "amperes"], 1.0),
        unit(Current, "mA", &["milliamp", "milliamps"], 1e-3),
        unit(Power, "W", &["watt", "watts"], 1.0),
        unit(Power, "kW", &["kilowatt", "kilowatts"], 1e3),
        unit(Charge, "A·h", &["ah", "a.h", "a*h", "amp-hr", "amphr"], 1.0),
        unit(Charge, "mA·h", &["mah", "ma.h", "ma*h"], 1e-3),
        unit(Charge, "A·s", &["as", "a.s", "coulomb"], 1.0 / 3600.0),
        unit(Temperature, "°C", &["c", "degc", "deg_c", "celsius"], 1.0),
        Unit { offset: -273.15, ..unit(Temperature, "K", &["kelvin"], 1.0) },
        Unit { offset: -32.0 / 1.8, ..fahrenheit },
        unit(Ratio, "%", &["percent", "pct"], 0.01),
        unit(Ratio, "ratio", &["1", "-", "fraction", "0..1", "m/m"], 1.0),
        unit(Torque, "Nm", &["n·m", "n*m", "n.m", "n_m"], 1.0),
        unit(Power, "mW", &["milliwatt"], 1e-3),
        unit(Length, "cm", &["centimeter"], 0.01),
        unit(Length, "mm", &["millimeter"], 1e-3),
        unit(Direction, "", &[], 1.0),
    ]
};

impl Unit {
    /// The unit of that name for what is measured.
    pub(crate) fn named(dimension: Dimension, text: &str) -> Option<Self> {
        let small: String =
            text.to_lowercase().chars().filter(|c| !c.is_whitespace()).collect::<String>();
        // Degrees as a wrong encoding leaves them.
        let small = small.replace("â°", "°").replace(['º', '\u{fffd}'], "°");
        UNITS.into_iter().find(|unit| {
            unit.dimension == dimension
                && (unit.name.to_lowercase() == small || unit.also.contains(&small.as_str()))
        })
    }

    /// A number with this unit, in SI.
    #[inline]
    pub(crate) fn si(&self, number: f64) -> f64 {
        number * self.factor + self.offset
    }

    /// The number that has this unit, of a value in SI.
    pub(crate) fn of_si(&self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}

/// Units that people write and that nothing here has, in small letters: a column with one of them is
/// meant, and refused.
const FOREIGN: [&str; 12] =
    ["deg", "rad", "yd", "yds", "yard", "in", "inch", "kn", "knots", "kv", "ka", "hp"];

/// Whether a text is a unit of anything.
pub(crate) fn is_unit(text: &str) -> bool {
    let small = text.to_lowercase();
    FOREIGN.contains(&small.as_str())
        || UNITS.iter().any(|unit| Unit::named(unit.dimension, text).is_some())
}

impl Dimension {
    /// The unit that is converted to.
    pub(crate) const fn si(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Speed => "m/s",
            Self::Length => "m",
            Self::Voltage => "V",
            Self::Current => "A",
            Self::Power => "W",
            Self::Charge => "A·h",
            Self::Temperature => "°C",
            Self::Ratio => "ratio",
            Self::Torque => "Nm",
            Self::Direction => "",
        }
    }

    /// The units that it may have, as a list.
    pub(crate) fn units(self) -> String {
        let of = UNITS.iter().filter(|unit| unit.dimension == self).map(|unit| unit.name);
        of.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_units_are_converted_and_others_are_not() {
        use Dimension::*;
        for (dimension, name, number, si) in [
            (Speed, "km/h", 36.0, 10.0),
            (Speed, "MPH", 100.0, 44.704),
            (Speed, "m_s", 3.0, 3.0),
            (Time, "ms", 250.0, 0.25),
            (Time, "min", 2.0, 120.0),
            (Voltage, "mV", 3700.0, 3.7),
            (Current, "mA", -20.0, -0.02),
            (Power, "kW", 1.5, 1500.0),
            (Charge, "mAh", 500.0, 0.5),
            (Ratio, "%", 50.0, 0.5),
            (Ratio, "ratio", 0.5, 0.5),
            (Length, "ft", 10.0, 3.048),
            (Temperature, "K", 298.15, 25.0),
            (Temperature, "°F", 77.0, 25.0),
            (Temperature, "º C", 20.0, 20.0),
            (Temperature, "\u{fffd}C", 20.0, 20.0),
            (Temperature, "Â°C", 20.0, 20.0),
        ] {
            let unit = Unit::named(dimension, name).unwrap();
            assert!((unit.si(number) - si).abs() < 1e-12, "{name}");
            assert!((unit.of_si(unit.si(number)) - number).abs() < 1e-9, "{name}");
        }
        assert_eq!(Unit::named(Speed, "knots"), None);
        assert_eq!(Unit::named(Voltage, "mA"), None);
        assert_eq!(Speed.units(), "m/s, km/h, mph");
    }
}
