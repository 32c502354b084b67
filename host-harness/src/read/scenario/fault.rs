//! What can go wrong with a pack, and how much.

use serde::{Deserialize, Serialize};

/// A fault of a sensor, a contactor, the cells, the vehicle around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// The wire to a cell is open: its reading floats near zero.
    CellWireOpen,
    /// A cell's reading does not change any more.
    CellStuck,
    /// A cell reads too high \[V\].
    CellReadsHigh,
    /// A cell reads too low \[V\].
    CellReadsLow,
    /// Two neighbouring wires to the cells are swapped: one cell reads in reverse, those beside it read two.
    CellsSwapped,
    /// The front end does not answer.
    CellsLost,
    /// A cell reads 819.1 V: a sentinel.
    CellSentinel,
    /// A temperature sensor is open.
    TemperatureOpen,
    /// A temperature sensor is shorted.
    TemperatureShort,
    /// A temperature does not change any more.
    TemperatureStuck,
    /// A temperature reads too low \[K\].
    TemperatureReadsLow,
    /// No temperature comes.
    TemperatureLost,
    /// The current does not change any more.
    CurrentStuck,
    /// The current reads too high \[A\].
    CurrentOffset,
    /// The current reads too small, by a ratio.
    CurrentGain,
    /// The current has the wrong sign.
    CurrentReversed,
    /// The current sensor ends early \[A\].
    CurrentSaturated,
    /// No current comes.
    CurrentLost,
    /// The pack's voltage reads too high \[V\].
    PackVoltageOff,
    /// The pack's voltage does not come.
    PackVoltageLost,
    /// The link's voltage reads too high \[V\].
    LinkVoltageOff,
    /// The link's voltage does not come.
    LinkVoltageLost,
    /// The minus contactor does not close.
    MinusStuckOpen,
    /// The precharge contactor does not close.
    PrechargeStuckOpen,
    /// The plus contactor does not close.
    PlusStuckOpen,
    /// The minus contactor is welded.
    MinusWelded,
    /// The precharge contactor is welded.
    PrechargeWelded,
    /// The plus contactor is welded.
    PlusWelded,
    /// The minus contactor shows open.
    MinusShowsOpen,
    /// The precharge contactor shows closed.
    PrechargeShowsClosed,
    /// The plus contactor shows open.
    PlusShowsOpen,
    /// A short across the link before it is charged \[Ω\].
    LinkShortBefore,
    /// The precharge resistor has a multiple of its resistance.
    PrechargeResistorOpen,
    /// The link has a multiple of its capacitance.
    LinkTooLarge,
    /// A cell is heated from outside \[K/s\].
    CellHeated,
    /// A cell has a short inside \[Ω\].
    CellShort,
    /// The charger ignores its limit \[A\].
    Overcharge,
    /// The vehicle ignores its limit \[A\].
    Overload,
    /// A short across the closed link \[Ω\].
    LinkShort,
    /// The vehicle reports a crash.
    Crash,
    /// The loop through the connectors is open.
    Interlock,
    /// Insulation to the chassis \[Ω/V\].
    Insulation,
    /// The vehicle is silent.
    RequestLost,
    /// The vehicle's messages are corrupt.
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

/// What a fault is planted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// One cell or its wire.
    Cell,
    /// One temperature sensor.
    Sensor,
    /// The whole.
    Pack,
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
    ///
    /// The mildest of a sensor lies beyond three times what its sheet declares, at the current that the
    /// campaign drives with (120 A at most, a charger's 20 A); less is no fault of it. That of a load
    /// lies beyond what the cells bear for good.
    #[must_use]
    pub const fn severities(self) -> [f32; 4] {
        match self {
            // Declared: 2 mV.
            CellReadsHigh | CellReadsLow => [0.02, 0.1, 0.25, 0.5],
            // Declared: 1 K.
            TemperatureReadsLow => [3.0, 10.0, 20.0, 40.0],
            // Declared: 2 A, offset and gain together.
            CurrentOffset => [6.0, 12.0, 20.0, 60.0],
            // 6 A of the charger's 20 A.
            CurrentGain => [0.3, 0.45, 0.6, 0.9],
            // Two thirds of the largest current; 6 A less than the charger's.
            CurrentSaturated => [80.0, 50.0, 14.0, 5.0],
            // Declared: 0.2 V, and as much of the one that it is compared with.
            PackVoltageOff | LinkVoltageOff => [1.2, 2.0, 5.0, 15.0],
            LinkShortBefore => [10.0, 3.0, 1.0, 0.1],
            PrechargeResistorOpen => [300.0, 1e3, 1e4, 1e7],
            LinkTooLarge => [3.0, 5.0, 10.0, 30.0],
            CellHeated => [0.2, 0.5, 1.0, 3.0],
            CellShort => [1.0, 0.3, 0.1, 0.03],
            // For good: 40 A; for ten seconds: 80 A.
            Overcharge => [60.0, 90.0, 120.0, 200.0],
            // For good: 116 A; for ten seconds: 174 A. Less than 150 A takes longer than is watched.
            Overload => [150.0, 180.0, 250.0, 400.0],
            // Beyond 116 A at 50 V: 0.43 Ω.
            LinkShort => [0.3, 0.1, 0.05, 0.02],
            Insulation => [450.0, 250.0, 90.0, 1.0],
            _ => [1.0; 4],
        }
    }

    /// How severe an amount is, 0..3: the mildest of [`severities`](Self::severities) that it does not
    /// exceed.
    #[must_use]
    pub fn severity_of(self, much: f32) -> usize {
        let severities = self.severities();
        let falling = severities[3] < severities[0];
        let within = |most: &f32| if falling { much >= *most } else { much <= *most };
        severities.iter().position(within).unwrap_or(3)
    }

    /// Whether there can be more or less of it.
    #[must_use]
    pub fn has_amount(self) -> bool {
        self.severities() != [1.0; 4]
    }

    /// What of the pack it is planted in.
    #[must_use]
    pub const fn part(self) -> Part {
        match self {
            CellWireOpen | CellStuck | CellReadsHigh | CellReadsLow | CellsSwapped
            | CellSentinel | CellHeated | CellShort => Part::Cell,
            TemperatureOpen | TemperatureShort | TemperatureStuck | TemperatureReadsLow => {
                Part::Sensor
            }
            _ => Part::Pack,
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
            | PrechargeShowsClosed
            | CellsSwapped => When::Before,
            _ => When::Closed,
        }
    }

    /// Whether it is one of the current's sensor.
    #[must_use]
    pub const fn of_current(self) -> bool {
        matches!(
            self,
            CurrentStuck
                | CurrentOffset
                | CurrentGain
                | CurrentReversed
                | CurrentSaturated
                | CurrentLost
        )
    }

    /// Whether it shows only when the contactors open.
    #[must_use]
    pub const fn shows_when_opening(self) -> bool {
        matches!(self, MinusWelded | PrechargeWelded | PlusWelded)
    }

    /// Why it need not be noticed at a severity, 0..3, where nothing is harmed; fixed before the
    /// campaign. `None`: it must be.
    #[must_use]
    pub const fn need_not_be_noticed(self, severity: usize) -> Option<&'static str> {
        match (self, severity) {
            (CellReadsHigh | CellReadsLow, 0 | 1) => {
                Some("less than cells may differ, hidden by a load that changed at that moment")
            }
            (CellStuck, _) => Some("no current flowed that would have moved it"),
            (TemperatureStuck, _) => Some("it is noticed once temperatures move"),
            (CurrentGain, _) => Some("cells of another resistance explain it"),
            (CurrentReversed | CurrentStuck, _) => Some("no current flowed that it could hide"),
            (CurrentSaturated, _) => Some("not met, or cells of another resistance explain it"),
            (CellHeated, 0) => Some("no more than three times its own warming"),
            (CellShort, 0..=2) => {
                Some("it sags less than three times the sensor's error, or while the load changed")
            }
            _ => None,
        }
    }
}

/// What is planted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Planted {
    /// What.
    pub fault: Fault,
    /// How much of it, in the unit that it has.
    pub much: f32,
    /// From when on \[ms\].
    pub from_ms: u32,
    /// Which cell or sensor, from 0.
    pub at: usize,
}

impl Planted {
    /// In a cell or sensor in the middle of the pack.
    #[must_use]
    pub const fn new(fault: Fault, much: f32, from_ms: u32) -> Self {
        let at = match fault.part() {
            Part::Cell => 6,
            Part::Sensor => 1,
            Part::Pack => 0,
        };
        Self { fault, much, from_ms, at }
    }

    /// Which cell or sensor, where it is in one.
    #[must_use]
    pub fn place(&self) -> Option<usize> {
        Some(self.at).filter(|_| self.fault.part() != Part::Pack)
    }

    /// How severe it is, 0..3.
    #[must_use]
    pub fn severity(&self) -> usize {
        self.fault.severity_of(self.much)
    }
}
