//! A [`SocTable`] in a file: a list of `[soc, value]` pairs.

use core::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Real, SOC_POINTS, SocTable};

/// Most pairs that a file may give.
const MOST_POINTS: usize = 257;
/// The table that parameters hold.
const FIELD: &str = "table";

/// The state of charge at a point of the grid.
#[expect(clippy::cast_precision_loss, reason = "at most 64")]
fn grid_soc(i: usize) -> Real {
    i as Real / (SOC_POINTS - 1) as Real
}

impl Serialize for SocTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut pairs = serializer.serialize_seq(Some(SOC_POINTS))?;
        for (i, value) in self.values().iter().enumerate() {
            pairs.serialize_element(&(grid_soc(i), *value))?;
        }
        pairs.end()
    }
}

impl<'de> Deserialize<'de> for SocTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Pairs)
    }
}

struct Pairs;

impl<'de> Visitor<'de> for Pairs {
    type Value = SocTable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of 2 to {MOST_POINTS} pairs [state of charge, value]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut pairs: A) -> Result<SocTable, A::Error> {
        let mut points: [(Real, Real); MOST_POINTS] = [(0.0, 0.0); MOST_POINTS];
        let mut length = 0;
        while let Some(pair) = pairs.next_element()? {
            let Some(point) = points.get_mut(length) else {
                return Err(A::Error::invalid_length(MOST_POINTS + 1, &self));
            };
            *point = pair;
            length += 1;
        }
        let (points, _) = points.split_at(length);
        on_grid(points)
            .map_or_else(
                || SocTable::from_points(FIELD, points),
                |values| SocTable::new(FIELD, values),
            )
            .map_err(A::Error::custom)
    }
}

/// The values of points that already lie on the grid: what was written is read back to the bit.
fn on_grid(points: &[(Real, Real)]) -> Option<[Real; SOC_POINTS]> {
    let mut values = [0.0; SOC_POINTS];
    if points.len() != SOC_POINTS {
        return None;
    }
    for (i, (value, point)) in values.iter_mut().zip(points).enumerate() {
        #[expect(clippy::float_cmp, reason = "exact in binary")]
        if point.0 != grid_soc(i) {
            return None;
        }
        *value = point.1;
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::format;
    use std::string::{String, ToString};
    use std::vec::Vec;

    use super::*;
    use crate::battery::OpenCircuit;

    fn read(json: &str) -> Result<SocTable, String> {
        serde_json::from_str(json).map_err(|e| e.to_string())
    }

    #[test]
    fn reads_pairs_as_points() {
        let points = [(0.0, 300.0), (0.25, 350.0), (1.0, 400.0)];
        let read = read("[[0, 300], [0.25, 350.0], [1, 400]]").unwrap();
        assert_eq!(read, SocTable::from_points("t", &points).unwrap());
    }

    #[test]
    fn reads_back_what_it_wrote_to_the_bit() {
        let mut values = [0.0; SOC_POINTS];
        for (i, value) in values.iter_mut().enumerate() {
            // Steep: read as a polyline, the points would not meet their own values.
            *value = 0.1 * (1.0 + grid_soc(i)) * if i % 2 == 0 { 1.0 } else { 1e6 };
        }
        let table = SocTable::new("t", values).unwrap();
        let json = serde_json::to_string(&table).unwrap();
        assert!(json.starts_with("[[0.0,0.1],[0.015625,"), "{json}");
        assert_eq!(read(&json).unwrap(), table);
    }

    #[test]
    fn is_one_shape_of_the_open_circuit_voltage() {
        let json = r#"{"table": [[0.0, 300.0], [1.0, 400.0]]}"#;
        let open_circuit: OpenCircuit = serde_json::from_str(json).unwrap();
        assert_eq!(open_circuit.at(0.5), 350.0);
    }

    #[test]
    fn reads_up_to_257_points() {
        let list = |n: usize| {
            let pairs: Vec<_> = (0..n).map(|i| format!("[{}, 1.0]", i as f64 / 300.0)).collect();
            format!("[{}]", pairs.join(","))
        };
        assert!(read(&list(2)).is_ok() && read(&list(257)).is_ok());
        let error = read(&list(258)).unwrap_err();
        assert!(error.contains("258") && error.contains("2 to 257 pairs"), "{error}");
    }

    #[test]
    fn refuses_what_is_no_table() {
        for json in ["[]", "[[0, 1]]", "[[0, 1], [0, 2]]", "[[1, 1], [0, 2]]"] {
            let error = read(json).unwrap_err();
            assert!(error.starts_with("table must have two"), "{error}");
        }
        for (json, expected) in [
            ("[[0, 1], [1, 1e13]]", "table must be finite"),
            ("[[0, 1], [1]]", "invalid length 1"),
            (r#"[[0, 1], [1, "x"]]"#, "invalid type: string"),
            ("3", "a list of 2 to 257 pairs [state of charge, value]"),
        ] {
            let error = read(json).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
    }
}
