#![no_std]
#![no_main]
//! Calls every step function at every step of UDDS, each on a painted stack of its own. QEMU's
//! plugin counts the instructions between call and return; this program says how much stack each
//! used and how large its state is.

mod worst;

use cortex_m_rt::entry;
use panic_halt as _;
use plant_core::auxiliary::AuxiliaryInput;
use plant_core::battery::{BatteryInput, MappedBatteryInput, RcBranchInput};
use plant_core::control::driver::{DriverInput, DriverState};
use plant_core::control::pid::PidInput;
use plant_core::converter::ConverterInput;
use plant_core::machine::dc::DcMotorInput;
use plant_core::mechanics::body::{BodyInput, BodyState};
use plant_core::mechanics::gearbox::GearboxInput;
use plant_core::mechanics::rotational::{
    AxisInput, AxisState, RotationalLoadInput, RotationalLoadState,
};
use plant_core::mechanics::slope::{SlopeInput, SlopeState};
use plant_core::mechanics::wheel::WheelInput;
use plant_core::powertrain::PowertrainInput;
use plant_core::signal::sensors::{
    AxialSpeedSensorInput, AxialSpeedSensorState, CurrentSensorInput, VoltageSensorInput,
};
use plant_core::signal::sources::{PhaseState, TimeTableState};
use voltstep_bms::estimate::coulomb::CoulombInput;
use voltstep_trace::{
    BLOCKS, BMW_I3, BMW_I3_CONSTANT_LEDGER, BMW_I3_LEDGER, BMW_I3_PMSM, REFERENCE, STEPS_PER_BLOCK,
    TWO_AXLED,
};

use voltstep_bench::common::Common;
use voltstep_bench::estimators::{self, Estimators};
use voltstep_bench::pack::{self, Learnt, Rare};
use voltstep_bench::pids::{Apart, Pids, say_hard_cases};
use voltstep_bench::{
    call, call_functions, call_uncounted, circuits, end, fast, hprintln, items, manage, painted,
    pids, report,
};

/// Wheel turns (rad) per metre and motor turns per wheel turn: near enough for realistic inputs.
const WHEEL_RAD_PER_M: f32 = 2.94;
const RATIO: f32 = 9.665;
/// One cell's share of the pack's current.
const CELL_PER_PACK: f32 = 2.97 / 61.7;
/// The estimators run at 10 Hz.
const STEPS_PER_SAMPLE: u32 = 100;

#[entry]
fn main() -> ! {
    end(run())
}

#[allow(clippy::too_many_lines, reason = "a list")]
fn run() -> Option<()> {
    painted!(
        nothing,
        plant_pid_off,
        plant_pid_on,
        plant_torque_off,
        plant_torque_on,
        plant_mapped_off,
        plant_mapped_on,
        plant_pmsm_off,
        plant_axles_off,
        plant_dc_off,
        plant_dcs_off,
        powertrain,
        battery,
        mapped_battery,
        rc_branch,
        auxiliary,
        converter,
        dc_motor,
        gearbox,
        wheel,
        body,
        rotational_load,
        axis,
        slope,
        pid,
        torque_driver,
        voltage_sensor,
        current_sensor,
        speed_sensor,
        time_table,
        sine,
        pi,
        pi_ram,
        pi_pid,
        pi_idsp,
        pi_idsp_ram,
        h_bridge,
        three_phase,
        num_sqrt,
        fast_sqrt,
        num_exp,
        fast_exp,
        ekf_update,
        ekf_refresh,
        counter_step,
        counter_review,
        cells,
        kalman,
        resistance,
        capacity,
        energy_step,
        energy_report,
        energy_walk,
        power_ahead,
        power_walk,
        power_cells,
        power_cells_walk,
        cell_resistances,
        series,
        deep
    );
    let mut common = Common::new()?;
    let mut torque_on = BMW_I3_CONSTANT_LEDGER.start().ok()?;
    let mut mapped_off = BMW_I3.start().ok()?;
    let mut mapped_on = BMW_I3_LEDGER.start().ok()?;
    let mut pmsm_off = BMW_I3_PMSM.start().ok()?;
    let mut axles_off = TWO_AXLED.start().ok()?;
    let mut dc_off = items::ONE_DC.start().ok()?;
    let mut dcs_off = items::TWO_DC.start().ok()?;
    let mut plant = common.torque_off.plant;
    let mut mapped_state = mapped_off.plant.battery;
    let (mut gearbox_state, mut wheel_state) = (0.0, 0.0);
    let mut body_state = BodyState::default();
    let mut load_state = RotationalLoadState::default();
    let mut axis_state = AxisState::default();
    let mut slope_state = SlopeState::starting_at(0.0, 0.0);
    let mut driver_state = DriverState::default();
    let mut speed_sensor_state = AxialSpeedSensorState::default();
    let mut table_state = TimeTableState::default();
    let mut sine_state = PhaseState::default();
    let mut controllers = Pids::new()?;
    macro_rules! pis {
        ($input:expr) => {
            call!(pi, pids::bench_pi, &mut controllers.ours, $input);
            call!(pi_ram, pids::bench_pi_ram, &mut controllers.ours_ram, $input);
            call!(pi_pid, pids::bench_pi_pid, &mut controllers.pid, $input);
            call!(pi_idsp, pids::bench_pi_idsp, &mut controllers.idsp, $input);
            call!(pi_idsp_ram, pids::bench_pi_idsp_ram, &mut controllers.idsp_ram, $input);
        };
    }
    let (mut uncounted, mut apart) = (Pids::new()?, Apart::default());

    let (h_driven, three_driven) = circuits::run(&mut h_bridge, &mut three_phase);
    let (mut pack, mut learnt) = (Estimators::new()?, Learnt::new()?);

    for step in 0..BLOCKS * STEPS_PER_BLOCK {
        let reference = REFERENCE.step(&mut common.clock, ());
        call!(nothing, items::bench_nothing, &mut (), &());
        call!(plant_pid_off, items::bench_plant_pid_off, &mut common.pid_off, &reference);
        call!(plant_pid_on, items::bench_plant_pid_on, &mut common.pid_on, &reference);
        let seen = common.torque_off.seen;
        let driven = DriverInput {
            reference_m_s: reference.value,
            reference_m_s2: reference.rate_per_s,
            vehicle: seen,
        };
        call!(torque_driver, items::bench_torque_driver, &mut driver_state, &driven);
        call!(plant_torque_off, items::bench_plant_torque_off, &mut common.torque_off, &reference);
        call!(plant_torque_on, items::bench_plant_torque_on, &mut torque_on, &reference);
        call!(plant_mapped_off, items::bench_plant_mapped_off, &mut mapped_off, &reference);
        call!(plant_mapped_on, items::bench_plant_mapped_on, &mut mapped_on, &reference);
        call!(plant_pmsm_off, items::bench_plant_pmsm_off, &mut pmsm_off, &reference);
        call!(plant_axles_off, items::bench_plant_axles_off, &mut axles_off, &reference);
        call!(plant_dc_off, items::bench_plant_dc_off, &mut dc_off, &reference);
        call!(plant_dcs_off, items::bench_plant_dcs_off, &mut dcs_off, &reference);

        // The components on what the car does.
        let seen = common.torque_off.seen;
        let (v, i) = (seen.speed_m_s, seen.motor_a);
        let wheel_rad_s = WHEEL_RAD_PER_M * v;
        let motor_rad_s = RATIO * wheel_rad_s;
        let motor_nm = 0.27 * i;
        let current_a = seen.duty * i;
        let distance_m = common.torque_off.plant.body.distance_m.get();
        let input = PowertrainInput::on(seen.duty);
        call!(powertrain, items::bench_powertrain, &mut plant, &input);
        call!(battery, items::bench_battery, &mut common.battery, &BatteryInput { current_a });
        let input = MappedBatteryInput { current_a };
        call!(mapped_battery, items::bench_mapped_battery, &mut mapped_state, &input);
        let input = RcBranchInput { discharge_a: current_a };
        call!(rc_branch, items::bench_rc_branch, &mut common.rc_branch, &input);
        let input = AuxiliaryInput { voltage_v: seen.battery_v, power_w: 100.0 };
        call!(auxiliary, items::bench_auxiliary, &mut (), &input);
        let input = ConverterInput { duty: seen.duty, input_v: seen.battery_v, output_a: i };
        call!(converter, items::bench_converter, &mut (), &input);
        let input = DcMotorInput { voltage_v: seen.duty * seen.battery_v, load_nm: 0.5 * motor_nm };
        call!(dc_motor, items::bench_dc_motor, &mut common.dc_motor, &input);
        let input = GearboxInput { motor_nm, wheel_rad_s };
        call!(gearbox, items::bench_gearbox, &mut gearbox_state, &input);
        let input = WheelInput { axle_nm: RATIO * motor_nm, speed_m_s: v };
        call!(wheel, items::bench_wheel, &mut wheel_state, &input);
        let input =
            BodyInput { force_n: RATIO * WHEEL_RAD_PER_M * motor_nm, ..BodyInput::default() };
        call!(body, items::bench_body, &mut body_state, &input);
        let input = RotationalLoadInput { torque_nm: motor_nm };
        call!(rotational_load, items::bench_rotational_load, &mut load_state, &input);
        let input = AxisInput { speed_rad_s: motor_rad_s, torque_nm: motor_nm };
        call!(axis, items::bench_axis, &mut axis_state, &input);
        let input = SlopeInput { height_m: 0.01 * distance_m, distance_m };
        call!(slope, items::bench_slope, &mut slope_state, &input);
        let input = PidInput { reference: reference.value, measurement: v };
        call!(pid, items::bench_pid, &mut common.pid, &input);
        pis!(&input);
        apart.look(uncounted.step(input));
        let input = VoltageSensorInput { voltage_v: seen.battery_v };
        call!(voltage_sensor, items::bench_voltage_sensor, &mut (), &input);
        let input = CurrentSensorInput { current_a };
        call!(current_sensor, items::bench_current_sensor, &mut (), &input);
        let input = AxialSpeedSensorInput { speed_rad_s: motor_rad_s };
        call!(speed_sensor, items::bench_speed_sensor, &mut speed_sensor_state, &input);
        if step % STEPS_PER_SAMPLE == 0 {
            pack.drive(current_a * CELL_PER_PACK);
            if step % STEPS_PER_BLOCK == 0 {
                call!(ekf_refresh, estimators::bench_ekf_refresh, &mut pack.ekf, &pack.input);
                let voltage_v = pack.input.voltage_v;
                let counter = &mut pack.counter;
                call!(counter_review, estimators::bench_counter_review, counter, &voltage_v);
            }
            call!(ekf_update, estimators::bench_ekf_update, &mut pack.ekf, &pack.input);
            let counted = CoulombInput { current_a: pack.input.current_a };
            call!(counter_step, estimators::bench_counter_step, &mut pack.counter, &counted);
            call!(cells, estimators::bench_cells, &mut pack.cells, &pack.of_cells);
            call!(kalman, estimators::bench_kalman, &mut pack.kalman, &pack.input);
            learnt.see(&pack);
            let l = &mut learnt;
            call!(resistance, pack::bench_resistance, &mut l.resistance, &l.sample);
            call!(energy_step, pack::bench_energy_step, &mut l.energy, &l.flow);
            call!(series, pack::bench_series, &mut l.of_cells.socs, &l.cell_v);
            let of_each = &mut l.of_cells.resistances;
            call!(cell_resistances, pack::bench_cell_resistances, of_each, &l.cell_v);
            if step % STEPS_PER_BLOCK == 0 {
                let [walk, cells_walk] = &mut l.walks;
                call!(energy_report, pack::bench_energy_report, &mut l.energy, &l.known);
                l.energy_walk.1 = l.energy;
                call!(energy_walk, pack::bench_energy_walk, &mut l.energy_walk, &l.known);
                call!(power_ahead, pack::bench_power_ahead, &mut (), &l.known);
                call!(power_walk, pack::bench_power_walk, walk, &l.known);
                call!(power_cells, pack::bench_power_cells, &mut (), &l.of_cells);
                call!(power_cells_walk, pack::bench_power_cells_walk, cells_walk, &l.of_cells);
            }
        }
        call!(time_table, items::bench_time_table, &mut table_state, &());
        call!(sine, items::bench_sine, &mut sine_state, &());
    }

    for n in 0..pids::SATURATED {
        pis!(&pids::saturating(n));
    }
    call_functions!(num_sqrt, fast_sqrt, num_exp, fast_exp);
    fast::say_errors();
    apart.say();
    pack.say();
    learnt.say();
    let rare = Rare {
        capacity: &mut capacity,
        energy: [&mut energy_report, &mut energy_walk],
        power: [&mut power_ahead, &mut power_walk],
        cells: [&mut power_cells, &mut power_cells_walk],
    };
    pack::everywhere(&mut learnt, rare)?;
    say_hard_cases()?;

    worst::plant_pid_off(&mut plant_pid_off)?.say("plant_pid_off");
    worst::plant_pid_on(&mut plant_pid_on)?.say("plant_pid_on");
    worst::plant_torque_off(&mut plant_torque_off)?.say("plant_torque_off");
    worst::plant_torque_on(&mut plant_torque_on)?.say("plant_torque_on");
    worst::plant_mapped_off(&mut plant_mapped_off)?.say("plant_mapped_off");
    worst::plant_mapped_on(&mut plant_mapped_on)?.say("plant_mapped_on");
    worst::plant_pmsm_off(&mut plant_pmsm_off)?.say("plant_pmsm_off");
    worst::plant_axles_off(&mut plant_axles_off)?.say("plant_axles_off");
    worst::plant_dc_off(&mut plant_dc_off)?.say("plant_dc_off");
    worst::plant_dcs_off(&mut plant_dcs_off)?.say("plant_dcs_off");
    manage::run()?;
    call_uncounted!(deep, worst::deep as extern "C" fn(&mut (), &(), &mut ()), &mut (), &());

    report!(
        deep: (), nothing: (), plant_pid_off: common.pid_off, plant_pid_on: common.pid_on, plant_torque_off: common.torque_off,
        plant_torque_on: torque_on, plant_mapped_off: mapped_off, plant_mapped_on: mapped_on,
        plant_pmsm_off: pmsm_off, plant_axles_off: axles_off, plant_dc_off: dc_off,
        plant_dcs_off: dcs_off, powertrain: plant, battery: common.battery, mapped_battery: mapped_state,
        rc_branch: common.rc_branch, auxiliary: (), converter: (), dc_motor: common.dc_motor,
        gearbox: gearbox_state, wheel: wheel_state, body: body_state,
        rotational_load: load_state, axis: axis_state, slope: slope_state, pid: common.pid,
        torque_driver: driver_state, voltage_sensor: (), current_sensor: (),
        speed_sensor: speed_sensor_state, time_table: table_state, sine: sine_state,
        pi: controllers.ours, pi_ram: controllers.ours_ram, pi_pid: controllers.pid,
        pi_idsp: controllers.idsp, pi_idsp_ram: controllers.idsp_ram,
        num_sqrt: (), fast_sqrt: (), num_exp: (), fast_exp: (),
        ekf_update: pack.ekf, ekf_refresh: (), counter_step: pack.counter, counter_review: (),
        cells: pack.cells, kalman: pack.kalman,
        resistance: learnt.resistance, capacity: learnt.capacity, energy_step: learnt.energy,
        energy_report: (), energy_walk: learnt.energy_walk.0, power_ahead: (), power_walk: learnt.walks[0], power_cells: (),
        power_cells_walk: (), cell_resistances: learnt.of_cells.resistances,
        series: learnt.of_cells.socs, h_bridge: h_driven, three_phase: three_driven,
    );
    hprintln!("soc {} {}", common.pid_off.seen.soc, common.torque_off.seen.soc);
    Some(())
}
