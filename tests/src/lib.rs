//! Tests of the whole workspace. The crate itself is empty; the tests are in `tests/`:
//!
//! | Test | What it holds |
//! |---|---|
//! | `bms_pack` | coulomb counter, cells and record: honest, finite, never a wrong record |
//! | `bms_power` | the state of power's currents and powers, tried on the plant |
//! | `bms_soh` | the state of health of a faded cell after ten days of driving and charging |
//! | `coverage` | every public model has a case in `voltstep validate` |
//! | `order` | order of convergence, stability and steady state at any step |
//! | `properties` | what is true of the models for any input and any parameters (proptest) |
//! | `reference_system` | the published reference system: UDDS in closed loop, the DC motor's step |
//! | `rounding` | single precision against double, after ten hours of driving |
//! | `trips` | trips against their measurements; real ones where `VOLTSTEP_DATA` names them |
