//! Time as loggers write it: seconds from anywhere, dates, clock times.

use jiff::Timestamp;
use jiff::civil::DateTime;

/// Nanoseconds in a second, in a day.
const SECOND_NS: i128 = 1_000_000_000;
const DAY_NS: i128 = 86_400 * SECOND_NS;

/// How the times of a file are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Number,
    Date,
    Clock,
}

impl Form {
    const fn name(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Date => "a date and time (ISO 8601)",
            Self::Clock => "a clock time (hours:minutes:seconds)",
        }
    }
}

/// Reads the times of a file, one after another.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    form: Option<Form>,
    /// The first date or clock time \[ns\].
    first_ns: i128,
    /// Midnights that were passed.
    days: i128,
    /// The time before: as it was written, its line, its value \[s\].
    before: Option<(String, usize, f64)>,
}

impl Clock {
    /// The next time \[s\]: from the first where it is a date or a clock time, and as it stands
    /// where it is a number.
    ///
    /// # Errors
    /// It is none, is written in another form than the first, or is before the last.
    pub(crate) fn read(
        &mut self,
        field: &str,
        number: Option<f64>,
        line: usize,
    ) -> Result<f64, String> {
        if field.is_empty() {
            return Err("Time is empty; expected a number".to_owned());
        }
        let (form, ns) = match (number, date_ns(field), clock_ns(field)) {
            (Some(number), ..) if number.is_finite() && number.abs() <= LARGEST_S => {
                (Form::Number, 0)
            }
            (Some(number), ..) if number.is_finite() => {
                return Err(format!("Time of {field}; expected -{LARGEST_S:e} to {LARGEST_S:e} s"));
            }
            (_, Some(ns), _) => (Form::Date, ns),
            (_, _, Some(ns)) => (Form::Clock, ns),
            _ => {
                return Err(format!(
                    "`{field}` for Time; expected a number, a date and time (ISO 8601) or \
                     hours:minutes:seconds"
                ));
            }
        };
        let first = *self.form.get_or_insert(form);
        if first != form {
            return Err(format!("`{field}` for Time; expected {}, as before it", first.name()));
        }
        if self.before.is_none() {
            self.first_ns = ns;
        }
        let mut time_s = seconds(ns + self.days * DAY_NS - self.first_ns);
        if form == Form::Number {
            time_s = number.unwrap_or(time_s);
        }
        let before = self.before.as_ref();
        if form == Form::Clock && before.is_some_and(|(.., s)| time_s < s - HALF_DAY_S) {
            self.days += 1;
            time_s = seconds(ns + self.days * DAY_NS - self.first_ns);
        }
        if let Some((text, at, before_s)) = before
            && time_s < *before_s
        {
            return Err(format!(
                "time does not rise: {field} after {text} in line {at}; a file holds one \
                 recording: cut it before this line"
            ));
        }
        self.before = Some((field.to_owned(), line, time_s));
        Ok(time_s)
    }

    /// What is worth a word.
    pub(crate) fn notes(&self) -> Option<String> {
        (self.days > 0).then(|| format!("the clock passes midnight {} times", self.days))
    }
}

/// Counts from the first.
pub(crate) fn count_from_first(times_s: &mut [f64]) {
    let Some(&first_s) = times_s.first() else { return };
    for time_s in times_s {
        *time_s = since(first_s, *time_s);
    }
}

/// No time is larger, in seconds since 1970 or since anything.
const LARGEST_S: f64 = 1e11;
/// A clock that falls by more has passed midnight.
const HALF_DAY_S: f64 = 43_200.0;

/// The time from the first, as precisely as both were written: decimals that a large number
/// cannot hold are rounded away, so that the same drive is the same wherever its time begins.
fn since(first_s: f64, time_s: f64) -> f64 {
    if first_s == 0.0 {
        return time_s;
    }
    let mut per_s = 1e9;
    while per_s > 1.0 && 4.0 * f64::EPSILON * time_s.abs().max(first_s.abs()) * per_s > 1.0 {
        per_s /= 10.0;
    }
    ((time_s - first_s) * per_s).round() / per_s
}

#[expect(clippy::cast_precision_loss, reason = "durations of a recording")]
fn seconds(ns: i128) -> f64 {
    ns as f64 / SECOND_NS as f64
}

fn date_ns(field: &str) -> Option<i128> {
    if !field.contains('-') && !field.contains('T') {
        return None;
    }
    if let Ok(stamp) = field.parse::<Timestamp>() {
        return Some(stamp.as_nanosecond());
    }
    let date: DateTime = field.parse().ok()?;
    let days = i128::from(date.date().duration_since(jiff::civil::date(1970, 1, 1)).as_hours());
    let time = date.time().duration_since(jiff::civil::time(0, 0, 0, 0)).as_nanos();
    Some(days * 3600 * SECOND_NS + time)
}

/// `hours:minutes:seconds`; a running time may have more than 24 hours, or days before it: `2d 03:00:00`.
fn clock_ns(field: &str) -> Option<i128> {
    let (days, clock) = match field.split_once("d ") {
        Some((days, clock)) => (days.trim().parse::<u32>().ok()?, clock.trim()),
        None => (0, field),
    };
    let mut parts = clock.split(':');
    let (hours, minutes, rest) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() {
        return None;
    }
    let whole = |text: &str, largest: i128| {
        let digits =
            !text.is_empty() && text.len() <= 6 && text.bytes().all(|b| b.is_ascii_digit());
        text.parse().ok().filter(|n: &i128| digits && *n <= largest)
    };
    let rest = rest.replace(',', ".");
    let (secs, decimals) = rest.split_once('.').unwrap_or((&rest, ""));
    if !decimals.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let decimals: String = decimals.chars().chain("000000000".chars()).take(9).collect();
    let hours = whole(hours, 999_999)? + 24 * i128::from(days);
    let minutes = hours * 60 + whole(minutes, 59)?;
    Some((minutes * 60 + whole(secs, 60)?) * SECOND_NS + decimals.parse::<i128>().ok()?)
}

/// What there is of `samples` lies on average here; none where there is nothing.
pub(crate) fn mean(samples: impl Iterator<Item = f64>) -> Option<f64> {
    let finite = samples.filter(|x| x.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Makes one row of those with the same time, the first column: the mean of each other. What was
/// done, in words.
pub(crate) fn merge_equal(columns: &mut [Vec<f64>]) -> Option<String> {
    let (times, rest) = columns.split_first_mut()?;
    let rows = times.len();
    if times.windows(2).all(|t| t[0] < t[1]) {
        return None;
    }
    let mut starts: Vec<usize> = (0..rows).filter(|&i| i == 0 || times[i] > times[i - 1]).collect();
    let kept = starts.len();
    starts.push(rows);
    for column in rest.iter_mut().filter(|column| column.len() == rows) {
        *column = starts
            .windows(2)
            .map(|run| mean(column[run[0]..run[1]].iter().copied()))
            .map(|mean| mean.unwrap_or(f64::NAN))
            .collect();
    }
    *times = starts[..kept].iter().map(|&i| times[i]).collect();
    let merged = rows - kept;
    let have = if merged == 1 { "sample has" } else { "samples have" };
    Some(format!("{merged} {have} the time of the one before: averaged with it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(fields: &[&str]) -> Result<Vec<f64>, String> {
        let mut clock = Clock::default();
        let times: Result<Vec<f64>, String> = fields
            .iter()
            .zip(2..)
            .map(|(field, line)| clock.read(field, field.parse().ok(), line))
            .collect();
        let mut times = times?;
        count_from_first(&mut times);
        Ok(times)
    }

    #[test]
    fn every_form_counts_from_its_first() {
        let expected = [0.0, 0.1, 0.2, 1.3];
        for fields in [
            ["0", "0.1", "0.2", "1.3"],
            ["700000.0", "700000.1", "700000.2", "700001.3"],
            ["1700000000.0", "1700000000.1", "1700000000.2", "1700000001.3"],
            ["-5", "-4.9", "-4.8", "-3.7"],
            [
                "2026-11-27T23:59:59.5Z",
                "2026-11-27T23:59:59.6Z",
                "2026-11-28T00:59:59.7+01:00",
                "2026-11-28T00:00:00.8Z",
            ],
            [
                "2026-11-27 23:59:59.5",
                "2026-11-27 23:59:59.6",
                "2026-11-27 23:59:59.7",
                "2026-11-28 00:00:00.8",
            ],
            ["23:59:59.5", "23:59:59.6", "23:59:59,7", "0:00:00.8"],
            ["27:00:00", "27:00:00.1", "27:00:00.2", "27:00:01.3"],
        ] {
            assert_eq!(read(&fields).unwrap(), expected, "{fields:?}");
        }
    }

    #[test]
    fn says_what_is_wrong_with_a_time() {
        let refused = |fields: &[&str]| read(fields).unwrap_err();
        assert!(refused(&["5", "6", "0"]).starts_with("time does not rise: 0 after 6 in line 3;"));
        assert!(refused(&["0", "10:00:00"]).contains("expected a number, as before it"));
        assert!(refused(&["10:00:05", "10:00:04"]).contains("does not rise"));
        assert!(refused(&["25.11.2026"]).contains("ISO 8601"));
        assert!(refused(&["10:61:00"]).contains("hours:minutes:seconds"));
        assert!(refused(&["1e12"]).contains("1e11"));
        assert!(refused(&["nan"]).starts_with("`nan` for Time"));
        assert!(refused(&[""]).contains("empty"));
    }

    #[test]
    fn rows_with_one_time_become_their_mean() {
        let mut columns =
            vec![vec![0.0, 1.0, 1.0, 2.0], vec![1.0, 2.0, 4.0, 5.0], vec![f64::NAN; 4], Vec::new()];
        let note = merge_equal(&mut columns).unwrap();
        assert_eq!((&columns[0], &columns[1]), (&vec![0.0, 1.0, 2.0], &vec![1.0, 3.0, 5.0]));
        assert!(columns[2].len() == 3 && columns[2][1].is_nan() && columns[3].is_empty());
        assert!(note.starts_with("1 sample has"), "{note}");
        assert_eq!(merge_equal(&mut columns), None);
    }
}
