//! A frame of a CAN bus that is not there.

use embedded_can::{Frame, Id};

/// Eight bytes and an identifier.
pub struct CanFrame {
    id: Id,
    data: [u8; 8],
    length: usize,
}

impl Frame for CanFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self { id: id.into(), data: bytes, length: data.len() })
    }

    fn new_remote(_id: impl Into<Id>, _length: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.length
    }

    fn data(&self) -> &[u8] {
        self.data.get(..self.length).unwrap_or_default()
    }
}
