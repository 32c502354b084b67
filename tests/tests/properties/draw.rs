//! Parameters, made up around those of a real vehicle: a few per cent or many decades off.

use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{
    BatteryParams, BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OpenCircuit,
    OverSoc, RcBranchParams, ResistanceMap, ThermalParams, VoltageLimits,
};
use plant_core::control::driver::TorqueDriverParams;
use plant_core::control::foc::FocParams;
use plant_core::control::pid::{AntiWindup, DerivativeOf, PidParams};
use plant_core::converter::ConverterParams;
use plant_core::machine::dc::DcMotorParams;
use plant_core::machine::flux::{Flux, LinearFlux};
use plant_core::machine::pmsm::PmsmParams;
use plant_core::mechanics::body::{BodyParams, RoadResistance};
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::num::{LARGEST_PARAM, SMALLEST_PARAM, SocTable};
use plant_core::powertrain::{DriveParams, PowertrainParams};
use plant_core::{Dt, Real};
use proptest::prelude::*;

/// How far parameters may lie from what is typical.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    decades: f64,
    largest: Real,
}

/// Values that exist: most plausible vehicles lie within a factor of three of each other.
pub const PLAUSIBLE: Spread = Spread { decades: 0.5, largest: LARGEST_PARAM };
/// All that is permitted, 1e-12..1e12, both ends often.
pub const PERMITTED: Spread = within(LARGEST_PARAM);

/// From `1/largest` to `largest`, both ends often.
pub const fn within(largest: Real) -> Spread {
    Spread { decades: 24.0, largest }
}

/// Random numbers from which parameters are made, one after the other.
#[derive(Clone, Debug)]
pub struct Draw {
    spread: Spread,
    numbers: std::vec::IntoIter<f64>,
    flags: u64,
}

/// What `make` makes of random numbers.
pub fn drawn<T: std::fmt::Debug>(
    spread: Spread,
    make: impl Fn(&mut Draw) -> T,
) -> impl Strategy<Value = T> {
    let numbers = prop::collection::vec(-1.0..=1.0, 96);
    (numbers, any::<u64>(), any::<u64>()).prop_map(move |(numbers, one, other)| {
        make(&mut Draw { spread, numbers: numbers.into_iter(), flags: one & other })
    })
}

impl Draw {
    /// A number in −1..1.
    pub fn number(&mut self) -> f64 {
        self.numbers.next().expect("96 numbers are enough for every set of parameters")
    }

    /// True once in four.
    pub fn seldom(&mut self) -> bool {
        let flag = self.flags & 1 == 1;
        self.flags >>= 1;
        flag
    }

    /// Above zero, around `typical`, within the spread.
    pub fn near(&mut self, typical: f64) -> Real {
        let value = typical * 10_f64.powf(self.spread.decades * self.number());
        let Spread { largest, .. } = self.spread;
        (value as Real).clamp((1.0 / largest).max(SMALLEST_PARAM), largest)
    }

    /// The same, or now and then `other`.
    pub fn near_or(&mut self, typical: f64, other: Real) -> Real {
        let value = self.near(typical);
        if self.seldom() { other } else { value }
    }

    /// In 0..1; both ends now and then.
    pub fn ratio(&mut self) -> Real {
        let value = 0.5 + 0.5 * self.number();
        if self.seldom() { value.round() as Real } else { value as Real }
    }

    /// Of either sign, around ± `typical`.
    pub fn signed(&mut self, typical: f64) -> Real {
        let value = self.near_or(typical, 0.0);
        if self.seldom() { -value } else { value }
    }

    pub fn dt(&mut self) -> Dt {
        Dt::from_s(self.near(1e-3)).expect("within the permitted range")
    }
}

pub fn rc_branch(d: &mut Draw) -> RcBranchParams {
    RcBranchParams { resistance_ohm: d.near(0.02), capacitance_f: d.near(1500.0) }
}

pub fn battery(d: &mut Draw) -> BatteryParams {
    let empty_v = d.near(300.0);
    let full_v = (empty_v + d.near(60.0)).min(LARGEST_PARAM);
    let open_circuit = if d.seldom() {
        let points = [(0.0, empty_v), (0.3, 0.5 * (empty_v + full_v)), (1.0, full_v)];
        OpenCircuit::Table(SocTable::from_points("table", &points).expect("finite points"))
    } else {
        OpenCircuit::Linear { empty_v, full_v }
    };
    BatteryParams {
        open_circuit,
        capacity_ah: d.near(50.0),
        series_resistance_ohm: d.near(0.1),
        polarisation: rc_branch(d),
        discharge_limit_a: d.near_or(300.0, Real::INFINITY),
        charge_limit_a: d.near_or(200.0, Real::INFINITY),
        voltage_limits: VoltageLimits::NONE,
    }
}

fn over_soc(d: &mut Draw, typical: f64) -> OverSoc {
    let value = d.near_or(typical, 0.0);
    if d.seldom() {
        let points = [(0.0, value), (0.2, 0.5 * value), (1.0, value)];
        OverSoc::Table(SocTable::from_points("table", &points).expect("finite points"))
    } else {
        OverSoc::Constant(value)
    }
}

fn branch_map(d: &mut Draw, typical_s: f64) -> BranchMap {
    BranchMap {
        resistance_ohm: over_soc(d, 0.03),
        activation_k: 10_000.0 * d.ratio(),
        time_constant_s: d.near(typical_s),
    }
}

/// A battery with maps, around that of a pack.
pub fn mapped_battery(d: &mut Draw) -> MappedBatteryParams {
    let BatteryParams { open_circuit, capacity_ah, discharge_limit_a, charge_limit_a, .. } =
        battery(d);
    MappedBatteryParams {
        capacity_ah,
        discharge_limit_a,
        charge_limit_a,
        voltage_limits: VoltageLimits::NONE,
        refresh_s: d.near(0.1),
        open_circuit,
        hysteresis: HysteresisParams {
            half_gap_v: d.near_or(2.0, 0.0),
            rate_per_soc: d.near_or(50.0, 0.0),
        },
        series: ResistanceMap {
            resistance_ohm: over_soc(d, 0.1),
            activation_k: 10_000.0 * d.ratio(),
        },
        polarisation: branch_map(d, 20.0),
        second_polarisation: branch_map(d, 300.0),
        thermal: ThermalParams {
            heat_capacity_j_per_k: d.near_or(1e5, Real::INFINITY),
            cooling_w_per_k: d.near_or(10.0, 0.0),
            ambient_c: 300.0 * d.ratio() - 100.0,
        },
        identified: IdentifiedRange {
            soc_min: 0.2,
            soc_max: 0.9,
            temperature_min_c: -20.0,
            temperature_max_c: 60.0,
        },
    }
}

pub fn auxiliary(d: &mut Draw) -> AuxiliaryParams {
    AuxiliaryParams {
        power_w: d.near_or(500.0, 0.0),
        resistance_ohm: d.near_or(200.0, Real::INFINITY),
        cut_out_v: d.near(100.0),
    }
}

pub fn converter(d: &mut Draw) -> ConverterParams {
    if d.seldom() {
        return ConverterParams::IDEAL;
    }
    ConverterParams {
        duty_limit: d.near_or(1.0, 1.0),
        constant_loss_w: d.near_or(100.0, 0.0),
        voltage_drop_v: d.near_or(1.0, 0.0),
        resistance_ohm: d.near_or(1e-3, 0.0),
        current_limit_a: Real::INFINITY,
    }
}

/// With Kt = Ke: neither iron losses nor energy from nothing.
pub fn motor(d: &mut Draw) -> DcMotorParams {
    let ke = d.near(0.4);
    DcMotorParams {
        resistance_ohm: d.near(0.02),
        inductance_h: d.near(1e-4),
        back_emf_v_s_per_rad: ke,
        torque_nm_per_a: ke,
        inertia_kg_m2: d.near(0.03),
        viscous_nm_s_per_rad: d.near_or(5e-4, 0.0),
        coulomb_nm: d.near_or(0.1, 0.0),
    }
}

/// With Kt and Ke apart.
pub fn lossy_motor(d: &mut Draw) -> DcMotorParams {
    DcMotorParams { torque_nm_per_a: d.near(0.4), ..motor(d) }
}

/// A synchronous machine with constant inductances.
pub fn pmsm(d: &mut Draw) -> PmsmParams {
    PmsmParams {
        flux: Flux::Linear(LinearFlux {
            magnet_wb: d.near(0.05),
            d_h: d.near(1e-4),
            q_h: d.near(2e-4),
        }),
        resistance_ohm: d.near(0.01),
        resistance_per_k: 0.007 * d.ratio(),
        pole_pairs: 1 + (11.0 * f64::from(d.ratio())) as u16,
        iron_s: d.near_or(0.02, 0.0),
        inertia_kg_m2: d.near(0.03),
        viscous_nm_s_per_rad: d.near_or(5e-4, 0.0),
        coulomb_nm: d.near_or(0.1, 0.0),
    }
}

pub fn foc(d: &mut Draw) -> FocParams {
    FocParams {
        bandwidth_rad_s: d.near_or(2000.0, Real::INFINITY),
        current_limit_a: d.near_or(400.0, Real::INFINITY),
        torque_limit_nm: d.near_or(250.0, Real::INFINITY),
        voltage_share: d.ratio().max(0.01),
    }
}

pub fn gearbox(d: &mut Draw) -> GearboxParams {
    let loss = f64::from(d.near_or(0.03, 0.0));
    GearboxParams {
        ratio: d.near(6.0),
        efficiency: (1.0 - loss.min(0.9)) as Real,
        inertia_kg_m2: d.near_or(0.002, 0.0),
    }
}

pub fn wheel(d: &mut Draw) -> WheelParams {
    WheelParams {
        radius_m: d.near(0.3),
        inertia_kg_m2: d.near_or(2.0, 0.0),
        viscous_nm_s_per_rad: d.near_or(0.1, 0.0),
    }
}

pub fn body(d: &mut Draw) -> BodyParams {
    let resistance = if d.seldom() {
        RoadResistance::CoastDown {
            a_n: d.near_or(100.0, 0.0),
            b_n_s_per_m: d.near_or(2.0, 0.0),
            c_n_s2_per_m2: d.near_or(0.4, 0.0),
        }
    } else {
        RoadResistance::Physical {
            drag_coefficient: d.near_or(0.3, 0.0),
            frontal_area_m2: d.near(2.3),
            air_density_kg_m3: d.near(1.2),
            rolling_coefficient: d.near_or(0.009, 0.0),
        }
    };
    BodyParams { mass_kg: d.near(1300.0), resistance }
}

/// A whole plant, with everything that it may have.
pub fn plant(d: &mut Draw) -> PowertrainParams {
    PowertrainParams {
        battery: battery(d),
        auxiliary: auxiliary(d),
        drives: DriveParams { converter: converter(d), ..DriveParams::new(motor(d), gearbox(d)) },
        wheel: wheel(d),
        body: body(d),
    }
}

pub fn pid(d: &mut Draw) -> PidParams {
    let output_max = d.near_or(1.0, Real::INFINITY);
    PidParams {
        proportional: d.signed(5.0),
        integral_per_s: d.near_or(0.5, 0.0),
        derivative_s: d.near_or(0.1, 0.0),
        derivative_filter_s: d.near_or(0.05, 0.0),
        derivative_of: if d.seldom() { DerivativeOf::Error } else { DerivativeOf::Measurement },
        dead_zone: d.near_or(1e-3, 0.0),
        output_min: if d.seldom() { -Real::INFINITY } else { -0.5 * output_max },
        output_max,
        smoothing_per_s: d.near_or(1e3, Real::INFINITY),
        anti_windup: if d.seldom() { AntiWindup::Freeze } else { AntiWindup::Directional },
    }
}

pub fn torque_driver(d: &mut Draw) -> TorqueDriverParams {
    TorqueDriverParams {
        speed: pid(d),
        peak_torque_nm: d.near_or(250.0, Real::INFINITY),
        peak_power_w: d.near_or(1e5, Real::INFINITY),
        regen_torque_nm: d.near_or(80.0, 0.0),
        regen_power_w: d.near_or(5e4, Real::INFINITY),
        regen_fade_m_s: d.near(3.0),
        regen_fade_soc: d.near(0.05),
        brake_limit_n: d.near(1e4),
        current_rate_per_s: d.near(250.0),
    }
}
