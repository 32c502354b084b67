//! A value over time, given by points: a driving cycle, a load profile.
//!
//! `y = y_k + (y_k+1 − y_k)·(t − t_k)/(t_k+1 − t_k)`, the polyline. What it does is
//! \[EPowertrain2025, `Sources`\]; the time within a segment, instead of a search, is ours.
//!
//! Tests: below; properties `finite_plant`, `refusal`; case "step, ramp, table, delay, saturation".

use crate::error::{ParamError, above, check, finite};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, SMALLEST_PARAM};

/// What follows the last point of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum AtEnd {
    /// The last value stays.
    #[default]
    Hold,
    /// It begins again: the last point is the first of the next round.
    Repeat,
}

/// Parameters of a table: the points stay where they are, in flash for instance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TimeTableParams<'a> {
    /// Points (time \[s\], value): two at least, each 1e-12 s or more after the one before.
    pub points: &'a [(Real, Real)],
    /// What follows the last point.
    pub at_end: AtEnd,
}

/// The polyline through points over time. It starts at the first point, whatever its time.
///
/// `step` says the value at the current instant, then moves on by one step; one division, and
/// no search. It knows the segment and the time within it, so that time stays exact however long
/// the table is.
///
/// ```
/// use plant_core::signal::sources::{AtEnd, TimeTable, TimeTableParams, TimeTableState};
/// use plant_core::{Dt, must};
///
/// const POINTS: &[(f32, f32)] = &[(0.0, 0.0), (4.0, 10.0), (6.0, 10.0)];
/// const CYCLE: TimeTable = must!(TimeTable::new(
///     TimeTableParams { points: POINTS, at_end: AtEnd::Hold },
///     must!(Dt::from_s(1.0)),
/// ));
///
/// let mut state = TimeTableState::default();
/// let speeds = [(); 6].map(|()| CYCLE.step(&mut state, ()).value);
/// assert_eq!(speeds, [0.0, 2.5, 5.0, 7.5, 10.0, 10.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeTable<'a> {
    points: &'a [(Real, Real)],
    at_end: AtEnd,
    last_value: Real,
    dt_s: Real,
}

/// The state of a [`TimeTable`]; at its first point by default. It belongs to that table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TimeTableState {
    /// The point that the present segment begins with.
    pub segment: usize,
    /// Time within the segment \[s\].
    pub elapsed_s: Accum,
}

/// Output of one step of a [`TimeTable`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TimeTableOutput {
    /// The value now.
    pub value: Real,
    /// How fast it changes from here on \[1/s\]; zero where the last value holds.
    pub rate_per_s: Real,
    /// The last point has been reached, and its value holds. Never in a table that repeats.
    pub ended: bool,
}

impl<'a> TimeTable<'a> {
    /// Checks `params`, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError::NotIncreasing`] for the times, [`ParamError::NotFinite`] for the values,
    /// [`ParamError::NotAbove`] where a table that repeats is shorter than a step.
    pub const fn new(params: TimeTableParams<'a>, dt: Dt) -> Result<Self, ParamError> {
        let TimeTableParams { points, at_end } = params;
        let ([(first_s, _), .., (last_s, last_value)], true) = (points, times_increase(points))
        else {
            return Err(ParamError::NotIncreasing("table.time_s"));
        };
        let mut i = 0;
        while i < points.len() {
            check!(finite("table.value", points[i].1));
            i += 1;
        }
        if matches!(at_end, AtEnd::Repeat) {
            check!(above("table.time_s", *last_s - *first_s, dt.s()));
        }
        Ok(Self { points, at_end, last_value: *last_value, dt_s: dt.s() })
    }

    /// The value now; then time moves on by one step.
    #[inline]
    pub fn step(&self, state: &mut TimeTableState, _input: ()) -> TimeTableOutput {
        let Some([(from_s, from), (to_s, to), ..]) = self.points.get(state.segment..) else {
            return TimeTableOutput { value: self.last_value, rate_per_s: 0.0, ended: true };
        };
        let rate_per_s = (to - from) / (to_s - from_s);
        let value = from + rate_per_s * state.elapsed_s.get();
        self.advance(state);
        TimeTableOutput { value, rate_per_s, ended: false }
    }

    /// Moves on by one step, past as many points as it takes.
    #[inline]
    fn advance(&self, state: &mut TimeTableState) {
        state.elapsed_s.add(self.dt_s);
        // A step passes each point once at most.
        for _ in self.points {
            let Some([(from_s, _), (to_s, _), rest @ ..]) = self.points.get(state.segment..) else {
                state.elapsed_s = Accum::new(0.0);
                return;
            };
            let length_s = to_s - from_s;
            if state.elapsed_s.since(Accum::new(length_s)) < 0.0 {
                return;
            }
            // The length off the larger part first: nothing that was kept back is lost.
            let kept_s = state.elapsed_s.since(Accum::new(state.elapsed_s.get()));
            state.elapsed_s = Accum::new(state.elapsed_s.get());
            state.elapsed_s.add(-length_s);
            state.elapsed_s.add(kept_s);
            let repeats = rest.is_empty() && self.at_end == AtEnd::Repeat;
            state.segment = if repeats { 0 } else { state.segment + 1 };
        }
    }
}

impl_model!(TimeTable<'_>, TimeTableState, (), TimeTableOutput);

/// Whether each time is a finite number and far enough after the one before to divide by.
const fn times_increase(points: &[(Real, Real)]) -> bool {
    let mut i = 0;
    while i < points.len() {
        let far_enough = i == 0 || points[i].0 - points[i - 1].0 >= SMALLEST_PARAM;
        if finite("table.time_s", points[i].0).is_err() || !far_enough {
            return false;
        }
        i += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const POINTS: [(Real, Real); 4] = [(10.0, 1.0), (11.0, 3.0), (11.5, 3.0), (13.5, -1.0)];

    fn table(points: &[(Real, Real)], at_end: AtEnd, dt_s: Real) -> TimeTable<'_> {
        TimeTable::new(TimeTableParams { points, at_end }, Dt::from_s(dt_s).unwrap()).unwrap()
    }

    fn run(t: &TimeTable<'_>, steps: usize) -> Vec<TimeTableOutput> {
        let mut s = TimeTableState::default();
        (0..steps).map(|_| t.step(&mut s, ())).collect()
    }

    /// The polyline by search, in f64: an independent method for the same values.
    fn exact(points: &[(Real, Real)], time_s: f64) -> f64 {
        let i = points.partition_point(|p| f64::from(p.0) <= time_s).clamp(1, points.len() - 1);
        let ((x0, y0), (x1, y1)) = (points[i - 1], points[i]);
        let along = (time_s - f64::from(x0)) / (f64::from(x1) - f64::from(x0));
        f64::from(y0) + along.clamp(0.0, 1.0) * (f64::from(y1) - f64::from(y0))
    }

    #[test]
    fn says_the_value_at_the_current_instant_and_holds_the_last() {
        let out = run(&table(&POINTS, AtEnd::Hold, 0.25), 20);
        let values: Vec<_> = out.iter().map(|o| o.value).collect();
        assert_eq!(
            values[..16],
            [1.0, 1.5, 2.0, 2.5, 3.0, 3.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0, -0.5, -1.0, -1.0]
        );
        let rates: Vec<_> = out.iter().map(|o| o.rate_per_s).collect();
        assert_eq!((rates[0], rates[3], rates[4], rates[6]), (2.0, 2.0, 0.0, -2.0));
        for (i, o) in out.iter().enumerate() {
            assert_eq!(o.ended, i >= 14);
            assert!(!o.ended || (o.rate_per_s == 0.0 && o.value == -1.0));
        }
    }

    #[test]
    fn repeats_with_the_last_point_as_the_first() {
        let out = run(&table(&POINTS, AtEnd::Repeat, 0.25), 14 * 50);
        let once = run(&table(&POINTS, AtEnd::Hold, 0.25), 14);
        for (i, o) in out.iter().enumerate() {
            assert_eq!(*o, once[i % 14], "{i}");
        }
    }

    #[test]
    fn steps_longer_than_segments_skip_points() {
        let points: Vec<_> = (0..100).map(|i| (i as Real * 0.1, (i * i % 17) as Real)).collect();
        for dt_s in [0.033, 0.35, 2.3, 9.0] {
            let t = table(&points, AtEnd::Hold, dt_s);
            for (i, o) in run(&t, 400).iter().enumerate() {
                let expected = exact(&points, i as f64 * f64::from(dt_s));
                assert!((f64::from(o.value) - expected).abs() < 5e-4, "{dt_s} {i}: {o:?}");
            }
            let t = table(&points, AtEnd::Repeat, dt_s);
            let period = f64::from(points[99].0);
            for (i, o) in run(&t, 400).iter().enumerate() {
                let time_s = (i as f64 * f64::from(dt_s)) % period;
                let expected = exact(&points, time_s);
                // Rounding may put an instant at the seam on either side of it.
                let seam = time_s < 1e-6 || time_s > period - 1e-6;
                let close = (f64::from(o.value) - expected).abs() < 5e-4;
                assert!(close || seam, "{dt_s} {i}: {o:?} {expected}");
            }
        }
        let out = run(&table(&POINTS, AtEnd::Hold, 1e6), 3);
        assert_eq!((out[0].value, out[1].value, out[1].ended), (1.0, -1.0, true));
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn an_hour_at_a_millisecond_does_not_drift() {
        // A saw of 1 s segments, as a driving cycle has them.
        let points: Vec<_> =
            (0..=3602).map(|i| (i as Real, if i % 2 == 0 { 0.0 } else { 1.0 })).collect();
        for (points, at_end) in [(&points[..], AtEnd::Hold), (&points[..3], AtEnd::Repeat)] {
            let (t, mut s) = (table(points, at_end, 1e-3), TimeTableState::default());
            for _ in 0..3_600_500 {
                t.step(&mut s, ());
            }
            let out = t.step(&mut s, ());
            assert!((out.value - 0.5).abs() < 1e-3, "{out:?}");
            assert!((out.rate_per_s - 1.0).abs() < 1e-6 && !out.ended);
            // Against the step as `Real` has it, nothing but the last bits is off.
            let time_s = 3_600_500.0 * f64::from(t.dt_s) - 3600.0;
            assert!((f64::from(out.value) - time_s).abs() < 1e-6, "{out:?} against {time_s}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn short_segments_after_a_long_one_do_not_overshoot() {
        let points = [(0.0, 0.0), (1000.0, 0.0), (1000.001, 100.0), (1001.0, 100.0)];
        let (t, mut s) = (table(&points, AtEnd::Hold, 0.01), TimeTableState::default());
        for _ in 0..100_200 {
            let out = t.step(&mut s, ());
            assert!((0.0..=100.001).contains(&out.value), "{out:?}");
        }
        assert_eq!(t.step(&mut s, ()).value, 100.0);
    }

    #[test]
    fn a_state_of_a_longer_table_ends_instead_of_panicking() {
        for at_end in [AtEnd::Hold, AtEnd::Repeat] {
            for segment in [3, 4, usize::MAX] {
                let mut s = TimeTableState { segment, ..TimeTableState::default() };
                let out = table(&POINTS, at_end, 0.1).step(&mut s, ());
                assert!(out.ended && out.value == -1.0);
            }
        }
    }

    #[test]
    fn refuses_bad_points_by_name() {
        let refused = |points: &[(Real, Real)], at_end| {
            let dt = Dt::from_s(0.1).unwrap();
            TimeTable::new(TimeTableParams { points, at_end }, dt).unwrap_err()
        };
        let time = ParamError::NotIncreasing("table.time_s");
        assert_eq!(refused(&[], AtEnd::Hold), time);
        assert_eq!(refused(&[(0.0, 1.0)], AtEnd::Hold), time);
        assert_eq!(refused(&[(0.0, 1.0), (0.0, 2.0)], AtEnd::Hold), time);
        assert_eq!(refused(&[(0.0, 1.0), (1e-20, 2.0)], AtEnd::Hold), time);
        assert_eq!(refused(&[(0.0, 1.0), (2.0, 2.0), (1.0, 2.0)], AtEnd::Hold), time);
        for bad in [Real::NAN, Real::INFINITY, -1e13] {
            assert_eq!(refused(&[(bad, 1.0), (1.0, 2.0)], AtEnd::Hold), time);
            assert_eq!(refused(&[(0.0, 1.0), (bad, 2.0)], AtEnd::Hold), time);
            let value = ParamError::NotFinite("table.value");
            assert_eq!(refused(&[(0.0, bad), (1.0, 2.0)], AtEnd::Hold), value);
            assert_eq!(refused(&[(0.0, 1.0), (1.0, bad)], AtEnd::Hold), value);
        }
        let short = refused(&[(0.0, 1.0), (0.05, 2.0)], AtEnd::Repeat);
        assert_eq!(short, ParamError::NotAbove("table.time_s"));
    }
}
