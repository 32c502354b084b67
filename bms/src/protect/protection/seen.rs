//! What each row sees of the measurements.

use plant_core::Real;
use plant_core::num::{LARGEST, max, min, sane};

use super::{Fast, Protection, ProtectionState, along};
use crate::protect::id::{Flow, Id, Level, Side, Source};
use crate::protect::look::{Look, Taken};
use crate::protect::row::Seen;
use crate::protect::signals::Signals;

/// An insulation value may be this old \[s\]. Chosen: devices measure for up to 10 s.
const INSULATION_S: Real = 20.0;
/// The least share of a current that a temperature leaves.
const LEAST_SHARE: Real = 0.05;

impl<const CELLS: usize, const SENSORS: usize> Protection<'_, CELLS, SENSORS> {
    /// What a row sees.
    pub(super) fn seen(
        &self,
        state: &ProtectionState<CELLS, SENSORS>,
        fast: &Fast,
        signals: &Signals,
        id: Id,
    ) -> Seen {
        let known = |value: Option<Real>| value.map_or(Seen::NOTHING, Seen::all);
        let (cells, temperatures) = (&state.last_cells, &state.last_temperatures);
        let of = |value: Real, look: &Look| Seen { value, complete: look.complete() };
        let (current_a, pack_v) = (fast.current.value(), fast.pack.value());
        match id {
            Id::CellVoltage(Side::Low, _) | Id::DeepDischarge => of(cells.lowest, cells),
            Id::CellVoltage(Side::High, _) => of(cells.highest, cells),
            Id::Temperature(_, Side::Low, _) => of(temperatures.lowest, temperatures),
            Id::Temperature(_, Side::High, _) => of(temperatures.highest, temperatures),
            Id::Current(flow, level) => known(current_a.map(|current_a| {
                let share = if level == Level::Mol { self.share(flow, temperatures) } else { 1.0 };
                along(flow, current_a) / share
            })),
            Id::Surge(flow) => known(current_a.map(|current_a| along(flow, current_a))),
            Id::Heat(Flow::Discharge) => Seen::all(state.heat_a2s[0]),
            Id::Heat(Flow::Charge) => Seen::all(state.heat_a2s[1]),
            Id::CurrentWhileOpen if !signals.all_open => Seen::all(0.0),
            Id::ShortCircuit if signals.flags.has(id) => Seen::all(LARGEST),
            Id::CurrentWhileOpen | Id::ShortCircuit => known(current_a.map(Real::abs)),
            Id::PackVoltage(_) => known(pack_v),
            Id::CellSum if !cells.complete() => Seen::NOTHING,
            Id::CellSum => known(pack_v.map(|pack_v| (cells.sum - pack_v).abs())),
            Id::LinkDiffers if !signals.mains_closed => Seen::all(0.0),
            Id::LinkDiffers => {
                known(pack_v.zip(fast.link.value()).map(|(pack_v, link_v)| (pack_v - link_v).abs()))
            }
            Id::CurrentsDiffer => {
                known(current_a.map(|current_a| (current_a - signals.second_current_a).abs()))
            }
            Id::Residual => Seen::all(signals.residual_v.abs()),
            Id::CellCount => known(signals.cells_found.map(|found| {
                let all = usize::from(found) == CELLS;
                if all { 0.0 } else { 1.0 }
            })),
            Id::StuckCell | Id::StuckTemperature | Id::StuckCurrent => {
                Seen::flag(state.stuck.has(id))
            }
            Id::Stale(Source::Cell) => Seen::flag(cells.stale),
            Id::Stale(Source::Temperature) => Seen::flag(temperatures.stale),
            Id::Stale(Source::Current) => Seen::flag(fast.current == Taken::Stale),
            Id::Stale(Source::Pack) => Seen::flag(fast.pack == Taken::Stale),
            Id::Stale(Source::Link) => Seen::flag(fast.link == Taken::Stale),
            Id::Range(Source::Cell) => Seen::flag(cells.out_of_range),
            Id::Range(Source::Temperature) => Seen::flag(temperatures.out_of_range),
            Id::Range(Source::Current) => Seen::flag(fast.current == Taken::OutOfRange),
            Id::Range(Source::Pack) => Seen::flag(fast.pack == Taken::OutOfRange),
            Id::Range(Source::Link) => Seen::flag(fast.link == Taken::OutOfRange),
            Id::Imbalance => of(cells.highest - cells.lowest, cells),
            Id::TemperatureSpread => of(temperatures.highest - temperatures.lowest, temperatures),
            Id::TemperatureRate => of(state.warming.unexplained_k_per_s, temperatures),
            Id::OpenWire => wires(signals.wires_v, CELLS),
            Id::Insulation(_) => match &signals.insulation_ohm_per_v {
                None => Seen::all(LARGEST),
                Some(reading) => known(reading.usable(INSULATION_S)),
            },
            Id::LateStep => Seen::all(signals.elapsed_s / self.table.sheet().tick_s),
            _ => Seen::flag(signals.flags.has(id)),
        }
    }

    /// The share of a current that the temperatures leave.
    pub(super) fn share(&self, flow: Flow, temperatures: &Look) -> Real {
        if temperatures.seen == 0 {
            return 1.0;
        }
        let window = match flow {
            Flow::Discharge => &self.table.sheet().cell.discharge_window,
            Flow::Charge => &self.table.sheet().cell.charge_window,
        };
        let share = min(window.share(temperatures.lowest), window.share(temperatures.highest));
        max(LEAST_SHARE, share)
    }
}

/// The wire whose reading moves most: every one of them, one more than cells.
fn wires(wires_v: &[Real], cells: usize) -> Seen {
    let mut most = Seen { value: Real::NEG_INFINITY, complete: wires_v.len() == cells + 1 };
    for moved_v in wires_v {
        if sane(*moved_v) {
            most.value = max(moved_v.abs(), most.value);
        } else {
            most.complete = false;
        }
    }
    most
}
