//! Tests of whole sheets.

use super::text;
use super::{Bar, Kind, Panel, Series, Sheet, render};

fn series(name: &str, kind: Kind, values: Vec<f64>) -> Series {
    Series::new(name, kind, values)
}

fn sheet(time_s: Vec<f64>, series: Vec<Series>) -> Sheet {
    Sheet {
        title: "Replay".to_owned(),
        subtitle: vec!["15.4 kWh/100 km".to_owned()],
        time_s,
        panels: vec![Panel { title: "Speed".to_owned(), unit: "km/h".to_owned(), series }],
        bars_title: "Energy".to_owned(),
        bars_unit: "kWh".to_owned(),
        bars: vec![
            Bar { name: "Drag".to_owned(), value: 1.2345 },
            Bar { name: "Recuperated".to_owned(), value: -0.5 },
        ],
    }
}

fn seconds(count: u32) -> Vec<f64> {
    (0..count).map(f64::from).collect()
}

/// Values without a pattern, from -0.5 to 0.5.
fn noise(count: usize) -> Vec<f64> {
    let mut state = 1_u32;
    let next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24) - 0.5
    };
    std::iter::repeat_with(next).take(count).collect()
}

/// Renders the sheet and checks that the text is well-formed: one root, all
/// elements closed, no bare ampersands, no numbers that are none.
fn checked(sheet: &Sheet) -> String {
    let svg = render(sheet).unwrap();
    assert!(svg.starts_with("<svg width=\"1200\" height=\""));
    assert!(svg.ends_with("</svg>\n"));
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap();
        let name = tag.split([' ', '/']).find(|part| !part.is_empty()).unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else {
            assert_eq!(tag.matches('"').count() % 2, 0);
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty());
    for entity in svg.split('&').skip(1) {
        let (entity, _) = entity.split_once(';').unwrap();
        assert!(["amp", "lt", "gt", "quot", "apos"].contains(&entity));
    }
    assert!(!svg.contains("NaN") && !svg.contains(&i32::MAX.to_string()));
    svg
}

/// The points of the traces: polylines that are neither axis nor grid.
fn traces(svg: &str, color: &str) -> Vec<Vec<(i32, i32)>> {
    svg.lines()
        .filter(|line| line.starts_with("<polyline") && line.contains(color))
        .map(|line| {
            let (_, points) = line.split_once("points=\"").unwrap();
            let (points, _) = points.split_once('"').unwrap();
            points
                .split_whitespace()
                .map(|point| {
                    let (x, y) = point.split_once(',').unwrap();
                    (x.parse().unwrap(), y.parse().unwrap())
                })
                .collect()
        })
        .collect()
}

const BLUE: &str = "#0072B2";

#[test]
fn normal_sheet() {
    let speed: Vec<f64> = seconds(600).iter().map(|t| (t / 50.0).sin() * 40.0 + 40.0).collect();
    let all = vec![
        series("simulated", Kind::Simulated, speed.clone()),
        series("measured", Kind::Measured, speed.clone()),
        series("reference", Kind::Reference, speed),
    ];
    let sheet = sheet(seconds(600), all);
    let svg = checked(&sheet);
    let texts = ["Speed (km/h)", "reference", "Time (s)", "1.23 kWh", "−0.500 kWh"];
    for text in texts {
        assert!(svg.contains(text), "{text}");
    }
    assert_eq!(svg, render(&sheet).unwrap());
    // The reference lies behind the measured trace, that behind the simulated.
    let last = |color| svg.rfind(&format!("stroke=\"{color}\" stroke-width")).unwrap();
    assert!(last("#E69F00") < last(BLUE) && last("#B4B4B4") < last("#E69F00"));
}

#[test]
fn constant_data() {
    for value in [0.0, 42.0, -1e-300, 1e99, -5e-9] {
        let svg = checked(&sheet(
            seconds(50),
            vec![series("constant", Kind::Simulated, vec![value; 50])],
        ));
        // The sample in the legend and the trace, a level line across the plot.
        let traces = traces(&svg, BLUE);
        assert_eq!(traces.len(), 2);
        assert!(traces.iter().all(|line| matches!(line[..], [(a, y), (b, z)] if a < b && y == z)));
    }
}

#[test]
fn no_data() {
    let none = [f64::NAN, f64::INFINITY, f64::MAX];
    let all = vec![
        series("empty", Kind::Simulated, Vec::new()),
        series("missing", Kind::Measured, (0..60).map(|i| none[i % 3]).collect()),
    ];
    let svg = checked(&sheet(seconds(60), all.clone()));
    assert!(svg.contains("empty (no data)") && svg.contains("missing (no data)"));
    checked(&sheet(vec![f64::NAN; 60], all));
    checked(&sheet(Vec::new(), Vec::new()));
    checked(&sheet(vec![3.0], vec![series("one", Kind::Simulated, vec![1.0])]));
    let mut bare = sheet(Vec::new(), Vec::new());
    bare.panels.clear();
    bare.bars.clear();
    bare.subtitle.clear();
    checked(&bare);
    bare.bars = vec![Bar { name: "lost".to_owned(), value: f64::NAN }];
    assert!(checked(&bare).contains("n/a kWh"));
}

#[test]
fn line_breaks_at_missing_samples() {
    let mut values = vec![1.0; 100];
    values[30..40].fill(f64::NAN);
    values[70] = f64::NAN;
    let svg = checked(&sheet(seconds(100), vec![series("a", Kind::Simulated, values)]));
    assert_eq!(traces(&svg, BLUE).len(), 4);
}

#[test]
fn long_noisy_replay_stays_small_and_keeps_its_peak() {
    let count = 200_000;
    let time_s: Vec<f64> = seconds(count).iter().map(|i| i / 100.0).collect();
    let mut values = noise(time_s.len());
    values[123_456] = 25.0;
    let kinds = [Kind::Simulated, Kind::Measured];
    let mut sheet = sheet(time_s, kinds.map(|kind| series("a", kind, values.clone())).into());
    let panel = sheet.panels[0].clone();
    sheet.panels = vec![panel; 5];
    let svg = checked(&sheet);
    assert!(svg.len() < 500_000, "{} bytes", svg.len());

    let lines = traces(&svg, BLUE);
    let longest = lines.iter().max_by_key(|line| line.len()).unwrap();
    let peak = longest.iter().min_by_key(|point| point.1).unwrap();
    // 1234.56 s of 1999.99 s; four units to a pixel, 1100 px from 72 px on.
    assert!((peak.0 - (72 * 4 + 2716)).abs() <= 1, "{peak:?}");
    let next = longest.iter().filter(|point| *point != peak).map(|point| point.1).min().unwrap();
    assert!(next - peak.1 > 400);
    assert!(longest.len() > 2000);
}

#[test]
fn what_happened_between_two_samples_is_drawn() {
    let values: Vec<f64> = seconds(10).iter().map(|t| t / 10.0).collect();
    let mut spiked = series("a", Kind::Simulated, values.clone());
    spiked.extremes = values.iter().map(|v| (*v, *v)).collect();
    spiked.extremes[5] = (-40.0, 60.0);
    let svg = checked(&sheet(seconds(10), vec![spiked.clone()]));
    let lines = traces(&svg, BLUE);
    let longest = lines.iter().max_by_key(|line| line.len()).unwrap();
    let lowest = longest.iter().max_by_key(|point| point.1).unwrap();
    let highest = longest.iter().min_by_key(|point| point.1).unwrap();
    // 100 of the range from -40 to 60 on 144 px, four units to a pixel.
    assert!(lowest.1 - highest.1 > 480, "{lowest:?} {highest:?}");
    // Both lie between the samples at 4 s and 5 s: 1100 px for 9 s from 72 px on.
    for (x, _) in [lowest, highest] {
        assert!((4 * (72 + 488)..4 * (72 + 612)).contains(x), "{x}");
    }
    spiked.extremes.pop();
    let error = render(&sheet(seconds(10), vec![spiked])).unwrap_err().to_string();
    assert_eq!(error, "series `a` of panel `Speed` has 9 extremes for 10 values");
}

#[test]
fn many_gaps_stay_small() {
    let mut values = noise(1200);
    values.iter_mut().step_by(2).for_each(|value| *value = f64::NAN);
    let all = vec![series("a", Kind::Simulated, values); 4];
    let mut sheet = sheet(seconds(1200), all);
    sheet.panels = vec![sheet.panels[0].clone(); 8];
    assert!(checked(&sheet).len() < 500_000);
}

#[test]
fn hours_are_shown_in_minutes() {
    let time_s: Vec<f64> = seconds(7200);
    let values = time_s.clone();
    let svg = checked(&sheet(time_s, vec![series("a", Kind::Simulated, values)]));
    assert!(svg.contains("Time (min)") && !svg.contains("Time (s)"));
}

#[test]
fn titles_are_escaped_and_cut() {
    let mut sheet = sheet(seconds(3), vec![series("<&>\u{1}", Kind::Measured, vec![0.0; 3])]);
    sheet.title = format!("a <b> & \"c\"\n{}", "very long ".repeat(50));
    sheet.panels[0].title = "x ".repeat(200);
    sheet.bars[0].name = "&amp;".repeat(40);
    let svg = checked(&sheet);
    assert!(svg.contains("a &lt;b&gt; &amp; &quot;c&quot; very"));
    assert!(svg.contains("…") && svg.contains("… (km/h)"));
    assert!(!svg.contains('\u{1}'));
}

#[test]
fn lengths_must_agree() {
    let error = render(&sheet(seconds(3), vec![series("a", Kind::Simulated, vec![0.0; 4])]));
    assert_eq!(
        error.unwrap_err().to_string(),
        "series `a` of panel `Speed` has 4 values for 3 sample times"
    );
}

#[test]
fn three_significant_digits() {
    let cases = [
        (0.0, "0"),
        (9.999, "10.0"),
        (999.6, "1000"),
        (12_345.0, "12300"),
        (-1.1, "−1.10"),
        (0.012_34, "0.0123"),
        (1.234e-7, "1.23e−7"),
        (f64::NAN, "n/a"),
    ];
    for (value, expected) in cases {
        assert_eq!(text::three_digits(value), expected);
    }
}

#[test]
fn wrapped_lines_fit_and_keep_all_words() {
    let line = "SOC 80.0 % · ".repeat(30);
    let line = line.trim_end();
    let lines = text::wrap(line, 13.0, 300.0);
    assert!(lines.len() > 1);
    assert!(lines.iter().all(|line| text::width(line, 13.0) <= 300.0));
    assert_eq!(lines.join(" "), line);
}
