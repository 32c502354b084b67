//! Tests of reading trips.

#![expect(clippy::cast_precision_loss, reason = "counts are small")]

use std::path::Path;
use std::time::Instant;

use super::*;
use crate::read::error::InputError;
use crate::read::input;

const HEADER: &str = "Time [s];Velocity [km/h];Elevation [m];Motor Torque [Nm];Battery Voltage [V];\
                      Battery Current [A];Battery Temperature [°C];SoC [%];Heating Power CAN [kW];\
                      AirCon Power [kW];Ambient Temperature [°C]\r\n";

fn trip(rows: &str) -> Result<Trip, InputError> {
    parse("some/where/t.csv", format!("{HEADER}{rows}").as_bytes())
}

fn refused(bytes: &[u8]) -> String {
    parse("t.csv", bytes).unwrap_err().to_string()
}

/// A second row with one bad field after a good first row.
fn refused_row(row: &str) -> String {
    refused(format!("{HEADER}0;0;5;0;390;-2;20;80;0;0;20\r\n{row}\r\n").as_bytes())
}

#[test]
fn reads_every_quantity_in_si_units() {
    let t = trip("0;36;500;10;390.5;-20.5;21;80.5;1.5;0.5;18.5\n0.1;36;501;-5;391;8;21;;;0.5;18")
        .unwrap();
    assert_eq!(t.name, "t");
    assert_eq!((t.time_s, t.elevation_m), (vec![0.0, 0.1], vec![500.0, 501.0]));
    assert_eq!((t.battery_v, t.battery_a), (vec![390.5, 391.0], vec![20.5, -8.0]));
    assert_eq!((t.motor_torque_nm, t.battery_c), (vec![10.0, -5.0], vec![21.0, 21.0]));
    assert_eq!((t.aircon_w, t.ambient_c), (vec![500.0, 500.0], vec![18.5, 18.0]));
    assert!((t.speed_m_s[0] - 10.0).abs() < 1e-12 && (t.soc[0] - 0.805).abs() < 1e-12);
    assert!(t.heating_w[0] == 1500.0 && t.heating_w[1].is_nan() && t.soc[1].is_nan());
    assert!(t.notes.is_empty());
}

#[test]
fn units_separators_and_decimal_commas_do_not_matter() {
    let expected =
        trip("0;36;500;10;390.5;-20.5;21;80.5;1.5;0.5;18.5\n1;36;501;;391;8;21;;;0.5;18").unwrap();
    let header = HEADER.trim_end();
    let comma = "0;36;500;10;390,5;-20,5;21;80,5;1,5;0,5;18,5\n1;36;501;;391;8;21;;;0,5;18";
    let metric = header.replace("[km/h]", "[m/s]").replace("Current [A]", "Current [mA]");
    let metric = metric.replace("Voltage [V]", "Voltage [mV]").replace("CAN [kW]", "CAN [W]");
    let metric = metric.replace("SoC [%]", "SoC [ratio]").replace("Time [s]", "Time [min]");
    let metric_rows = "10;10;500;10;390500;-20500;21;0.805;1500;0.5;18.5\n\
        10.016666666666667;10;501;;391000;8000;21;;;0.5;18";
    for text in [
        format!("{header}\n{comma}"),
        format!("{header};;\n{comma}").replace('\n', ";;\r\n").replace(";;;;", ";;"),
        format!("{header}\n{comma}").replace(';', "\t"),
        format!("{metric}\n{metric_rows}"),
    ] {
        let mut found =
            parse("some/where/t.csv", text.as_bytes()).map_err(|e| format!("{text}: {e}")).unwrap();
        for (a, b) in [
            (&mut found.time_s, &expected.time_s),
            (&mut found.speed_m_s, &expected.speed_m_s),
            (&mut found.battery_v, &expected.battery_v),
            (&mut found.battery_a, &expected.battery_a),
            (&mut found.heating_w, &expected.heating_w),
            (&mut found.soc, &expected.soc),
        ] {
            assert!(
                a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 || (a.is_nan() && b.is_nan())),
                "{text}: {a:?} {b:?}"
            );
        }
    }
    let unknown = refused(header.replace("[km/h]", "[knots]").as_bytes());
    assert_eq!(
        unknown,
        "t.csv:1:10: unknown unit `knots` of column `Velocity [knots]`; expected m/s, km/h, mph"
    );
    let unknown = refused(header.replace("Power [kW]", "Power [BTU/h]").as_bytes());
    assert!(unknown.contains("unknown unit `BTU/h` of column `AirCon Power [BTU/h]`"), "{unknown}");
}

#[test]
fn what_is_missing_or_a_little_off_is_said() {
    let t = trip(
        "0;0;5;0;390;-2;;100.0017;0;0;20\n0;0;5;0;392;-2;;100.001;0;0;20\n5;0;5;0;390;-2;;98;0;0;20",
    )
    .unwrap();
    assert_eq!((t.time_s.as_slice(), t.battery_v[0]), (&[0.0, 5.0][..], 391.0));
    let said = t.notes.join("\n");
    for note in [
        "column `Battery Temperature [°C]` is empty",
        "1 sample has the time",
        "1 samples taken as",
    ] {
        assert!(said.contains(note), "{said}");
    }
}

#[test]
fn helpers_skip_what_is_missing() {
    let t = trip("10;36;0;;390;-20;;;1;-0.5;\n11;36;0;;390;-20;;60;;0.5;\n12;0;0;;390;-20;;59;;;\n13;0;0;;390;0;;;;;\n").unwrap();
    assert_eq!((t.len(), t.duration_s(), t.missing_soc()), (4, 3.0, 2));
    assert!((t.distance_km() - 0.015).abs() < 1e-12);
    assert_eq!((t.first_soc(), t.last_soc()), (Some(0.6), Some(0.59)));
    assert_eq!([0, 1, 2, 9].map(|i| t.auxiliary_w(i)), [1000.0, 500.0, 0.0, 0.0]);
    assert!(Trip::empty("e", 0).is_empty() && Trip::empty("e", 0).duration_s() == 0.0);
}

#[test]
fn finds_columns_by_name_in_any_order_and_encoding() {
    let rows = "\n90;0;380;-1;5;9;7\n\n\r\n91;0.5;380;-1;5;9;7\n";
    let header = "soc [%); TIME ;Battery Voltage [V];battery current [A]]];Velocity [km/h]]];Elevation;Time [min]";
    for text in [
        format!("{header}{rows}").into_bytes(),
        format!("\u{feff}{header}{rows}").into_bytes(),
        format!("{header}{rows}").replace('\n', "\r\n").into_bytes(),
        [header.as_bytes(), b";Extra [\xb0C]", rows.replace(";7", ";7;").as_bytes()].concat(),
        format!("{header};Extra [°C]{}", rows.replace(";7", ";7;")).into_bytes(),
    ] {
        let t = parse("t.csv", &text).unwrap();
        assert_eq!(
            (t.time_s, t.elevation_m, t.battery_a),
            (vec![0.0, 0.5], vec![9.0; 2], vec![1.0; 2])
        );
        assert_eq!((t.heating_w, t.aircon_w), (vec![0.0; 2], vec![0.0; 2]));
        assert!(
            t.motor_torque_nm.iter().chain(&t.battery_c).chain(&t.ambient_c).all(|x| x.is_nan())
        );
        assert_eq!(t.notes.len(), 5, "{:?}", t.notes);
        assert_eq!(t.notes[0], "no column `Motor Torque [Nm]`");
        assert_eq!(t.notes[2], "no column `Heating Power CAN [kW]`, taken as 0");
    }
}

#[test]
fn names_line_and_column_of_each_error() {
    for (row, expected) in [
        ("1;x;5;0;390;-2;20;80;0;0;20", "t.csv:3:3: `x` for Velocity; expected a number"),
        ("1;0;5;0;39O;-2;20;80;0;0;20", "t.csv:3:9: `39O` for Battery Voltage; expected a number"),
        ("1;0;5;0;NaN;-2;20;80;0;0;20", "t.csv:3:9: `NaN` for Battery Voltage; expected a number"),
        (
            "1;0;5;0;9;-inf;20;80;0;0;20",
            "t.csv:3:11: `-inf` for Battery Current; expected a number",
        ),
        (
            "1;0;5;0;9;1e999;20;80;0;0;20",
            "t.csv:3:11: `1e999` for Battery Current; expected a number",
        ),
        ("1;0;5;0;9;2;20;inf;0;0;20", "t.csv:3:16: `inf` for SoC; expected a number"),
        (
            "0.5;0,1;5;0;9;2;20;0;0;0;20",
            "t.csv:3:5: `0,1` for Velocity; expected a number with a decimal point, as before it",
        ),
        ("1;;5;0;390;-2;20;80;0;0;20", "t.csv:3:3: Velocity is empty; expected a number"),
        ("1;0; ;0;390;-2;20;80;0;0;20", "t.csv:3:5: Elevation is empty; expected a number"),
        ("1;0;5;0;;-2;20;80;0;0;20", "t.csv:3:9: Battery Voltage is empty; expected a number"),
        ("1;0;5;0;9;;20;80;0;0;20", "t.csv:3:11: Battery Current is empty; expected a number"),
        (
            "1;-401;5;0;9;2;20;80;0;0;20",
            "t.csv:3:3: Velocity of -401 km/h; expected -400 to 400 km/h",
        ),
        (
            "1;0;5;0;2001;2;20;8;0;0;20",
            "t.csv:3:9: Battery Voltage of 2001 V; expected -2000 to 2000 V",
        ),
        (
            "1;0;5;0;9;5001;20;8;0;0;20",
            "t.csv:3:11: Battery Current of 5001 A; expected -5000 to 5000 A",
        ),
        ("1;0;5;0;9;2;20;105.1;0;0;20", "t.csv:3:16: SoC of 105.1 %; expected -5 to 105 %"),
        ("1;0;5;0;9;2;20;-5.1;0;0;20", "t.csv:3:16: SoC of -5.1 %; expected -5 to 105 %"),
        (
            "-2;0;5;0;9;2;20;80;0;0;20",
            "t.csv:3:1: time does not rise: -2 after 0 in line 2; a file holds one recording: cut it before this line",
        ),
        ("1;0;5", "t.csv:3:6: 3 fields; expected 11, as in the header"),
        ("1;0;5;0;9;2;20;80;0;0;20;7", "t.csv:3:26: 12 fields; expected 11, as in the header"),
        ("\n\r\n1;0;\u{b0};0;9;2;20;80;0;0;20", "t.csv:5:5: `°` for Elevation; expected a number"),
        (
            "\u{7f}\"\0;0;5;0;9;2;20;80;0;0;20",
            "t.csv:3:1: `\u{fffd}\"\u{fffd}` for Time; expected a number, a date and time (ISO 8601) or hours:minutes:seconds",
        ),
    ] {
        assert_eq!(refused_row(row), expected);
    }
    let latin = [HEADER.as_bytes(), b"1;0;\xe4\xb0;0;9;2;20;80;0;0;20"].concat();
    assert_eq!(refused(&latin), "t.csv:2:5: `ä°` for Elevation; expected a number");
    let long = format!("{};0;5;0;9;2;20;80;0;0;20", "x".repeat(99));
    assert_eq!(
        refused_row(&long),
        format!(
            "t.csv:3:1: `{}…` for Time; expected a number, a date and time (ISO 8601) or hours:minutes:seconds",
            "x".repeat(60)
        )
    );
}

#[test]
fn refuses_a_file_that_is_no_trip() {
    assert_eq!(refused(b""), "t.csv: the file is empty; expected a header and samples");
    assert_eq!(
        refused(b"\xef\xbb\xbf\r\n\n"),
        "t.csv: the file is empty; expected a header and samples"
    );
    assert_eq!(refused(b"\xff\xfeT\0"), "t.csv: UTF-16: save the file as UTF-8 or Latin-1");
    assert_eq!(refused(HEADER.as_bytes()), "t.csv: 0 samples; expected two at least");
    let one = format!("{HEADER}0;0;5;0;390;-2;20;80;0;0;20");
    assert_eq!(refused(one.as_bytes()), "t.csv: 1 samples; expected two at least");
    assert_eq!(
        refused(b"\ntime_s,speed_m_s\n0,0\n"),
        "t.csv:2:1: no column `Elevation [m]`; found `time_s`, `speed_m_s`"
    );
    assert_eq!(
        refused("Time [s];Velocity [km/h];max. SoC [%)\n".as_bytes()),
        "t.csv:1:1: no column `Elevation [m]`; found `Time`, `Velocity`, `max. SoC`"
    );
    let near = HEADER.replace("Battery Current", "Batery Current").replace("\r\n", ";a;b\r\n");
    assert_eq!(
        refused(near.as_bytes()),
        "t.csv:1:1: no column `Battery Current [A]`; found `Batery Current`"
    );
    let no_soc = HEADER.replace("SoC", "displayed SoC").replace("\r\n", ";a;b\r\n");
    assert_eq!(
        refused(no_soc.as_bytes()),
        "t.csv:1:1: no column `SoC [%]`; found none like it among 13 columns"
    );
    let missing = input::trip(Path::new("no/such.csv")).unwrap_err().to_string();
    assert!(missing.starts_with("no/such.csv: cannot read: "), "{missing}");
    let folder = std::env::temp_dir();
    assert!(input::trip(&folder).unwrap_err().message.starts_with("cannot read: "));
}

/// Any change of a few bytes gives a trip or an error.
#[test]
fn no_bytes_panic() {
    let good = format!("{HEADER}0;0;5;0;390;-2;20;80;0;0;20\r\n1;0;5;0;390;-2;20;80;0;0;20\r\n");
    let mut seed: u32 = 1;
    let mut next = move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as usize
    };
    for _ in 0..20_000 {
        let mut bytes = good.clone().into_bytes();
        for _ in 0..=next() % 4 {
            let at = next() % bytes.len();
            match next() % 4 {
                0 => bytes[at] = next().to_le_bytes()[0],
                1 => bytes.truncate(at + 1),
                2 => bytes.insert(at, b"\r\n;\0\"\xff9e-."[next() % 10]),
                _ => drop(bytes.remove(at.min(bytes.len() - 2).max(1) % bytes.len())),
            }
            if bytes.len() < 3 {
                bytes = good.clone().into_bytes();
            }
        }
        if let Ok(trip) = parse("t.csv", &bytes) {
            assert!(trip.soc.len() == trip.len() && trip.ambient_c.len() == trip.len());
            let _ = (trip.quirks(60.0), trip.distance_km(), trip.auxiliary_w(0));
        }
    }
}

#[test]
fn quirks_are_found_and_only_where_they_are() {
    let n = 4000;
    let clean = || {
        let time = |i: usize| i as f64 * 0.1;
        let a = |i: usize| if i.is_multiple_of(2) { 100.0 } else { 116.0 };
        Trip {
            time_s: (0..n).map(time).collect(),
            speed_m_s: vec![10.0; n],
            battery_v: vec![380.0; n],
            battery_a: (0..n).map(a).collect(),
            // 108 A on a battery of 60 Ah
            soc: (0..n).map(|i| 0.8 - 108.0 * time(i) / 3600.0 / 60.0).collect(),
            ..Trip::empty("t", n)
        }
    };
    assert!(clean().quirks(60.0).is_empty() && clean().quirks(52.5).is_empty());
    assert_eq!(clean().quirks(50.0).len(), 1);

    let mut t = clean();
    t.soc.iter_mut().for_each(|s| *s = 0.8 - 0.75 * (0.8 - *s));
    assert_eq!(
        t.quirks(60.0),
        ["SoC drop does not fit the ampere-hours: 15.0 points for 12.0 Ah (80 Ah per 100 %)"]
    );
    let mut t = clean();
    t.battery_a.iter_mut().for_each(|a| *a = -*a);
    assert!(
        t.quirks(60.0)[0].starts_with("the sign of the current is reversed"),
        "{:?}",
        t.quirks(60.0)
    );
    // What the current does without a reference beside it says nothing.
    let mut t = clean();
    t.soc[2000..].fill(f64::NAN);
    assert_eq!(t.quirks(60.0), ["2000 SoC samples missing"]);
    t.soc[1..].fill(f64::NAN);
    t.soc[2] = 0.7;
    assert_eq!(t.quirks(60.0)[0], "3998 SoC samples missing");
    assert!(t.quirks(60.0)[1].contains("10.0 points for 0.0 Ah"));

    let mut t = clean();
    t.battery_a.fill(108.0);
    t.time_s[3000..].iter_mut().for_each(|t| *t += 11.9);
    t.soc.fill(0.5);
    assert_eq!(t.quirks(60.0), ["time gap of 12 s at 299.9 s"]);
    for k in 0..8 {
        t.time_s[100 * (k + 1)..].iter_mut().for_each(|t| *t += 5.0);
    }
    assert_eq!((t.quirks(60.0).len(), t.quirks(60.0)[5].as_str()), (6, "4 time gaps more"));

    let mut t = clean();
    for i in 1000..2000 {
        t.battery_a[i] = 20.0 + 0.1 * i as f64;
    }
    let found = t.quirks(60.0);
    assert!(
        found[0]
            .starts_with("speed, voltage and current follow straight lines from 100 s to 199.9 s"),
        "{found:?}"
    );

    let mut t = clean();
    t.speed_m_s[..10].fill(0.0);
    t.battery_a[..10].fill(2.0);
    t.heating_w[..4].fill(5520.0);
    t.aircon_w[100] = -170.0;
    assert_eq!(
        t.quirks(60.0),
        [
            "heating or air conditioning below 0 in 1 sample, taken as 0",
            "heating and air conditioning exceed what the battery gives in 4 of 10 samples at standstill"
        ]
    );
}

/// The 28 real trips, where `VOLTSTEP_DATA` says they are.
#[test]
fn every_real_trip_is_read() {
    let Some(folder) = std::env::var_os("VOLTSTEP_DATA") else {
        println!("SKIPPED: the real trips are not part of the project; set VOLTSTEP_DATA");
        return;
    };
    let folder = Path::new(&folder).join("bmw-i3-trips");
    let entries = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path());
    let mut paths: Vec<_> = entries.filter(|p| p.extension().is_some_and(|e| e == "csv")).collect();
    paths.sort();
    assert_eq!(paths.len(), 28);
    let start = Instant::now();
    let trips: Vec<_> = paths.iter().map(|p| input::trip(p).unwrap()).collect();
    println!("28 files in {:.3} s", start.elapsed().as_secs_f64());
    assert_eq!(trips.iter().map(Trip::len).sum::<usize>(), 361_865);
    for t in &trips {
        let quirks = t.quirks(60.0);
        println!("{} {:.1} km {:.0} s {:?}", t.name, t.distance_km(), t.duration_s(), quirks);
        assert!(t.notes.is_empty() && (300.0..3000.0).contains(&t.duration_s()), "{}", t.name);
        assert!(t.battery_v.iter().all(|v| (300.0..400.0).contains(v)), "{}", t.name);
        assert!(t.first_soc() > t.last_soc() && t.distance_km() > 1.0, "{}", t.name);
        let bad_reference = quirks.iter().any(|q| q.contains("ampere-hours"));
        let filled_in = quirks.iter().any(|q| q.contains("straight lines"));
        assert_eq!((bad_reference, filled_in), (t.name == "TripB02", t.name == "TripB02"));
        assert_eq!(t.missing_soc() > 13, t.name == "TripB34");
    }
    let b34 = trips.iter().find(|t| t.name == "TripB34").unwrap();
    assert!(b34.quirks(60.0).contains(&"4407 SoC samples missing".to_owned()));
}
