//! The capacity: from a slow sweep of a cell, or from the drops of a vehicle's state of charge.

use crate::read::cell::CellRecord;
use crate::read::trip::Trip;

use super::series::emptied;

/// A value and its standard error; NaN where none is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// Slower than this share of the capacity an hour is slow.
const SLOW_PER_HOUR: f64 = 0.125;
/// A trip tells the capacity where its state of charge moves by this.
const TELLING_SOC: f64 = 0.02;

/// From the slow discharge of a full cell: the charge on the counter where it is empty. It is known
/// to one sample; evenly anywhere in it, that makes a third of its square.
pub fn of_sweep(record: &CellRecord) -> Option<Estimate> {
    let end = emptied(record);
    let value = record.discharged_ah[end];
    let slow = record.current_a[..=end].iter().all(|a| a.abs() <= SLOW_PER_HOUR * value);
    let is_full = record.discharged_ah[0] <= TELLING_SOC * value;
    let hours = record.sampling_s() / 3600.0;
    let sample_ah = hours * record.current_a[..=end].iter().copied().fold(0.0, f64::max);
    (slow && is_full && value > 0.0).then(|| Estimate { value, error: sample_ah / f64::sqrt(3.0) })
}

/// From the ampere-hours over the drop of the state of charge, both from the first to the last
/// sample that has one; by least squares over trips, with a delete-one jackknife.
pub fn of_trips(trips: &[Trip]) -> Option<Estimate> {
    let drops: Vec<(f64, f64)> = trips.iter().filter_map(drop).collect();
    let implied = |skip: usize| {
        let used = drops.iter().enumerate().filter(|(i, _)| *i != skip).map(|(_, d)| d);
        let (products, squares) =
            used.fold((0.0, 0.0), |(p, s), (soc, ah)| (p + soc * ah, s + soc * soc));
        products / squares
    };
    let value = implied(usize::MAX);
    if drops.len() < 3 || !(value.is_finite() && value > 0.0) {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let n = drops.len() as f64;
    let squares: f64 = (0..drops.len()).map(|i| (implied(i) - value).powi(2)).sum();
    Some(Estimate { value, error: ((n - 1.0) / n * squares).sqrt() })
}

/// The capacity that the middle one of the trips implies.
pub fn rough(trips: &[Trip]) -> Option<f64> {
    let mut implied: Vec<f64> =
        trips.iter().filter_map(drop).map(|(soc, ah)| ah / soc).filter(|q| *q > 0.0).collect();
    implied.sort_unstable_by(f64::total_cmp);
    implied.get(implied.len() / 2).copied()
}

/// Drop of the state of charge, and the ampere-hours meanwhile.
fn drop(trip: &Trip) -> Option<(f64, f64)> {
    let first = trip.soc.iter().position(|s| s.is_finite())?;
    let last = trip.soc.iter().rposition(|s| s.is_finite())?;
    let (t, a) = (&trip.time_s[first..=last], &trip.battery_a[first..=last]);
    let ah = t
        .windows(2)
        .zip(a.windows(2))
        .map(|(t, a)| 0.5 * (a[0] + a[1]) * (t[1] - t[0]) / 3600.0)
        .sum();
    let soc = trip.soc[first] - trip.soc[last];
    (soc.abs() >= TELLING_SOC).then_some((soc, ah))
}
