//! What many rows come to.

use serde::ser::{Serialize, SerializeMap, Serializer};

/// Median, 90th percentile and largest magnitude of one figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The figure's name, with its unit.
    pub name: &'static str,
    /// Half lie below.
    pub median: f64,
    /// Nine in ten lie below.
    pub p90: f64,
    /// The worst.
    pub max: f64,
}

/// The spread of the magnitudes of a figure; those that are absent do not count, none where all
/// are.
pub fn spread(name: &'static str, values: impl Iterator<Item = Option<f64>>) -> Option<Spread> {
    let mut sizes: Vec<f64> = values.flatten().map(f64::abs).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let max = *sizes.last()?;
    Some(Spread { name, median: quantile(&sizes, 0.5), p90: quantile(&sizes, 0.9), max })
}

/// The quantile of sorted values, linear between two of them.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let place = share * (sorted.len() - 1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in the list"
    )]
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - place.floor()) * (sorted[above] - sorted[below])
}

/// The spreads of every figure over the rows that count.
#[derive(Clone, Debug, PartialEq)]
pub struct Spreads {
    /// How many rows count.
    pub count: usize,
    /// A spread for each figure that any row has.
    pub spreads: Vec<Spread>,
}

impl Spreads {
    /// The spread of a figure.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Spread> {
        self.spreads.iter().find(|s| s.name == name)
    }
}

/// One flat table: `count`, `name_median`, `name_p90`, `name_max`, …
impl Serialize for Spreads {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3 * self.spreads.len() + 1))?;
        map.serialize_entry("count", &self.count)?;
        for s in &self.spreads {
            for (suffix, value) in [("median", s.median), ("p90", s.p90), ("max", s.max)] {
                map.serialize_entry(&format!("{}_{suffix}", s.name), &value)?;
            }
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_quantiles_of_magnitudes() {
        let values = [Some(-11.0), Some(1.0), None, Some(2.0), Some(3.0), Some(-4.0)];
        let s = spread("x", values.into_iter()).unwrap();
        assert_eq!((s.median, s.max), (3.0, 11.0));
        assert!((s.p90 - 8.2).abs() < 1e-9, "{s:?}");
        assert!(spread("x", [None].into_iter()).is_none());
        let one = spread("x", [Some(5.0)].into_iter()).unwrap();
        assert_eq!((one.median, one.p90, one.max), (5.0, 5.0, 5.0));
        let summary = Spreads { count: 1, spreads: vec![one] };
        let text = serde_json::to_string(&summary).unwrap();
        assert_eq!(text, r#"{"count":1,"x_median":5.0,"x_p90":5.0,"x_max":5.0}"#);
        assert!(summary.get("x").is_some() && summary.get("y").is_none());
    }
}
