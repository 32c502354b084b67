//! What turns: a load on a shaft, and the shaft's angle.

mod axis;
mod load;

pub use axis::{Axis, AxisInput, AxisOutput, AxisState};
pub(crate) use axis::{angle_rad, turn, turns_per_rad_s};
pub use load::{
    RotationalLoad, RotationalLoadInput, RotationalLoadOutput, RotationalLoadParams,
    RotationalLoadState,
};
