//! A vehicle on its way along a cycle, a stretch at a time.

use std::fmt::Write;

use plant_core::battery::Pack;
use plant_core::control::driver::Steering;
use plant_core::powertrain::Drives;
use plant_core::powertrain::PowertrainState;
use plant_core::powertrain::ledger::{EnergyLedger, NoLedger};
use plant_core::signal::sources::{AtEnd, TimeTable, TimeTableParams, TimeTableState};
use plant_core::{Dt, ParamError};
use voltstep_trace::{Fnv1a, Frame, Rig, RigState, Words};

use crate::cycle::Cycle;
use crate::json;

/// Rows of the trace in a second.
pub const ROWS_PER_S: u32 = 10;
/// Values in a row: speed to follow and speed \[m/s\], mean power out of the battery since the row before
/// \[W\], state of charge.
pub const COLUMNS: usize = 4;

/// A run that is under way.
pub trait Going {
    /// Drives on for so many rows; whether the cycle is over.
    ///
    /// # Errors
    /// Says when the plant refused a step.
    fn advance(&mut self, rows: u32) -> Result<bool, String>;
    /// The rows so far, [`COLUMNS`] values each; the first is the start.
    fn rows(&self) -> &[f32];
    /// What it has come to, as JSON.
    fn result(&self) -> String;
}

/// What a vehicle of this battery and these drives remembers.
type State<B, D> = RigState<EnergyLedger, <B as Pack>::State, <D as Drives>::State>;

/// A vehicle on its way.
pub struct Run<B: Pack, D: Drives, C> {
    rig: Rig<EnergyLedger, B, D, C>,
    reference: TimeTable<'static>,
    clock: TimeTableState,
    start: PowertrainState<EnergyLedger, B::State, D::State>,
    state: State<B, D>,
    dt_s: f32,
    steps_per_row: u32,
    steps: u32,
    rows_in_all: usize,
    rows: Vec<f32>,
    hash: Fnv1a,
    energy_j: f64,
    limited_steps: u32,
}

impl<B, D, C> Run<B, D, C>
where
    B: Pack<State: Words> + 'static,
    D: Drives<State: Words> + 'static,
    C: Steering<D> + Copy + 'static,
{
    /// At the start of a cycle; a row takes a whole number of steps.
    ///
    /// # Errors
    /// [`ParamError`] names what is out of range.
    pub fn begin(
        rig: Rig<NoLedger, B, D, C>,
        cycle: &'static Cycle,
        dt: Dt,
    ) -> Result<Box<dyn Going>, ParamError> {
        let rig = rig.with_ledger();
        let points = &cycle.points;
        let reference = TimeTable::new(TimeTableParams { points, at_end: AtEnd::Hold }, dt)?;
        let state = rig.start()?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "counts"
        )]
        let (steps_per_row, rows_in_all) = (
            (1.0 / (ROWS_PER_S as f32 * dt.s())).round() as u32,
            (cycle.duration_s() * ROWS_PER_S as f32).round() as usize,
        );
        let mut rows = Vec::with_capacity((rows_in_all + 1) * COLUMNS);
        let first_m_s = points.first().map_or(0.0, |(_, speed_m_s)| *speed_m_s);
        rows.extend([first_m_s, state.seen.speed_m_s, 0.0, state.seen.soc]);
        Ok(Box::new(Self {
            rig,
            reference,
            clock: TimeTableState::default(),
            start: state.plant,
            state,
            dt_s: dt.s(),
            steps_per_row,
            steps: 0,
            rows_in_all,
            rows,
            hash: Fnv1a::default(),
            energy_j: 0.0,
            limited_steps: 0,
        }))
    }

    /// The steps up to the next row.
    fn row(&mut self) -> Result<(), String> {
        let mut row_j = 0.0;
        for _ in 0..self.steps_per_row {
            let reference = self.reference.step(&mut self.clock, ());
            let out = self.rig.step(&mut self.state, reference);
            if out.rejected {
                let time_s = f64::from(self.steps) * f64::from(self.dt_s);
                return Err(format!("the plant refused the step at {time_s:.3} s"));
            }
            self.steps += 1;
            self.limited_steps += u32::from(self.state.seen.limited);
            row_j += f64::from(out.battery_v * out.battery_a) * f64::from(self.dt_s);
            for word in Frame::plant(&self.state).words() {
                self.hash.word(*word);
            }
        }
        self.energy_j += row_j;
        // What is to be followed now, at the end of the last step.
        let now_m_s = self.reference.step(&mut self.clock.clone(), ()).value;
        let mean_w = row_j * f64::from(ROWS_PER_S);
        #[expect(clippy::cast_possible_truncation, reason = "to be drawn")]
        self.rows.extend([now_m_s, self.state.seen.speed_m_s, mean_w as f32, self.state.seen.soc]);
        Ok(())
    }
}

impl<B, D, C> Going for Run<B, D, C>
where
    B: Pack<State: Words> + 'static,
    D: Drives<State: Words> + 'static,
    C: Steering<D> + Copy + 'static,
{
    fn advance(&mut self, rows: u32) -> Result<bool, String> {
        for _ in 0..rows {
            if self.rows.len() > self.rows_in_all * COLUMNS {
                break;
            }
            self.row()?;
        }
        Ok(self.rows.len() > self.rows_in_all * COLUMNS)
    }

    fn rows(&self) -> &[f32] {
        &self.rows
    }

    fn result(&self) -> String {
        let energy = self.rig.plant.energy(&self.start, &self.state.plant);
        let terms = energy.terms().map(|(name, joules)| (name, json::number(f64::from(joules))));
        let mut text = String::from("{");
        let _ = write!(
            text,
            "\"hash\":\"{:016x}\",\"steps\":{},\"energy_j\":{},\"distance_m\":{},\"soc\":{},\
             \"limited_s\":{},\"residual_rel\":{},\"terms\":{}}}",
            self.hash.get(),
            self.steps,
            json::number(self.energy_j),
            json::number(f64::from(self.state.plant.body.distance_m.get())),
            json::number(f64::from(self.state.seen.soc)),
            json::number(f64::from(self.limited_steps) * f64::from(self.dt_s)),
            json::number(f64::from(energy.residual_rel())),
            json::object(&terms),
        );
        text
    }
}
