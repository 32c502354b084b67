//! Files that appear whole or not at all.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use tempfile::NamedTempFile;

use crate::read::trip::Trip;
use crate::simulate::run::{Run, TraceRow};

/// Writes every file into `folder`: first all of them beside their places, then into place.
pub fn write_all(folder: &Path, files: &[(&str, Vec<u8>)]) -> anyhow::Result<()> {
    let context = || format!("writing into {}", folder.display());
    std::fs::create_dir_all(folder).with_context(context)?;
    // What would stop a later file must not leave an earlier one replaced.
    for path in files.iter().map(|(name, _)| folder.join(name)) {
        anyhow::ensure!(!path.is_dir(), "writing {}: it is a directory", path.display());
    }
    let mut ready = Vec::new();
    for (name, content) in files {
        let mut file = NamedTempFile::new_in(folder).with_context(context)?;
        file.write_all(content).with_context(context)?;
        readable_by_all(&file)?;
        ready.push((file, folder.join(name)));
    }
    for (file, path) in ready {
        let persisted = file.persist(&path).map_err(|e| e.error);
        persisted.with_context(|| format!("writing {}", path.display()))?;
    }
    Ok(())
}

/// A temporary file is private; what it becomes is an ordinary file.
fn readable_by_all(file: &NamedTempFile) -> anyhow::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    #[cfg(not(unix))]
    let _ = file;
    Ok(())
}

/// A column of the trace: its name and how to read it.
type Column = (&'static str, fn(&TraceRow) -> f64);

const COLUMNS: [Column; 12] = [
    ("time_s", |r| r.time_s),
    ("reference_m_s", |r| f64::from(r.reference_m_s)),
    ("speed_m_s", |r| f64::from(r.speed_m_s)),
    ("distance_m", |r| f64::from(r.distance_m)),
    ("slope_sin", |r| f64::from(r.slope_sin)),
    ("duty", |r| f64::from(r.duty)),
    ("motor_torque_nm", |r| f64::from(r.motor_torque_nm)),
    ("brake_n", |r| f64::from(r.brake_n)),
    ("motor_current_a", |r| f64::from(r.motor_current_a)),
    ("battery_current_a", |r| f64::from(r.battery_current_a)),
    ("battery_voltage_v", |r| f64::from(r.battery_voltage_v)),
    ("soc", |r| f64::from(r.soc)),
];

/// The trace as CSV; on trips with the measured values beside ours. A missing one is empty.
pub fn trace_csv(run: &Run, trip: Option<&Trip>) -> anyhow::Result<Vec<u8>> {
    let measured: Vec<(&str, &[f64])> = trip.map_or_else(Vec::new, |t| {
        vec![
            ("measured_motor_torque_nm", t.motor_torque_nm.as_slice()),
            ("measured_battery_current_a", &t.battery_a),
            ("measured_battery_voltage_v", &t.battery_v),
            ("measured_soc", &t.soc),
        ]
    });
    let mut csv = csv::Writer::from_writer(Vec::new());
    csv.write_record(COLUMNS.iter().map(|c| c.0).chain(measured.iter().map(|m| m.0)))?;
    for (i, row) in run.trace.iter().enumerate() {
        // Six significant digits at least, and no noise of the conversion from f32.
        let ours = COLUMNS.iter().map(|c| number(c.1(row)));
        let theirs = measured.iter().map(|m| number(m.1.get(i).copied().unwrap_or(f64::NAN)));
        csv.write_record(ours.chain(theirs))?;
    }
    csv.into_inner().map_err(|e| anyhow::anyhow!("writing the trace: {e}"))
}

#[expect(clippy::cast_possible_truncation, reason = "single precision is what was computed")]
fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    // As f32 the shortest text that reads back the same.
    let value = value as f32;
    let text = value.to_string();
    if text.len() > 12 { format!("{value:e}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_files_and_leaves_no_others() {
        let folder = tempfile::tempdir().unwrap();
        for text in ["one", "two"] {
            write_all(
                &folder.path().join("a/b"),
                &[("x.txt", text.into()), ("y.txt", b"y".into())],
            )
            .unwrap();
            let read = std::fs::read_to_string(folder.path().join("a/b/x.txt")).unwrap();
            assert_eq!(read, text);
        }
        assert_eq!(std::fs::read_dir(folder.path().join("a/b")).unwrap().count(), 2);
    }

    #[test]
    fn keeps_what_is_there_when_one_file_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        write_all(folder.path(), &[("x.txt", b"old".into())]).unwrap();
        let blocked = folder.path().join("x.txt/under-a-file");
        assert!(write_all(&blocked, &[("y.txt", b"new".into())]).is_err());
        std::fs::create_dir(folder.path().join("y.txt")).unwrap();
        let files = [("x.txt", b"new".to_vec()), ("y.txt", b"new".to_vec())];
        assert!(write_all(folder.path(), &files).is_err());
        assert_eq!(std::fs::read_to_string(folder.path().join("x.txt")).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn numbers_read_back() {
        for value in [0.0, 0.1, 389.25, -12.5, 1e-7, 123_456.7, -3.456_789e-4, 1e-30, 1e30] {
            let text = number(value);
            let back: f64 = text.parse().unwrap();
            assert!((back - value).abs() <= 1e-6 * value.abs(), "{value}: {text}");
        }
        assert_eq!(number(f64::NAN), "");
    }
}
