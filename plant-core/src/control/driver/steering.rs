//! Who drives which drives.

use super::{Driver, DriverInput, DriverState, TorqueDriver};
use crate::converter::Gates;
use crate::num::Real;
use crate::powertrain::{Drive, Drives};

/// What a driver makes of its input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steered<C> {
    /// The command of the drives.
    pub command: C,
    /// Force of the friction brake \[N\], ≥ 0.
    pub brake_n: Real,
    /// The input was refused; the command is that of before.
    pub rejected: bool,
}

/// A driver of these drives: a [`Driver`] of one DC drive by its duty, a [`TorqueDriver`] of any by a
/// torque, of which each takes its share.
pub trait Steering<D: Drives> {
    /// Advances the driver by one step.
    fn steer(&self, state: &mut DriverState, input: DriverInput, drives: &D)
    -> Steered<D::Command>;
}

impl Steering<Drive> for Driver {
    #[inline(always)]
    fn steer(&self, state: &mut DriverState, input: DriverInput, _: &Drive) -> Steered<Gates> {
        let out = self.step(state, input);
        Steered { command: Gates::On(out.duty), brake_n: out.brake_n, rejected: out.rejected }
    }
}

impl<D: Drives> Steering<D> for TorqueDriver {
    #[inline(always)]
    fn steer(
        &self,
        state: &mut DriverState,
        input: DriverInput,
        drives: &D,
    ) -> Steered<D::Command> {
        let out = self.step(state, input);
        let command = drives.command(out.torque_nm);
        Steered { command, brake_n: out.brake_n, rejected: out.rejected }
    }
}
