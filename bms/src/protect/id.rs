//! What is watched: the names of the rows.

/// Below or above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// Below its limit is bad.
    Low,
    /// Above its limit is bad.
    High,
}

/// Which way the current flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Flow {
    /// Out of the battery.
    Discharge,
    /// Into it.
    Charge,
}

/// How severe it is: the three limits of the field, each inside the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Level {
    /// Maximum operating limit: where use should end.
    Mol,
    /// Recommended safety limit: power is taken back.
    Rsl,
    /// Maximum safety limit: the contactors open.
    Msl,
}

/// All three.
pub(super) const LEVELS: [Level; 3] = [Level::Mol, Level::Rsl, Level::Msl];

/// A kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Source {
    /// Voltages of the cells.
    Cell,
    /// Temperatures.
    Temperature,
    /// The pack's current.
    Current,
    /// The pack's voltage.
    Pack,
    /// The voltage behind the contactors.
    Link,
}

/// One of the three contactors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Contactor {
    /// The main contactor at the negative pole.
    Minus,
    /// The one in series with the precharge resistor.
    Precharge,
    /// The main contactor at the positive pole.
    Plus,
}

/// What a precharge can end in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum PrechargeFault {
    /// Current flows, the link does not rise.
    Short,
    /// No current flows.
    Open,
    /// The link rises more slowly than resistor and capacitor let expect.
    Slow,
    /// The resistor is too warm for another try.
    Hot,
}

/// What a row watches: the family, and which of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Id {
    /// The lowest or highest cell \[V\].
    CellVoltage(Side, Level),
    /// A cell so far down that it must not be charged again without a look \[V\].
    DeepDischarge,
    /// The coldest or hottest sensor \[°C\], against the window of either direction.
    Temperature(Flow, Side, Level),
    /// The pack's current against the continuous one at this temperature (MOL), the short-time one
    /// (RSL) and beyond (MSL) \[A\].
    Current(Flow, Level),
    /// Twice the short-time current, at once \[A\].
    Surge(Flow),
    /// Charge of squared current above the continuous one \[A²·s\].
    Heat(Flow),
    /// Current though every contactor is open \[A\].
    CurrentWhileOpen,
    /// The current sensor is near its end, or a comparator says so.
    ShortCircuit,
    /// The pack's voltage \[V\].
    PackVoltage(Side),
    /// The sum of the cells against the pack \[V\].
    CellSum,
    /// The link against the pack while both mains are closed \[V\].
    LinkDiffers,
    /// Two current sensors against each other \[A\].
    CurrentsDiffer,
    /// The mean cell against its model \[V\].
    Residual,
    /// The front end counts other cells than there are.
    CellCount,
    /// A cell that does not move when the current does, or moves when nothing does.
    StuckCell,
    /// A temperature that does not move when the others do, or falls faster than anything cools.
    StuckTemperature,
    /// A current that does not move when the cells do, or moves and they do not.
    StuckCurrent,
    /// No value, or an old one.
    Stale(Source),
    /// A value that the sensor cannot show: sentinels, wrong units.
    Range(Source),
    /// Highest less lowest cell \[V\].
    Imbalance,
    /// Hottest less coldest sensor \[K\].
    TemperatureSpread,
    /// How fast the fastest sensor warms up beyond what the current explains \[K/s\].
    TemperatureRate,
    /// A wire between cells and front end: how far a reading moves under the test current \[V\].
    OpenWire,
    /// A contactor does not show what it was told.
    Feedback(Contactor),
    /// A contactor does not open.
    Weld(Contactor),
    /// A pin that drives or reads a contactor fails.
    Pin,
    /// The link rises before it is precharged, or a contactor shows closed that is not driven.
    Bypassed,
    /// The precharge failed.
    Precharge(PrechargeFault),
    /// The loop through the connectors is open.
    Interlock,
    /// The vehicle reports a crash.
    Crash,
    /// Resistance to the chassis \[Ω/V\]; MOL also where the device is silent.
    Insulation(Level),
    /// The supply of the control unit is low.
    Supply,
    /// The coolant pump or level is not as it should be.
    Coolant,
    /// No valid request in time.
    RequestLost,
    /// Requests whose checksum or counter is wrong.
    RequestCorrupt,
    /// The charger is silent.
    ChargerLost,
    /// The time between two calls, as a multiple of the period.
    LateStep,
    /// The record is damaged or cannot be written.
    Record,
    /// The parameters are not those that were checked.
    Parameters,
    /// The log cannot be written.
    LogStore,
    /// The estimator says that it is lost.
    Estimator,
    /// A bleed switch does not do what it was told.
    BleedStuck,
    /// The balancing board is hot.
    BleedHot,
}

/// How many rows there are.
pub const ROWS: usize = 84;

impl Id {
    /// Every one, in the order of [`index`](Self::index).
    pub const ALL: [Self; ROWS] = {
        use Contactor::{Minus, Plus, Precharge};
        use Flow::{Charge, Discharge};
        use Level::{Mol, Msl, Rsl};
        use PrechargeFault::{Hot, Open, Short, Slow};
        use Side::{High, Low};
        use Source::{Cell, Current, Link, Pack, Temperature};
        [
            Self::CellVoltage(Low, Mol),
            Self::CellVoltage(Low, Rsl),
            Self::CellVoltage(Low, Msl),
            Self::CellVoltage(High, Mol),
            Self::CellVoltage(High, Rsl),
            Self::CellVoltage(High, Msl),
            Self::Temperature(Discharge, Low, Mol),
            Self::Temperature(Discharge, Low, Rsl),
            Self::Temperature(Discharge, Low, Msl),
            Self::Temperature(Discharge, High, Mol),
            Self::Temperature(Discharge, High, Rsl),
            Self::Temperature(Discharge, High, Msl),
            Self::Temperature(Charge, Low, Mol),
            Self::Temperature(Charge, Low, Rsl),
            Self::Temperature(Charge, Low, Msl),
            Self::Temperature(Charge, High, Mol),
            Self::Temperature(Charge, High, Rsl),
            Self::Temperature(Charge, High, Msl),
            Self::Current(Discharge, Mol),
            Self::Current(Discharge, Rsl),
            Self::Current(Discharge, Msl),
            Self::Current(Charge, Mol),
            Self::Current(Charge, Rsl),
            Self::Current(Charge, Msl),
            Self::Surge(Discharge),
            Self::Surge(Charge),
            Self::Heat(Discharge),
            Self::Heat(Charge),
            Self::PackVoltage(Low),
            Self::PackVoltage(High),
            Self::Stale(Cell),
            Self::Stale(Temperature),
            Self::Stale(Current),
            Self::Stale(Pack),
            Self::Stale(Link),
            Self::Range(Cell),
            Self::Range(Temperature),
            Self::Range(Current),
            Self::Range(Pack),
            Self::Range(Link),
            Self::Feedback(Minus),
            Self::Feedback(Precharge),
            Self::Feedback(Plus),
            Self::Weld(Minus),
            Self::Weld(Precharge),
            Self::Weld(Plus),
            Self::Precharge(Short),
            Self::Precharge(Open),
            Self::Precharge(Slow),
            Self::Precharge(Hot),
            Self::Insulation(Mol),
            Self::Insulation(Rsl),
            Self::Insulation(Msl),
            Self::DeepDischarge,
            Self::CurrentWhileOpen,
            Self::ShortCircuit,
            Self::CellSum,
            Self::LinkDiffers,
            Self::CurrentsDiffer,
            Self::Residual,
            Self::CellCount,
            Self::StuckCell,
            Self::StuckTemperature,
            Self::StuckCurrent,
            Self::Imbalance,
            Self::TemperatureSpread,
            Self::TemperatureRate,
            Self::OpenWire,
            Self::Pin,
            Self::Bypassed,
            Self::Interlock,
            Self::Crash,
            Self::Supply,
            Self::Coolant,
            Self::RequestLost,
            Self::RequestCorrupt,
            Self::ChargerLost,
            Self::LateStep,
            Self::Record,
            Self::Parameters,
            Self::LogStore,
            Self::Estimator,
            Self::BleedStuck,
            Self::BleedHot,
        ]
    };

    /// Its place among [`ALL`](Self::ALL): that of its row, its bit and its number on the bus.
    #[must_use]
    pub const fn index(self) -> u8 {
        match self {
            Self::CellVoltage(side, level) => 3 * side as u8 + level as u8,
            Self::Temperature(flow, side, level) => {
                6 + 6 * flow as u8 + 3 * side as u8 + level as u8
            }
            Self::Current(flow, level) => 18 + 3 * flow as u8 + level as u8,
            Self::Surge(flow) => 24 + flow as u8,
            Self::Heat(flow) => 26 + flow as u8,
            Self::PackVoltage(side) => 28 + side as u8,
            Self::Stale(source) => 30 + source as u8,
            Self::Range(source) => 35 + source as u8,
            Self::Feedback(contactor) => 40 + contactor as u8,
            Self::Weld(contactor) => 43 + contactor as u8,
            Self::Precharge(fault) => 46 + fault as u8,
            Self::Insulation(level) => 50 + level as u8,
            Self::DeepDischarge => 53,
            Self::CurrentWhileOpen => 54,
            Self::ShortCircuit => 55,
            Self::CellSum => 56,
            Self::LinkDiffers => 57,
            Self::CurrentsDiffer => 58,
            Self::Residual => 59,
            Self::CellCount => 60,
            Self::StuckCell => 61,
            Self::StuckTemperature => 62,
            Self::StuckCurrent => 63,
            Self::Imbalance => 64,
            Self::TemperatureSpread => 65,
            Self::TemperatureRate => 66,
            Self::OpenWire => 67,
            Self::Pin => 68,
            Self::Bypassed => 69,
            Self::Interlock => 70,
            Self::Crash => 71,
            Self::Supply => 72,
            Self::Coolant => 73,
            Self::RequestLost => 74,
            Self::RequestCorrupt => 75,
            Self::ChargerLost => 76,
            Self::LateStep => 77,
            Self::Record => 78,
            Self::Parameters => 79,
            Self::LogStore => 80,
            Self::Estimator => 81,
            Self::BleedStuck => 82,
            Self::BleedHot => 83,
        }
    }

    /// The one with this index.
    #[must_use]
    pub fn at(index: u8) -> Option<Self> {
        Self::ALL.get(usize::from(index)).copied()
    }

    /// The direction whose use it concerns; `None` where it concerns both.
    #[must_use]
    pub const fn flow(self) -> Option<Flow> {
        match self {
            Self::Temperature(flow, ..)
            | Self::Current(flow, _)
            | Self::Surge(flow)
            | Self::Heat(flow) => Some(flow),
            Self::CellVoltage(Side::Low, _) | Self::PackVoltage(Side::Low) => Some(Flow::Discharge),
            Self::CellVoltage(Side::High, _) | Self::PackVoltage(Side::High) => Some(Flow::Charge),
            _ => None,
        }
    }

    /// On which side of its threshold it is bad.
    #[must_use]
    pub const fn side(self) -> Side {
        match self {
            Self::CellVoltage(side, _)
            | Self::Temperature(_, side, _)
            | Self::PackVoltage(side) => side,
            Self::DeepDischarge | Self::Insulation(_) => Side::Low,
            _ => Side::High,
        }
    }
}

/// Each index is that of its place: a wrong one does not compile.
const _: () = {
    let mut i = 0;
    while i < ROWS {
        assert!(Id::ALL[i].index() as usize == i);
        i += 1;
    }
};

/// A set of rows, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Faults(u128);

impl Faults {
    /// None.
    pub const NONE: Self = Self(0);

    /// Every row.
    pub(super) const ALL: Self = Self((1 << ROWS) - 1);

    /// What is in both.
    pub(super) const fn both(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The set with one more.
    #[must_use]
    pub const fn with(self, id: Id) -> Self {
        Self(self.0 | 1 << id.index())
    }

    /// The set without one.
    #[must_use]
    pub const fn without(self, id: Id) -> Self {
        Self(self.0 & !(1 << id.index()))
    }

    /// Whether one is in it.
    #[must_use]
    pub const fn has(self, id: Id) -> bool {
        self.0 >> id.index() & 1 == 1
    }

    /// Whether it is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// What is in either.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// What is in this and not in the other.
    #[must_use]
    pub const fn minus(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Bit k stands for the row with index k.
    #[must_use]
    pub const fn bits(self) -> u128 {
        self.0
    }

    /// Each of them.
    pub fn iter(self) -> impl Iterator<Item = Id> {
        let mut left = self.0;
        core::iter::from_fn(move || {
            let index = left.trailing_zeros();
            left &= left.wrapping_sub(1);
            Id::ALL.get(index as usize).copied()
        })
    }
}
