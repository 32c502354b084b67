//! Electric machines.

pub mod dc;
