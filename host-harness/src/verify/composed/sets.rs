//! The parameter sets of the source work (`EPowertrain2025`).

use super::{Controller, Description, Drive, Machine};

const UDDS_DRIVE: Drive = Drive {
    machine: Machine::Dc { r: 0.025, l: 1e-3, ke: 1.4, kt: 1.4 },
    j: 3.87e-7,
    bm: 4.21e-6,
    gear: 1.0,
    rate: f64::NAN,
};

/// Table 5.5 with the motor constants of the printed code.
pub const UDDS: Description = Description {
    v_empty: 500.0,
    v_full: 600.0,
    q_ah: 30.0,
    rs: 0.06,
    rp: 1e-3,
    c: 1e-6,
    load_s: 0.0,
    drives: &[UDDS_DRIVE],
    radius: 0.25,
    mass: 1500.0,
    area: 2.2,
    cd: 0.29,
    cr: 0.009,
    rho: 1.2,
    controller: Some(Controller {
        k: 20.0,
        i: 0.1,
        d: 0.0,
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        smoothing: 1e6,
    }),
};

/// Table 5.5 to the letter.
pub const UDDS_TABLE: Description = Description {
    drives: &[Drive {
        machine: Machine::Dc { r: 0.025, l: 1e-3, ke: 0.65, kt: 0.65 },
        ..UDDS_DRIVE
    }],
    ..UDDS
};

/// Table 5.6.
pub const I3: Description = Description {
    v_empty: 343.22,
    v_full: 399.8,
    q_ah: 60.0,
    rs: 0.1051,
    rp: 1.7834e-4,
    c: 9532.9,
    load_s: 1.0 / 80.4765,
    drives: &[Drive {
        machine: Machine::Dc { r: 1.72, l: 106.26e-6, ke: 0.7144, kt: 0.72 },
        j: 0.031,
        bm: 5e-4,
        gear: 6.0,
        rate: f64::NAN,
    }],
    radius: 0.29,
    mass: 1280.0,
    area: 2.38,
    cd: 0.29,
    cr: 0.0084,
    rho: 1.225,
    controller: Some(Controller { k: 0.5, i: 0.005, d: 0.1, min: -0.5, max: 1.0, smoothing: 1e6 }),
};
