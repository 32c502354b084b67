//! The memory that C owns, and the checks before it is touched.

use core::mem::MaybeUninit;

use crate::cars::{Cars, Trips};
use crate::params::VOLTSTEP_ABI;
use crate::status::VoltstepStatus;

/// Words (8 bytes) of a `VoltstepPlant`.
pub const VOLTSTEP_PLANT_WORDS: usize = 168;
/// Words (4 bytes) of a `VoltstepState`.
pub const VOLTSTEP_STATE_WORDS: usize = 96;

/// A vehicle with its driver, checked and discretised for one step. Opaque: set it up by
/// `voltstep_plant_init`; from then on it is only read, so any number of states may share it.
#[repr(C)]
pub struct VoltstepPlant {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_PLANT_WORDS],
}

/// Everything that a vehicle and its driver remember. Opaque: set it up by
/// `voltstep_state_init`. A snapshot, a roll-back or a what-if run is a copy (`a = b;`).
#[repr(C)]
pub struct VoltstepState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u32>; VOLTSTEP_STATE_WORDS],
}

/// What tells an initialised object from any other memory; it changes with the layout.
pub(crate) const fn mark<T>(kind: u32) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "a few hundred bytes")]
    let size = size_of::<T>() as u32;
    0x5653_0000 ^ (kind << 24) ^ (VOLTSTEP_ABI << 12) ^ size
}

/// What is inside a `VoltstepPlant`.
#[repr(C)]
pub(crate) struct Plant {
    mark: u32,
    pub cars: Cars,
}

/// What is inside a `VoltstepState`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(crate) struct State {
    mark: u32,
    pub trips: Trips,
}

/// An opaque object of C and what is inside.
///
/// # Safety
/// `Inside` fits into `Self` in size and alignment and begins with its mark.
pub(crate) unsafe trait Opaque {
    type Inside;
    const MARK: u32;
    const NOT_INITIALISED: VoltstepStatus;
}

pub(crate) const fn fits<Inside, Outside>() -> bool {
    size_of::<Inside>() <= size_of::<Outside>() && align_of::<Inside>() <= align_of::<Outside>()
}

// SAFETY: `Plant` is `repr(C)` with its mark first; the size is checked on the next line.
unsafe impl Opaque for VoltstepPlant {
    type Inside = Plant;
    const MARK: u32 = mark::<Plant>(1);
    const NOT_INITIALISED: VoltstepStatus = VoltstepStatus::PlantNotInitialised;
}
const _: () = assert!(fits::<Plant, VoltstepPlant>());

// SAFETY: `State` is `repr(C)` with its mark first; the size is checked on the next line.
unsafe impl Opaque for VoltstepState {
    type Inside = State;
    const MARK: u32 = mark::<State>(2);
    const NOT_INITIALISED: VoltstepStatus = VoltstepStatus::StateNotInitialised;
}
const _: () = assert!(fits::<State, VoltstepState>());

impl Plant {
    pub const fn new(cars: Cars) -> Self {
        Self { mark: VoltstepPlant::MARK, cars }
    }
}

impl State {
    pub const fn new(trips: Trips) -> Self {
        Self { mark: VoltstepState::MARK, trips }
    }
}

/// Whether a pointer can be used at all.
#[inline]
pub(crate) fn check<T>(pointer: *const T) -> Result<(), VoltstepStatus> {
    if pointer.is_null() {
        Err(VoltstepStatus::NullPointer)
    } else if !pointer.is_aligned() {
        Err(VoltstepStatus::Misaligned)
    } else {
        Ok(())
    }
}

/// Whether two objects share no memory.
#[inline]
pub(crate) fn check_apart<A, B>(a: *const A, b: *const B) -> Result<(), VoltstepStatus> {
    check_ranges_apart((a.addr(), size_of::<A>()), (b.addr(), size_of::<B>()))
}

/// Whether two ranges, each an address and a length, have nothing in common.
#[inline]
pub(crate) const fn check_ranges_apart(
    (from_a, length_a): (usize, usize),
    (from_b, length_b): (usize, usize),
) -> Result<(), VoltstepStatus> {
    let apart =
        if from_a <= from_b { from_b - from_a >= length_a } else { from_a - from_b >= length_b };
    if apart { Ok(()) } else { Err(VoltstepStatus::Overlap) }
}

/// What is inside an object of C, once it is known to be there.
///
/// # Safety
/// `object` is null, or points to memory of its type that may be read.
#[inline]
pub(crate) unsafe fn inside<T: Opaque>(
    object: *const T,
) -> Result<*const T::Inside, VoltstepStatus> {
    check(object)?;
    // SAFETY: not null, aligned for u32 as `T` is, readable by the caller's promise; any four
    // bytes are a u32.
    let mark = unsafe { object.cast::<u32>().read() };
    if mark == T::MARK { Ok(object.cast()) } else { Err(T::NOT_INITIALISED) }
}

/// What is inside an object of C, to read.
///
/// # Safety
/// `object` is null, or points to memory of its type that may be read and that nothing writes
/// during `'a`; where it carries the mark, `voltstep_..._init` wrote it.
#[inline]
pub(crate) unsafe fn shared<'a, T: Opaque>(
    object: *const T,
) -> Result<&'a T::Inside, VoltstepStatus> {
    // SAFETY: as promised by the caller.
    let inside = unsafe { inside(object) }?;
    // SAFETY: not null and aligned (checked inside); initialised, as the mark says; nothing
    // writes it meanwhile, by the caller's promise.
    Ok(unsafe { &*inside })
}

/// What is inside an object of C, to change.
///
/// # Safety
/// As for [`shared`], and nothing else reads or writes the object during `'a`.
#[inline]
pub(crate) unsafe fn exclusive<'a, T: Opaque>(
    object: *mut T,
) -> Result<&'a mut T::Inside, VoltstepStatus> {
    // SAFETY: as promised by the caller.
    unsafe { inside(object) }?;
    // SAFETY: as in `shared`; nobody else uses it, by the caller's promise.
    Ok(unsafe { &mut *object.cast::<T::Inside>() })
}

/// Writes what is inside an object of C, whatever was there.
///
/// # Safety
/// `object` is null, or points to memory of its type that may be written.
pub(crate) unsafe fn initialise<T: Opaque>(
    object: *mut T,
    inside: T::Inside,
) -> Result<(), VoltstepStatus> {
    // SAFETY: `Inside` fits into the object (`Opaque`), so what may be written as the one may be
    // written as the other.
    unsafe { write_to(object.cast(), inside) }
}

/// Writes a plain value.
///
/// # Safety
/// `target` is null, or points to memory of its type that may be written.
#[inline]
pub(crate) unsafe fn write_to<T>(target: *mut T, value: T) -> Result<(), VoltstepStatus> {
    check(target)?;
    // SAFETY: not null, aligned, writable by the caller's promise; nothing there needs dropping.
    unsafe { target.write(value) };
    Ok(())
}

/// Whether a pointer that may be null can be used at all.
#[inline]
pub(crate) fn check_optional<T>(pointer: *const T) -> Result<(), VoltstepStatus> {
    if pointer.is_null() { Ok(()) } else { check(pointer) }
}

/// Writes a plain value, where there is a place for it.
///
/// # Safety
/// As for [`write_to`].
#[inline]
pub(crate) unsafe fn write_optional<T>(target: *mut T, value: T) -> Result<(), VoltstepStatus> {
    if target.is_null() {
        return Ok(());
    }
    // SAFETY: as promised by the caller.
    unsafe { write_to(target, value) }
}

/// What a function answers.
#[inline]
pub(crate) fn answer(result: Result<(), VoltstepStatus>) -> VoltstepStatus {
    match result {
        Ok(()) => VoltstepStatus::Ok,
        Err(status) => status,
    }
}

/// Reads a plain value, by copy, so that it may lie anywhere.
///
/// # Safety
/// `source` is null, or points to an initialised value of its type.
#[inline]
pub(crate) unsafe fn read_from<T: Copy>(source: *const T) -> Result<T, VoltstepStatus> {
    check(source)?;
    // SAFETY: not null, aligned, readable by the caller's promise; the plain structs of this
    // interface have no invalid bit pattern.
    Ok(unsafe { source.read() })
}
