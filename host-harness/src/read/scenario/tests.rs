//! What a scenario's file may say.

use super::*;

const GOOD: &str = "[start]\nsoc = 0.5\ntemperature_c = 20\n[drive]\ncharge_a = 10\n";

fn with(fault: &str) -> String {
    format!("{GOOD}[[fault]]\n{fault}\n")
}

#[track_caller]
fn refused(text: &str) -> String {
    match parse("s.toml", text.as_bytes()) {
        Ok(scenario) => panic!("{scenario:?}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn faults_are_read_and_sorted() {
    let text = format!(
        "{}[[fault]]\nkind = \"cell-reads-high\"\nat_s = 1.5\nseverity = 1\ncell = 13\n",
        with("kind = \"crash\"\nat_s = 9")
    );
    let scenario = parse("a/s.toml", text.as_bytes()).unwrap();
    assert_eq!((scenario.name.as_str(), scenario.soc, scenario.temperature_c), ("s", 0.5, 20.0));
    assert!(matches!(scenario.course, Course::Charged(10.0)), "{:?}", scenario.course);
    let high = Planted { fault: Fault::CellReadsHigh, much: 0.02, from_ms: 1500, at: 13 };
    assert_eq!(scenario.planted, [high, Planted::new(Fault::Crash, 1.0, 9000)]);
    assert_eq!((high.place(), scenario.planted[1].place()), (Some(13), None));
}

#[test]
fn the_example_is_sound() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/scenarios/heated-cell.toml");
    let scenario = load(Path::new(path)).unwrap();
    assert_eq!(scenario.planted.len(), 2);
    assert_eq!(scenario.planted[1].much, Fault::CellHeated.severities()[2]);
    let Course::Driven(input::Drive::Cycle(cycle), vehicle) = scenario.course else { panic!() };
    assert_eq!((cycle.name.as_str(), vehicle.name.as_str()), ("udds", "bmw-i3-60ah"));
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let fault = |rest: &str| refused(&with(&format!("at_s = 1\n{rest}")));
    for (message, part) in [
        (refused("[start"), "s.toml:1:"),
        (refused("[start]\nsoc = 0.5\n"), "s.toml:1:2: missing key `temperature_c` in [start]"),
        (refused(&GOOD.replace("0.5", "1.5")), "s.toml:2:1: `soc` in [start] must lie in 0..1"),
        (refused(&GOOD.replace("= 20", "= nan")), "s.toml:3:1: `temperature_c` in [start] must"),
        (refused(&GOOD.replace("charge_a", "charge")), "s.toml:5:1: unknown key `charge`"),
        (refused(&GOOD.replace("= 10", "= 0")), "s.toml:5:1: `charge_a` in [drive] must be above"),
        (refused(&GOOD.replace("charge_a = 10", "")), "s.toml:4:2: `drive` needs `cycle`"),
        (refused(&format!("{GOOD}cycle = \"udds\"\n")), "`charge_a` in [drive] cannot stand"),
        (refused(&format!("{GOOD}vehicle = \"x\"\n")), "s.toml:6:1: `vehicle` in [drive] has no"),
        (refused(&format!("{GOOD}seconds = 0\n")), "s.toml:6:1: `seconds` in [drive] must lie"),
        (refused(&GOOD.replace("charge_a = 10", "cycle = \"udds\"")), "needs a `vehicle`"),
        (
            refused(&GOOD.replace("charge_a = 10", "cycle = \"uds\"\nvehicle = \"bmw-i3-60ah\"")),
            "s.toml:5:1: `cycle` in [drive] must be a file beside this one or built in (",
        ),
        (
            refused(&GOOD.replace("charge_a = 10", "cycle = \"udds\"\nvehicle = \"none\"")),
            "s.toml:6:1: `vehicle` in [drive] must be a file beside this one or built in (",
        ),
        (fault("kind = \"cell-heatd\""), "did you mean `cell-heated`?"),
        (fault("kind = \"crash\"\namount = 1"), "s.toml:9:1: `amount` in [fault] has no meaning"),
        (fault("kind = \"crash\"\nseverity = 1"), "`severity` in [fault] has no meaning"),
        (fault("kind = \"overload\"\namount = -1"), "`amount` in [fault] must be above 0"),
        (fault("kind = \"overload\"\nseverity = 5"), "`severity` in [fault] must lie in 1..4"),
        (fault("kind = \"overload\"\nseverity = 1\namount = 2"), "cannot stand beside `severity`"),
        (fault("kind = \"cell-stuck\"\ncell = 14"), "`cell` in [fault] must lie in 0..13"),
        (fault("kind = \"cell-stuck\"\nsensor = 1"), "`sensor` in [fault] has no meaning"),
        (refused(&with("kind = \"crash\"\nat_s = -1")), "`at_s` in [fault] must lie in 0..36000"),
        (
            refused(&with("kind = \"crash\"\nat_s = 1\n[[fault]]\nkind = \"crash\"\nat_s = 2")),
            "`kind` in [fault] stands twice in the same place",
        ),
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
}

#[test]
fn an_amount_is_as_severe_as_the_next_of_the_campaign() {
    assert_eq!([0.01, 0.02, 0.05, 9.0].map(|v| Fault::CellReadsHigh.severity_of(v)), [0, 0, 1, 3]);
    assert_eq!([900.0, 450.0, 100.0, 0.1].map(|v| Fault::Insulation.severity_of(v)), [0, 0, 2, 3]);
}
