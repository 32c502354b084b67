//! What is worth knowing after a power cut, as bytes for two slots of non-volatile memory.

use voltstep_bms::Health;
use voltstep_bms::estimate::ekf::{EkfMemory, Polarisation};
use voltstep_bms::store::record::{Found, LENGTH, Record, RecordError, Slot};

use crate::handle::{answer, check, read_from, write_to};
use crate::status::VoltstepStatus;

/// Bytes of a slot that holds a record.
pub const VOLTSTEP_RECORD_BYTES: usize = 96;
const _: () = assert!(VOLTSTEP_RECORD_BYTES == LENGTH);

/// What is worth knowing after a power cut.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepRecord {
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Its standard deviation, a ratio 0..1.
    pub soc_sd: f32,
    /// Capacity in A h; above 0, up to 1e6.
    pub capacity_ah: f32,
    /// Its standard deviation in A h, 0 up to the capacity.
    pub capacity_sd_ah: f32,
    /// Resistance as a multiple of that of a new cell, 0.01..100.
    pub resistance_factor: f32,
    /// Its standard deviation, 0..100.
    pub resistance_factor_sd: f32,
    /// What the current sensor shows without a current in A, within +-10000.
    pub current_offset_a: f32,
    /// Its standard deviation in A, 0..10000.
    pub current_offset_sd_a: f32,
    /// Charge that has gone in or out over the life in A h, 0..1e9.
    pub throughput_ah: f32,
    /// Other than 0: the time is known.
    pub timed: u32,
    /// When this was written, in s on a clock of the product's own.
    pub written_at_s: u32,
    /// Other than 0: what the last minutes left in the cell is known.
    pub polarised: u32,
    /// Voltage across the RC branches, the faster first, in V, within +-10000.
    pub polarisation_v: [f32; 2],
    /// Mean magnitude of the current over the last minutes in A, 0..1e5.
    pub load_a: f32,
    /// Where between the curves of discharge (-1) and charge (1) the open-circuit voltage lies.
    pub hysteresis: f32,
    /// Heat in the precharge resistor in J, 0..1e6.
    pub resistor_heat_j: f32,
    /// Why the contactors must stay open, a number of the product's own; 0: they need not.
    pub lock_out_cause: u16,
    /// Sequence number of the newest entry of the product's log.
    pub log_sequence: u32,
}

/// What two slots hold.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepStored {
    /// The newest record.
    pub record: VoltstepRecord,
    /// Its sequence number.
    pub sequence: u32,
    /// The slot for the next record, 0 or 1: never that of the newest.
    pub next_slot: u32,
    /// The sequence number for the next record.
    pub next_sequence: u32,
    /// A slot holds something else than a record or nothing: there may have been a newer record.
    pub damaged: bool,
}

/// A time that nobody knows is none.
pub(super) fn elapsed(seconds: f32) -> Option<f32> {
    (seconds >= 0.0).then_some(seconds)
}

impl VoltstepRecord {
    pub(super) const fn of(memory: EkfMemory, health: Health) -> Self {
        Self::from_model(Record::of(memory, health))
    }

    pub(crate) const fn from_model(r: Record) -> Self {
        let (timed, written_at_s) = match r.written_at_s {
            Some(seconds) => (1, seconds),
            None => (0, 0),
        };
        let (polarised, polarisation) = match r.polarisation {
            Some(polarisation) => (1, polarisation),
            None => (0, Polarisation::NONE),
        };
        Self {
            soc: r.soc,
            soc_sd: r.soc_sd,
            capacity_ah: r.capacity_ah,
            capacity_sd_ah: r.capacity_sd_ah,
            resistance_factor: r.resistance_factor,
            resistance_factor_sd: r.resistance_factor_sd,
            current_offset_a: r.current_offset_a,
            current_offset_sd_a: r.current_offset_sd_a,
            throughput_ah: r.throughput_ah,
            timed,
            written_at_s,
            polarised,
            polarisation_v: polarisation.branches_v,
            load_a: polarisation.load_a,
            hysteresis: polarisation.hysteresis,
            resistor_heat_j: r.resistor_heat_j,
            lock_out_cause: r.lock_out_cause,
            log_sequence: r.log_sequence,
        }
    }

    pub(crate) fn model(&self) -> Record {
        Record {
            soc: self.soc,
            soc_sd: self.soc_sd,
            capacity_ah: self.capacity_ah,
            capacity_sd_ah: self.capacity_sd_ah,
            resistance_factor: self.resistance_factor,
            resistance_factor_sd: self.resistance_factor_sd,
            current_offset_a: self.current_offset_a,
            current_offset_sd_a: self.current_offset_sd_a,
            throughput_ah: self.throughput_ah,
            written_at_s: (self.timed != 0).then_some(self.written_at_s),
            polarisation: (self.polarised != 0).then_some(Polarisation {
                branches_v: self.polarisation_v,
                load_a: self.load_a,
                hysteresis: self.hysteresis,
            }),
            resistor_heat_j: self.resistor_heat_j,
            lock_out_cause: self.lock_out_cause,
            log_sequence: self.log_sequence,
        }
    }

    /// What the filter goes on from, and the health.
    pub(super) fn remembered(&self) -> Result<(EkfMemory, Health), VoltstepStatus> {
        let record = self.model().checked()?;
        let memory = EkfMemory {
            soc: record.soc,
            soc_sd: record.soc_sd,
            polarisation: record.polarisation,
            current_offset_a: record.current_offset_a,
            current_offset_sd_a: record.current_offset_sd_a,
        };
        Ok((memory, record.health()))
    }
}

/// The bytes of a slot that holds `record` under a sequence number: `bytes` is an array of
/// `VOLTSTEP_RECORD_BYTES`. A field that is out of range is named by the code.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `record` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_record_encode(
    record: *const VoltstepRecord,
    sequence: u32,
    bytes: *mut u8,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe {
        read_from(record)
            .and_then(|record| write_to(bytes.cast(), record.model().encode(sequence)?))
    })
}

/// What a slot of `VOLTSTEP_RECORD_BYTES` holds: a record and its sequence number, or the code that
/// says why there is none.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `bytes` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_record_decode(
    bytes: *const u8,
    record: *mut VoltstepRecord,
    sequence: *mut u32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe {
        read_from(bytes.cast()).and_then(|bytes| {
            check(record).and(check(sequence))?;
            let (found, number) = Record::decode(&bytes).map_err(refused)?;
            write_to(sequence, number)?;
            write_to(record, VoltstepRecord::from_model(found))
        })
    })
}

/// What two slots of `VOLTSTEP_RECORD_BYTES` hold. `VOLTSTEP_STATUS_RECORD_BLANK` says that there is
/// no record in either; `stored` is written all the same, its record then all zero.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `first` and `second` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_record_newest(
    first: *const u8,
    second: *const u8,
    stored: *mut VoltstepStored,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe {
        read_from(first.cast()).and_then(|first| {
            let found = Found::in_slots(&first, &read_from(second.cast())?);
            let (slot, next_sequence) = found.next();
            let said = VoltstepStored {
                record: found.newest.map_or(NOTHING, |s| VoltstepRecord::from_model(s.record)),
                sequence: found.newest.map_or(0, |stored| stored.sequence),
                next_slot: u32::from(slot == Slot::Second),
                next_sequence,
                damaged: found.damaged,
            };
            write_to(stored, said)?;
            found.newest.map(|_| ()).ok_or(VoltstepStatus::RecordBlank)
        })
    })
}

const NOTHING: VoltstepRecord = VoltstepRecord {
    soc: 0.0,
    soc_sd: 0.0,
    capacity_ah: 0.0,
    capacity_sd_ah: 0.0,
    resistance_factor: 0.0,
    resistance_factor_sd: 0.0,
    current_offset_a: 0.0,
    current_offset_sd_a: 0.0,
    throughput_ah: 0.0,
    timed: 0,
    written_at_s: 0,
    polarised: 0,
    polarisation_v: [0.0; 2],
    load_a: 0.0,
    hysteresis: 0.0,
    resistor_heat_j: 0.0,
    lock_out_cause: 0,
    log_sequence: 0,
};

fn refused(error: RecordError) -> VoltstepStatus {
    match error {
        RecordError::Blank => VoltstepStatus::RecordBlank,
        RecordError::Corrupted => VoltstepStatus::RecordCorrupted,
        RecordError::Implausible(error) => error.into(),
        _ => VoltstepStatus::RecordUnknown,
    }
}
