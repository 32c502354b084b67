//! What each fuzz target does with its bytes. A workspace test runs the corpus through the same
//! functions, without nightly.

use plant_core::Dt;
use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{
    BatteryParams, BranchMap, CurrentLimits, HysteresisParams, IdentifiedRange,
    MappedBatteryParams, OpenCircuit, OverSoc, RcBranchParams, ResistanceMap, ThermalParams,
    VoltageLimits,
};
use plant_core::converter::{ConverterParams, Gates};
use plant_core::machine::dc::DcMotorParams;
use plant_core::machine::flux::{Flux, LinearFlux};
use plant_core::machine::pmsm::PmsmParams;
use plant_core::machine::transform::Dq;
use plant_core::mechanics::body::{BodyParams, Road, RoadResistance};
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::mechanics::slope::Grade;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::powertrain::{DriveParams, Powertrain, PowertrainInput, PowertrainParams};
use voltstep::read::vehicle::{DriveKind, VehicleBattery};

/// A driving cycle: read, or refused with a place.
pub fn cycle(data: &[u8]) {
    if let Ok(cycle) = voltstep::read::cycle::parse("fuzz.csv", data) {
        assert!(cycle.points.len() >= 2);
        assert!(cycle.points.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}

/// A measured trip, its quirks included.
pub fn trip(data: &[u8]) {
    if let Ok(trip) = voltstep::read::trip::parse("fuzz.csv", data) {
        assert!(trip.len() >= 2 && trip.time_s.windows(2).all(|t| t[0] < t[1]));
        let _ = trip.quirks(60.0);
    }
}

/// A vehicle: what is read can be built.
pub fn vehicle(data: &[u8]) {
    if let Ok(vehicle) = voltstep::read::vehicle::parse("fuzz.toml", data) {
        let dt = Dt::from_s(0.001).expect("a sound step");
        let plant = vehicle.powertrain;
        for drive in plant.drives.as_slice().iter().flatten() {
            let built = match (plant.battery, drive) {
                (VehicleBattery::Constant(battery), DriveKind::Dc(drive)) => {
                    plant.with_battery(battery).with_drives(*drive).build(dt).is_ok()
                }
                (VehicleBattery::Constant(battery), DriveKind::Pmsm(drive)) => {
                    plant.with_battery(battery).with_drives(*drive).build(dt).is_ok()
                }
                (VehicleBattery::Mapped(battery), DriveKind::Dc(drive)) => {
                    plant.with_battery(battery).with_drives(*drive).build(dt).is_ok()
                }
                (VehicleBattery::Mapped(battery), DriveKind::Pmsm(drive)) => {
                    plant.with_battery(battery).with_drives(*drive).build(dt).is_ok()
                }
            };
            assert!(built, "checked by the reader");
        }
    }
}

/// A battery: what is read can be built.
pub fn battery(data: &[u8]) {
    if let Ok(file) = voltstep::read::battery::parse("fuzz.toml", data) {
        let dt = Dt::from_s(0.1).expect("a sound step");
        plant_core::battery::MappedBattery::new(file.battery, dt).expect("checked by the reader");
    }
}

/// A test of a cell.
pub fn cell(data: &[u8]) {
    if let Ok(record) = voltstep::read::cell::parse("fuzz.csv", data) {
        assert!(record.time_s.len() >= 2 && record.time_s.windows(2).all(|t| t[0] < t[1]));
        assert!(record.unlogged_ah() >= 0.0 && record.sampling_s() > 0.0);
    }
}

/// Numbers out of bytes; where these end, the last number again.
struct Bits<'a> {
    data: &'a [u8],
    last: f32,
}

impl Bits<'_> {
    fn next(&mut self) -> f32 {
        if let Some((head, tail)) = self.data.split_first_chunk::<4>() {
            self.data = tail;
            self.last = f32::from_le_bytes(*head);
        }
        self.last
    }
}

fn over_soc(bits: &mut Bits<'_>) -> OverSoc {
    OverSoc::Constant(bits.next())
}

fn branch(bits: &mut Bits<'_>) -> BranchMap {
    BranchMap {
        resistance_ohm: over_soc(bits),
        activation_k: bits.next(),
        time_constant_s: bits.next(),
    }
}

fn plant(bits: &mut Bits<'_>) -> PowertrainParams {
    PowertrainParams {
        battery: BatteryParams {
            open_circuit: OpenCircuit::Linear { empty_v: bits.next(), full_v: bits.next() },
            capacity_ah: bits.next(),
            series_resistance_ohm: bits.next(),
            polarisation: RcBranchParams {
                resistance_ohm: bits.next(),
                capacitance_f: bits.next(),
            },
            discharge_limit_a: bits.next(),
            charge_limit_a: bits.next(),
            voltage_limits: VoltageLimits { lowest_v: bits.next(), highest_v: bits.next() },
        },
        auxiliary: AuxiliaryParams {
            power_w: bits.next(),
            resistance_ohm: bits.next(),
            cut_out_v: bits.next(),
        },
        drives: DriveParams {
            converter: ConverterParams {
                duty_limit: bits.next(),
                constant_loss_w: bits.next(),
                voltage_drop_v: bits.next(),
                resistance_ohm: bits.next(),
                current_limit_a: bits.next(),
            },
            motor: DcMotorParams {
                resistance_ohm: bits.next(),
                inductance_h: bits.next(),
                back_emf_v_s_per_rad: bits.next(),
                torque_nm_per_a: bits.next(),
                inertia_kg_m2: bits.next(),
                viscous_nm_s_per_rad: bits.next(),
                coulomb_nm: bits.next(),
            },
            gearbox: GearboxParams {
                ratio: bits.next(),
                efficiency: bits.next(),
                inertia_kg_m2: bits.next(),
            },
            torque_rate_per_s: bits.next(),
            torque_share: 1.0,
        },
        wheel: WheelParams {
            radius_m: bits.next(),
            inertia_kg_m2: bits.next(),
            viscous_nm_s_per_rad: bits.next(),
        },
        body: BodyParams {
            mass_kg: bits.next(),
            resistance: RoadResistance::CoastDown {
                a_n: bits.next(),
                b_n_s_per_m: bits.next(),
                c_n_s2_per_m2: bits.next(),
            },
        },
    }
}

fn mapped(bits: &mut Bits<'_>, plain: &BatteryParams) -> MappedBatteryParams {
    MappedBatteryParams {
        capacity_ah: plain.capacity_ah,
        discharge_limit_a: plain.discharge_limit_a,
        charge_limit_a: plain.charge_limit_a,
        voltage_limits: plain.voltage_limits,
        refresh_s: bits.next(),
        open_circuit: plain.open_circuit,
        hysteresis: HysteresisParams { half_gap_v: bits.next(), rate_per_soc: bits.next() },
        series: ResistanceMap { resistance_ohm: over_soc(bits), activation_k: bits.next() },
        polarisation: branch(bits),
        second_polarisation: branch(bits),
        thermal: ThermalParams {
            heat_capacity_j_per_k: bits.next(),
            cooling_w_per_k: bits.next(),
            ambient_c: bits.next(),
        },
        identified: IdentifiedRange::ALL,
    }
}

fn synchronous(bits: &mut Bits<'_>, like: &DriveParams) -> DriveParams<PmsmParams> {
    DriveParams {
        converter: ConverterParams { voltage_drop_v: 0.0, ..like.converter },
        motor: PmsmParams {
            flux: Flux::Linear(LinearFlux {
                magnet_wb: bits.next(),
                d_h: bits.next(),
                q_h: bits.next(),
            }),
            resistance_ohm: bits.next(),
            resistance_per_k: 0.0,
            pole_pairs: bits.next() as u16,
            iron_s: bits.next(),
            inertia_kg_m2: bits.next(),
            viscous_nm_s_per_rad: bits.next(),
            coulomb_nm: bits.next(),
        },
        gearbox: like.gearbox,
        torque_rate_per_s: like.torque_rate_per_s,
        torque_share: bits.next(),
    }
}

fn gates<M>(bits: &mut Bits<'_>, modulation: impl FnOnce(&mut Bits<'_>) -> M) -> Gates<M> {
    match bits.next() {
        which if which < 0.0 => Gates::Off,
        which if which < 1.0 => Gates::Torque(bits.next()),
        _ => Gates::On(modulation(bits)),
    }
}

fn input(bits: &mut Bits<'_>) -> PowertrainInput {
    PowertrainInput {
        gates: gates(bits, |bits| bits.next()),
        road: Road {
            grade: Grade { sin: bits.next(), cos: bits.next() },
            headwind_m_s: bits.next(),
            brake_n: bits.next(),
            air_density_factor: bits.next(),
            rolling_factor: bits.next(),
        },
        auxiliary_w: bits.next(),
        limits: CurrentLimits { discharge_a: bits.next(), charge_a: bits.next() },
    }
}

/// The plant with any bits for parameters and inputs, with either battery, and with two drives: it
/// refuses them, or steps without a panic and keeps the state of charge within 0..1.
pub fn step(data: &[u8]) {
    let mut bits = Bits { data, last: 1.0 };
    let Ok(dt) = Dt::from_s(bits.next()) else { return };
    let (soc, speed_m_s) = (bits.next(), bits.next());
    let params = plant(&mut bits);
    if let Ok(plant) = Powertrain::new(params, dt).map(Powertrain::with_ledger)
        && let Ok(start) = plant.at_speed(soc, speed_m_s)
    {
        let (mut state, mut bits) = (start, Bits { data: bits.data, last: bits.last });
        for _ in 0..32 {
            let out = plant.step(&mut state, input(&mut bits));
            assert!((0.0..=1.0).contains(&out.soc), "{out:?}");
        }
        let _ = plant.energy(&start, &state);
    }
    let pmsm = synchronous(&mut bits, &params.drives);
    if let Ok(plant) = params.with_drives((pmsm, params.drives)).build(dt)
        && let Ok(mut state) = plant.at_speed(soc, speed_m_s)
    {
        for _ in 0..32 {
            let of_both = (
                gates(&mut bits, |bits| Dq { d: bits.next(), q: bits.next() }),
                gates(&mut bits, |bits| bits.next()),
            );
            let PowertrainInput { road, auxiliary_w, limits, .. } = input(&mut bits);
            let input = PowertrainInput { gates: of_both, road, auxiliary_w, limits };
            let out = plant.step(&mut state, input);
            assert!((0.0..=1.0).contains(&out.soc), "{out:?}");
        }
    }
    let battery = mapped(&mut bits, &params.battery);
    if let Ok(plant) = params.with_battery(battery).build(dt)
        && let Ok(mut state) = plant.at_speed(soc, speed_m_s)
    {
        for _ in 0..32 {
            let out = plant.step(&mut state, input(&mut bits));
            assert!((0.0..=1.0).contains(&out.soc), "{out:?}");
        }
    }
}
