//! A synchronous machine as a network sees it: three coils with back-EMFs.

use super::Element;
use crate::error::{ParamError, check, positive};
use crate::machine::flux::Flux;
use crate::machine::pmsm::PmsmParams;
use crate::machine::transform::{Abc, Dq, RotorAngle};
use crate::num::Real;

/// The phases of a permanent-magnet synchronous machine without saliency, for a [`Circuit`](super::Circuit):
/// each is an [`Element::Coil`], whose value in a step is its constant times the speed.
///
/// `k_n = −p·ψ_m·sin(p·θ − n·120°)`; `e_n = k_n·ω`, `T = Σ k_n·i_n`: the magnets take from the network
/// what the shaft gets. With `L_d = L_q` the equations of [`Pmsm`](crate::machine::pmsm::Pmsm) in
/// phase quantities \[EPowertrain2025, PMSM\].
///
/// ```
/// use plant_core::circuit::Phases;
/// use plant_core::presets::PMSM_EPOWERTRAIN;
///
/// let phases = Phases::new(&PMSM_EPOWERTRAIN).unwrap();
/// // A quarter turn on, phase a makes its greatest torque: 2·0.125 N·m/A.
/// assert!((phases.constants_nm_per_a(0.25).a + 0.25).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Phases {
    ohm: Real,
    henry: Real,
    /// `p·ψ_m`
    largest_nm_per_a: Real,
}

impl Phases {
    /// Checks `params`. Iron loss and friction are not a matter of the network; its resistance is
    /// that at 25 °C.
    ///
    /// # Errors
    /// [`ParamError`] names a field out of range, or `flux.q_h` where the axes differ or the flux is
    /// a map: then the inductance of a phase turns with the rotor.
    pub const fn new(params: &PmsmParams) -> Result<Self, ParamError> {
        let Flux::Linear(flux) = params.flux else {
            return Err(ParamError::OutOfRange("flux.q_h"));
        };
        let ohm = check!(positive("resistance_ohm", params.resistance_ohm));
        let henry = check!(positive("flux.d_h", flux.d_h));
        let magnet_wb = check!(positive("flux.magnet_wb", flux.magnet_wb));
        if flux.q_h != flux.d_h {
            return Err(ParamError::OutOfRange("flux.q_h"));
        }
        if params.pole_pairs == 0 {
            return Err(ParamError::OutOfRange("pole_pairs"));
        }
        Ok(Self { ohm, henry, largest_nm_per_a: params.pole_pairs as Real * magnet_wb })
    }

    /// One phase.
    #[must_use]
    pub const fn coil(&self) -> Element {
        Element::Coil { henry: self.henry, ohm: self.ohm }
    }

    /// The constants of the three phases \[N·m/A = V·s/rad\] at an electrical angle in turns.
    #[must_use]
    pub fn constants_nm_per_a(&self, electrical_turns: Real) -> Abc {
        let induced = Dq { d: 0.0, q: self.largest_nm_per_a };
        induced.to_stator(RotorAngle::of_turns(electrical_turns)).to_phases()
    }
}
