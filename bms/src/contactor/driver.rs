//! Coils on pins, and what the mirror contacts show.

use embedded_hal::digital::{InputPin, OutputPin};

use super::state::{Coils, Feedback};

/// Three contactors on pins: minus, precharge, plus. High closes, and high shows closed.
///
/// ```
/// # use embedded_hal::digital::{InputPin, OutputPin};
/// # use voltstep_bms::contactor::{Coils, Contactors, Feedback, PinFaults};
/// fn drive<O: OutputPin, I: InputPin>(
///     contactors: &mut Contactors<O, I>,
///     coils: Coils,
/// ) -> ([Feedback; 3], PinFaults) {
///     let mut faults = contactors.apply(coils);
///     let feedback = contactors.read(&mut faults);
///     (feedback, faults)
/// }
/// ```
#[derive(Debug)]
pub struct Contactors<O, I> {
    /// The pins that drive.
    pub coils: [O; 3],
    /// The pins that read.
    pub feedback: [I; 3],
}

/// Pins that failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PinFaults {
    /// Of those that drive.
    pub coils: [bool; 3],
    /// Of those that read.
    pub feedback: [bool; 3],
}

impl PinFaults {
    /// Whether any failed.
    #[must_use]
    pub fn any(&self) -> bool {
        self.coils.contains(&true) || self.feedback.contains(&true)
    }
}

impl<O: OutputPin, I: InputPin> Contactors<O, I> {
    /// Puts coils on their pins: what opens before what closes. A pin that fails is told; the others
    /// are written all the same.
    pub fn apply(&mut self, coils: Coils) -> PinFaults {
        let wanted = [coils.minus, coils.precharge, coils.plus];
        let mut faults = PinFaults::default();
        for closes in [false, true] {
            let pins = self.coils.iter_mut().zip(wanted).zip(&mut faults.coils);
            for ((pin, on), fault) in pins.filter(|((_, on), _)| *on == closes) {
                *fault = pin.set_state(on.into()).is_err();
            }
        }
        faults
    }

    /// What the contactors show; unknown where a pin fails.
    pub fn read(&mut self, faults: &mut PinFaults) -> [Feedback; 3] {
        let mut shown = [Feedback::Unknown; 3];
        let pins = self.feedback.iter_mut().zip(&mut shown).zip(&mut faults.feedback);
        for ((pin, shown), fault) in pins {
            match pin.is_high() {
                Ok(high) => *shown = if high { Feedback::Closed } else { Feedback::Open },
                Err(_) => *fault = true,
            }
        }
        shown
    }
}
