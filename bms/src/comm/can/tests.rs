extern crate std;

mod dbc;
mod inverter;
mod messages;
mod readout;
mod request;
mod signals;

use embedded_can::{ExtendedId, Frame, Id, StandardId};

use super::field::Layout;
use super::{Message, cells, faults, inverter as map, readout as log, request as ask, state};

/// Every layout of our own map.
const OWN: &[&Layout] = &[
    &state::STATUS,
    &state::PACK,
    &state::LIMITS,
    &cells::CELL_EXTREMES,
    &cells::TEMPERATURE_EXTREMES,
    &cells::CELLS,
    &faults::FAULTS,
    &log::LOG_PART,
    &ask::VEHICLE_REQUEST,
    &ask::CHARGER_REQUEST,
    &log::LOG_REQUEST,
];

/// Every layout of the inverters' map.
const INVERTER: &[&Layout] =
    &[&map::LIMITS, &map::CHARGE, &map::MEASURED, &map::ALARMS, &map::PERMITS, &map::MAKER];

/// A frame as drivers have them.
#[derive(Clone, Debug)]
struct DriverFrame {
    id: Id,
    data: std::vec::Vec<u8>,
    remote: bool,
}

impl Frame for DriverFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= 8).then(|| Self { id: id.into(), data: data.to_vec(), remote: false })
    }

    fn new_remote(id: impl Into<Id>, _: usize) -> Option<Self> {
        Some(Self { id: id.into(), data: std::vec::Vec::new(), remote: true })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.data.len()
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}

/// A message with these data, of any length.
fn message(id: u16, data: &[u8]) -> Message {
    Message::of(&DriverFrame::new(StandardId::new(id).unwrap(), data).unwrap()).unwrap()
}

/// A message with one bit turned around.
fn harmed(sound: &Message, bit: usize) -> Message {
    let mut data = sound.data().to_vec();
    data[bit / 8] ^= 1 << (bit % 8);
    message(sound.id(), &data)
}

#[test]
fn a_frame_comes_back_as_it_went() {
    for layout in OWN.iter().chain(INVERTER) {
        let sent = layout.message(0x0807_0605_0403_0201);
        let frame: DriverFrame = sent.frame().unwrap();
        assert_eq!(frame.id, Id::Standard(StandardId::new(layout.id).unwrap()));
        assert_eq!(frame.data, [1, 2, 3, 4, 5, 6, 7, 8][..layout.length]);
        assert_eq!(Message::of(&frame).unwrap().data(), sent.data());
    }
}

#[test]
fn other_kinds_of_frame_are_no_message() {
    let extended = ExtendedId::new(0x510).unwrap();
    let standard = StandardId::new(0x510).unwrap();
    assert_eq!(Message::of(&DriverFrame::new(extended, &[0; 8]).unwrap()), None);
    assert_eq!(Message::of(&DriverFrame::new_remote(standard, 8).unwrap()), None);
    let long = DriverFrame { id: Id::Standard(standard), data: std::vec![0; 9], remote: false };
    assert_eq!(Message::of(&long), None, "longer than CAN");
}

#[test]
fn a_message_of_another_length_is_another() {
    for layout in OWN.iter().chain(INVERTER) {
        for length in 0..=8 {
            let found = message(layout.id, &[0; 8][..length]).bits(layout).is_some();
            assert_eq!(found, length == layout.length, "{} of {length}", layout.name);
        }
    }
}

#[test]
fn signals_do_not_overlap_and_lie_inside() {
    for layout in OWN.iter().chain(INVERTER) {
        let mut taken = 0_u128;
        for field in layout.fields {
            let own = ((1_u128 << field.width) - 1) << field.start;
            let own = field.valid.map_or(own, |bit| own | 1 << bit);
            assert_eq!(taken & own, 0, "{}: {}", layout.name, field.name);
            taken |= own;
        }
        assert!(taken < 1 << (8 * layout.length), "{}", layout.name);
    }
}
