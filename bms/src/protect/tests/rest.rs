//! Rows at rest are not judged, and it makes no difference.

use super::scene::{MSL, PACK, Scene, State, TABLE};
use crate::protect::{Faults, Flow, Id, Pace, Protection, ROWS, Row, Signals};
use crate::{Reading, Real};

/// Numbers that look random, the same each time.
struct Dice(u32);

impl Dice {
    fn below(&mut self, most: u32) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) % most
    }
}

/// Something that happens to a pack: a row's event, a value near a threshold, a reading that is missing.
fn happens(dice: &mut Dice, scene: &mut Scene, state: &mut State) {
    let one = |dice: &mut Dice| Id::at(u8::try_from(dice.below(84)).unwrap()).unwrap();
    match dice.below(6) {
        0 => *scene = Scene::healthy(),
        1 => scene.now.current_a.valid = dice.below(2) == 0,
        2 => {
            scene.now.cell_v[3] = if dice.below(2) == 0 { Reading::NONE } else { Reading::new(3.7) }
        }
        // Warm cells leave a share of the current.
        3 => {
            scene.now.temperature_c[1].value = [46.0, 50.0, 55.0][dice.below(3) as usize];
            scene.now.current_a.value = [70.0, 100.0, 130.0, -30.0][dice.below(4) as usize];
            scene.signals.second_current_a = scene.now.current_a.value;
        }
        4 => {
            let id = one(dice);
            scene.plant(id, state);
            // On either side of the threshold, by less than anybody could measure.
            let off = (dice.below(7) as Real - 3.0) * 1e-6;
            let current_a = TABLE.row(Id::Current(Flow::Charge, MSL));
            if dice.below(4) == 0 {
                scene.now.current_a.value = -current_a.threshold * (1.0 + off);
                scene.signals.second_current_a = scene.now.current_a.value;
            }
        }
        _ => {
            let id = one(dice);
            scene.plant(id, state);
        }
    }
}

fn same_as_all(pack: &Protection<14, 4>, seed: u32) -> u32 {
    let mut dice = Dice(seed);
    let mut scene = Scene::healthy();
    let (mut state, mut all) = (State::NEW, State::NEW);
    let mut trips = 0;
    for step in 0..20_000_u32 {
        if dice.below(60) == 0 {
            let mut other = state;
            happens(&mut dice, &mut scene, &mut other);
            (state.heat_a2s, all.heat_a2s) = (other.heat_a2s, other.heat_a2s);
        }
        let signals = Signals { wires_v: &scene.wires_v, ..scene.signals };
        let verdict = pack.step(&mut state, &scene.now, &signals);
        let judged = pack.step_with(&mut all, &scene.now, &signals, Faults::ALL);
        assert_eq!(verdict, judged, "seed {seed}, step {step}");
        trips += verdict.rose.iter().count();
    }
    u32::try_from(trips).unwrap()
}

#[test]
fn rows_at_rest_need_not_be_judged() {
    let trips: u32 = (0..20).map(|seed| same_as_all(&PACK, seed)).sum();
    assert!(trips > 1000, "{trips} trips alone");
}

#[test]
fn nor_where_rows_are_judged_at_another_pace() {
    let mut table = TABLE;
    for id in Id::ALL {
        let row = *table.row(id);
        table = table.with(Row { pace: Pace::Tick, ..row }).unwrap_or(table);
    }
    let moved = (0..ROWS).filter(|i| table.rows()[*i].pace != TABLE.rows()[*i].pace).count();
    assert!(moved > 5, "{moved}");
    let pack = Protection::new(&table).unwrap();
    let trips: u32 = (0..5).map(|seed| same_as_all(&pack, seed)).sum();
    assert!(trips > 500, "{trips} trips alone");
}
