//! Electric machines, and what turns three phases into one vector.

pub mod dc;
pub mod flux;
pub mod pmsm;
pub mod transform;
