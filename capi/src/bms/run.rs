//! What is asked for, a tick, a record.

use voltstep_bms::limit::Request;
use voltstep_bms::manage::{Asked, Bms, BmsState};
use voltstep_bms::protect::Clear;

use super::board::{VoltstepBmsInputs, VoltstepBmsOutputs, Wired, rows};
use super::handle::{VoltstepBms, VoltstepBmsState, whole};
use super::report::VoltstepBmsReport;
use super::{CELLS, SENSORS};
use crate::estimators::VoltstepRecord;
use crate::handle::{
    answer, check, check_apart, exclusive, read_from, shared, write_optional, write_to,
};
use crate::status::VoltstepStatus;

/// What somebody asks for.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsWish {
    /// Nobody is there, or has not been heard in time.
    Silent = 0,
    /// Open.
    Off = 1,
    /// Close to drive.
    Drive = 2,
    /// Close to charge.
    Charge = 3,
}

/// Which faults to end.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBmsClear {
    /// None.
    No = 0,
    /// What a reset by the driver or the vehicle may end.
    Reset = 1,
    /// What a workshop may end, too.
    Service = 2,
}

/// What vehicle and charger ask for.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsRequest {
    /// One of `VoltstepBmsWish`; another number is not understood, and opens.
    pub vehicle: u32,
    /// The charger's, likewise.
    pub charger: u32,
    /// One of `VoltstepBmsClear` (another number: none); each wish counts once.
    pub clear: u32,
    /// What is wrong with their messages, a bit for each of `VoltstepBmsRow`, row k in word k/32.
    pub flags: [u32; 3],
}

const fn wish(number: u32) -> Request {
    match number {
        w if w == VoltstepBmsWish::Silent as u32 => Request::Silent,
        w if w == VoltstepBmsWish::Off as u32 => Request::Off,
        w if w == VoltstepBmsWish::Drive as u32 => Request::Drive,
        w if w == VoltstepBmsWish::Charge as u32 => Request::Charge,
        _ => Request::Unknown,
    }
}

/// Says what is asked for, from now on.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `request` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_request(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    request: *const VoltstepBmsRequest,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            let r = read_from(request)?;
            check_apart(bms, state)?;
            let asked = Asked {
                vehicle: wish(r.vehicle),
                charger: wish(r.charger),
                clear: match r.clear {
                    c if c == VoltstepBmsClear::Reset as u32 => Clear::Reset,
                    c if c == VoltstepBmsClear::Service as u32 => Clear::Service,
                    _ => Clear::No,
                },
                flags: rows(r.flags),
            };
            whole.request(&mut exclusive(state)?.state, asked);
            Ok(())
        })
    })
}

/// One of the calls in which the hardware has a part.
///
/// # Safety
/// As for [`voltstep_bms_tick`].
#[inline(always)]
unsafe fn with_board(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    inputs: *const VoltstepBmsInputs,
    outputs: *mut VoltstepBmsOutputs,
    call: impl FnOnce(&Bms<CELLS, SENSORS>, &mut BmsState<CELLS, SENSORS>, &mut Wired<'_>),
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside. The references
    // are not used any more when the outputs are written.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            let inputs = read_from(inputs)?;
            check(outputs).and(check_apart(bms, state))?;
            let inside = exclusive(state)?;
            call(whole, &mut inside.state, &mut Wired { inputs: &inputs, told: &mut inside.told });
            let said = (&inside.told).into();
            write_to(outputs, said)
        })
    })
}

/// All of it in the order of a single loop, once every `sheet.tick_s`: `voltstep_bms_fast`, then
/// either a sample or a slice. `outputs` is what the hardware is told from now on.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `inputs` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_tick(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    inputs: *const VoltstepBmsInputs,
    outputs: *mut VoltstepBmsOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller.
    unsafe { with_board(bms, state, inputs, outputs, |bms, state, board| bms.tick(state, board)) }
}

/// Reads, judges every row, moves the contactors: every `sheet.tick_s`. Waits for nothing.
///
/// # Safety
/// As for `voltstep_bms_tick`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_fast(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    inputs: *const VoltstepBmsInputs,
    outputs: *mut VoltstepBmsOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller.
    unsafe { with_board(bms, state, inputs, outputs, |bms, state, board| bms.fast(state, board)) }
}

/// One sample of the estimators, every `sample_s`: limits follow, and the bleed switches. Of the
/// inputs only `balancing_c` is read.
///
/// # Safety
/// As for `voltstep_bms_tick`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_filter(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    inputs: *const VoltstepBmsInputs,
    outputs: *mut VoltstepBmsOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller.
    unsafe { with_board(bms, state, inputs, outputs, |bms, state, board| bms.filter(state, board)) }
}

/// One slice of what is worked out once a second, some 23 times a second, when there is time. `left`
/// may be null; it says whether there is more to do in this second.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_slow(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    left: *mut bool,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            check_apart(bms, state)?;
            let more = whole.slow(&mut exclusive(state)?.state);
            write_optional(left, more)
        })
    })
}

/// What is known now.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else writes during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_report(
    bms: *const VoltstepBms,
    state: *const VoltstepBmsState,
    report: *mut VoltstepBmsReport,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            let said = (&whole.report(&shared(state)?.state)).into();
            write_to(report, said)
        })
    })
}

/// What should be stored now (`voltstep_record_encode`), where it is worth a write: `worth` says so,
/// and `record` is written only then, which counts as stored. Ask after every tick. `now_s` is the
/// product's clock, where `timed` is other than 0.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_record(
    bms: *const VoltstepBms,
    state: *mut VoltstepBmsState,
    timed: u32,
    now_s: u32,
    record: *mut VoltstepRecord,
    worth: *mut bool,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            check(record).and(check(worth)).and(check_apart(bms, state))?;
            let state = &mut exclusive(state)?.state;
            let found = whole.record(state, (timed != 0).then_some(now_s));
            write_to(worth, found.is_some())?;
            found.map_or(Ok(()), |found| write_to(record, VoltstepRecord::from_model(found)))
        })
    })
}

/// All that a record holds, before the power goes.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else writes during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_bms_worth_keeping(
    bms: *const VoltstepBms,
    state: *const VoltstepBmsState,
    timed: u32,
    now_s: u32,
    record: *mut VoltstepRecord,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        whole(bms).and_then(|whole| {
            let now_s = (timed != 0).then_some(now_s);
            let kept = whole.worth_keeping(&shared(state)?.state, now_s);
            write_to(record, VoltstepRecord::from_model(kept))
        })
    })
}
