//! Each message, there and back.

extern crate std;

use proptest::prelude::*;

use super::super::state::{MODES, PHASES, REASONS, TRIPS};
use super::super::*;
use super::{harmed, message};
use crate::contactor::Cause;
use crate::limit::{Limit, Limits};
use crate::measure::Reading;
use crate::protect::{Faults, Id, ROWS, Trip, Verdict};
use crate::{Real, limit::Mode};

/// A value in a range, or none.
fn value(range: core::ops::Range<Real>) -> impl Strategy<Value = Real> {
    prop_oneof![4 => range, 1 => Just(Real::NAN)]
}

/// The same to within half a step and what single precision adds, or both missing; a signal with an
/// offset is as coarse everywhere as at its far end, which `step` allows for by a thousandth.
fn near(a: Real, b: Real, step: Real) -> bool {
    a.is_nan() && b.is_nan() || (a - b).abs() <= 0.501 * step + 2e-6 * a.abs()
}

fn verdict(tripped: u128, latched: u128) -> Verdict {
    let set = |mask: u128| {
        let rows = Id::ALL.into_iter().filter(|id| mask >> id.index() & 1 == 1);
        rows.fold(Faults::NONE, Faults::with)
    };
    let none = Faults::NONE;
    let (tripped, latched) = (set(tripped), set(latched));
    Verdict { trip: Trip::None, permit: true, tripped, latched, rose: none, fell: none }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn status_comes_back(
        (phase, cause, trip) in (0..PHASES.len(), 0..Cause::ALL.len(), 0..TRIPS.len()),
        (permit, mode, alive) in (any::<bool>(), 0..MODES.len(), 0_u8..15),
        (soc, soc_sd) in (value(0.0..1.0), value(0.0..1.0)),
    ) {
        let sent = Status {
            phase: PHASES[phase],
            cause: Cause::ALL[cause],
            trip: TRIPS[trip],
            permit,
            mode: MODES[mode],
            soc,
            soc_sd,
        };
        let heard = Status::decode(&sent.encode(alive)).unwrap();
        prop_assert!(near(heard.soc, soc, 0.001) && near(heard.soc_sd, soc_sd, 0.001), "{heard:?}");
        let rest = Status { soc: 0.0, soc_sd: 0.0, ..heard };
        prop_assert_eq!(rest, Status { soc: 0.0, soc_sd: 0.0, ..sent });
    }

    #[test]
    fn pack_comes_back(
        (pack_v, link_v) in (value(0.0..1310.0), value(0.0..1310.0)),
        current_a in value(-1638.0..1638.0),
        alive in 0_u8..15,
    ) {
        let heard = Pack::decode(&Pack { pack_v, link_v, current_a }.encode(alive)).unwrap();
        prop_assert!(near(heard.pack_v, pack_v, 0.02), "{heard:?}");
        prop_assert!(near(heard.link_v, link_v, 0.02), "{heard:?}");
        // Seen from the offset a current has up to 3276 A, with 0.0002 between two numbers.
        prop_assert!(near(heard.current_a, current_a, 0.051), "{heard:?}");
    }

    #[test]
    fn limits_come_back_and_never_higher(
        (discharge_a, charge_a) in (0.0 as Real..6553.0, 0.0 as Real..6553.0),
        (discharge_by, charge_by) in (0..REASONS.len(), 0..REASONS.len()),
        alive in 0_u8..15,
    ) {
        let sent = Limits {
            discharge: Limit { current_a: discharge_a, by: REASONS[discharge_by] },
            charge: Limit { current_a: charge_a, by: REASONS[charge_by] },
        };
        let heard = decode_limits(&encode_limits(&sent, alive)).unwrap();
        for (heard, sent) in [(heard.discharge, sent.discharge), (heard.charge, sent.charge)] {
            prop_assert_eq!(heard.by, sent.by);
            prop_assert!(heard.current_a <= sent.current_a, "{heard:?} {sent:?}");
            prop_assert!(sent.current_a - heard.current_a < 0.102, "{heard:?} {sent:?}");
        }
    }

    #[test]
    fn cells_and_extremes_come_back(
        cells in prop::collection::vec(value(0.0..6.5), 1..40),
        old in any::<prop::sample::Index>(),
    ) {
        let mut readings: std::vec::Vec<_> = cells.iter().map(|v| Reading::new(*v)).collect();
        readings[old.index(cells.len())].age_s = 2.0;
        let usable = |i: usize| readings[i].usable(1.0);

        let ends = CellExtremes::of(&readings, 1.0);
        let heard = CellExtremes::decode(&ends.encode()).unwrap();
        let seen: std::vec::Vec<_> = (0..cells.len()).filter_map(usable).collect();
        prop_assert_eq!(usize::from(heard.missing), cells.len() - seen.len());
        let lowest = seen.iter().copied().reduce(Real::min).unwrap_or(Real::NAN);
        let highest = seen.iter().copied().reduce(Real::max).unwrap_or(Real::NAN);
        prop_assert!(near(heard.lowest_v, lowest, 0.0001) && near(heard.highest_v, highest, 0.0001));
        if !seen.is_empty() {
            prop_assert_eq!(usable(heard.lowest_cell.into()), Some(lowest));
            prop_assert_eq!(usable(heard.highest_cell.into()), Some(highest));
        }

        let mut shown = 0;
        for number in 0..=u8::MAX {
            let Some(group) = CellGroup::of(&readings, 1.0, number) else { break };
            let heard = CellGroup::decode(&group.encode()).unwrap();
            prop_assert_eq!(heard.group, number);
            for (k, cell_v) in (0..).zip(heard.cell_v) {
                let index = CELLS_IN_A_GROUP * usize::from(number) + k;
                let wanted = (index < cells.len()).then(|| usable(index)).flatten();
                prop_assert!(near(cell_v, wanted.unwrap_or(Real::NAN), 0.001), "{index}: {cell_v}");
                shown += 1;
            }
        }
        prop_assert_eq!(shown, cells.len().next_multiple_of(CELLS_IN_A_GROUP));
    }

    #[test]
    fn temperatures_come_back(
        (coldest_c, hottest_c) in (value(-100.0..300.0), value(-100.0..300.0)),
        (coldest_sensor, hottest_sensor, missing) in (0_u16..1024, 0_u16..1024, 0_u16..1024),
    ) {
        let sent =
            TemperatureExtremes { coldest_c, hottest_c, coldest_sensor, hottest_sensor, missing };
        let heard = TemperatureExtremes::decode(&sent.encode()).unwrap();
        prop_assert!(near(heard.coldest_c, coldest_c, 0.1) && near(heard.hottest_c, hottest_c, 0.1));
        let rest = (heard.coldest_sensor, heard.hottest_sensor, heard.missing);
        prop_assert_eq!(rest, (coldest_sensor, hottest_sensor, missing));
    }

    #[test]
    fn faults_come_back(tripped in any::<u128>(), latched in any::<u128>()) {
        let sent = verdict(tripped, latched);
        let [mut heard, mut held] = [Faults::NONE; 2];
        for number in 0..FAULT_PAGES {
            let page = FaultPage::of(&sent, number).unwrap();
            let page = FaultPage::decode(&page.encode()).unwrap();
            let set = if page.latched() { &mut held } else { &mut heard };
            *set = set.union(page.rows);
        }
        prop_assert_eq!((heard, held), (sent.tripped, sent.latched));
    }
}

#[test]
fn each_row_has_one_place() {
    for id in Id::ALL {
        let one = verdict(1 << id.index(), 0);
        let pages = (0..FAULT_PAGES).map(|page| FaultPage::of(&one, page).unwrap());
        let found: std::vec::Vec<_> = pages.filter(|page| !page.rows.is_empty()).collect();
        assert_eq!(found.len(), 1, "{id:?}");
        assert_eq!(found[0].encode().data().iter().skip(1).map(|b| b.count_ones()).sum::<u32>(), 1);
    }
    assert_eq!(FaultPage::of(&verdict(0, 0), FAULT_PAGES), None);
}

#[test]
fn pages_and_rows_that_there_are_not_are_refused() {
    assert_eq!(FaultPage::decode(&message(0x516, &[4, 0, 0, 0, 0, 0, 0, 0])), None);
    let beyond = ROWS - 56;
    let mut data = [1, 0, 0, 0, 0, 0, 0, 0];
    data[1 + beyond / 8] = 1 << (beyond % 8);
    assert_eq!(FaultPage::decode(&message(0x516, &data)), None, "a row of another version");
}

#[test]
fn numbers_without_a_meaning_are_refused() {
    // Sealed as it should be, so that only the number is wrong.
    let sealed = |layout, bits| super::super::guard::sealed(layout, bits, 3);
    let status = |bits| Status::decode(&sealed(&state::STATUS, bits));
    assert!(status(0).is_some_and(|s| s.mode == Mode::Off && s.soc.is_nan()));
    assert_eq!(status(13), None, "a phase");
    assert_eq!(status(15 << 4), None, "a cause");
    assert_eq!(status(3 << 11), None, "a mode");
    let limits = |bits| decode_limits(&sealed(&state::LIMITS, bits));
    assert!(limits(0).is_some());
    assert_eq!(limits(9 << 32), None, "a reason to discharge");
    assert_eq!(limits(15 << 36), None, "a reason to charge");
}

#[test]
fn one_wrong_bit_anywhere_is_noticed() {
    let status = Status {
        phase: PHASES[6],
        cause: Cause::None,
        trip: Trip::None,
        permit: true,
        mode: Mode::Drive,
        soc: 0.8,
        soc_sd: 0.01,
    };
    let pack = Pack { pack_v: 52.0, link_v: 51.9, current_a: 17.0 };
    let limits = encode_limits(&Limits::NONE, 2);
    for bit in 0..64 {
        assert_eq!(Status::decode(&harmed(&status.encode(5), bit)), None, "bit {bit}");
        assert_eq!(Pack::decode(&harmed(&pack.encode(5), bit)), None, "bit {bit}");
        assert_eq!(decode_limits(&harmed(&limits, bit)), None, "bit {bit}");
    }
}

#[test]
fn a_message_under_another_identifier_is_noticed() {
    let pack = Pack { pack_v: 52.0, link_v: 51.9, current_a: 17.0 };
    let moved = message(0x512, pack.encode(1).data());
    assert_eq!(decode_limits(&moved), None, "the checksum knows the identifier");
    assert_eq!(Status::decode(&pack.encode(1)), None);
}

#[test]
fn the_checksum_is_that_of_the_standard() {
    // Over the identifier 0x511 and seven bytes, by another implementation of CRC-8 SAE J1850,
    // bit by bit.
    let sent = Pack { pack_v: 1.0, link_v: 2.0, current_a: 3.0 }.encode(7);
    let mut crc = 0xff_u8;
    for byte in [0x11, 0x05].iter().chain(&sent.data()[..7]) {
        crc ^= byte;
        for _ in 0..8 {
            crc = if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0x1d };
        }
    }
    assert_eq!(sent.data()[7], crc ^ 0xff, "{:02x?}", sent.data());
}
