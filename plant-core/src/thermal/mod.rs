//! Heat: lumped nodes, what a temperature does to a winding, and the losses of a whole drive.
//!
//! - [`ThermalNode`]: `C·dT/dt = P − (T − T_ambient)/R`; [`ThermalPair`]: two of them, one within the
//!   other, as winding and housing \[Wallscheid2016, with two nodes\]
//! - [`Derating`]: all below one temperature, nothing above another, ours
//! - [`Conductor`]: `R(T) = R_ref·(1 + α·(T − T_ref))` \[Iec60034\]
//! - [`DriveLosses`]: `P = a·T² + b·|T| + c·ω² + d`, ours
//!
//! Every node is taken implicitly, so a step of any length is stable, and what flows in less what
//! flows out is what is stored, to rounding.
//!
//! Tests: below; properties `finite`, `refusal`; order of convergence in `tests/tests/order.rs`; case
//! "thermal nodes".

mod chain;
mod losses;
mod nodes;

pub(crate) use chain::Chain;
pub use losses::{Conductor, Derating, DriveLosses};
pub use nodes::{
    ThermalNode, ThermalNodeInput, ThermalNodeOutput, ThermalNodeParams, ThermalNodeState,
    ThermalPair, ThermalPairInput, ThermalPairOutput, ThermalPairParams, ThermalPairState,
};

#[cfg(test)]
mod tests;
