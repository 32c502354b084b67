//! `voltstep identify`: parameters from measurements, each with its standard error.
//!
//! For given time constants and activation temperatures the voltage of a
//! [`MappedBattery`](plant_core::battery::MappedBattery) is linear in its open-circuit voltages and
//! resistances, which are tables over the state of charge. `normal` runs the model over every
//! series and sums the normal equations by blocks, `fit` finds the least squares under bounds and
//! the standard errors by leaving blocks out, `cross` does the same with whole files. `vehicle` finds
//! what trips tell of a vehicle.

mod battery;
mod capacity;
mod cross;
mod fit;
mod input;
mod layout;
mod normal;
mod parameters;
mod series;
mod telling;
#[cfg(test)]
mod tests;
mod thermal;
mod vehicle;
mod write;

pub use battery::{Identified, Options, Tick, identify, of_records};
pub use capacity::Estimate;
pub use cross::HeldOut;
pub use input::NoCapacity;
pub use thermal::Node;
pub use vehicle::{
    IdentifiedVehicle, LeftOut, Parameter, VehicleOptions, identify_vehicle, vehicle_of_trips,
};
