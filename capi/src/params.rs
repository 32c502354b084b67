//! The parameters as C sees them: plain structs, choices as `uint32_t`, so that no bit pattern
//! from C is invalid.

/// Version of this interface. `VoltstepParams.abi` must hold it, so that a header and a library
/// that do not belong together are noticed.
pub const VOLTSTEP_ABI: u32 = 3;

/// Points of an open-circuit table: at state of charge i/64, i = 0..64.
pub const VOLTSTEP_SOC_POINTS: usize = 65;

/// Drives of a vehicle, at most.
pub const VOLTSTEP_DRIVES: usize = 4;

/// Parameter sets that come with the library.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepPreset {
    /// A physical BMW i3 60 Ah, driven by torque, with a battery of constant parameters:
    /// `bmw-i3-60ah-constant`. The mapped battery of `bmw-i3-60ah` is not in this interface yet.
    BmwI3Constant = 0,
    /// The BMW i3 of `EPowertrain` (2025), Table 5.6, to the letter.
    BmwI3Epowertrain = 1,
    /// The UDDS vehicle of `EPowertrain` (2025) that gives its published state of charge.
    EpowertrainUdds = 2,
    /// The same, Table 5.5 to the letter.
    EpowertrainUddsTable = 3,
    /// The car of `BmwI3Constant` with a synchronous machine: `bmw-i3-60ah-pmsm`.
    BmwI3Pmsm = 4,
    /// A car with a synchronous machine behind and a DC machine in front: `two-axles`.
    TwoAxles = 5,
    /// The car of `BmwI3Constant` with a drive that heats up: `bmw-i3-60ah-thermal`.
    BmwI3Thermal = 6,
}

/// The machine of a drive.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepMachine {
    /// A DC machine: `motor`.
    Dc = 0,
    /// A permanent-magnet synchronous machine: `pmsm`.
    Pmsm = 1,
}

/// How the battery is modelled.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepBatteryModel {
    /// Open-circuit voltage over the state of charge; resistances and one RC branch are constant.
    Constant = 0,
}

/// How the open-circuit voltage depends on the state of charge.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepOpenCircuit {
    /// A line from `empty_v` to `full_v`.
    Linear = 0,
    /// The polyline through `table_v`.
    Table = 1,
}

/// How the road load is given.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepRoadLaw {
    /// Drag and rolling resistance by their coefficients.
    Physical = 0,
    /// A + B v + C v^2 of a coast-down test.
    CoastDown = 1,
}

/// Who drives.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepDriverKind {
    /// Nobody: the inputs say duty or torque, and brake.
    None = 0,
    /// A PID from the speed error straight to the duty; for one DC machine only.
    Duty = 1,
    /// Speed, torque, limits, and of one DC machine current and duty; the friction brake takes the
    /// rest.
    Torque = 2,
}

/// What the integral of a PID does in saturation.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepWindup {
    /// It stands still.
    Freeze = 0,
    /// It may move back, and counts saturation further down the loop too.
    Directional = 1,
}

/// What is known about a battery.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBatteryParams {
    /// One of `VoltstepBatteryModel`.
    pub model: u32,
    /// One of `VoltstepOpenCircuit`.
    pub open_circuit: u32,
    /// Linear: voltage at state of charge 0, in V.
    pub empty_v: f32,
    /// Linear: voltage at state of charge 1, in V; not below `empty_v`.
    pub full_v: f32,
    /// Table: voltage at state of charge i/64, in V; must not fall.
    pub table_v: [f32; VOLTSTEP_SOC_POINTS],
    /// Charge between state of charge 0 and 1, in A h; above zero.
    pub capacity_ah: f32,
    /// Series resistance in ohm; above zero.
    pub series_resistance_ohm: f32,
    /// Resistance of the RC branch in ohm; above zero.
    pub polarisation_resistance_ohm: f32,
    /// Capacitance of the RC branch in F; above zero.
    pub polarisation_capacitance_f: f32,
    /// Largest discharge current in A; above zero, infinity for none.
    pub discharge_limit_a: f32,
    /// Largest charge current in A; above zero, infinity for none.
    pub charge_limit_a: f32,
}

/// What else draws from the battery.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepAuxiliaryParams {
    /// Constant power in W; zero or above.
    pub power_w: f32,
    /// Resistor across the battery in ohm; above zero, infinity for none.
    pub resistance_ohm: f32,
    /// Below this voltage in V the constant power is cut out; above zero.
    pub cut_out_v: f32,
}

/// What is known about the converter.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepConverterParams {
    /// Largest magnitude of the duty, a ratio; above zero, infinity for none.
    pub duty_limit: f32,
    /// Loss that does not depend on the load, in W; zero or above.
    pub constant_loss_w: f32,
    /// Voltage drop against the output current, in V; zero or above, of a synchronous machine's zero.
    pub voltage_drop_v: f32,
    /// Resistance in the output, in ohm; zero or above.
    pub resistance_ohm: f32,
    /// Largest magnitude of the output current in A; above zero, infinity for none.
    pub current_limit_a: f32,
}

/// What is known about the DC motor.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepMotorParams {
    /// Winding resistance in ohm; above zero.
    pub resistance_ohm: f32,
    /// Winding inductance in H; above zero.
    pub inductance_h: f32,
    /// Back-EMF constant in V s/rad; above zero.
    pub back_emf_v_s_per_rad: f32,
    /// Torque constant in N m/A; above zero.
    pub torque_nm_per_a: f32,
    /// Rotor inertia in kg m^2; above zero.
    pub inertia_kg_m2: f32,
    /// Viscous friction in N m s/rad; zero or above.
    pub viscous_nm_s_per_rad: f32,
    /// Coulomb friction in N m; zero or above.
    pub coulomb_nm: f32,
}

/// What is known about the synchronous machine.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepPmsmParams {
    /// Flux linkage of the magnets in Wb, peak of a phase; zero or above, zero only where the
    /// inductances differ.
    pub magnet_wb: f32,
    /// Inductance of the d axis in H; above zero.
    pub d_h: f32,
    /// Inductance of the q axis in H; above zero.
    pub q_h: f32,
    /// Resistance of one phase at 25 degrees C in ohm; above zero.
    pub resistance_ohm: f32,
    /// How much it grows per kelvin; 0..0.007, of copper 1/260.
    pub resistance_per_k: f32,
    /// Pole pairs, 1..65535.
    pub pole_pairs: u32,
    /// Iron loss as a conductance across the induced voltage of each phase, in S; zero or above.
    pub iron_s: f32,
    /// Rotor inertia in kg m^2; above zero.
    pub inertia_kg_m2: f32,
    /// Viscous friction in N m s/rad; zero or above.
    pub viscous_nm_s_per_rad: f32,
    /// Coulomb friction in N m; zero or above.
    pub coulomb_nm: f32,
}

/// What is known about the gearbox.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepGearboxParams {
    /// Motor turns per wheel turn; above zero.
    pub ratio: f32,
    /// Share of the torque that gets through; above 0, up to 1.
    pub efficiency: f32,
    /// Inertia at the motor's side in kg m^2; zero or above.
    pub inertia_kg_m2: f32,
}

/// A part of a drive that heats up: the machine, or the inverter.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepHeatedPartParams {
    /// Heat capacity in J/K; above zero, infinity: it stays as warm as the coolant.
    pub heat_capacity_j_per_k: f32,
    /// Thermal resistance to the coolant in K/W; above zero, infinity for none.
    pub coolant_k_per_w: f32,
    /// Up to this temperature in degrees C the whole current limit is left; infinity: always.
    pub derate_from_c: f32,
    /// From this temperature in degrees C on nothing is left; above the other, infinity: never.
    pub derate_to_c: f32,
}

/// How a drive heats up.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepDriveThermalParams {
    /// Other than 0: losses heat machine and inverter. 0: they do not, and the rest is not looked at.
    pub heated: u32,
    /// Temperature of the coolant in degrees C, -100..200: that of both parts at the start.
    pub coolant_c: f32,
    /// The machine: its winding counts as warm as the rest.
    pub machine: VoltstepHeatedPartParams,
    /// The inverter.
    pub inverter: VoltstepHeatedPartParams,
    /// Temperature in degrees C at which the resistance of the winding is given.
    pub reference_c: f32,
    /// How much the resistance of the winding grows per kelvin, as a share of what it is at
    /// `reference_c`; of copper 1/255 at 20 degrees C. Of a synchronous machine in place of
    /// `resistance_per_k`.
    pub per_k: f32,
}

/// A drive: converter, machine and gearbox on an axle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepDriveParams {
    /// One of `VoltstepMachine`.
    pub machine: u32,
    /// The converter.
    pub converter: VoltstepConverterParams,
    /// DC: the machine.
    pub motor: VoltstepMotorParams,
    /// Synchronous: the machine.
    pub pmsm: VoltstepPmsmParams,
    /// The gearbox.
    pub gearbox: VoltstepGearboxParams,
    /// Its temperatures.
    pub thermal: VoltstepDriveThermalParams,
    /// Bandwidth of the ideal current loop behind a torque demand, in 1/s; above zero.
    pub torque_rate_per_s: f32,
    /// Of a torque demand this drive takes its share, in proportion to those of the others; above
    /// zero.
    pub torque_share: f32,
}

/// What is known about the wheels.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepWheelParams {
    /// Rolling radius in m; above zero.
    pub radius_m: f32,
    /// Inertia of all wheels in kg m^2; zero or above.
    pub inertia_kg_m2: f32,
    /// Viscous friction in N m s/rad; zero or above.
    pub viscous_nm_s_per_rad: f32,
}

/// What is known about the body.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBodyParams {
    /// Mass in kg, without what turns; above zero.
    pub mass_kg: f32,
    /// One of `VoltstepRoadLaw`.
    pub road_law: u32,
    /// Physical: drag coefficient; zero or above.
    pub drag_coefficient: f32,
    /// Physical: frontal area in m^2; zero or above.
    pub frontal_area_m2: f32,
    /// Physical: density of the air in kg/m^3; zero or above.
    pub air_density_kg_m3: f32,
    /// Physical: rolling resistance coefficient; zero or above.
    pub rolling_coefficient: f32,
    /// Coast-down: the part that does not depend on speed, in N; zero or above.
    pub a_n: f32,
    /// Coast-down: the part that grows with speed, in N s/m; zero or above.
    pub b_n_s_per_m: f32,
    /// Coast-down: the part that grows with its square, in N s^2/m^2; zero or above.
    pub c_n_s2_per_m2: f32,
}

/// The speed controller: a PID from m/s to duty, or from m/s to N for the torque driver.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepPidParams {
    /// Proportional gain; finite.
    pub proportional: f32,
    /// Integral gain in 1/s; zero or above.
    pub integral_per_s: f32,
    /// Derivative gain in s; zero or above.
    pub derivative_s: f32,
    /// Time constant that smooths the derivative, in s; zero for none.
    pub derivative_filter_s: f32,
    /// Other than 0: the derivative is of the measurement, not of the error.
    pub derivative_of_measurement: u32,
    /// Below this magnitude the raw output counts as zero; zero for no dead zone.
    pub dead_zone: f32,
    /// Lowest output; -infinity for none.
    pub output_min: f32,
    /// Highest output, above the lowest; infinity for none.
    pub output_max: f32,
    /// Rate at which the output follows its target, in 1/s; above zero, infinity for at once.
    pub smoothing_per_s: f32,
    /// One of `VoltstepWindup`.
    pub anti_windup: u32,
}

/// What the torque driver knows beside its speed controller.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepTorqueParams {
    /// Peak torque of the motor in N m; above zero.
    pub peak_torque_nm: f32,
    /// Peak mechanical power of the motor in W; above zero.
    pub peak_power_w: f32,
    /// Largest regenerative torque in N m; zero or above.
    pub regen_torque_nm: f32,
    /// Largest regenerative mechanical power in W; above zero.
    pub regen_power_w: f32,
    /// Below this speed in m/s regeneration fades to zero; above zero.
    pub regen_fade_m_s: f32,
    /// Regeneration fades to zero over this last share of the state of charge; above zero.
    pub regen_fade_soc: f32,
    /// Largest force of the friction brake at the road in N; above zero.
    pub brake_limit_n: f32,
    /// Bandwidth of the current controller in 1/s; above zero.
    pub current_rate_per_s: f32,
}

/// A vehicle with its driver. Start from `voltstep_params_preset` and change what differs.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepParams {
    /// `VOLTSTEP_ABI`.
    pub abi: u32,
    /// State of charge at the start, a ratio 0..1: what the preset's sources used.
    pub initial_soc: f32,
    /// The battery.
    pub battery: VoltstepBatteryParams,
    /// What else draws from it.
    pub auxiliary: VoltstepAuxiliaryParams,
    /// How many drives there are, 1..`VOLTSTEP_DRIVES`.
    pub drive_count: u32,
    /// The drives; those beyond `drive_count` are not looked at.
    pub drives: [VoltstepDriveParams; VOLTSTEP_DRIVES],
    /// The wheels.
    pub wheel: VoltstepWheelParams,
    /// The body.
    pub body: VoltstepBodyParams,
    /// One of `VoltstepDriverKind`.
    pub driver: u32,
    /// Duty and torque driver: the speed controller.
    pub pid: VoltstepPidParams,
    /// Torque driver: the rest of it.
    pub torque: VoltstepTorqueParams,
}
