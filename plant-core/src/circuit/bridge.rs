//! The branches of the bridges that drive machines.

use super::{Branch, Element};

/// The source of an H-bridge or a three-phase bridge: its plus is node 1, its minus the ground.
const SOURCE: Branch = Branch::new(1, 0, Element::Voltage);

/// An H-bridge on a source of voltage, with a load between the middles of its legs: four nodes.
///
/// | Element | What it is | From | To |
/// |---|---|---|---|
/// | 0 | source | 1 | 0 |
/// | 1, 2 | upper and lower switch of the first leg | 1, 2 | 2, 0 |
/// | 3, 4 | of the second | 1, 3 | 3, 0 |
/// | 5 | load | 2 | 3 |
#[must_use]
pub const fn h_bridge(switch: Element, load: Element) -> [Branch; 6] {
    [
        SOURCE,
        Branch::new(1, 2, switch),
        Branch::new(2, 0, switch),
        Branch::new(1, 3, switch),
        Branch::new(3, 0, switch),
        Branch::new(2, 3, load),
    ]
}

/// A three-phase bridge on a source of voltage, with a load in star whose middle is node 5: six nodes.
///
/// | Element | What it is | From | To |
/// |---|---|---|---|
/// | 0 | source | 1 | 0 |
/// | 1, 2 | upper and lower switch of leg a | 1, 2 | 2, 0 |
/// | 3, 4 | of leg b | 1, 3 | 3, 0 |
/// | 5, 6 | of leg c | 1, 4 | 4, 0 |
/// | 7, 8, 9 | phases a, b, c | 2, 3, 4 | 5 |
#[must_use]
pub const fn three_phase(switch: Element, phase: Element) -> [Branch; 10] {
    [
        SOURCE,
        Branch::new(1, 2, switch),
        Branch::new(2, 0, switch),
        Branch::new(1, 3, switch),
        Branch::new(3, 0, switch),
        Branch::new(1, 4, switch),
        Branch::new(4, 0, switch),
        Branch::new(2, 5, phase),
        Branch::new(3, 5, phase),
        Branch::new(4, 5, phase),
    ]
}
