//! What each fuzz target does with its bytes. A workspace test runs the corpus through the same
//! functions, without nightly.

mod circuit;

pub use circuit::circuit;

use plant_core::Dt;
use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{
    BatteryParams, BranchMap, CurrentLimits, HysteresisParams, IdentifiedRange,
    MappedBatteryParams, OpenCircuit, OverSoc, RcBranchParams, ResistanceMap, ThermalParams,
    VoltageLimits,
};
use plant_core::converter::{ConverterParams, Gates};
use plant_core::machine::dc::DcMotorParams;
use plant_core::machine::flux::{Flux, FluxAxis, FluxMap, LinearFlux};
use plant_core::machine::pmsm::PmsmParams;
use plant_core::machine::transform::Dq;
use plant_core::mechanics::body::{BodyParams, Road, RoadResistance};
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::mechanics::slope::Grade;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::powertrain::{
    DriveParams, Drives, DrivesParams, PackParams, PowertrainInput, PowertrainParams,
};
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
            let built = match plant.battery {
                VehicleBattery::Constant(battery) => builds(plant.with_battery(battery), drive, dt),
                VehicleBattery::Mapped(battery) => builds(plant.with_battery(battery), drive, dt),
            };
            assert!(built, "checked by the reader");
        }
    }
}

/// Whether a plant with one drive can be built.
fn builds<P: PackParams, D: Copy>(
    plant: PowertrainParams<P, D>,
    drive: &DriveKind,
    dt: Dt,
) -> bool {
    match drive {
        DriveKind::Dc(drive) => plant.with_drives(*drive).build(dt).is_ok(),
        DriveKind::Pmsm(drive) => plant.with_drives(*drive).build(dt).is_ok(),
        DriveKind::HeatedDc(drive) => plant.with_drives(*drive).build(dt).is_ok(),
        DriveKind::HeatedPmsm(drive) => plant.with_drives(*drive).build(dt).is_ok(),
    }
}

/// A battery: what is read can be built.
pub fn battery(data: &[u8]) {
    if let Ok(file) = voltstep::read::battery::parse("fuzz.toml", data) {
        let dt = Dt::from_s(0.1).expect("a sound step");
        plant_core::battery::MappedBattery::new(file.battery, dt).expect("checked by the reader");
    }
}

/// A circuit: what is read can be built.
pub fn netlist(data: &[u8]) {
    if let Ok(netlist) = voltstep::read::netlist::parse("fuzz.toml", data) {
        assert!(netlist.circuit().is_ok(), "checked by the reader");
    }
}

/// A test of a cell.
pub fn cell(data: &[u8]) {
    if let Ok(record) = voltstep::read::cell::parse("fuzz.csv", data) {
        assert!(record.time_s.len() >= 2 && record.time_s.windows(2).all(|t| t[0] < t[1]));
        assert!(record.unlogged_ah() >= 0.0 && record.sampling_s() > 0.0);
    }
}

/// Whatever a file is: what is said of it is sound.
pub fn check(data: &[u8]) {
    if let Ok(found) = voltstep::read::check::parse("fuzz", data, 60.0) {
        assert!(!found.commands.is_empty());
        for column in found.table.iter().flat_map(|table| &table.columns) {
            assert!(column.least <= column.largest || column.missing > 0, "{column:?}");
        }
    }
}

/// Numbers out of bytes; where these end, the last number again.
#[derive(Clone, Copy)]
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

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "any count will do")]
    fn count(&mut self) -> u16 {
        self.next() as u16
    }

    /// What comes after so many numbers.
    fn after(mut self, numbers: usize) -> Self {
        for _ in 0..numbers {
            self.next();
        }
        self
    }
}

/// Numbers that are kept for one step, whatever it reads of them.
const PER_STEP: usize = 24;

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
            pole_pairs: bits.count(),
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

fn gates<'a, M>(bits: &mut Bits<'a>, modulation: impl FnOnce(&mut Bits<'a>) -> M) -> Gates<M> {
    match bits.next() {
        which if which < 0.0 => Gates::Off,
        which if which < 1.0 => Gates::Torque(bits.next()),
        _ => Gates::On(modulation(bits)),
    }
}

/// What a step is told beside its command.
fn input(bits: &mut Bits<'_>) -> PowertrainInput {
    PowertrainInput {
        gates: Gates::Off,
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

/// The same with a flux map, its axes any bits, its table one of two.
fn saturating(bits: &mut Bits<'_>, like: DriveParams<PmsmParams>) -> DriveParams<PmsmParams> {
    let mut axis = || FluxAxis { start_a: bits.next(), step_a: bits.next(), points: bits.count() };
    let (d, q) = (axis(), axis());
    let flux_wb = if bits.next() < 0.0 { &FOLDED } else { &SATURATING };
    let motor = PmsmParams { flux: Flux::Map(FluxMap { d, q, flux_wb }), ..like.motor };
    DriveParams { motor, ..like }
}

/// Four currents of the d axis, four of the q axis: both saturate.
static SATURATING: [[f32; 2]; 16] = {
    let (d, q) = ([0.01, 0.025, 0.04, 0.05], [-0.06, -0.03, 0.0, 0.06]);
    let (mut table, mut i) = ([[0.0; 2]; 16], 0);
    while i < 16 {
        table[i] = [d[i / 4], q[i % 4]];
        i += 1;
    }
    table
};
/// More current makes less flux.
static FOLDED: [[f32; 2]; 16] = {
    let mut table = SATURATING;
    table[5] = [-1.0, 1e30];
    table
};

/// Which plants of [`step`] took a step that they did not refuse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stepped {
    /// A DC machine on a battery of constant parameters.
    pub plain: bool,
    /// The same on a battery with a map.
    pub mapped: bool,
    /// A synchronous machine, of constant inductances and with a flux map.
    pub synchronous: [bool; 2],
    /// Both kinds of machine, in either order; two of a kind; a pair of pairs.
    pub pairs: [bool; 5],
}

/// Thirty-two steps, without a panic and with the state of charge within 0..1. Whether one of them
/// was taken.
fn steps<P: PackParams, Q: DrivesParams>(
    params: PowertrainParams<P, Q>,
    dt: Dt,
    (soc, speed_m_s): (f32, f32),
    mut bits: Bits<'_>,
    command: impl Fn(&mut Bits<'_>) -> <Q::Drives as Drives>::Command,
) -> bool {
    let Ok(plant) = params.build(dt) else { return false };
    let plant = plant.with_ledger();
    let Ok(start) = plant.at_speed(soc, speed_m_s) else { return false };
    let (mut state, mut taken) = (start, false);
    for _ in 0..32 {
        let mut now = bits;
        let PowertrainInput { road, auxiliary_w, limits, .. } = input(&mut now);
        let gates = command(&mut now);
        bits = bits.after(PER_STEP);
        let out = plant.step(&mut state, PowertrainInput { gates, road, auxiliary_w, limits });
        assert!((0.0..=1.0).contains(&out.soc), "{:?}", out.flows);
        taken |= !out.rejected;
    }
    let _ = plant.energy(&start, &state);
    taken
}

/// Plants with any bits for parameters and inputs, with either battery and with drives of all kinds:
/// they refuse them, or step. Each reads its own after those of the first, so that a seed for one
/// remains one.
pub fn step(data: &[u8]) -> Stepped {
    let mut bits = Bits { data, last: 1.0 };
    let Ok(dt) = Dt::from_s(bits.next()) else { return Stepped::default() };
    let start = (bits.next(), bits.next());
    let params = plant(&mut bits);
    let duty = |bits: &mut Bits<'_>| gates(bits, Bits::next);
    let vector = |bits: &mut Bits<'_>| gates(bits, |bits| Dq { d: bits.next(), q: bits.next() });

    let plain = steps(params, dt, start, bits, duty);
    let mut of_map = bits;
    let battery = mapped(&mut of_map, &params.battery);
    let mapped = steps(params.with_battery(battery), dt, start, of_map, duty);

    let dc = params.drives;
    let linear = synchronous(&mut bits, &dc);
    let map = saturating(&mut bits, linear);
    let synchronous =
        [linear, map].map(|drive| steps(params.with_drives(drive), dt, start, bits, vector));
    let pairs = [
        steps(params.with_drives((linear, dc)), dt, start, bits, |b| (vector(b), duty(b))),
        steps(params.with_drives((dc, map)), dt, start, bits, |b| (duty(b), vector(b))),
        steps(params.with_drives((map, linear)), dt, start, bits, |b| (vector(b), vector(b))),
        steps(params.with_drives((dc, dc)), dt, start, bits, |b| (duty(b), duty(b))),
        steps(params.with_drives(((linear, dc), (dc, map))), dt, start, bits, |b| {
            ((vector(b), duty(b)), (duty(b), vector(b)))
        }),
    ];
    Stepped { plain, mapped, synchronous, pairs }
}
