//! Readings that have changed, in few bytes; `eye` reads them.

use plant_core::Real;

use crate::{Measurements, Reading};

/// What has become of a reading, in two bits.
pub(super) const SAME: u8 = 0;
/// New, with the value of before.
pub(super) const AGAIN: u8 = 1;
/// New: how many numbers further its value is follows, one to five bytes.
pub(super) const FRESH: u8 = 2;
/// All of it follows: value, age, whether it is valid.
pub(super) const OTHER: u8 = 3;

/// In the byte of a call that reads, above current, pack and link: cells and temperatures follow.
pub(super) const CELLS_CHANGED: u8 = 1 << 6;
pub(super) const TEMPERATURES_CHANGED: u8 = 1 << 7;

/// Bytes that are written one after the other; what no longer fits is remembered.
#[derive(Debug)]
pub(super) struct Pen<'p> {
    pub bytes: &'p mut [u8],
    pub at: usize,
    pub full: bool,
}

impl Pen<'_> {
    pub fn put(&mut self, bytes: &[u8]) {
        match self.bytes.get_mut(self.at..).and_then(|rest| rest.get_mut(..bytes.len())) {
            Some(place) => {
                place.copy_from_slice(bytes);
                self.at += bytes.len();
            }
            None => self.full = true,
        }
    }

    /// A byte that is not known yet, and where it is.
    pub fn reserve(&mut self) -> usize {
        let at = self.at;
        self.put(&[0]);
        at
    }

    pub fn set(&mut self, at: usize, bits: u8) {
        if let Some(byte) = self.bytes.get_mut(at) {
            *byte |= bits;
        }
    }

    /// What `postcard` writes.
    pub fn put_all(&mut self, value: &impl serde::Serialize) {
        let rest = self.bytes.get_mut(self.at..).unwrap_or_default();
        match postcard::to_slice(value, rest) {
            Ok(written) => self.at += written.len(),
            Err(_) => self.full = true,
        }
    }
}

#[allow(clippy::cast_possible_truncation, clippy::unnecessary_cast)]
pub(super) const fn single(value: Real) -> [u8; 4] {
    (value as f32).to_le_bytes()
}

pub(super) const fn same(a: Real, b: Real) -> bool {
    a.to_bits() == b.to_bits()
}

/// Writes what has become of a reading, and says in two bits what that is.
fn put_reading(pen: &mut Pen, before: &Reading, now: &Reading) -> u8 {
    let unmoved = same(before.value, now.value);
    let fresh = now.valid && same(now.age_s, 0.0);
    if unmoved && same(before.age_s, now.age_s) && before.valid == now.valid {
        return SAME;
    }
    let [old, new] = [single(before.value), single(now.value)];
    if fresh && unmoved {
        AGAIN
    } else if fresh {
        // Numbers of one sign are in the order of their bits.
        pen.put_all(&i32::from_le_bytes(new).wrapping_sub(i32::from_le_bytes(old)));
        FRESH
    } else {
        pen.put(&new);
        pen.put(&single(now.age_s));
        pen.put(&[u8::from(now.valid)]);
        OTHER
    }
}

fn put_many(pen: &mut Pen, before: &[Reading], now: &[Reading]) -> bool {
    let from = pen.at;
    let mut changed = false;
    for (before, now) in before.chunks(4).zip(now.chunks(4)) {
        let at = pen.reserve();
        for (index, (before, now)) in before.iter().zip(now).enumerate() {
            let code = put_reading(pen, before, now);
            changed |= code != SAME;
            pen.set(at, code << (2 * index));
        }
    }
    if !changed {
        pen.at = from;
    }
    changed
}

/// Writes what a board has changed.
pub(super) fn put<const CELLS: usize, const SENSORS: usize>(
    pen: &mut Pen,
    before: &Measurements<CELLS, SENSORS>,
    now: &Measurements<CELLS, SENSORS>,
) {
    let at = pen.reserve();
    let scalars = [
        (&before.current_a, &now.current_a),
        (&before.pack_v, &now.pack_v),
        (&before.link_v, &now.link_v),
    ];
    for (index, (before, now)) in scalars.into_iter().enumerate() {
        let code = put_reading(pen, before, now);
        pen.set(at, code << (2 * index));
    }
    if put_many(pen, &before.cell_v, &now.cell_v) {
        pen.set(at, CELLS_CHANGED);
    }
    if put_many(pen, &before.temperature_c, &now.temperature_c) {
        pen.set(at, TEMPERATURES_CHANGED);
    }
}
