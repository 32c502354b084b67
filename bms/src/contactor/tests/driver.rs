//! Pins, some of which fail.

extern crate std;

use std::cell::RefCell;
use std::rc::Rc;
use std::vec;
use std::vec::Vec;

use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};

use crate::contactor::{Coils, Contactors, Feedback, PinFaults};

#[derive(Debug)]
struct Broken;

impl Error for Broken {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

type Written = Rc<RefCell<Vec<(usize, bool)>>>;

struct Coil {
    which: usize,
    works: bool,
    written: Written,
}

impl ErrorType for Coil {
    type Error = Broken;
}

impl OutputPin for Coil {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.written.borrow_mut().push((self.which, false));
        self.works.then_some(()).ok_or(Broken)
    }

    fn set_high(&mut self) -> Result<(), Broken> {
        self.written.borrow_mut().push((self.which, true));
        self.works.then_some(()).ok_or(Broken)
    }
}

struct Mirror(Option<bool>);

impl ErrorType for Mirror {
    type Error = Broken;
}

impl InputPin for Mirror {
    fn is_high(&mut self) -> Result<bool, Broken> {
        self.0.ok_or(Broken)
    }

    fn is_low(&mut self) -> Result<bool, Broken> {
        self.0.map(|high| !high).ok_or(Broken)
    }
}

fn board(works: [bool; 3], shown: [Option<bool>; 3]) -> (Contactors<Coil, Mirror>, Written) {
    let written = Written::default();
    let coil = |which: usize| Coil { which, works: works[which], written: written.clone() };
    let contactors = Contactors { coils: [coil(0), coil(1), coil(2)], feedback: shown.map(Mirror) };
    (contactors, written)
}

#[test]
fn opens_before_it_closes_and_writes_every_pin() {
    let coils = Coils { minus: true, precharge: false, plus: true };
    for works in [[true; 3], [false, true, true], [true, false, true], [false; 3]] {
        let (mut contactors, written) = board(works, [None; 3]);
        let faults = contactors.apply(coils);
        assert_eq!(*written.borrow(), vec![(1, false), (0, true), (2, true)]);
        assert_eq!(faults.coils, works.map(|works| !works));
        assert_eq!(faults.any(), works.contains(&false));
    }
}

#[test]
fn a_pin_that_cannot_be_read_shows_nothing() {
    let (mut contactors, _) = board([true; 3], [Some(true), None, Some(false)]);
    let mut faults = PinFaults::default();
    let shown = contactors.read(&mut faults);
    assert_eq!(shown, [Feedback::Closed, Feedback::Unknown, Feedback::Open]);
    assert_eq!(faults.feedback, [false, true, false]);
    assert!(faults.any());
}
