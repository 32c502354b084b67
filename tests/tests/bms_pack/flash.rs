//! A flash memory whose power fails.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// A flash memory whose power fails after so many bytes, and which then may refuse to read the
/// word that was being written.
#[derive(Clone, Debug)]
pub struct Flash {
    bytes: Vec<u8>,
    pub left: u32,
    pub torn: Option<usize>,
    pub unreadable: bool,
    pub forgets: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerCut;

impl NorFlashError for PowerCut {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Flash {
    pub fn new(bytes: usize, unreadable: bool) -> Self {
        Self { bytes: vec![0xff; bytes], left: u32::MAX, torn: None, unreadable, forgets: false }
    }

    fn program(&mut self, at: usize, byte: u8) -> Result<(), PowerCut> {
        if self.left == 0 {
            self.torn = Some(at);
            return Err(PowerCut);
        }
        self.left -= 1;
        self.bytes[at] = byte;
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = PowerCut;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerCut> {
        let range = offset as usize..offset as usize + bytes.len();
        if self.unreadable && self.torn.is_some_and(|at| range.contains(&at)) {
            return Err(PowerCut);
        }
        bytes.copy_from_slice(&self.bytes[range]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 128;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerCut> {
        (from..to).try_for_each(|at| self.program(at as usize, 0xff))?;
        if self.torn.is_some_and(|at| (from as usize..to as usize).contains(&at)) {
            self.torn = None;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerCut> {
        if self.forgets {
            return Ok(());
        }
        // A flash memory clears bits and sets none.
        let old = self.bytes.clone();
        bytes
            .iter()
            .zip(offset as usize..)
            .try_for_each(|(byte, at)| self.program(at, old[at] & byte))
    }
}
