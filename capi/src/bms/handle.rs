//! The memory of a BMS, and how it is set up.

use core::ffi::c_char;
use core::mem::MaybeUninit;
use core::ptr::null;

use plant_core::ParamError;
use voltstep_bms::contactor::Coils;
use voltstep_bms::manage::{Bms, BmsParams, BmsState, Description};
use voltstep_bms::protect::EXAMPLE;

use super::params::{VoltstepBmsParams, VoltstepBmsSheet};
use super::refusals::words;
use super::{CELLS, SENSORS};
use crate::estimators::{VoltstepCellParams, VoltstepRecord};
use crate::handle::{
    Opaque, answer, check, check_apart, check_optional, fits, initialise, inside, mark, read_from,
    write_optional, write_to,
};
use crate::refusals::voltstep_error_message;
use crate::status::VoltstepStatus;

/// Words (8 bytes) of a `VoltstepBms`.
pub const VOLTSTEP_BMS_WORDS: usize = 1280;
/// Words (8 bytes) of a `VoltstepBmsState`.
pub const VOLTSTEP_BMS_STATE_WORDS: usize = 832;

/// A whole BMS, derived from its description. Opaque: set it up by `voltstep_bms_init` where it
/// stays, a copy is refused; from then on it is only read. Sets of rows are 128 bits, which some
/// machines want aligned.
#[repr(C, align(16))]
pub struct VoltstepBms {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_BMS_WORDS],
}

/// What a BMS remembers. Opaque: set it up by `voltstep_bms_start`. A snapshot is a copy.
#[repr(C, align(16))]
pub struct VoltstepBmsState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_BMS_STATE_WORDS],
}

/// What is inside a `VoltstepBms`.
#[repr(C)]
pub(crate) struct Whole {
    mark: u32,
    /// Where it lies: the BMS refers to the description in it.
    home: usize,
    description: Description,
    bms: Bms<CELLS, SENSORS>,
}

/// What is inside a `VoltstepBmsState`.
#[repr(C)]
pub(crate) struct Remembered {
    mark: u32,
    pub state: BmsState<CELLS, SENSORS>,
    /// What the hardware was told last.
    pub told: Told,
}

/// What the hardware is told.
#[derive(Clone, Copy, Default)]
pub(crate) struct Told {
    pub coils: Coils,
    pub bleed: [bool; CELLS],
}

// SAFETY: `Whole` is `repr(C)` with its mark first; the size is checked on the next line.
unsafe impl Opaque for VoltstepBms {
    type Inside = Whole;
    const MARK: u32 = mark::<Whole>(11);
    const NOT_INITIALISED: VoltstepStatus = VoltstepStatus::BmsNotInitialised;
}
const _: () = assert!(fits::<Whole, VoltstepBms>());

// SAFETY: `Remembered` is `repr(C)` with its mark first; the size is checked on the next line.
unsafe impl Opaque for VoltstepBmsState {
    type Inside = Remembered;
    const MARK: u32 = mark::<Remembered>(12);
    const NOT_INITIALISED: VoltstepStatus = VoltstepStatus::StateNotInitialised;
}
const _: () = assert!(fits::<Remembered, VoltstepBmsState>());

/// The BMS inside an object, to read.
///
/// # Safety
/// As for [`shared`](crate::handle::shared).
#[inline]
pub(super) unsafe fn whole<'a>(
    bms: *const VoltstepBms,
) -> Result<&'a Bms<CELLS, SENSORS>, VoltstepStatus> {
    // SAFETY: as promised by the caller.
    let inside = unsafe { inside(bms) }?;
    // SAFETY: the mark says that it was initialised; an address is a number.
    let home = unsafe { (&raw const (*inside).home).read() };
    if home != bms.addr() {
        return Err(VoltstepStatus::BmsMoved);
    }
    // SAFETY: initialised, and it lies where it was, so what it refers to is its own description;
    // nothing writes it meanwhile, by the caller's promise.
    Ok(unsafe { &(*inside).bms })
}

/// Fills `sheet` with a pack of 14 groups of 20 cells of the size 21700: for examples. Take the
/// figures of your own data sheets.
///
/// # Safety
/// `sheet` is null, or points to memory of its type that may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_sheet_example(
    sheet: *mut VoltstepBmsSheet,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe { write_to(sheet, EXAMPLE.into()) })
}

/// Fills `params` with what fits a pack with sensors and contactors of a production car, and a link
/// that `precharge_ohm` charges in some 0.2 s: from the data sheets and the map of a cell, for the
/// numbers of cells and temperatures that the library is built for. Each field can be set on its own.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `sheet` and `cell` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_params_typical(
    sheet: *const VoltstepBmsSheet,
    cell: *const VoltstepCellParams,
    precharge_ohm: f32,
    params: *mut VoltstepBmsParams,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe {
        read_from(sheet).and_then(|sheet| {
            let cell = read_from(cell)?.model()?;
            let typical = BmsParams::typical(sheet.into(), cell, precharge_ohm);
            write_to(params, (&typical).into())
        })
    })
}

/// Checks `params` and derives the whole BMS from them. A field that is refused has a code of its own
/// where the estimators have it, too, else `VOLTSTEP_STATUS_PARAMETER`; its words are in `*refused`,
/// a static text, null where nothing is refused; `refused` itself may be null. After a refusal `bms`
/// is not initialised. The object has to stay where it is: a copy of it is refused by
/// `VOLTSTEP_STATUS_BMS_MOVED`. It takes some 26 kB of stack, once.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `params` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_init(
    bms: *mut VoltstepBms,
    params: *const VoltstepBmsParams,
    refused: *mut *const c_char,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller.
    let made = check_optional(refused).and_then(|()| unsafe {
        write_optional(refused, null())?;
        check(bms).and(check(params)).and(check_apart(bms, params))?;
        set_up(bms, params).map_err(|refusal| {
            let text = match refusal {
                Refusal::Of(error) => words(error),
                Refusal::By(status) => voltstep_error_message(status as u32),
            };
            let _ = write_optional(refused, text);
            refusal.status()
        })
    });
    answer(made)
}

/// Why there is no BMS.
enum Refusal {
    Of(ParamError),
    By(VoltstepStatus),
}

impl Refusal {
    fn status(&self) -> VoltstepStatus {
        match self {
            Self::Of(error) => (*error).into(),
            Self::By(status) => *status,
        }
    }
}

/// # Safety
/// As for [`voltstep_bms_init`], with pointers that were checked.
unsafe fn set_up(bms: *mut VoltstepBms, params: *const VoltstepBmsParams) -> Result<(), Refusal> {
    let inside = bms.cast::<Whole>();
    // SAFETY: checked, writable by the caller's promise, and large enough (`Opaque`). The description
    // is read as long as the object lies there with its mark, which `whole` checks.
    unsafe {
        (&raw mut (*inside).mark).write(0);
        describe(&raw mut (*inside).description, &*params)?;
        derive(&raw mut (*inside).bms, &(*inside).description)?;
        (&raw mut (*inside).home).write(bms.addr());
        (&raw mut (*inside).mark).write(VoltstepBms::MARK);
    }
    Ok(())
}

/// The description, checked. Apart from what follows, or the stack would have to hold both at once.
///
/// # Safety
/// `place` may be written.
#[inline(never)]
unsafe fn describe(place: *mut Description, params: &VoltstepBmsParams) -> Result<(), Refusal> {
    let params = params.model().map_err(Refusal::By)?;
    let description = Description::new(params).map_err(Refusal::Of)?;
    // SAFETY: as promised by the caller.
    unsafe { place.write(description) };
    Ok(())
}

/// What follows from it.
///
/// # Safety
/// `place` may be written.
#[inline(never)]
unsafe fn derive(
    place: *mut Bms<CELLS, SENSORS>,
    description: &'static Description,
) -> Result<(), Refusal> {
    let derived = Bms::new(description).map_err(Refusal::Of)?;
    // SAFETY: as promised by the caller.
    unsafe { place.write(derived) };
    Ok(())
}

/// After a reset: from what was recorded, null: nothing is known of the charge, and the product's
/// clock in s, where `timed` is other than 0, at a first temperature in degC (-100..200). Everything
/// is open, nothing is asked for. It takes some 10 kB of stack, a tick 2.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `record` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_start(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    record: *const VoltstepRecord,
    timed: u32,
    now_s: u32,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            check(state).and(check_apart(bms, state))?;
            let record =
                if record.is_null() { None } else { Some(read_from(record)?.model().checked()?) };
            let made =
                whole.start(record.as_ref(), (timed != 0).then_some(now_s), temperature_c)?;
            let mark = VoltstepBmsState::MARK;
            initialise(state, Remembered { mark, state: made, told: Told::default() })
        })
    })
}
