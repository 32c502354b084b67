//! What turns: a load on a shaft, the shaft's angle, a shaft with inertia.

mod axis;
mod load;
mod rot_axis;

pub use axis::{Axis, AxisInput, AxisOutput, AxisState};
pub(crate) use axis::{angle_rad, turn, turns_per_rad_s};
pub use load::{
    RotationalLoad, RotationalLoadInput, RotationalLoadOutput, RotationalLoadParams,
    RotationalLoadState,
};
pub use rot_axis::{RotAxis, RotAxisInput, RotAxisOutput, RotAxisParams, RotAxisState};
