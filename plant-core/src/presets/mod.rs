//! Parameter sets, each with its source.
//!
//! `voltstep` reads the same vehicles from `data/vehicles/*.toml`; a test keeps the two equal.

mod batteries;
mod table_5_2;
mod thermal;

pub use batteries::{BMW_I3_60AH_PACK, PANASONIC_NCR18650PF};
pub use table_5_2::{BMW_I3_60AH_TABLE_5_2, EPOWERTRAIN_TABLE_5_2, IdentifiedAt};
pub use thermal::BMW_I3_60AH_THERMAL;

use crate::auxiliary::AuxiliaryParams;
use crate::battery::{
    BatteryParams, MappedBatteryParams, OpenCircuit, RcBranchParams, VoltageLimits,
};
use crate::control::driver::{DriverParams, TorqueDriverParams};
use crate::control::pid::{AntiWindup, DerivativeOf, PidParams};
use crate::converter::ConverterParams;
use crate::machine::dc::DcMotorParams;
use crate::machine::flux::{Flux, LinearFlux};
use crate::machine::pmsm::{COPPER_PER_K, PmsmParams};
use crate::mechanics::body::{BodyParams, RoadResistance};
use crate::mechanics::gearbox::GearboxParams;
use crate::mechanics::rotational::RotationalLoadParams;
use crate::mechanics::wheel::WheelParams;
use crate::num::Real;
use crate::powertrain::{DriveParams, PowertrainParams, TORQUE_RATE_PER_S};

/// A vehicle with its driver; `P` says which battery it has, `D` what drives it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vehicle<P = BatteryParams, D = DriveParams> {
    /// Its name, as in `voltstep replay --vehicle`.
    pub name: &'static str,
    /// State of charge at the start of a cycle, 0..1.
    pub initial_soc: Real,
    /// The plant.
    pub powertrain: PowertrainParams<P, D>,
    /// Who drives it.
    pub driver: DriverParams,
}

/// Every vehicle whose battery has constant parameters.
pub const VEHICLES: [&Vehicle; 4] =
    [&BMW_I3_60AH_CONSTANT, &BMW_I3_60AH_EPOWERTRAIN, &EPOWERTRAIN_UDDS, &EPOWERTRAIN_UDDS_TABLE];

/// Every vehicle whose battery has parameters over state of charge and temperature.
pub const MAPPED_VEHICLES: [&Vehicle<MappedBatteryParams>; 1] = [&BMW_I3_60AH];

/// The laboratory motor as identified by Pasek's method \[EPowertrain2025, section 5.2.1\].
pub const MOTOR_PASEK: DcMotorParams = DcMotorParams {
    resistance_ohm: 30.9,
    inductance_h: 0.438,
    back_emf_v_s_per_rad: 1.323,
    torque_nm_per_a: 1.323,
    inertia_kg_m2: 0.0036,
    viscous_nm_s_per_rad: 0.0005,
    coulomb_nm: 0.128,
};

/// The same motor as identified by the method of moments \[EPowertrain2025, section 5.2.1\].
pub const MOTOR_MOMENTS: DcMotorParams =
    DcMotorParams { inductance_h: 0.803, inertia_kg_m2: 0.0031, ..MOTOR_PASEK };

/// The motor of the converter bench \[EPowertrain2025, Table 5.4\]. Its Kt exceeds its Ke, so it
/// creates energy: the ledger's `conversion` term is negative.
pub const CONVERTER_BENCH_MOTOR: DcMotorParams = DcMotorParams {
    resistance_ohm: 0.025,
    inductance_h: 1e-3,
    back_emf_v_s_per_rad: 0.7144,
    torque_nm_per_a: 0.72,
    inertia_kg_m2: 0.031,
    viscous_nm_s_per_rad: 5e-4,
    coulomb_nm: 0.0,
};

/// Supply of the converter bench \[V\] \[EPowertrain2025, Table 5.4\].
pub const CONVERTER_BENCH_SUPPLY_V: Real = 400.0;

/// Load of the converter bench \[EPowertrain2025, Table 5.4\].
pub const CONVERTER_BENCH_LOAD: RotationalLoadParams =
    RotationalLoadParams { inertia_kg_m2: 10.0, viscous_nm_s_per_rad: 8.5e-6, coulomb_nm: 0.0 };

/// The controller of both UDDS sets \[EPowertrain2025, section 5.3\]: m/s to duty, no limit.
const UDDS_PID: PidParams = PidParams {
    proportional: 20.0,
    integral_per_s: 0.1,
    derivative_s: 0.0,
    derivative_filter_s: 0.0,
    derivative_of: DerivativeOf::Error,
    dead_zone: 1e-9,
    output_min: -Real::INFINITY,
    output_max: Real::INFINITY,
    smoothing_per_s: 1e6,
    anti_windup: AntiWindup::Freeze,
};

/// The synchronous machine of the source work, with its defaults \[EPowertrain2025, PMSM\].
pub const PMSM_EPOWERTRAIN: PmsmParams = PmsmParams {
    flux: Flux::Linear(LinearFlux { magnet_wb: 0.125, d_h: 7e-3, q_h: 7e-3 }),
    resistance_ohm: 2.98,
    resistance_per_k: 0.0,
    pole_pairs: 2,
    iron_s: 0.0,
    inertia_kg_m2: 4.7e-5,
    viscous_nm_s_per_rad: 1.1e-4,
    coulomb_nm: 0.0,
};

/// Table 5.5 of EPowertrain2025, to the letter.
pub const EPOWERTRAIN_UDDS_TABLE: Vehicle = Vehicle {
    name: "epowertrain-udds-table",
    initial_soc: 0.80,
    powertrain: PowertrainParams {
        battery: BatteryParams {
            open_circuit: OpenCircuit::Linear { empty_v: 500.0, full_v: 600.0 },
            capacity_ah: 30.0,
            series_resistance_ohm: 0.06,
            polarisation: RcBranchParams { resistance_ohm: 1e-3, capacitance_f: 1e-6 },
            discharge_limit_a: 400.0,
            charge_limit_a: 400.0,
            voltage_limits: VoltageLimits::NONE,
        },
        auxiliary: AuxiliaryParams::NONE,
        drives: DriveParams {
            converter: ConverterParams { duty_limit: Real::INFINITY, ..ConverterParams::IDEAL },
            motor: DcMotorParams {
                resistance_ohm: 0.025,
                inductance_h: 1e-3,
                back_emf_v_s_per_rad: 0.65,
                torque_nm_per_a: 0.65,
                inertia_kg_m2: 3.87e-7,
                viscous_nm_s_per_rad: 4.21e-6,
                coulomb_nm: 0.0,
            },
            gearbox: GearboxParams::NONE,
            torque_rate_per_s: TORQUE_RATE_PER_S,
            torque_share: 1.0,
        },
        wheel: WheelParams { radius_m: 0.25, inertia_kg_m2: 0.0, viscous_nm_s_per_rad: 0.0 },
        body: BodyParams {
            mass_kg: 1500.0,
            resistance: RoadResistance::Physical {
                drag_coefficient: 0.29,
                frontal_area_m2: 2.2,
                air_density_kg_m3: 1.2,
                rolling_coefficient: 0.009,
            },
        },
    },
    driver: DriverParams::Duty(UDDS_PID),
};

/// Table 5.5 of EPowertrain2025 with the motor constants of its printed code, Ke = Kt = 1.4:
/// the reading that gives the published state of charge.
pub const EPOWERTRAIN_UDDS: Vehicle = Vehicle {
    name: "epowertrain-udds",
    powertrain: PowertrainParams {
        drives: DriveParams {
            motor: DcMotorParams {
                back_emf_v_s_per_rad: 1.4,
                torque_nm_per_a: 1.4,
                ..EPOWERTRAIN_UDDS_TABLE.powertrain.drives.motor
            },
            ..EPOWERTRAIN_UDDS_TABLE.powertrain.drives
        },
        ..EPOWERTRAIN_UDDS_TABLE.powertrain
    },
    ..EPOWERTRAIN_UDDS_TABLE
};

/// The BMW i3 of EPowertrain2025, Table 5.6, to the letter. Its winding resistance is rated
/// voltage over rated current, not an armature resistance, its gear ratio is not the car's, and
/// its Kt exceeds its Ke: see [`BMW_I3_60AH`] for a physical set.
pub const BMW_I3_60AH_EPOWERTRAIN: Vehicle = Vehicle {
    name: "bmw-i3-60ah-epowertrain",
    initial_soc: 0.869,
    powertrain: PowertrainParams {
        battery: BatteryParams {
            open_circuit: OpenCircuit::Linear { empty_v: 343.22, full_v: 399.8 },
            capacity_ah: 60.0,
            series_resistance_ohm: 0.1051,
            polarisation: RcBranchParams { resistance_ohm: 1.7834e-4, capacitance_f: 9532.9 },
            discharge_limit_a: 400.0,
            charge_limit_a: 400.0,
            voltage_limits: VoltageLimits::NONE,
        },
        auxiliary: AuxiliaryParams { resistance_ohm: 80.4765, ..AuxiliaryParams::NONE },
        drives: DriveParams {
            converter: ConverterParams::IDEAL,
            motor: DcMotorParams {
                resistance_ohm: 1.72,
                inductance_h: 106.26e-6,
                ..CONVERTER_BENCH_MOTOR
            },
            gearbox: GearboxParams { ratio: 6.0, efficiency: 1.0, inertia_kg_m2: 0.0 },
            torque_rate_per_s: TORQUE_RATE_PER_S,
            torque_share: 1.0,
        },
        wheel: WheelParams { radius_m: 0.29, inertia_kg_m2: 0.0, viscous_nm_s_per_rad: 0.0 },
        body: BodyParams {
            mass_kg: 1280.0,
            resistance: RoadResistance::Physical {
                drag_coefficient: 0.29,
                frontal_area_m2: 2.38,
                air_density_kg_m3: 1.225,
                rolling_coefficient: 0.0084,
            },
        },
    },
    driver: DriverParams::Duty(PidParams {
        proportional: 0.5,
        integral_per_s: 0.005,
        derivative_s: 0.1,
        output_min: -0.5,
        output_max: 1.0,
        ..UDDS_PID
    }),
};

/// A physical BMW i3 60 Ah as 26 trips of a real car tell it (TU Munich, DOI 10.21227/6jr9-5235), with
/// the battery of [`BMW_I3_60AH_PACK`]; what trips do not tell is that of [`BMW_I3_60AH_CONSTANT`].
///
/// Mass, drag, rolling resistance at 15 °C on warm tyres, gear, losses of motor and converter, base
/// load and regeneration are found by `voltstep identify vehicle`. The standard errors stand in its
/// file, and how far it is from trips that it was not fitted to. The losses are those of a DC machine
/// and a converter together: they do not tell one from the other.
pub const BMW_I3_60AH: Vehicle<MappedBatteryParams> = Vehicle {
    name: "bmw-i3-60ah",
    initial_soc: BMW_I3_60AH_CONSTANT.initial_soc,
    powertrain: PowertrainParams {
        auxiliary: AuxiliaryParams { power_w: 524.55, ..BMW_I3_60AH_CONSTANT.powertrain.auxiliary },
        drives: DriveParams {
            converter: ConverterParams {
                voltage_drop_v: 2.4574,
                ..BMW_I3_60AH_CONSTANT.powertrain.drives.converter
            },
            motor: DcMotorParams {
                resistance_ohm: 3.3193e-3,
                viscous_nm_s_per_rad: 1.1553e-3,
                ..BMW_I3_60AH_CONSTANT.powertrain.drives.motor
            },
            gearbox: GearboxParams {
                efficiency: 0.92668,
                ..BMW_I3_60AH_CONSTANT.powertrain.drives.gearbox
            },
            ..BMW_I3_60AH_CONSTANT.powertrain.drives
        },
        body: BodyParams {
            mass_kg: 1486.5,
            resistance: RoadResistance::Physical {
                drag_coefficient: 0.2461,
                frontal_area_m2: 2.38,
                air_density_kg_m3: 1.2,
                rolling_coefficient: 0.009_992_7,
            },
        },
        ..BMW_I3_60AH_CONSTANT.powertrain.with_battery(BMW_I3_60AH_PACK)
    },
    driver: match BMW_I3_60AH_CONSTANT.driver {
        DriverParams::Torque(driver) => DriverParams::Torque(TorqueDriverParams {
            regen_torque_nm: 86.5,
            regen_power_w: 54_323.0,
            regen_fade_m_s: 1.25,
            ..driver
        }),
        duty @ DriverParams::Duty(_) => duty,
    },
};

/// A physical BMW i3 60 Ah from its data sheet and estimates, with a battery of constant parameters,
/// for targets that want no map: 60 Ah, 343.22…399.8 V, 0.1051 Ω and the RC branch from
/// EPowertrain2025, Table 5.6, identified there on one trip of the real car.
///
/// | Value | Source |
/// |---|---|
/// | peak torque 250 N·m, peak power 125 kW, gear ratio 9.665, drag 0.29 · 2.38 m² | BMW, technical data of the i3 (60 Ah), 2013 |
/// | mass 1490 kg | estimate: what the motor torque of the 28 trips below accelerates, behind this gear; 1195 kg kerb weight (DIN, BMW), driver, passengers, equipment |
/// | wheel radius 0.340 m | tyre 155/70 R19, 0.350 m unloaded; rolling radius by ETRTO's circumference of 3.05 diameters |
/// | regeneration 87 N·m, 57 kW; auxiliary base load 530 W; discharge 400 A | extremes, and the median at standstill less heating and air conditioning, of 28 trips of a real car (TU Munich, DOI 10.21227/6jr9-5235) |
/// | charge limit 150 A | estimate, just above the largest of the same trips (145 A) |
/// | rolling resistance 0.0131 | estimate from the motor torque of the same trips; it stands for everything that resists at any speed |
/// | Ke = Kt = 0.27 | estimate: a DC machine that reaches 150 km/h (top speed, BMW) at 311 V without field weakening |
/// | winding 5 mΩ, 50 µH | estimate: 4.3 kW of heat at 250 N·m; 10 ms |
/// | rotor 0.031 kg·m², viscous friction | EPowertrain2025, Table 5.6 |
/// | wheels 2.2 kg·m² | estimate: four of 9 kg near the rim |
/// | gear efficiency 0.97 | estimate for one stage with differential |
/// | converter 1.0 V, 1 mΩ | estimate: about 98 % at 20 kW; its constant loss is part of the base load measured at standstill |
/// | converter 1000 A | estimate: 8 % above the current of the peak torque |
/// | regeneration fades below 3 m/s and above 95 % | estimate |
/// | friction brake 15 kN | estimate: more than the tyres hold |
pub const BMW_I3_60AH_CONSTANT: Vehicle = Vehicle {
    name: "bmw-i3-60ah-constant",
    initial_soc: 0.90,
    powertrain: PowertrainParams {
        battery: BatteryParams {
            discharge_limit_a: 400.0,
            charge_limit_a: 150.0,
            ..BMW_I3_60AH_EPOWERTRAIN.powertrain.battery
        },
        auxiliary: AuxiliaryParams {
            power_w: 530.0,
            resistance_ohm: Real::INFINITY,
            cut_out_v: 250.0,
        },
        drives: DriveParams {
            converter: ConverterParams {
                duty_limit: 1.0,
                constant_loss_w: 0.0,
                voltage_drop_v: 1.0,
                resistance_ohm: 1e-3,
                current_limit_a: 1000.0,
            },
            motor: DcMotorParams {
                resistance_ohm: 5e-3,
                inductance_h: 50e-6,
                back_emf_v_s_per_rad: 0.27,
                torque_nm_per_a: 0.27,
                inertia_kg_m2: 0.031,
                viscous_nm_s_per_rad: 5e-4,
                coulomb_nm: 0.0,
            },
            gearbox: GearboxParams { ratio: 9.665, efficiency: 0.97, inertia_kg_m2: 0.0 },
            torque_rate_per_s: TORQUE_RATE_PER_S,
            torque_share: 1.0,
        },
        wheel: WheelParams { radius_m: 0.340, inertia_kg_m2: 2.2, viscous_nm_s_per_rad: 0.0 },
        body: BodyParams {
            mass_kg: 1490.0,
            resistance: RoadResistance::Physical {
                drag_coefficient: 0.29,
                frontal_area_m2: 2.38,
                air_density_kg_m3: 1.2,
                rolling_coefficient: 0.0131,
            },
        },
    },
    driver: DriverParams::Torque(TorqueDriverParams {
        speed: PidParams {
            proportional: 6000.0,
            integral_per_s: 3000.0,
            derivative_s: 0.0,
            derivative_filter_s: 0.0,
            derivative_of: DerivativeOf::Measurement,
            dead_zone: 0.0,
            output_min: -20_000.0,
            output_max: 20_000.0,
            smoothing_per_s: Real::INFINITY,
            anti_windup: AntiWindup::Directional,
        },
        peak_torque_nm: 250.0,
        peak_power_w: 125_000.0,
        regen_torque_nm: 87.0,
        regen_power_w: 57_000.0,
        regen_fade_m_s: 3.0,
        regen_fade_soc: 0.05,
        brake_limit_n: 15_000.0,
        current_rate_per_s: 250.0,
    }),
};

/// The same car with a synchronous machine in the place of the DC machine that stands for it.
///
/// The real car has one of 6 pole pairs, 250 N·m, 125 kW and 11 400 rpm (BMW, technical data of the
/// i3, 2013). Its flux and inductances are estimates: those with which 530 A make 250 N·m, and 355 V
/// hold that torque up to 4500 rpm; 10 mΩ make the heat of [`BMW_I3_60AH_CONSTANT`] at that torque, and the
/// iron takes 1 kW at full voltage.
pub const BMW_I3_60AH_PMSM: Vehicle<BatteryParams, DriveParams<PmsmParams>> = Vehicle {
    name: "bmw-i3-60ah-pmsm",
    initial_soc: BMW_I3_60AH_CONSTANT.initial_soc,
    powertrain: BMW_I3_60AH_CONSTANT.powertrain.with_drives(I3_PMSM_DRIVE),
    driver: BMW_I3_60AH_CONSTANT.driver,
};

/// The drive of [`BMW_I3_60AH_PMSM`].
const I3_PMSM_DRIVE: DriveParams<PmsmParams> = DriveParams {
    converter: ConverterParams {
        duty_limit: 1.0,
        constant_loss_w: 0.0,
        voltage_drop_v: 0.0,
        resistance_ohm: 2e-3,
        current_limit_a: 600.0,
    },
    motor: PmsmParams {
        flux: Flux::Linear(LinearFlux { magnet_wb: 0.04, d_h: 1e-4, q_h: 2e-4 }),
        resistance_ohm: 0.01,
        resistance_per_k: COPPER_PER_K,
        pole_pairs: 6,
        iron_s: 0.016,
        inertia_kg_m2: 0.031,
        viscous_nm_s_per_rad: 5e-4,
        coulomb_nm: 0.0,
    },
    gearbox: GearboxParams { ratio: 9.665, efficiency: 0.97, inertia_kg_m2: 0.0 },
    torque_rate_per_s: TORQUE_RATE_PER_S,
    torque_share: 1.0,
};

/// A car with two axles: the drive of [`BMW_I3_60AH_PMSM`] behind, which takes 70 % of the driver's
/// demand, and a small DC machine in front. No car that is built; an example of two drives.
pub const TWO_AXLES: Vehicle<BatteryParams, (DriveParams<PmsmParams>, DriveParams)> = Vehicle {
    name: "two-axles",
    initial_soc: BMW_I3_60AH_CONSTANT.initial_soc,
    powertrain: BMW_I3_60AH_CONSTANT.powertrain.with_drives((
        DriveParams { torque_share: 0.7, ..I3_PMSM_DRIVE },
        DriveParams {
            converter: ConverterParams {
                current_limit_a: 400.0,
                ..BMW_I3_60AH_CONSTANT.powertrain.drives.converter
            },
            gearbox: GearboxParams { ratio: 8.0, efficiency: 0.97, inertia_kg_m2: 0.0 },
            torque_share: 0.3,
            ..BMW_I3_60AH_CONSTANT.powertrain.drives
        },
    )),
    driver: BMW_I3_60AH_CONSTANT.driver,
};
