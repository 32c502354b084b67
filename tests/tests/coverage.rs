//! Every public model of plant-core has a case in `voltstep validate`.

use std::collections::BTreeSet;
use std::path::Path;

/// The models that a source file ties to the trait `Model`.
fn models(source: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    // Unit tests tie nothing.
    let source = source.split("#[cfg(test)]").next().unwrap_or("");
    for after in source.split("impl_model!(").skip(1) {
        found.extend(name(after));
    }
    for after in source.split(" Model for ").skip(1) {
        found.extend(name(after));
    }
    // The sensors of one quantity come from one macro; its fourth word is the model.
    for call in source.split("\nsensor_of!(").skip(1) {
        found.extend(call.split(',').nth(3).and_then(|word| name(word.trim())));
    }
    found
}

/// The name that a text begins with; none where a macro's variable stands there.
fn name(text: &str) -> Option<String> {
    let name: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    name.starts_with(char::is_uppercase).then_some(name)
}

fn every_model(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            every_model(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.extend(models(&std::fs::read_to_string(&path).unwrap()));
        }
    }
}

/// The models without a case.
fn missing(models: &BTreeSet<String>) -> Vec<&str> {
    let covered: BTreeSet<&str> =
        voltstep::verify::covered().iter().flat_map(|c| c.models.iter().copied()).collect();
    models.iter().map(String::as_str).filter(|m| !covered.contains(m)).collect()
}

#[test]
fn every_public_model_has_a_case() {
    let mut models = BTreeSet::new();
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../plant-core/src");
    every_model(&sources, &mut models);
    for known in ["DcMotor", "Powertrain", "Driver", "VoltageSensor", "TimeTable", "RcBranch"] {
        assert!(models.contains(known), "{known} is not found among {models:?}");
    }
    assert_eq!(missing(&models), [""; 0], "models without a case in `voltstep validate`");

    // No case names a model that is not there.
    for case in voltstep::verify::covered() {
        for model in case.models {
            assert!(models.contains(*model), "{}: no model `{model}`", case.name);
        }
    }
}

#[test]
fn a_model_without_a_case_is_noticed() {
    let source = "impl_model!(Flywheel, (), f32, f32);\nimpl<L: Book> Model for Turbine<L> {\n\
                  impl_model!($sensor, (), $input, $output);\n\
                  sensor_of!(\"heat\", heat_w, \"W\", HeatSensor, HeatInput, HeatOutput);\n\
                  #[cfg(test)]\nmod tests { impl_model!(Fake, (), f32, f32); }";
    let models = models(source);
    assert_eq!(missing(&models), ["Flywheel", "HeatSensor", "Turbine"]);
}
