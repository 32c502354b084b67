//! What can go wrong with a pack, and how much.

use serde::Serialize;

/// A fault of a sensor, a contactor, the cells, the vehicle around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    CellWireOpen,
    CellStuck,
    CellReadsHigh,
    CellReadsLow,
    CellsSwapped,
    CellsLost,
    CellSentinel,
    TemperatureOpen,
    TemperatureShort,
    TemperatureStuck,
    TemperatureReadsLow,
    TemperatureLost,
    CurrentStuck,
    CurrentOffset,
    CurrentGain,
    CurrentReversed,
    CurrentSaturated,
    CurrentLost,
    PackVoltageOff,
    PackVoltageLost,
    LinkVoltageOff,
    LinkVoltageLost,
    MinusStuckOpen,
    PrechargeStuckOpen,
    PlusStuckOpen,
    MinusWelded,
    PrechargeWelded,
    PlusWelded,
    MinusShowsOpen,
    PrechargeShowsClosed,
    PlusShowsOpen,
    LinkShortBefore,
    PrechargeResistorOpen,
    LinkTooLarge,
    CellHeated,
    CellShort,
    Overcharge,
    Overload,
    LinkShort,
    Crash,
    Interlock,
    Insulation,
    RequestLost,
    RequestCorrupt,
}

/// When a fault has to be there to be met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Before the contactors close.
    Before,
    /// While they are closed.
    Closed,
}

use Fault::{
    CellHeated, CellReadsHigh, CellReadsLow, CellSentinel, CellShort, CellStuck, CellWireOpen,
    CellsLost, CellsSwapped, Crash, CurrentGain, CurrentLost, CurrentOffset, CurrentReversed,
    CurrentSaturated, CurrentStuck, Insulation, Interlock, LinkShort, LinkShortBefore,
    LinkTooLarge, LinkVoltageLost, LinkVoltageOff, MinusShowsOpen, MinusStuckOpen, MinusWelded,
    Overcharge, Overload, PackVoltageLost, PackVoltageOff, PlusShowsOpen, PlusStuckOpen,
    PlusWelded, PrechargeResistorOpen, PrechargeShowsClosed, PrechargeStuckOpen, PrechargeWelded,
    RequestCorrupt, RequestLost, TemperatureLost, TemperatureOpen, TemperatureReadsLow,
    TemperatureShort, TemperatureStuck,
};

impl Fault {
    /// Every one.
    pub const ALL: [Self; 44] = [
        CellWireOpen,
        CellStuck,
        CellReadsHigh,
        CellReadsLow,
        CellsSwapped,
        CellsLost,
        CellSentinel,
        TemperatureOpen,
        TemperatureShort,
        TemperatureStuck,
        TemperatureReadsLow,
        TemperatureLost,
        CurrentStuck,
        CurrentOffset,
        CurrentGain,
        CurrentReversed,
        CurrentSaturated,
        CurrentLost,
        PackVoltageOff,
        PackVoltageLost,
        LinkVoltageOff,
        LinkVoltageLost,
        MinusStuckOpen,
        PrechargeStuckOpen,
        PlusStuckOpen,
        MinusWelded,
        PrechargeWelded,
        PlusWelded,
        MinusShowsOpen,
        PrechargeShowsClosed,
        PlusShowsOpen,
        LinkShortBefore,
        PrechargeResistorOpen,
        LinkTooLarge,
        CellHeated,
        CellShort,
        Overcharge,
        Overload,
        LinkShort,
        Crash,
        Interlock,
        Insulation,
        RequestLost,
        RequestCorrupt,
    ];

    /// How much of it, at four severities, in the unit that it has: V, K, A, Ω, a ratio, K/s, or a
    /// share of time. Where it is so or not, all are the same.
    #[must_use]
    pub const fn severities(self) -> [f32; 4] {
        match self {
            CellReadsHigh | CellReadsLow => [0.02, 0.1, 0.25, 0.5],
            TemperatureReadsLow => [3.0, 10.0, 20.0, 40.0],
            CurrentOffset => [1.0, 5.0, 20.0, 60.0],
            CurrentGain => [0.02, 0.1, 0.3, 0.6],
            CurrentSaturated => [200.0, 100.0, 50.0, 20.0],
            PackVoltageOff | LinkVoltageOff => [0.5, 2.0, 5.0, 15.0],
            LinkShortBefore => [10.0, 3.0, 1.0, 0.1],
            PrechargeResistorOpen => [300.0, 1e3, 1e4, 1e7],
            LinkTooLarge => [3.0, 5.0, 10.0, 30.0],
            CellHeated => [0.2, 0.5, 1.0, 3.0],
            CellShort => [1.0, 0.3, 0.1, 0.03],
            Overcharge => [20.0, 60.0, 120.0, 200.0],
            Overload => [60.0, 150.0, 250.0, 400.0],
            LinkShort => [1.0, 0.3, 0.1, 0.02],
            Insulation => [450.0, 250.0, 90.0, 1.0],
            _ => [1.0; 4],
        }
    }

    /// When it happens.
    #[must_use]
    pub const fn when(self) -> When {
        match self {
            MinusStuckOpen
            | PrechargeStuckOpen
            | PlusStuckOpen
            | LinkShortBefore
            | PrechargeResistorOpen
            | LinkTooLarge
            | PrechargeShowsClosed => When::Before,
            _ => When::Closed,
        }
    }

    /// Why it need not be noticed at a severity, 0..3, where nothing is harmed; fixed before the
    /// campaign. `None`: it must be.
    #[must_use]
    pub const fn need_not_be_noticed(self, severity: usize) -> Option<&'static str> {
        match (self, severity) {
            (CellsSwapped, _) => Some("cells that are alike read alike"),
            (CellReadsHigh | CellReadsLow, 0 | 1) => Some("less than cells may differ"),
            (CellStuck, _) => Some("it is noticed once the current moves enough"),
            (TemperatureReadsLow, 0 | 1) => Some("less than sensors may differ"),
            (TemperatureStuck, _) => Some("it is noticed once temperatures move"),
            (CurrentOffset, 0 | 1) => Some("within the sensor's error, or the filter learns it"),
            (CurrentOffset | CurrentGain | CurrentReversed | CurrentStuck, _) => {
                Some("one current sensor: only the cells' voltages contradict, in minutes")
            }
            (CurrentSaturated, _) => Some("it is not met below its limit"),
            (PackVoltageOff | LinkVoltageOff, 0) => Some("within the sensors' errors"),
            (PackVoltageOff | LinkVoltageOff, 1) => Some("less than the sum of the cells' errors"),
            (CellHeated, 0) => Some("slower than a cell warms up by itself"),
            (CellShort, 0 | 1) => Some("less than the current sensor's error"),
            (Overcharge | Overload, 0) => Some("within the limits"),
            _ => None,
        }
    }
}

/// What is planted in a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planted {
    pub fault: Fault,
    /// How much of it.
    pub much: f32,
    /// From when on \[ms\].
    pub from_ms: u32,
}
