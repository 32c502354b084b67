//! The plant behind the book's live page, as WebAssembly: `page/live.js` calls what is exported here.
//!
//! A page asks for the [`catalogue`], begins a run and has it advance a stretch at a time, so that it can
//! give up one for a newer. Numbers go both ways as arguments; texts and rows lie in memory, at
//! [`text`] and [`rows`].
//!
//! The vehicle, the words of its state and their hash are those of the firmware's trace.

pub mod car;
pub mod cycle;
mod json;
pub mod run;

use std::cell::RefCell;

use plant_core::Dt;

use crate::car::{CARS, Knobs};
use crate::cycle::CYCLES;
use crate::run::Going;

/// What the page has asked for.
struct Page {
    run: Option<Box<dyn Going>>,
    text: String,
}

thread_local! {
    static PAGE: RefCell<Page> = const { RefCell::new(Page { run: None, text: String::new() }) };
}

/// Leaves a text for the page.
fn say(text: String) {
    PAGE.with_borrow_mut(|page| page.text = text);
}

/// Leaves what can be chosen as [`text`]: vehicles with their values, cycles with their duration.
#[unsafe(no_mangle)]
pub extern "C" fn catalogue() {
    let number = |value| json::number(f64::from(value));
    let cars = CARS.map(|car| {
        let sheet = car.sheet();
        let (what, celsius) = sheet.temperature.unwrap_or(("", f32::NAN));
        json::object(&[
            ("name", json::name(sheet.name)),
            ("mass_kg", number(sheet.mass_kg)),
            ("drag_coefficient", number(sheet.drag_coefficient)),
            ("capacity_ah", number(sheet.capacity_ah)),
            ("resistance_ohm", number(sheet.resistance_ohm)),
            ("warm", json::name(what)),
            ("temperature_c", number(celsius)),
        ])
    });
    let cycles: Vec<_> = (CYCLES.iter())
        .map(|cycle| {
            json::object(&[
                ("name", json::name(cycle.name)),
                ("duration_s", number(cycle.duration_s())),
            ])
        })
        .collect();
    say(json::object(&[("cars", json::list(&cars)), ("cycles", json::list(&cycles))]));
}

/// Begins a run of the vehicle and cycle with these numbers in the [`catalogue`], in steps of so many
/// milliseconds, of which a tenth of a second takes a whole number; the factors are those of
/// [`Knobs`]. 1, or 0 where it is refused: then [`text`] says why.
#[unsafe(no_mangle)]
pub extern "C" fn begin(
    car: u32,
    cycle: u32,
    step_ms: u32,
    mass: f32,
    drag: f32,
    capacity: f32,
    resistance: f32,
    temperature_c: f32,
) -> u32 {
    let knobs = Knobs { mass, drag, capacity, resistance, temperature_c };
    let run = run_of(car, cycle, step_ms, knobs);
    let begun = u32::from(run.is_ok());
    PAGE.with_borrow_mut(|page| match run {
        Ok(run) => page.run = Some(run),
        Err(text) => (page.run, page.text) = (None, text),
    });
    begun
}

fn run_of(car: u32, cycle: u32, step_ms: u32, knobs: Knobs) -> Result<Box<dyn Going>, String> {
    let (Some(car), Some(cycle)) = (CARS.get(car as usize), CYCLES.get(cycle as usize)) else {
        return Err("no such vehicle or cycle".to_owned());
    };
    if step_ms == 0 || !100_u32.is_multiple_of(step_ms) {
        return Err("the step must be a part of 100 ms".to_owned());
    }
    // In double precision, so that one millisecond is 1e-3 to the bit.
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let dt = Dt::from_s((f64::from(step_ms) * 1e-3) as f32);
    dt.and_then(|dt| car.set_out(knobs, cycle, dt))
        .map_err(|error| format!("{}: {}", error.field(), error.message()))
}

/// Drives on for so many rows: 0 on the way, 1 at the end of the cycle, 2 where the plant refused a step
/// or nothing was begun: then [`text`] says why.
#[unsafe(no_mangle)]
pub extern "C" fn advance(rows: u32) -> u32 {
    PAGE.with_borrow_mut(|page| {
        let advanced = match &mut page.run {
            Some(run) => run.advance(rows),
            None => Err("no run was begun".to_owned()),
        };
        advanced.map_or_else(
            |text| {
                page.text = text;
                2
            },
            u32::from,
        )
    })
}

/// Leaves what the run has come to as [`text`].
#[unsafe(no_mangle)]
pub extern "C" fn result() {
    PAGE.with_borrow_mut(|page| {
        page.text = page.run.as_ref().map_or_else(|| "null".to_owned(), |run| run.result());
    });
}

/// Where the last text lies, UTF-8.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    PAGE.with_borrow(|page| page.text.as_ptr())
}

/// How many bytes it has.
#[unsafe(no_mangle)]
pub extern "C" fn text_length() -> usize {
    PAGE.with_borrow(|page| page.text.len())
}

/// Where the rows so far lie: [`run::COLUMNS`] values each, [`run::ROWS_PER_S`] a second.
#[unsafe(no_mangle)]
pub extern "C" fn rows() -> *const f32 {
    PAGE.with_borrow(|page| page.run.as_ref().map_or(std::ptr::null(), |run| run.rows().as_ptr()))
}

/// How many values they have.
#[unsafe(no_mangle)]
pub extern "C" fn rows_length() -> usize {
    PAGE.with_borrow(|page| page.run.as_ref().map_or(0, |run| run.rows().len()))
}
