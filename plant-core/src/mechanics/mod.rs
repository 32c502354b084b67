//! From the machine's shaft to the road, and a load on a shaft.

pub mod body;
pub mod gearbox;
pub mod rotational;
pub mod slope;
pub mod wheel;
