//! What vehicle or charger would draw.

use std::sync::Arc;

/// The current of a charger \[A\].
pub const CHARGER_A: f32 = 20.0;
/// A course's samples lie so far apart \[ms\].
pub const SAMPLE_MS: u32 = 100;

/// What would be drawn if nothing were limited, over time.
#[derive(Clone, Debug)]
pub enum Demand {
    /// Pulses and braking, over and over.
    Pulses,
    /// A constant current \[A\], positive when discharging.
    Constant(f32),
    /// A course from a time on \[ms\], a sample every [`SAMPLE_MS`], linear between them \[A\]; nothing
    /// before and after.
    Course(u32, Arc<[f32]>),
}

impl Demand {
    /// Of a charger, or of pulses.
    pub const fn of(charging: bool) -> Self {
        if charging { Self::Constant(-CHARGER_A) } else { Self::Pulses }
    }

    /// The current at a time \[A\].
    pub fn at(&self, ms: u32) -> f32 {
        const PULSES_A: [f32; 8] = [40.0, 0.0, 120.0, 60.0, -60.0, 20.0, 90.0, -30.0];
        match self {
            Self::Pulses => PULSES_A[(ms / 700) as usize % PULSES_A.len()],
            Self::Constant(current_a) => *current_a,
            Self::Course(from_ms, samples) => {
                let Some(since_ms) = ms.checked_sub(*from_ms) else { return 0.0 };
                let index = (since_ms / SAMPLE_MS) as usize;
                let sample = |at: usize| samples.get(at).copied().unwrap_or(0.0);
                #[expect(clippy::cast_precision_loss, reason = "below 100")]
                let share = (since_ms % SAMPLE_MS) as f32 / SAMPLE_MS as f32;
                sample(index) + share * (sample(index + 1) - sample(index))
            }
        }
    }

    /// A course of samples at times \[s\] that rise, from a time on \[ms\]; the currents times a factor.
    pub fn course(from_ms: u32, time_s: &[f64], current_a: &[f64], factor: f64) -> Self {
        let (Some(first_s), Some(last_s)) = (time_s.first(), time_s.last()) else {
            return Self::Constant(0.0);
        };
        let step_s = f64::from(SAMPLE_MS) / 1000.0;
        let (mut row, mut samples) = (0, Vec::new());
        for number in 0_u32.. {
            let now_s = first_s + f64::from(number) * step_s;
            if now_s > *last_s {
                break;
            }
            while time_s.get(row + 1).is_some_and(|next_s| *next_s <= now_s) {
                row += 1;
            }
            let next = (row + 1).min(time_s.len() - 1);
            let span_s = time_s[next] - time_s[row];
            let share = if span_s > 0.0 { (now_s - time_s[row]) / span_s } else { 0.0 };
            let drawn_a = current_a[row] + share * (current_a[next] - current_a[row]);
            #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
            samples.push((drawn_a * factor) as f32);
        }
        Self::Course(from_ms, samples.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_linear_between_its_samples_and_nothing_beyond() {
        let course = Demand::course(3000, &[5.0, 5.2, 6.2], &[0.0, 10.0, -10.0], 2.0);
        let at = |ms| course.at(ms);
        for (ms, current_a) in
            [(0, 0.0), (2999, 0.0), (3000, 0.0), (3050, 5.0), (3100, 10.0), (3200, 20.0)]
        {
            assert!((at(ms) - current_a).abs() < 1e-3, "{ms}: {}", at(ms));
        }
        assert!((at(3700)).abs() < 1e-3 && (at(4190) + 19.6).abs() < 0.1, "{}", at(4190));
        assert_eq!(at(4400), 0.0);
        assert_eq!(Demand::course(0, &[], &[], 1.0).at(0), 0.0);
    }
}
