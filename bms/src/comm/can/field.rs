//! Signals in the data of a frame.

use embedded_can::{Frame, Id, StandardId};
use plant_core::Real;
use plant_core::num::floor;

/// A frame's identifier and data, whatever type a driver has for it.
///
/// ```
/// # use embedded_can::{Frame, Id, StandardId};
/// # struct DriverFrame(Id, [u8; 8], usize);
/// # impl Frame for DriverFrame {
/// #     fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
/// #         let mut bytes = [0; 8];
/// #         bytes.get_mut(..data.len())?.copy_from_slice(data);
/// #         Some(Self(id.into(), bytes, data.len()))
/// #     }
/// #     fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> { None }
/// #     fn is_extended(&self) -> bool { false }
/// #     fn is_remote_frame(&self) -> bool { false }
/// #     fn id(&self) -> Id { self.0 }
/// #     fn dlc(&self) -> usize { self.2 }
/// #     fn data(&self) -> &[u8] { &self.1[..self.2] }
/// # }
/// use voltstep_bms::comm::can::{Message, Pack};
///
/// let pack = Pack { pack_v: 52.0, link_v: f32::NAN, current_a: -3.5 };
/// let frame: DriverFrame = pack.encode(4).frame().expect("eight bytes fit");
/// let heard = Pack::decode(&Message::of(&frame).expect("it has data")).expect("unharmed");
/// assert_eq!(heard.current_a, -3.5);
/// assert!(heard.link_v.is_nan());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Message {
    id: u16,
    length: usize,
    data: [u8; 8],
}

impl Message {
    /// One with an identifier of 11 bits and up to eight bytes; `None` where it cannot be.
    #[must_use]
    pub fn new(id: u16, data: &[u8]) -> Option<Self> {
        let id = StandardId::new(id)?.as_raw();
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self { id, length: data.len(), data: bytes })
    }

    /// As the frame of a driver; `None` where the driver refuses it.
    #[must_use]
    pub fn frame<F: Frame>(&self) -> Option<F> {
        F::new(StandardId::new(self.id)?, self.data())
    }

    /// That of a frame; `None` where the frame has an extended identifier, or no data.
    #[must_use]
    pub fn of<F: Frame>(frame: &F) -> Option<Self> {
        let Id::Standard(id) = frame.id() else { return None };
        if frame.is_remote_frame() {
            return None;
        }
        Self::new(id.as_raw(), frame.data())
    }

    /// The identifier, of 11 bits.
    #[must_use]
    pub const fn id(&self) -> u16 {
        self.id
    }

    /// The data.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        self.data.get(..self.length).unwrap_or_default()
    }

    /// The data as one number, the first byte lowest, where this is the message of that layout.
    pub(super) fn bits(&self, layout: &Layout) -> Option<u64> {
        (self.id == layout.id && self.length == layout.length)
            .then(|| u64::from_le_bytes(self.data))
    }
}

/// What follows an alive counter: 0 to 14, and again. 15 is none.
#[must_use]
pub const fn alive_after(alive: u8) -> u8 {
    if alive < 14 { alive + 1 } else { 0 }
}

/// Where the signals of a message lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub id: u16,
    pub length: usize,
    /// Under their names in the DBC.
    #[cfg_attr(not(test), allow(dead_code))]
    pub name: &'static str,
    #[cfg_attr(not(test), allow(dead_code))]
    pub fields: &'static [Field],
}

impl Layout {
    pub const fn message(&self, bits: u64) -> Message {
        Message { id: self.id, length: self.length, data: bits.to_le_bytes() }
    }
}

/// Where a value goes that lies between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rounding {
    Nearest,
    /// Never above: limits.
    Down,
}

/// One signal: value = factor · raw + offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    #[cfg_attr(not(test), allow(dead_code))]
    pub name: &'static str,
    pub start: u8,
    /// At most 24 where it is a value: a `Real` holds each raw number then.
    pub width: u8,
    pub signed: bool,
    pub factor: Real,
    pub offset: Real,
    pub rounding: Rounding,
    /// The bit that says whether it is there.
    pub valid: Option<u8>,
}

impl Field {
    /// A number.
    pub const fn raw(name: &'static str, start: u8, width: u8) -> Self {
        Self::value(name, start, width, 1.0, 0.0)
    }

    /// A value in a unit.
    pub const fn value(
        name: &'static str,
        start: u8,
        width: u8,
        factor: Real,
        offset: Real,
    ) -> Self {
        let rounding = Rounding::Nearest;
        Self { name, start, width, signed: false, factor, offset, rounding, valid: None }
    }

    pub const fn signed(self) -> Self {
        Self { signed: true, ..self }
    }

    pub const fn down(self) -> Self {
        Self { rounding: Rounding::Down, ..self }
    }

    pub const fn valid_at(self, bit: u8) -> Self {
        Self { valid: Some(bit), ..self }
    }

    const fn mask(&self) -> u64 {
        u64::MAX >> (64 - self.width)
    }

    /// The lowest and highest raw number that stand for a value.
    #[expect(clippy::cast_possible_truncation, reason = "values have at most 24 bits")]
    pub const fn range(&self) -> (i32, i32) {
        let all = self.mask() as i32;
        match (self.signed, self.valid) {
            (true, _) => (-(all / 2) - 1, all / 2),
            (false, None) => (0, all),
            (false, Some(_)) => (0, all - 1),
        }
    }

    /// `bits` with this raw number, cut to its width.
    pub const fn with_raw(&self, bits: u64, raw: u64) -> u64 {
        bits & !(self.mask() << self.start) | (raw & self.mask()) << self.start
    }

    pub const fn raw_of(&self, bits: u64) -> u64 {
        bits >> self.start & self.mask()
    }

    /// `bits` with a number, at most the largest that fits.
    pub fn with_number(&self, bits: u64, number: usize) -> u64 {
        let number = u64::try_from(number).unwrap_or(u64::MAX);
        self.with_raw(bits, number.min(self.mask()))
    }

    /// `bits` with the nearest value in range; NaN is missing, or the lowest where nothing can be.
    pub fn with(&self, bits: u64, value: Real) -> u64 {
        let (low, high) = self.range();
        if value.is_nan() {
            return match self.valid {
                Some(_) => self.with_raw(bits, self.mask()),
                None => self.with_raw(bits, bits_of(low)),
            };
        }
        #[expect(clippy::cast_possible_truncation, reason = "it saturates, and is in range then")]
        let nearest = floor((value - self.offset) / self.factor + 0.5) as i32;
        let above = self.rounding == Rounding::Down && self.physical(nearest) > value;
        // Not by `clamp`, which can panic.
        let raw = nearest.saturating_sub(i32::from(above)).max(low).min(high);
        let bits = self.with_raw(bits, bits_of(raw));
        self.valid.map_or(bits, |valid| bits | 1 << valid)
    }

    /// NaN where it is missing.
    pub fn of(&self, bits: u64) -> Real {
        let raw = self.raw_of(bits);
        let there = self.valid.is_none_or(|bit| bits >> bit & 1 == 1 && raw != self.mask());
        if there { self.physical(self.extended(raw)) } else { Real::NAN }
    }

    #[expect(clippy::cast_possible_truncation, reason = "values have at most 24 bits")]
    const fn extended(&self, raw: u64) -> i32 {
        let raw = raw as i32;
        if self.signed && raw > self.range().1 { raw - (1 << self.width) } else { raw }
    }

    // In f64 nothing is lost, and an expectation would be unfulfilled.
    #[allow(clippy::cast_precision_loss, reason = "values have at most 24 bits")]
    const fn physical(&self, raw: i32) -> Real {
        raw as Real * self.factor + self.offset
    }
}

/// The bits of a number, the sign's repeated above.
const fn bits_of(number: i32) -> u64 {
    (number as i64).cast_unsigned()
}
