//! Readings that have changed, read again.

use plant_core::Real;

use super::change::{AGAIN, CELLS_CHANGED, FRESH, SAME, TEMPERATURES_CHANGED, single};
use crate::{Measurements, Reading};

/// Bytes that are read one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye<'e> {
    pub bytes: &'e [u8],
}

impl<'e> Eye<'e> {
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*taken)
    }

    pub fn byte(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    pub fn slice(&mut self, length: usize) -> Option<&'e [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        Some(taken)
    }

    pub fn take_all<T: serde::Deserialize<'e>>(&mut self) -> Option<T> {
        let (value, rest) = postcard::take_from_bytes(self.bytes).ok()?;
        self.bytes = rest;
        Some(value)
    }
}

#[allow(clippy::cast_lossless, clippy::unnecessary_cast)]
pub(super) const fn real(bytes: [u8; 4]) -> Real {
    f32::from_le_bytes(bytes) as Real
}

fn take_reading(eye: &mut Eye, code: u8, reading: &mut Reading) -> Option<()> {
    match code & 3 {
        SAME => {}
        AGAIN => *reading = Reading::new(reading.value),
        FRESH => {
            let bits = i32::from_le_bytes(single(reading.value)).wrapping_add(eye.take_all()?);
            *reading = Reading::new(real(bits.to_le_bytes()));
        }
        _ => {
            let (value, age_s) = (real(eye.take()?), real(eye.take()?));
            *reading = Reading { value, age_s, valid: eye.byte()? != 0 };
        }
    }
    Some(())
}

fn take_many(eye: &mut Eye, readings: &mut [Reading]) -> Option<()> {
    for readings in readings.chunks_mut(4) {
        let codes = eye.byte()?;
        for (index, reading) in readings.iter_mut().enumerate() {
            take_reading(eye, codes >> (2 * index), reading)?;
        }
    }
    Some(())
}

/// Changes what a board has changed; `None` where the bytes end too soon.
pub(super) fn take<const CELLS: usize, const SENSORS: usize>(
    eye: &mut Eye,
    now: &mut Measurements<CELLS, SENSORS>,
) -> Option<()> {
    let codes = eye.byte()?;
    take_reading(eye, codes, &mut now.current_a)?;
    take_reading(eye, codes >> 2, &mut now.pack_v)?;
    take_reading(eye, codes >> 4, &mut now.link_v)?;
    if codes & CELLS_CHANGED != 0 {
        take_many(eye, &mut now.cell_v)?;
    }
    if codes & TEMPERATURES_CHANGED != 0 {
        take_many(eye, &mut now.temperature_c)?;
    }
    Some(())
}
