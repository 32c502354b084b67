//! Which cells are bled, and what that takes out of them.
//!
//! A cell is bled where its state of charge is surely above that of the others: its lower bound above
//! the lowest of the others' upper bounds, by a hysteresis. Where states of charge are not that
//! certain, by voltage, at rest alone. What is bled is counted, so that the estimates may know.
//!
//! Time is cut into frames: bleeding first, then a pause in which the readings settle and are taken.
//! Even and odd cells take turns, frame by frame: two neighbours share a wire, and one that is bled
//! shifts the reading of the other.
//!
//! It is ours. Tests: `tests` below.

use plant_core::error::{above, check, finite, not_negative, positive};
use plant_core::num::{min, sane};
use plant_core::{Accum, Dt, ParamError, Real};

/// Parameters of [`Balancer`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BalancerParams {
    /// Resistor across a cell \[Ω\], above zero.
    pub bleed_ohm: Real,
    /// Capacity of a cell, with those in parallel \[A·h\], above zero.
    pub capacity_ah: Real,
    /// How much a state of charge must surely be above the others, ≥ 0. Chosen where unknown: 0.005.
    pub hysteresis: Real,
    /// Standard deviations that "surely" means, ≥ 0. Chosen where unknown: 3.
    pub sds: Real,
    /// How much a voltage at rest must be above the lowest \[V\], above zero: more than what two
    /// readings may be off.
    pub hysteresis_v: Real,
    /// No bleeding below \[V\], above zero.
    pub least_v: Real,
    /// No bleeding with the board warmer than this \[°C\].
    pub board_max_c: Real,
    /// The most channels at once, at least 1.
    pub channels: u16,
    /// How long cells are bled in a frame \[s\], above zero.
    pub bleed_s: Real,
    /// How long none is \[s\], above zero: five time constants of the readings' filter, and the time
    /// to take them.
    pub pause_s: Real,
}

/// What is known of the cells, at the end of a pause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BalancerInput<'a, const CELLS: usize> {
    /// State of charge of each and its standard deviation; NaN where it is not known.
    pub soc: &'a [(Real, Real); CELLS],
    /// Voltage of each \[V\]; NaN where there is no reading.
    pub cell_v: &'a [Real; CELLS],
    /// No current has flowed for long enough: voltages tell the charge.
    pub rested: bool,
    /// Temperature of the board \[°C\]; NaN where it is not known.
    pub board_c: Real,
    /// Bleeding is allowed at all.
    pub allowed: bool,
}

/// The state of a [`Balancer`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct BalancerState<const CELLS: usize> {
    /// What each still has to lose \[A·s\].
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    to_bleed_as: [Accum; CELLS],
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    bleeding: [bool; CELLS],
    since: u16,
    odd: bool,
}

impl<const CELLS: usize> BalancerState<CELLS> {
    /// Nothing to do.
    pub const NEW: Self = Self {
        to_bleed_as: [Accum::new(0.0); CELLS],
        bleeding: [false; CELLS],
        since: 0,
        odd: false,
    };

    /// The bleed switches.
    #[must_use]
    pub const fn bleeding(&self) -> &[bool; CELLS] {
        &self.bleeding
    }

    /// What a cell still has to lose \[A·s\]; `None` where there is none of this number.
    #[must_use]
    pub fn to_bleed_as(&self, cell: usize) -> Option<Real> {
        self.to_bleed_as.get(cell).map(|left_as| left_as.get())
    }

    /// Whether the reading of a cell is disturbed: it is bled, or a neighbour is.
    #[must_use]
    pub fn disturbs(&self, cell: usize) -> bool {
        let bled = |index: usize| self.bleeding.get(index).is_some_and(|bled| *bled);
        bled(cell) || bled(cell + 1) || cell.checked_sub(1).is_some_and(bled)
    }
}

/// Decides which cells are bled.
///
/// ```
/// use voltstep_bms::balance::{Balancer, BalancerInput, BalancerParams, BalancerState};
/// use voltstep_bms::{Dt, must};
///
/// const BALANCER: Balancer = must!(Balancer::new(
///     BalancerParams {
///         bleed_ohm: 33.0,
///         capacity_ah: 50.0,
///         hysteresis: 0.005,
///         sds: 3.0,
///         hysteresis_v: 0.01,
///         least_v: 3.0,
///         board_max_c: 80.0,
///         channels: 8,
///         bleed_s: 0.9,
///         pause_s: 0.1,
///     },
///     must!(Dt::from_s(0.01))
/// ));
/// let mut state = BalancerState::NEW;
/// let input = BalancerInput {
///     soc: &[(0.60, 0.002), (0.63, 0.002), (0.60, 0.002)],
///     cell_v: &[3.7, 3.72, 3.7],
///     rested: false,
///     board_c: 30.0,
///     allowed: true,
/// };
/// let mut bled_as = [0.0; 3];
/// for _ in 0..1000 {
///     let step_as = BALANCER.step(&mut state, &input);
///     for (sum, bled) in bled_as.iter_mut().zip(step_as) {
///         *sum += bled;
///     }
/// }
/// assert!(bled_as[1] > 0.4 && bled_as[0] == 0.0 && bled_as[2] == 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balancer {
    params: BalancerParams,
    dt_s: Real,
    bleed: u16,
    frame: u16,
}

impl Balancer {
    /// Checks the parameters, for a call every `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: BalancerParams, dt: Dt) -> Result<Self, ParamError> {
        check!(positive("balancer.bleed_ohm", params.bleed_ohm));
        check!(positive("balancer.capacity_ah", params.capacity_ah));
        check!(not_negative("balancer.hysteresis", params.hysteresis));
        check!(not_negative("balancer.sds", params.sds));
        check!(positive("balancer.hysteresis_v", params.hysteresis_v));
        check!(positive("balancer.least_v", params.least_v));
        check!(finite("balancer.board_max_c", params.board_max_c));
        if params.channels == 0 {
            return Err(ParamError::OutOfRange("balancer.channels"));
        }
        check!(positive("balancer.bleed_s", params.bleed_s));
        check!(positive("balancer.pause_s", params.pause_s));
        check!(above("balancer.bleed_s", params.bleed_s, dt.s()));
        check!(above("balancer.pause_s", params.pause_s, dt.s()));
        let frame = (params.bleed_s + params.pause_s) / dt.s();
        if frame > 60_000.0 {
            return Err(ParamError::OutOfRange("balancer.bleed_s"));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let (bleed, frame) = ((params.bleed_s / dt.s() + 0.5) as u16, (frame + 0.5) as u16);
        Ok(Self { params, dt_s: dt.s(), bleed, frame })
    }

    /// One step; the charge that was taken out of each cell \[A·s\].
    pub fn step<const CELLS: usize>(
        &self,
        state: &mut BalancerState<CELLS>,
        input: &BalancerInput<CELLS>,
    ) -> [Real; CELLS] {
        let p = &self.params;
        let mut bled_as = [0.0; CELLS];
        let cool = sane(input.board_c) && input.board_c <= p.board_max_c;
        if !(input.allowed && cool) {
            state.bleeding = [false; CELLS];
            state.since = 0;
            return bled_as;
        }
        if state.since == 0 {
            self.decide(state, input);
            self.switch(state, input);
        }
        let cells = bled_as.iter_mut().zip(&mut state.bleeding).zip(&mut state.to_bleed_as);
        for (((bled_as, bleeding), left_as), cell_v) in cells.zip(input.cell_v) {
            if state.since >= self.bleed
                || !sane(*cell_v)
                || *cell_v < p.least_v
                || left_as.get() <= 0.0
            {
                *bleeding = false;
            }
            if *bleeding {
                *bled_as = cell_v / p.bleed_ohm * self.dt_s;
                left_as.add(-*bled_as);
            }
        }
        state.since = if state.since + 1 >= self.frame { 0 } else { state.since + 1 };
        bled_as
    }

    /// What each has to lose, at the end of a pause.
    fn decide<const CELLS: usize>(
        &self,
        state: &mut BalancerState<CELLS>,
        input: &BalancerInput<CELLS>,
    ) {
        let p = &self.params;
        let known = |(soc, sd): &(Real, Real)| sane(*soc) && sane(*sd);
        let (mut lowest_soc, mut lowest_v) = (Real::INFINITY, Real::INFINITY);
        for (soc, cell_v) in input.soc.iter().zip(input.cell_v) {
            if known(soc) {
                lowest_soc = min(soc.0 + p.sds * soc.1, lowest_soc);
            }
            if sane(*cell_v) {
                lowest_v = min(*cell_v, lowest_v);
            }
        }
        let cells = state.to_bleed_as.iter_mut().zip(input.soc).zip(input.cell_v);
        for ((left_as, soc), cell_v) in cells {
            let above = if known(soc) { soc.0 - p.sds * soc.1 - lowest_soc } else { 0.0 };
            if above > p.hysteresis {
                *left_as = Accum::new(3600.0 * p.capacity_ah * above);
            } else if input.rested && cell_v - lowest_v > p.hysteresis_v {
                // By how much is not known; one frame, and look again.
                *left_as = Accum::new(cell_v / p.bleed_ohm * p.bleed_s);
            } else if input.rested {
                *left_as = Accum::new(0.0);
            }
        }
    }

    /// Those of this frame: of every second cell, as many as the board can bear, the fullest first.
    fn switch<const CELLS: usize>(
        &self,
        state: &mut BalancerState<CELLS>,
        input: &BalancerInput<CELLS>,
    ) {
        state.odd = !state.odd;
        state.bleeding = [false; CELLS];
        let first = usize::from(state.odd);
        for _ in 0..self.params.channels {
            let mut fullest: Option<(usize, Real)> = None;
            let cells = state.to_bleed_as.iter().zip(&state.bleeding).zip(input.cell_v).enumerate();
            for (index, ((left_as, bleeding), cell_v)) in cells.skip(first).step_by(2) {
                let may = !bleeding && sane(*cell_v) && *cell_v >= self.params.least_v;
                if may && left_as.get() > fullest.map_or(0.0, |(_, most_as)| most_as) {
                    fullest = Some((index, left_as.get()));
                }
            }
            let Some((index, _)) = fullest else { break };
            if let Some(bleeding) = state.bleeding.get_mut(index) {
                *bleeding = true;
            }
        }
    }
}

#[cfg(test)]
mod tests;
