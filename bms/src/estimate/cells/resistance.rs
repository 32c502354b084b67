//! The resistance of each cell, beside the mean of all.

use plant_core::error::{above, positive};
use plant_core::num::{max, min, sane, sqrt};
use plant_core::{ParamError, Real, check};

use super::real;

/// What no number of steps tells: short ones see mostly the series resistance, and the branches of a
/// cell may be other ones.
const SYSTEMATIC: Real = 0.015;

/// What is known of the cells' resistances, and how [`CellResistances`] learns of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct CellResistanceParams {
    /// Of a new cell between two samples, about its series resistance \[Ω\], above zero.
    pub resistance_ohm: Real,
    /// How alike the cells are: standard deviation as a ratio to that, above zero.
    pub spread_sd: Real,
    /// Standard deviation of the noise of a cell's voltage \[V\], above zero.
    pub noise_sd_v: Real,
    /// The smallest change of the current between two samples to learn from \[A\], above zero.
    pub least_step_a: Real,
    /// How many such changes are remembered, above 1.
    pub memory_steps: Real,
}

/// How much larger the resistance of each cell is than the mean of all.
///
/// Between two samples `−Δ(v − v̄) = δR·ΔI + noise`: what is common to the cells drops out, and with
/// it the model. Recursive least squares with forgetting for one parameter a cell (Ljung 1999,
/// *System Identification*, eq. 11.12); all see the same current, so they share their gain and their
/// variance. Voltages that are late for the current weaken a cell's `δR` and the mean's `R` alike,
/// and leave their ratio.
///
/// ```
/// use plant_core::must;
/// use voltstep_bms::estimate::cells::{CellResistanceParams, CellResistances};
///
/// const RESISTANCES: CellResistances = must!(CellResistances::new(CellResistanceParams {
///     resistance_ohm: 0.03,
///     spread_sd: 0.2,
///     noise_sd_v: 0.001,
///     least_step_a: 1.0,
///     memory_steps: 500.0,
/// }));
/// let mut state = RESISTANCES.start::<3>();
/// for second in 0_u8..200 {
///     let current_a = if second % 2 == 0 { 4.0 } else { 0.0 };
///     let cell_v = [0.03, 0.03, 0.045].map(|ohm| 3.7 - ohm * current_a);
///     RESISTANCES.step(&mut state, &cell_v, current_a);
/// }
/// let (ratio, sd) = state.ratio(2).unwrap();
/// assert!((ratio - 0.045 / 0.035).abs() < 0.02 && sd < 0.02);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellResistances {
    params: CellResistanceParams,
    noise_v2: Real,
    keep: Real,
    largest_ohm2: Real,
}

/// The state of [`CellResistances`]; [`CellResistances::start`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct CellResistancesState<const CELLS: usize> {
    mean_ohm: Real,
    /// Variance of the mean and of each cell's difference \[Ω²\].
    variance_ohm2: Real,
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    more_ohm: [Real; CELLS],
    last: Last<CELLS>,
}

/// The last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
struct Last<const CELLS: usize> {
    current_a: Real,
    mean_v: Real,
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    cell_v: [Real; CELLS],
    /// How many of them were readings; none before the first sample.
    seen: usize,
}

impl CellResistances {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: CellResistanceParams) -> Result<Self, ParamError> {
        let ohm = check!(positive("cell_resistances.resistance_ohm", params.resistance_ohm));
        let spread = check!(positive("cell_resistances.spread_sd", params.spread_sd));
        let noise_v = check!(positive("cell_resistances.noise_sd_v", params.noise_sd_v));
        check!(positive("cell_resistances.least_step_a", params.least_step_a));
        let memory = check!(positive("cell_resistances.memory_steps", params.memory_steps));
        check!(above("cell_resistances.memory_steps", memory, 1.0));
        Ok(Self {
            params,
            noise_v2: 2.0 * noise_v * noise_v,
            keep: 1.0 - 1.0 / memory,
            largest_ohm2: spread * spread * ohm * ohm,
        })
    }

    /// Nothing learnt yet: all alike.
    #[must_use]
    pub const fn start<const CELLS: usize>(&self) -> CellResistancesState<CELLS> {
        CellResistancesState {
            mean_ohm: self.params.resistance_ohm,
            variance_ohm2: self.largest_ohm2,
            more_ohm: [0.0; CELLS],
            last: Last { current_a: 0.0, mean_v: 0.0, cell_v: [0.0; CELLS], seen: 0 },
        }
    }

    /// Looks at one sample: the cells' voltages \[V\], NaN where there is no reading, and the current
    /// \[A\]. Whether it has learnt from it. A cell without a reading keeps what is known of it.
    pub fn step<const CELLS: usize>(
        &self,
        state: &mut CellResistancesState<CELLS>,
        cell_v: &[Real; CELLS],
        current_a: Real,
    ) -> bool {
        let (mut sum_v, mut seen) = (0.0, 0);
        for voltage_v in cell_v.iter().filter(|v| sane(**v)) {
            sum_v += voltage_v;
            seen += 1;
        }
        let mean_v = if seen > 0 { sum_v / real(seen) } else { 0.0 };
        let seen = if sane(current_a) && sane(mean_v) { seen } else { 0 };
        let last = state.last;
        state.last = Last { current_a, mean_v, cell_v: *cell_v, seen };
        let step_a = current_a - last.current_a;
        // Another set of cells has another mean.
        let learns = seen > 0 && seen == last.seen && step_a.abs() >= self.params.least_step_a;
        if learns {
            let spread = state.variance_ohm2 * step_a * step_a + self.noise_v2;
            let gain = state.variance_ohm2 * step_a / spread;
            let mean_drop_v = last.mean_v - mean_v;
            state.mean_ohm += gain * (mean_drop_v - state.mean_ohm * step_a);
            // A mean that is not above zero is none.
            state.mean_ohm = max(state.mean_ohm, 0.01 * self.params.resistance_ohm);
            for ((more_ohm, now_v), then_v) in
                state.more_ohm.iter_mut().zip(cell_v).zip(last.cell_v)
            {
                let drop_v = then_v - now_v - mean_drop_v;
                if sane(drop_v) {
                    *more_ohm += gain * (drop_v - *more_ohm * step_a);
                }
            }
            let variance = state.variance_ohm2 * self.noise_v2 / (spread * self.keep);
            state.variance_ohm2 = min(variance, self.largest_ohm2);
        }
        learns
    }
}

impl<const CELLS: usize> CellResistancesState<CELLS> {
    /// A cell's resistance over the mean of all, and its standard deviation; `None` where there is
    /// none of this number.
    #[must_use]
    pub fn ratio(&self, index: usize) -> Option<(Real, Real)> {
        let more_ohm = self.more_ohm.get(index)?;
        let ratio = max(1.0 + more_ohm / self.mean_ohm, 0.1);
        let per_ohm2 = 1.0 / (self.mean_ohm * self.mean_ohm);
        Some((ratio, sqrt(self.variance_ohm2 * per_ohm2 + SYSTEMATIC * SYSTEMATIC)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant_core::must;

    const PARAMS: CellResistanceParams = CellResistanceParams {
        resistance_ohm: 0.03,
        spread_sd: 0.3,
        noise_sd_v: 0.001,
        least_step_a: 1.0,
        memory_steps: 300.0,
    };
    const RESISTANCES: CellResistances = must!(CellResistances::new(PARAMS));
    const OHM: [Real; 4] = [0.03, 0.027, 0.05, 0.033];

    fn run(state: &mut CellResistancesState<4>, steps: u32, lost: Option<usize>) {
        for i in 0..steps {
            let current_a = [0.0, 5.0, 2.0, -1.0, -1.2][i as usize % 5];
            // Half a millivolt to either side, another for each cell.
            let mut cell_v = [0.0; 4];
            for (cell, (voltage_v, ohm)) in cell_v.iter_mut().zip(OHM).enumerate() {
                let noise_v =
                    if (i as usize * (cell + 3) / 2).is_multiple_of(2) { 5e-4 } else { -5e-4 };
                *voltage_v = 3.7 - ohm * current_a + noise_v;
            }
            if let Some(cell) = lost {
                cell_v[cell] = Real::NAN;
            }
            RESISTANCES.step(state, &cell_v, current_a);
        }
    }

    #[test]
    fn finds_what_each_cell_has_more() {
        let mut state = RESISTANCES.start::<4>();
        let (first, doubt) = state.ratio(2).unwrap();
        assert!(first == 1.0 && (doubt - 0.3).abs() < 1e-3);
        run(&mut state, 500, None);
        for (cell, ohm) in OHM.iter().enumerate() {
            let (ratio, sd) = state.ratio(cell).unwrap();
            assert!((ratio - ohm / 0.035).abs() <= 3.0 * sd && sd < 0.02, "{cell}: {ratio} ± {sd}");
        }
        assert_eq!(state.ratio(4), None);
    }

    #[test]
    fn a_lost_reading_keeps_what_was_known() {
        let mut state = RESISTANCES.start::<4>();
        run(&mut state, 500, None);
        let before = state.ratio(2).unwrap().0;
        run(&mut state, 100, Some(2));
        assert!((state.more_ohm[2] / 0.035 + 1.0 - before).abs() < 0.02);
        for current_a in [Real::NAN, 1e38] {
            let mut other = state;
            assert!(!RESISTANCES.step(&mut other, &[3.7; 4], current_a));
            assert!(!RESISTANCES.step(&mut other, &[3.7; 4], 0.0), "nothing to compare with");
            assert_eq!(other.more_ohm, state.more_ohm);
        }
        assert!(!RESISTANCES.step(&mut state, &[Real::NAN; 4], 5.0));
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |change: fn(&mut CellResistanceParams, Real), bad| {
            let mut params = PARAMS;
            change(&mut params, bad);
            CellResistances::new(params).unwrap_err().field()
        };
        for bad in [0.0, -1.0, Real::NAN] {
            assert_eq!(
                refused(|p, x| p.resistance_ohm = x, bad),
                "cell_resistances.resistance_ohm"
            );
            assert_eq!(refused(|p, x| p.spread_sd = x, bad), "cell_resistances.spread_sd");
            assert_eq!(refused(|p, x| p.noise_sd_v = x, bad), "cell_resistances.noise_sd_v");
            assert_eq!(refused(|p, x| p.least_step_a = x, bad), "cell_resistances.least_step_a");
            assert_eq!(refused(|p, x| p.memory_steps = x, bad), "cell_resistances.memory_steps");
        }
        assert_eq!(refused(|p, x| p.memory_steps = x, 1.0), "cell_resistances.memory_steps");
    }
}
