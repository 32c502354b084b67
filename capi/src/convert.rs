//! From C's parameters to the models' and back. A choice that is none is refused by its name.

mod drives;

use plant_core::Dt;
use plant_core::ParamError;
use plant_core::auxiliary::AuxiliaryParams;
#[cfg(any(feature = "drives", feature = "pmsm", feature = "thermal"))]
use plant_core::battery::Battery;
use plant_core::battery::{BatteryParams, OpenCircuit, RcBranchParams, VoltageLimits};
#[cfg(any(feature = "drives", feature = "pmsm", feature = "thermal"))]
use plant_core::control::driver::TorqueDriver;
use plant_core::control::driver::{Driver, DriverParams, TorqueDriverParams};
use plant_core::control::pid::{AntiWindup, DerivativeOf, PidParams};
use plant_core::mechanics::body::{BodyParams, RoadResistance};
use plant_core::mechanics::wheel::WheelParams;
use plant_core::num::SocTable;
#[cfg(any(feature = "drives", feature = "pmsm", feature = "thermal"))]
use plant_core::powertrain::{Axles, Drives};
use plant_core::powertrain::{Drive, Powertrain, PowertrainParams};
use plant_core::presets::Vehicle;

use crate::cars::{Car, Cars};
#[cfg(feature = "drives")]
use crate::params::VoltstepDriveParams;
use crate::params::{
    VOLTSTEP_ABI, VOLTSTEP_DRIVES, VOLTSTEP_SOC_POINTS, VoltstepAuxiliaryParams,
    VoltstepBatteryModel, VoltstepBatteryParams, VoltstepBodyParams, VoltstepDriverKind,
    VoltstepOpenCircuit, VoltstepParams, VoltstepPidParams, VoltstepRoadLaw, VoltstepTorqueParams,
    VoltstepWheelParams, VoltstepWindup,
};
use crate::status::VoltstepStatus;
use drives::{Described, DriveModel, NO_DRIVE};

const _: () = assert!(VOLTSTEP_SOC_POINTS == plant_core::num::SOC_POINTS);

impl VoltstepParams {
    /// The plant and its driver, checked and discretised.
    pub(crate) fn models(&self, dt_s: f32) -> Result<Cars, VoltstepStatus> {
        if self.abi != VOLTSTEP_ABI {
            return Err(VoltstepStatus::AbiMismatch);
        }
        let dt = Dt::from_s(dt_s)?;
        let vehicle = PowertrainParams {
            battery: self.battery.model()?,
            auxiliary: AuxiliaryParams {
                power_w: self.auxiliary.power_w,
                resistance_ohm: self.auxiliary.resistance_ohm,
                cut_out_v: self.auxiliary.cut_out_v,
            },
            drives: (),
            wheel: WheelParams {
                radius_m: self.wheel.radius_m,
                inertia_kg_m2: self.wheel.inertia_kg_m2,
                viscous_nm_s_per_rad: self.wheel.viscous_nm_s_per_rad,
            },
            body: self.body.model()?,
        };
        #[cfg(feature = "drives")]
        let axle = |drive: &VoltstepDriveParams| drive.axles(vehicle.wheel, dt);
        let driver = self.driver()?;
        let [one, ..] = &self.drives;
        #[cfg(feature = "drives")]
        let [_, two, three, four] = &self.drives;
        Ok(match self.drive_count {
            #[cfg(feature = "thermal")]
            1 if one.thermal.heated != 0 => match one.model()? {
                DriveModel::Dc(drive) => {
                    let axles = one.warm(drive).on(vehicle.wheel, dt)?;
                    Cars::HeatedDc(composed(&vehicle, axles, driver, dt)?)
                }
                #[cfg(feature = "pmsm")]
                DriveModel::Pmsm(drive) => {
                    let axles = one.warm(drive).on(vehicle.wheel, dt)?;
                    Cars::HeatedPmsm(composed(&vehicle, axles, driver, dt)?)
                }
            },
            1 => match one.model()? {
                DriveModel::Dc(drive) => Cars::Dc(dc(vehicle.with_drives(drive), driver, dt)?),
                #[cfg(feature = "pmsm")]
                DriveModel::Pmsm(drive) => {
                    Cars::Pmsm(composed(&vehicle, drive.on(vehicle.wheel, dt)?, driver, dt)?)
                }
            },
            #[cfg(not(feature = "drives"))]
            2..=4 => return Err(VoltstepStatus::NotBuiltIn),
            #[cfg(feature = "drives")]
            2 => Cars::Two(composed(&vehicle, axle(one)?.and(axle(two)?), driver, dt)?),
            #[cfg(feature = "drives")]
            3 => {
                let axles = axle(one)?.and(axle(two)?.and(axle(three)?));
                Cars::Three(composed(&vehicle, axles, driver, dt)?)
            }
            #[cfg(feature = "drives")]
            4 => {
                let axles = axle(one)?.and(axle(two)?).and(axle(three)?.and(axle(four)?));
                Cars::Four(composed(&vehicle, axles, driver, dt)?)
            }
            _ => return Err(VoltstepStatus::DriveCount),
        })
    }

    fn driver(&self) -> Result<Option<DriverParams>, VoltstepStatus> {
        match self.driver {
            d if d == VoltstepDriverKind::None as u32 => Ok(None),
            d if d == VoltstepDriverKind::Duty as u32 => {
                Ok(Some(DriverParams::Duty(self.pid.model()?)))
            }
            d if d == VoltstepDriverKind::Torque as u32 => {
                let t = &self.torque;
                Ok(Some(DriverParams::Torque(TorqueDriverParams {
                    speed: self.pid.model()?,
                    peak_torque_nm: t.peak_torque_nm,
                    peak_power_w: t.peak_power_w,
                    regen_torque_nm: t.regen_torque_nm,
                    regen_power_w: t.regen_power_w,
                    regen_fade_m_s: t.regen_fade_m_s,
                    regen_fade_soc: t.regen_fade_soc,
                    brake_limit_n: t.brake_limit_n,
                    current_rate_per_s: t.current_rate_per_s,
                })))
            }
            _ => Err(VoltstepStatus::UnknownDriver),
        }
    }
}

/// One DC machine, whose driver may ask for a duty.
fn dc(
    vehicle: PowertrainParams,
    driver: Option<DriverParams>,
    dt: Dt,
) -> Result<Car<Drive, Driver>, VoltstepStatus> {
    let plant = Powertrain::new(vehicle, dt)?;
    let driver = match driver {
        Some(params) => Some(Driver::new(params, &vehicle, dt)?),
        None => None,
    };
    Ok(Car { plant, driver })
}

/// Any drives, whose driver asks for a torque.
#[cfg(any(feature = "drives", feature = "pmsm", feature = "thermal"))]
fn composed<D: Drives>(
    vehicle: &PowertrainParams<BatteryParams, ()>,
    axles: Axles<D>,
    driver: Option<DriverParams>,
    dt: Dt,
) -> Result<Car<D, TorqueDriver>, VoltstepStatus> {
    let plant = Powertrain::of(Battery::new(vehicle.battery, dt)?, axles, vehicle, dt)?;
    let driver = match driver {
        Some(DriverParams::Torque(params)) => {
            let (body_kg, moving_kg) = (vehicle.body.mass_kg, plant.moving_mass_kg());
            Some(TorqueDriver::fitted(params, plant.motor_rad_per_m(), body_kg, moving_kg, dt)?)
        }
        Some(DriverParams::Duty(_)) => return Err(VoltstepStatus::DriverOfOneDc),
        None => None,
    };
    Ok(Car { plant, driver })
}

impl VoltstepBatteryParams {
    fn model(&self) -> Result<BatteryParams, VoltstepStatus> {
        if self.model != VoltstepBatteryModel::Constant as u32 {
            return Err(VoltstepStatus::UnknownBatteryModel);
        }
        let open_circuit = match self.open_circuit {
            o if o == VoltstepOpenCircuit::Linear as u32 => {
                OpenCircuit::Linear { empty_v: self.empty_v, full_v: self.full_v }
            }
            o if o == VoltstepOpenCircuit::Table as u32 => {
                OpenCircuit::Table(SocTable::new("battery.open_circuit.table", self.table_v)?)
            }
            _ => return Err(VoltstepStatus::UnknownOpenCircuit),
        };
        Ok(BatteryParams {
            open_circuit,
            capacity_ah: self.capacity_ah,
            series_resistance_ohm: self.series_resistance_ohm,
            polarisation: RcBranchParams {
                resistance_ohm: self.polarisation_resistance_ohm,
                capacitance_f: self.polarisation_capacitance_f,
            },
            discharge_limit_a: self.discharge_limit_a,
            charge_limit_a: self.charge_limit_a,
            voltage_limits: VoltageLimits::NONE,
        })
    }
}

impl VoltstepBodyParams {
    fn model(&self) -> Result<BodyParams, VoltstepStatus> {
        let resistance = match self.road_law {
            r if r == VoltstepRoadLaw::Physical as u32 => RoadResistance::Physical {
                drag_coefficient: self.drag_coefficient,
                frontal_area_m2: self.frontal_area_m2,
                air_density_kg_m3: self.air_density_kg_m3,
                rolling_coefficient: self.rolling_coefficient,
            },
            r if r == VoltstepRoadLaw::CoastDown as u32 => RoadResistance::CoastDown {
                a_n: self.a_n,
                b_n_s_per_m: self.b_n_s_per_m,
                c_n_s2_per_m2: self.c_n_s2_per_m2,
            },
            _ => return Err(VoltstepStatus::UnknownRoadLaw),
        };
        Ok(BodyParams { mass_kg: self.mass_kg, resistance })
    }
}

impl VoltstepPidParams {
    fn model(&self) -> Result<PidParams, VoltstepStatus> {
        let anti_windup = match self.anti_windup {
            a if a == VoltstepWindup::Freeze as u32 => AntiWindup::Freeze,
            a if a == VoltstepWindup::Directional as u32 => AntiWindup::Directional,
            _ => return Err(VoltstepStatus::UnknownWindup),
        };
        let derivative_of = if self.derivative_of_measurement == 0 {
            DerivativeOf::Error
        } else {
            DerivativeOf::Measurement
        };
        Ok(PidParams {
            proportional: self.proportional,
            integral_per_s: self.integral_per_s,
            derivative_s: self.derivative_s,
            derivative_filter_s: self.derivative_filter_s,
            derivative_of,
            dead_zone: self.dead_zone,
            output_min: self.output_min,
            output_max: self.output_max,
            smoothing_per_s: self.smoothing_per_s,
            anti_windup,
        })
    }
}

impl From<ParamError> for VoltstepStatus {
    fn from(error: ParamError) -> Self {
        crate::refusals::status(error)
    }
}

impl<D: Described> From<&Vehicle<BatteryParams, D>> for VoltstepParams {
    fn from(vehicle: &Vehicle<BatteryParams, D>) -> Self {
        let p = &vehicle.powertrain;
        let (driver, pid, torque) = match &vehicle.driver {
            DriverParams::Duty(pid) => (VoltstepDriverKind::Duty, pid, NO_TORQUE),
            DriverParams::Torque(t) => (VoltstepDriverKind::Torque, &t.speed, t.into()),
        };
        let mut drives = [NO_DRIVE; VOLTSTEP_DRIVES];
        p.drives.describe(&mut drives.iter_mut());
        Self {
            abi: VOLTSTEP_ABI,
            initial_soc: vehicle.initial_soc,
            battery: (&p.battery).into(),
            auxiliary: VoltstepAuxiliaryParams {
                power_w: p.auxiliary.power_w,
                resistance_ohm: p.auxiliary.resistance_ohm,
                cut_out_v: p.auxiliary.cut_out_v,
            },
            drive_count: D::COUNT,
            drives,
            wheel: VoltstepWheelParams {
                radius_m: p.wheel.radius_m,
                inertia_kg_m2: p.wheel.inertia_kg_m2,
                viscous_nm_s_per_rad: p.wheel.viscous_nm_s_per_rad,
            },
            body: (&p.body).into(),
            driver: driver as u32,
            pid: pid.into(),
            torque,
        }
    }
}

/// For vehicles without a torque driver: invalid on purpose, so that it is set when one is chosen.
const NO_TORQUE: VoltstepTorqueParams = VoltstepTorqueParams {
    peak_torque_nm: 0.0,
    peak_power_w: 0.0,
    regen_torque_nm: 0.0,
    regen_power_w: 0.0,
    regen_fade_m_s: 0.0,
    regen_fade_soc: 0.0,
    brake_limit_n: 0.0,
    current_rate_per_s: 0.0,
};

impl From<&TorqueDriverParams> for VoltstepTorqueParams {
    fn from(t: &TorqueDriverParams) -> Self {
        Self {
            peak_torque_nm: t.peak_torque_nm,
            peak_power_w: t.peak_power_w,
            regen_torque_nm: t.regen_torque_nm,
            regen_power_w: t.regen_power_w,
            regen_fade_m_s: t.regen_fade_m_s,
            regen_fade_soc: t.regen_fade_soc,
            brake_limit_n: t.brake_limit_n,
            current_rate_per_s: t.current_rate_per_s,
        }
    }
}

impl From<&BatteryParams> for VoltstepBatteryParams {
    fn from(b: &BatteryParams) -> Self {
        let (open_circuit, empty_v, full_v, table_v) = match &b.open_circuit {
            OpenCircuit::Linear { empty_v, full_v } => {
                (VoltstepOpenCircuit::Linear, *empty_v, *full_v, [0.0; VOLTSTEP_SOC_POINTS])
            }
            OpenCircuit::Table(table) => (VoltstepOpenCircuit::Table, 0.0, 0.0, *table.values()),
        };
        Self {
            model: VoltstepBatteryModel::Constant as u32,
            open_circuit: open_circuit as u32,
            empty_v,
            full_v,
            table_v,
            capacity_ah: b.capacity_ah,
            series_resistance_ohm: b.series_resistance_ohm,
            polarisation_resistance_ohm: b.polarisation.resistance_ohm,
            polarisation_capacitance_f: b.polarisation.capacitance_f,
            discharge_limit_a: b.discharge_limit_a,
            charge_limit_a: b.charge_limit_a,
        }
    }
}

impl From<&BodyParams> for VoltstepBodyParams {
    fn from(b: &BodyParams) -> Self {
        let none = Self {
            mass_kg: b.mass_kg,
            road_law: VoltstepRoadLaw::Physical as u32,
            drag_coefficient: 0.0,
            frontal_area_m2: 0.0,
            air_density_kg_m3: 0.0,
            rolling_coefficient: 0.0,
            a_n: 0.0,
            b_n_s_per_m: 0.0,
            c_n_s2_per_m2: 0.0,
        };
        match b.resistance {
            RoadResistance::Physical {
                drag_coefficient,
                frontal_area_m2,
                air_density_kg_m3,
                rolling_coefficient,
            } => Self {
                drag_coefficient,
                frontal_area_m2,
                air_density_kg_m3,
                rolling_coefficient,
                ..none
            },
            RoadResistance::CoastDown { a_n, b_n_s_per_m, c_n_s2_per_m2 } => Self {
                road_law: VoltstepRoadLaw::CoastDown as u32,
                a_n,
                b_n_s_per_m,
                c_n_s2_per_m2,
                ..none
            },
        }
    }
}

impl From<&PidParams> for VoltstepPidParams {
    fn from(p: &PidParams) -> Self {
        Self {
            proportional: p.proportional,
            integral_per_s: p.integral_per_s,
            derivative_s: p.derivative_s,
            derivative_filter_s: p.derivative_filter_s,
            derivative_of_measurement: u32::from(p.derivative_of == DerivativeOf::Measurement),
            dead_zone: p.dead_zone,
            output_min: p.output_min,
            output_max: p.output_max,
            smoothing_per_s: p.smoothing_per_s,
            anti_windup: match p.anti_windup {
                AntiWindup::Freeze => VoltstepWindup::Freeze as u32,
                AntiWindup::Directional => VoltstepWindup::Directional as u32,
            },
        }
    }
}
