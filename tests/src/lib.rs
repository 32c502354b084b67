//! Tests of the whole workspace. The crate itself is empty; the tests are in `tests/`:
//!
//! | Test | What it holds |
//! |---|---|
//! | `properties` | what is true of the models for any input and any parameters (proptest) |
