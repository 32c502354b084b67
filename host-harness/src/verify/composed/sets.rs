//! The parameter sets of the source work (`EPowertrain2025`), and the vehicles of several machines
//! that `plant-core` names.

use super::{Controller, Description, Drive, Machine};

const UDDS_DRIVE: Drive = Drive {
    machine: Machine::Dc { r: 0.025, l: 1e-3, ke: 1.4, kt: 1.4 },
    j: 3.87e-7,
    bm: 4.21e-6,
    gear: 1.0,
    gear_loss: 0.0,
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
        gear_loss: 0.0,
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

/// The i3 with a synchronous machine: winding and inverter in series, the wheels' inertia at the
/// shaft of the machine.
pub const I3_PMSM: Description = Description {
    load_s: 0.0,
    drives: &[PMSM_DRIVE],
    radius: 0.340,
    mass: 1490.0,
    cr: 0.0131,
    rho: 1.2,
    controller: None,
    ..I3
};

/// The same with a DC machine in front, whose converter has a resistance alone.
pub const TWO_AXLES: Description = Description {
    drives: &[
        PMSM_DRIVE,
        Drive {
            machine: Machine::Dc { r: 6e-3, l: 50e-6, ke: 0.27, kt: 0.27 },
            j: 0.031,
            gear: 8.0,
            ..PMSM_DRIVE
        },
    ],
    ..I3_PMSM
};

const PMSM_DRIVE: Drive = Drive {
    machine: Machine::Pmsm { r: 0.012, ld: 1e-4, lq: 2e-4, magnet: 0.04, pairs: 6.0, iron: 0.016 },
    j: 0.031 + 2.2 / (9.665 * 9.665),
    bm: 5e-4,
    gear: 9.665,
    gear_loss: 0.03,
    rate: 500.0,
};
