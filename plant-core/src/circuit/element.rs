//! What a circuit is made of.

use crate::error::{ParamError, check, finite, not_negative, positive};
use crate::num::{Real, exp, ln, max, min, sqrt};

/// An element between two nodes. Its current is positive from `from` to `to` through it, its voltage
/// is `from` minus `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Branch {
    /// Node where a positive current enters: anode, drain, plus. Node 0 is the ground.
    pub from: usize,
    /// Node where it leaves: cathode, source, minus.
    pub to: usize,
    /// What lies between.
    pub element: Element,
}

impl Branch {
    /// An element between two nodes.
    #[must_use]
    pub const fn new(from: usize, to: usize, element: Element) -> Self {
        Self { from, to, element }
    }
}

/// What lies between two nodes. The value that an element takes in each step is its entry of
/// [`CircuitInput::values`](super::CircuitInput::values).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
#[non_exhaustive]
pub enum Element {
    /// `v = R·i`.
    Resistor {
        /// Resistance \[Ω\], above zero.
        ohm: Real,
    },
    /// `v = R·i + L·di/dt + e`; the value is the electromotive force `e` \[V\].
    Coil {
        /// Inductance \[H\], above zero.
        henry: Real,
        /// Resistance in series \[Ω\], ≥ 0.
        ohm: Real,
    },
    /// `i = C·dv/dt`.
    Capacitor {
        /// Capacitance \[F\], above zero.
        farad: Real,
    },
    /// A resistor whose value \[Ω\] is given with each step, above zero.
    VariableResistor,
    /// `i = d(C·v)/dt`; the value is the capacitance \[F\], above zero.
    VariableCapacitor,
    /// Holds the voltage that is its value \[V\].
    Voltage,
    /// Drives the current that is its value \[A\].
    Current,
    /// Closed while its gate is on.
    Switch {
        /// Resistance when closed \[Ω\], above zero.
        on_ohm: Real,
        /// Resistance when open \[Ω\], above `on_ohm`.
        off_ohm: Real,
    },
    /// Conducts from `from` to `to` above its voltage drop.
    Diode {
        /// Slope when it conducts \[Ω\], above zero.
        on_ohm: Real,
        /// Resistance when it blocks \[Ω\], above `on_ohm`.
        off_ohm: Real,
        /// Voltage at which it begins to conduct \[V\], ≥ 0.
        drop_v: Real,
    },
    /// A switch of a converter with its reverse diode: conducts forward above `drop_v` while its gate
    /// is on, backward above `diode_drop_v` always. With `drop_v` = 0 the channel of a MOSFET, which
    /// while its gate is on conducts both ways without a drop.
    Transistor {
        /// Slope when it conducts \[Ω\], above zero.
        on_ohm: Real,
        /// Resistance when it blocks \[Ω\], above `on_ohm`.
        off_ohm: Real,
        /// Voltage drop forward \[V\], ≥ 0.
        drop_v: Real,
        /// Voltage drop of the reverse diode \[V\], ≥ 0.
        diode_drop_v: Real,
    },
    /// `i = I_s·(exp(v/V_t) − 1) + v/R`, from `v/V_t` = `largest_exponent` on along its tangent.
    Junction {
        /// Saturation current \[A\], above zero.
        saturation_a: Real,
        /// Thermal voltage times the emission factor \[V\], above zero.
        thermal_v: Real,
        /// Where the exponential goes on as a straight line, above zero and up to 80.
        largest_exponent: Real,
        /// Resistance in parallel \[Ω\], above zero.
        parallel_ohm: Real,
    },
    /// Level 1 transistor, drain at `from`, source at `to`.
    Mos {
        /// Node of the gate, which takes no current.
        gate: usize,
        /// P channel: all voltages and currents the other way round.
        p_channel: bool,
        /// Threshold \[V\], as a magnitude.
        threshold_v: Real,
        /// Transconductance times width over length \[A/V²\], above zero.
        gain_a_v2: Real,
        /// Channel length modulation \[1/V\], ≥ 0.
        modulation_per_v: Real,
    },
}

impl Element {
    /// The diode of the reference system: 1 µA, 40 mV, exponent up to 15, 1e8 Ω
    /// \[EPowertrain2025, table of defaults\].
    pub const JUNCTION: Self = Self::Junction {
        saturation_a: 1e-6,
        thermal_v: 0.04,
        largest_exponent: 15.0,
        parallel_ohm: 1e8,
    };
    /// Its ideal switch: 1e5 Ω open, 1e-5 Ω closed.
    pub const IDEAL_SWITCH: Self = Self::Switch { on_ohm: 1e-5, off_ohm: 1e5 };
    /// Its NMOS: 3 V, 100 µA/V², 10 µm by 2 µm.
    pub const NMOS: Self = Self::Mos {
        gate: 0,
        p_channel: false,
        threshold_v: 3.0,
        gain_a_v2: 5e-4,
        modulation_per_v: 0.0,
    };

    /// Whether it conducts or blocks, with a conductance for each.
    pub(super) const fn two_state(&self) -> bool {
        matches!(self, Self::Switch { .. } | Self::Diode { .. } | Self::Transistor { .. })
    }

    /// Whether its current or voltage lasts from step to step.
    pub(super) const fn stores(&self) -> bool {
        matches!(self, Self::Coil { .. } | Self::Capacitor { .. } | Self::VariableCapacitor)
    }

    /// Whether its conductance is known only within a step.
    pub(super) const fn varies(&self) -> bool {
        matches!(
            self,
            Self::VariableResistor
                | Self::VariableCapacitor
                | Self::Junction { .. }
                | Self::Mos { .. }
        )
    }

    /// Whether its curve is found by Newton's iteration.
    pub(super) const fn curved(&self) -> bool {
        matches!(self, Self::Junction { .. } | Self::Mos { .. })
    }

    /// Whether it can drive a current by itself.
    pub(super) const fn drives(&self) -> bool {
        match self {
            Self::Resistor { .. } | Self::VariableResistor | Self::Switch { .. } => false,
            Self::Diode { drop_v, .. } => *drop_v > 0.0,
            Self::Transistor { drop_v, diode_drop_v, .. } => *drop_v > 0.0 || *diode_drop_v > 0.0,
            _ => true,
        }
    }

    pub(super) const fn check(&self) -> Result<(), ParamError> {
        match *self {
            Self::Resistor { ohm } => {
                check!(positive("resistor.ohm", ohm));
            }
            Self::Coil { henry, ohm } => {
                check!(positive("coil.henry", henry));
                check!(not_negative("coil.ohm", ohm));
            }
            Self::Capacitor { farad } => {
                check!(positive("capacitor.farad", farad));
            }
            Self::Switch { on_ohm, off_ohm } => check!(two_ohms("switch.off_ohm", on_ohm, off_ohm)),
            Self::Diode { on_ohm, off_ohm, drop_v } => {
                check!(two_ohms("diode.off_ohm", on_ohm, off_ohm));
                check!(not_negative("diode.drop_v", drop_v));
            }
            Self::Transistor { on_ohm, off_ohm, drop_v, diode_drop_v } => {
                check!(two_ohms("transistor.off_ohm", on_ohm, off_ohm));
                check!(not_negative("transistor.drop_v", drop_v));
                check!(not_negative("transistor.diode_drop_v", diode_drop_v));
            }
            Self::Junction { saturation_a, thermal_v, largest_exponent, parallel_ohm } => {
                check!(positive("junction.saturation_a", saturation_a));
                check!(positive("junction.thermal_v", thermal_v));
                check!(positive("junction.parallel_ohm", parallel_ohm));
                if !(largest_exponent > 0.0 && largest_exponent <= 80.0) {
                    return Err(ParamError::OutOfRange("junction.largest_exponent"));
                }
            }
            Self::Mos { threshold_v, gain_a_v2, modulation_per_v, .. } => {
                check!(finite("mos.threshold_v", threshold_v));
                check!(positive("mos.gain_a_v2", gain_a_v2));
                check!(not_negative("mos.modulation_per_v", modulation_per_v));
            }
            Self::VariableResistor | Self::VariableCapacitor | Self::Voltage | Self::Current => {}
        }
        Ok(())
    }

    /// What it conducts \[S\] in a step that divides time by `per_s`; infinity for a voltage source.
    /// `value` is its input, where that decides.
    pub(super) const fn conductance_s(&self, per_s: Real, conducts: bool, value: Real) -> Real {
        match *self {
            Self::Resistor { ohm } => 1.0 / ohm,
            Self::Coil { henry, ohm } => 1.0 / (ohm + henry * per_s),
            Self::Capacitor { farad } => farad * per_s,
            Self::VariableResistor => 1.0 / value,
            Self::VariableCapacitor => value * per_s,
            Self::Voltage => Real::INFINITY,
            Self::Switch { on_ohm, off_ohm }
            | Self::Diode { on_ohm, off_ohm, .. }
            | Self::Transistor { on_ohm, off_ohm, .. } => {
                if conducts {
                    1.0 / on_ohm
                } else {
                    1.0 / off_ohm
                }
            }
            Self::Current | Self::Junction { .. } | Self::Mos { .. } => 0.0,
        }
    }

    /// The voltage drops, forward and backward, of a two-state element.
    pub(super) const fn drop_v(&self) -> (Real, Real) {
        match *self {
            Self::Diode { drop_v, .. } => (drop_v, 0.0),
            Self::Transistor { drop_v, diode_drop_v, .. } => (drop_v, diode_drop_v),
            _ => (0.0, 0.0),
        }
    }

    /// Current \[A\] and its slope \[S\] of a curved element at a voltage, `gate_v` being the gate's
    /// over `to`.
    pub(super) fn curve(&self, voltage_v: Real, gate_v: Real) -> (Real, Real) {
        match *self {
            Self::Junction { saturation_a, thermal_v, largest_exponent, parallel_ohm } => {
                let x = voltage_v / thermal_v;
                let held = if x > largest_exponent { largest_exponent } else { x };
                let e = saturation_a * exp(held);
                (
                    e * (1.0 + (x - held)) - saturation_a + voltage_v / parallel_ohm,
                    e / thermal_v + 1.0 / parallel_ohm,
                )
            }
            Self::Mos { p_channel, threshold_v, gain_a_v2, modulation_per_v, .. } => {
                let way = if p_channel { -1.0 } else { 1.0 };
                let mos = Level1 { threshold_v, gain_a_v2, modulation_per_v };
                let (current, slope) = mos.both_ways(way * voltage_v, way * gate_v);
                (way * current + LEAST_S * voltage_v, slope + LEAST_S)
            }
            _ => (0.0, 0.0),
        }
    }

    /// How far Newton's iteration goes from one guess of a junction's voltage towards the next:
    /// where the exponential would run away, as far as its logarithm says \[Nagel1975\].
    pub(super) fn damped_v(&self, from_v: Real, to_v: Real) -> Real {
        let Self::Junction { saturation_a, thermal_v, .. } = *self else {
            return to_v;
        };
        // Not below zero where a large current saturates: then nothing runs away.
        let critical_v = max(thermal_v * ln(thermal_v / (sqrt(2.0) * saturation_a)), 0.0);
        let rise = (to_v - from_v) / thermal_v;
        if to_v <= critical_v || rise.abs() <= 2.0 {
            to_v
        } else if from_v > 0.0 {
            if rise > -1.0 { from_v + thermal_v * ln(1.0 + rise) } else { critical_v }
        } else {
            thermal_v * ln(to_v / thermal_v)
        }
    }
}

/// What keeps a transistor that is off tied to its nodes \[S\]; that of SPICE.
const LEAST_S: Real = 1e-12;

/// The two-state elements of a circuit, a bit for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Devices {
    pub all: u32,
    /// Conduct forward only while the gate is on.
    pub gated: u32,
    /// And then both ways.
    pub level: u32,
    /// Conduct backward at any time.
    pub back: u32,
    /// Have a voltage drop.
    pub drop: u32,
}

impl Devices {
    /// The conducting elements as a number, the first two-state element being the lowest bit.
    #[inline(always)]
    pub(super) const fn configuration(&self, conducts: u32) -> usize {
        let first = self.all.trailing_zeros();
        let in_a_row = self.all.wrapping_shr(first);
        if in_a_row & in_a_row.wrapping_add(1) == 0 {
            return (conducts & self.all).wrapping_shr(first) as usize;
        }
        let (mut configuration, mut device, mut left) = (0, 0, self.all);
        while left != 0 {
            configuration |= (conducts >> left.trailing_zeros() & 1) << device;
            device += 1;
            left &= left - 1;
        }
        configuration as usize
    }

    pub(super) const fn of<const E: usize>(branches: &[Branch; E]) -> Self {
        let mut devices = Self { all: 0, gated: 0, level: 0, back: 0, drop: 0 };
        let mut e = 0;
        while e < E && e < 32 {
            let (element, bit) = (&branches[e].element, 1 << e);
            if element.two_state() {
                devices.all |= bit;
                if element.drives() {
                    devices.drop |= bit;
                }
            }
            match *element {
                Element::Switch { .. } => {
                    devices.gated |= bit;
                    devices.level |= bit;
                }
                Element::Transistor { drop_v, .. } => {
                    devices.gated |= bit;
                    devices.back |= bit;
                    if drop_v == 0.0 {
                        devices.level |= bit;
                    }
                }
                _ => {}
            }
            e += 1;
        }
        devices
    }
}

struct Level1 {
    threshold_v: Real,
    gain_a_v2: Real,
    modulation_per_v: Real,
}

impl Level1 {
    /// Drain and source change places where the voltage is negative.
    fn both_ways(&self, drain_v: Real, gate_v: Real) -> (Real, Real) {
        if drain_v >= 0.0 {
            let (current, slope, _) = self.forward(drain_v, gate_v - self.threshold_v);
            (current, slope)
        } else {
            // Its gate is counted from what is now the source, which moves with the voltage.
            let (current, slope, by_gate) =
                self.forward(-drain_v, gate_v - drain_v - self.threshold_v);
            (-current, slope + by_gate)
        }
    }

    /// Current, its slope over the drain's voltage, and over the gate's.
    fn forward(&self, drain_v: Real, over_v: Real) -> (Real, Real, Real) {
        if over_v <= 0.0 {
            return (0.0, 0.0, 0.0);
        }
        let longer = 1.0 + self.modulation_per_v * drain_v;
        let (shape, slope) = if drain_v < over_v {
            ((over_v - 0.5 * drain_v) * drain_v, over_v - drain_v)
        } else {
            (0.5 * over_v * over_v, 0.0)
        };
        (
            self.gain_a_v2 * shape * longer,
            self.gain_a_v2 * (slope * longer + shape * self.modulation_per_v),
            self.gain_a_v2 * min(drain_v, over_v) * longer,
        )
    }
}

const fn two_ohms(field: &'static str, on_ohm: Real, off_ohm: Real) -> Result<(), ParamError> {
    check!(positive(field, on_ohm));
    check!(positive(field, off_ohm));
    if on_ohm < off_ohm { Ok(()) } else { Err(ParamError::NotAbove(field)) }
}
