//! The driving cycles, as tables of time and speed.

use std::sync::LazyLock;

/// A cycle: its name, and its points (time \[s\], speed \[m/s\]) from 0 on.
pub struct Cycle {
    /// As in `voltstep replay`.
    pub name: &'static str,
    /// Its points.
    pub points: Vec<(f32, f32)>,
}

/// What is built in.
const FILES: [(&str, &str); 5] = [
    ("udds", include_str!("../../data/cycles/udds.csv")),
    ("hwfet", include_str!("../../data/cycles/hwfet.csv")),
    ("us06", include_str!("../../data/cycles/us06.csv")),
    ("wltc3b", include_str!("../../data/cycles/wltc3b.csv")),
    ("nedc", include_str!("../../data/cycles/nedc.csv")),
];

/// Every cycle; the first is that of the golden bits.
pub static CYCLES: LazyLock<Vec<Cycle>> =
    LazyLock::new(|| FILES.iter().map(|(name, csv)| Cycle { name, points: points(csv) }).collect());

/// The files are the project's own, and tests read each of their lines.
fn points(csv: &str) -> Vec<(f32, f32)> {
    let point = |line: &str| {
        let (time_s, speed_m_s) = line.split_once(',')?;
        Some((time_s.trim().parse().ok()?, speed_m_s.trim().parse().ok()?))
    };
    csv.lines().skip(1).filter_map(point).collect()
}

impl Cycle {
    /// How long it takes \[s\].
    #[must_use]
    pub fn duration_s(&self) -> f32 {
        self.points.last().map_or(0.0, |(time_s, _)| *time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_a_point_of_whole_seconds() {
        for ((name, csv), cycle) in FILES.iter().zip(&*CYCLES) {
            assert_eq!((cycle.name, cycle.points.len()), (*name, csv.lines().count() - 1));
            assert_eq!(cycle.points[0].0, 0.0, "{name}");
            assert!(cycle.points.iter().all(|(time_s, _)| time_s.fract() == 0.0), "{name}");
        }
        assert_eq!(CYCLES[0].points, voltstep_trace::CYCLE);
    }
}
