//! Drives from C's parameters to the models' and back.

use core::slice::IterMut;

use plant_core::converter::ConverterParams;
use plant_core::machine::dc::DcMotorParams;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::powertrain::DriveParams;
#[cfg(all(feature = "drives", feature = "pmsm"))]
use plant_core::powertrain::Either;
#[cfg(feature = "drives")]
use plant_core::{Dt, mechanics::wheel::WheelParams, powertrain::Axles};
#[cfg(feature = "pmsm")]
use plant_core::{
    ParamError,
    machine::flux::{Flux, LinearFlux},
    machine::pmsm::PmsmParams,
    machine::transform::Dq,
};
#[cfg(feature = "thermal")]
use plant_core::{
    machine::heated::{DriveThermalParams, HeatedPartParams},
    powertrain::HeatedDriveParams,
    thermal::Conductor,
};

#[cfg(feature = "drives")]
use crate::cars::AnyDrive;
use crate::params::{
    VoltstepConverterParams, VoltstepDriveParams, VoltstepDriveThermalParams,
    VoltstepGearboxParams, VoltstepHeatedPartParams, VoltstepMachine, VoltstepMotorParams,
    VoltstepPmsmParams,
};
use crate::status::VoltstepStatus;

/// A drive of either kind.
pub(super) enum DriveModel {
    Dc(DriveParams),
    #[cfg(feature = "pmsm")]
    Pmsm(DriveParams<PmsmParams>),
}

impl VoltstepDriveParams {
    /// The drive, told apart at run time.
    #[cfg(feature = "drives")]
    pub(super) fn axles(
        &self,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Axles<AnyDrive>, VoltstepStatus> {
        Ok(match self.model()? {
            #[cfg(feature = "pmsm")]
            DriveModel::Dc(drive) => self.warm(drive).on(wheel, dt)?.map(Either::One),
            #[cfg(not(feature = "pmsm"))]
            DriveModel::Dc(drive) => self.warm(drive).on(wheel, dt)?,
            #[cfg(feature = "pmsm")]
            DriveModel::Pmsm(drive) => self.warm(drive).on(wheel, dt)?.map(Either::Other),
        })
    }

    /// The drive with its temperatures, if it has any.
    #[cfg(feature = "thermal")]
    pub(super) fn warm<M>(&self, drive: DriveParams<M>) -> HeatedDriveParams<M> {
        HeatedDriveParams { drive, thermal: self.thermal.model() }
    }

    #[cfg(all(feature = "drives", not(feature = "thermal")))]
    #[expect(clippy::unused_self, reason = "where temperatures are built in, it is used")]
    fn warm<M>(&self, drive: DriveParams<M>) -> DriveParams<M> {
        drive
    }

    pub(super) fn model(&self) -> Result<DriveModel, VoltstepStatus> {
        if cfg!(not(feature = "thermal")) && self.thermal.heated != 0 {
            return Err(VoltstepStatus::NotBuiltIn);
        }
        match self.machine {
            m if m == VoltstepMachine::Dc as u32 => {
                Ok(DriveModel::Dc(self.with(self.motor.model())))
            }
            #[cfg(not(feature = "pmsm"))]
            m if m == VoltstepMachine::Pmsm as u32 => Err(VoltstepStatus::NotBuiltIn),
            #[cfg(feature = "pmsm")]
            m if m == VoltstepMachine::Pmsm as u32 => {
                Ok(DriveModel::Pmsm(self.with(self.pmsm.model()?)))
            }
            _ => Err(VoltstepStatus::UnknownMachine),
        }
    }

    fn with<M>(&self, motor: M) -> DriveParams<M> {
        let (converter, gearbox) = (&self.converter, &self.gearbox);
        DriveParams {
            converter: ConverterParams {
                duty_limit: converter.duty_limit,
                constant_loss_w: converter.constant_loss_w,
                voltage_drop_v: converter.voltage_drop_v,
                resistance_ohm: converter.resistance_ohm,
                current_limit_a: converter.current_limit_a,
            },
            motor,
            gearbox: GearboxParams {
                ratio: gearbox.ratio,
                efficiency: gearbox.efficiency,
                inertia_kg_m2: gearbox.inertia_kg_m2,
            },
            torque_rate_per_s: self.torque_rate_per_s,
            torque_share: self.torque_share,
        }
    }
}

impl VoltstepMotorParams {
    const fn model(&self) -> DcMotorParams {
        DcMotorParams {
            resistance_ohm: self.resistance_ohm,
            inductance_h: self.inductance_h,
            back_emf_v_s_per_rad: self.back_emf_v_s_per_rad,
            torque_nm_per_a: self.torque_nm_per_a,
            inertia_kg_m2: self.inertia_kg_m2,
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
            coulomb_nm: self.coulomb_nm,
        }
    }
}

#[cfg(feature = "pmsm")]
impl VoltstepPmsmParams {
    fn model(&self) -> Result<PmsmParams, ParamError> {
        Ok(PmsmParams {
            flux: Flux::Linear(LinearFlux {
                magnet_wb: self.magnet_wb,
                d_h: self.d_h,
                q_h: self.q_h,
            }),
            resistance_ohm: self.resistance_ohm,
            resistance_per_k: self.resistance_per_k,
            pole_pairs: u16::try_from(self.pole_pairs)
                .map_err(|_| ParamError::OutOfRange("pmsm.pole_pairs"))?,
            iron_s: self.iron_s,
            inertia_kg_m2: self.inertia_kg_m2,
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
            coulomb_nm: self.coulomb_nm,
        })
    }
}

#[cfg(feature = "thermal")]
impl VoltstepDriveThermalParams {
    const fn model(&self) -> DriveThermalParams {
        if self.heated == 0 {
            return DriveThermalParams::NONE;
        }
        DriveThermalParams {
            coolant_c: self.coolant_c,
            machine: self.machine.model(),
            inverter: self.inverter.model(),
            winding: Conductor { reference_c: self.reference_c, per_k: self.per_k },
        }
    }
}

#[cfg(feature = "thermal")]
impl VoltstepHeatedPartParams {
    const fn model(&self) -> HeatedPartParams {
        HeatedPartParams {
            heat_capacity_j_per_k: self.heat_capacity_j_per_k,
            coolant_k_per_w: self.coolant_k_per_w,
            derate_from_c: self.derate_from_c,
            derate_to_c: self.derate_to_c,
        }
    }
}

/// Drives that a preset has, for C.
pub(crate) trait Described {
    const COUNT: u32;
    /// Each into the next place.
    fn describe(&self, places: &mut IterMut<'_, VoltstepDriveParams>);
}

#[cfg(all(feature = "drives", feature = "pmsm"))]
impl<A: Described, B: Described> Described for (A, B) {
    const COUNT: u32 = A::COUNT + B::COUNT;

    fn describe(&self, places: &mut IterMut<'_, VoltstepDriveParams>) {
        self.0.describe(places);
        self.1.describe(places);
    }
}

impl Described for DriveParams {
    const COUNT: u32 = 1;

    fn describe(&self, places: &mut IterMut<'_, VoltstepDriveParams>) {
        let m = &self.motor;
        let motor = VoltstepMotorParams {
            resistance_ohm: m.resistance_ohm,
            inductance_h: m.inductance_h,
            back_emf_v_s_per_rad: m.back_emf_v_s_per_rad,
            torque_nm_per_a: m.torque_nm_per_a,
            inertia_kg_m2: m.inertia_kg_m2,
            viscous_nm_s_per_rad: m.viscous_nm_s_per_rad,
            coulomb_nm: m.coulomb_nm,
        };
        put(places, VoltstepDriveParams { motor, ..described(self, VoltstepMachine::Dc) });
    }
}

#[cfg(feature = "pmsm")]
impl Described for DriveParams<PmsmParams> {
    const COUNT: u32 = 1;

    fn describe(&self, places: &mut IterMut<'_, VoltstepDriveParams>) {
        let m = &self.motor;
        // Of a map what it is without current; no preset has one.
        let flux = m.flux.near(Dq::ZERO);
        let pmsm = VoltstepPmsmParams {
            magnet_wb: flux.magnet_wb,
            d_h: flux.d_h,
            q_h: flux.q_h,
            resistance_ohm: m.resistance_ohm,
            resistance_per_k: m.resistance_per_k,
            pole_pairs: m.pole_pairs.into(),
            iron_s: m.iron_s,
            inertia_kg_m2: m.inertia_kg_m2,
            viscous_nm_s_per_rad: m.viscous_nm_s_per_rad,
            coulomb_nm: m.coulomb_nm,
        };
        put(places, VoltstepDriveParams { pmsm, ..described(self, VoltstepMachine::Pmsm) });
    }
}

#[cfg(feature = "thermal")]
impl Described for HeatedDriveParams {
    const COUNT: u32 = 1;

    fn describe(&self, places: &mut IterMut<'_, VoltstepDriveParams>) {
        let Some(place) = places.next() else { return };
        self.drive.describe(&mut core::slice::from_mut(place).iter_mut());
        let t = &self.thermal;
        place.thermal = VoltstepDriveThermalParams {
            heated: 1,
            coolant_c: t.coolant_c,
            machine: part(&t.machine),
            inverter: part(&t.inverter),
            reference_c: t.winding.reference_c,
            per_k: t.winding.per_k,
        };
    }
}

#[cfg(feature = "thermal")]
const fn part(part: &HeatedPartParams) -> VoltstepHeatedPartParams {
    VoltstepHeatedPartParams {
        heat_capacity_j_per_k: part.heat_capacity_j_per_k,
        coolant_k_per_w: part.coolant_k_per_w,
        derate_from_c: part.derate_from_c,
        derate_to_c: part.derate_to_c,
    }
}

fn put(places: &mut IterMut<'_, VoltstepDriveParams>, drive: VoltstepDriveParams) {
    if let Some(place) = places.next() {
        *place = drive;
    }
}

/// What a drive has beside its machine.
fn described<M>(drive: &DriveParams<M>, machine: VoltstepMachine) -> VoltstepDriveParams {
    let (converter, gearbox) = (&drive.converter, &drive.gearbox);
    VoltstepDriveParams {
        machine: machine as u32,
        converter: VoltstepConverterParams {
            duty_limit: converter.duty_limit,
            constant_loss_w: converter.constant_loss_w,
            voltage_drop_v: converter.voltage_drop_v,
            resistance_ohm: converter.resistance_ohm,
            current_limit_a: converter.current_limit_a,
        },
        gearbox: VoltstepGearboxParams {
            ratio: gearbox.ratio,
            efficiency: gearbox.efficiency,
            inertia_kg_m2: gearbox.inertia_kg_m2,
        },
        torque_rate_per_s: drive.torque_rate_per_s,
        torque_share: drive.torque_share,
        ..NO_DRIVE
    }
}

const NO_PART: VoltstepHeatedPartParams = VoltstepHeatedPartParams {
    heat_capacity_j_per_k: 0.0,
    coolant_k_per_w: 0.0,
    derate_from_c: 0.0,
    derate_to_c: 0.0,
};

/// For drives, and machines, that there are not: invalid on purpose, so that they are set when they
/// are counted or chosen.
pub(super) const NO_DRIVE: VoltstepDriveParams = VoltstepDriveParams {
    machine: VoltstepMachine::Dc as u32,
    converter: VoltstepConverterParams {
        duty_limit: 0.0,
        constant_loss_w: 0.0,
        voltage_drop_v: 0.0,
        resistance_ohm: 0.0,
        current_limit_a: 0.0,
    },
    motor: VoltstepMotorParams {
        resistance_ohm: 0.0,
        inductance_h: 0.0,
        back_emf_v_s_per_rad: 0.0,
        torque_nm_per_a: 0.0,
        inertia_kg_m2: 0.0,
        viscous_nm_s_per_rad: 0.0,
        coulomb_nm: 0.0,
    },
    pmsm: VoltstepPmsmParams {
        magnet_wb: 0.0,
        d_h: 0.0,
        q_h: 0.0,
        resistance_ohm: 0.0,
        resistance_per_k: 0.0,
        pole_pairs: 0,
        iron_s: 0.0,
        inertia_kg_m2: 0.0,
        viscous_nm_s_per_rad: 0.0,
        coulomb_nm: 0.0,
    },
    gearbox: VoltstepGearboxParams { ratio: 0.0, efficiency: 0.0, inertia_kg_m2: 0.0 },
    thermal: VoltstepDriveThermalParams {
        heated: 0,
        coolant_c: 0.0,
        machine: NO_PART,
        inverter: NO_PART,
        reference_c: 0.0,
        per_k: 0.0,
    },
    torque_rate_per_s: 0.0,
    torque_share: 0.0,
};
