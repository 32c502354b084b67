//! What is counted: one function per step function, called as C would.
//!
//! `xtask` knows them by their names: everything that begins with `bench_`.

use plant_core::Accum;
use plant_core::auxiliary::{Auxiliary, AuxiliaryInput, AuxiliaryOutput};
use plant_core::battery::{
    Battery, BatteryInput, BatteryOutput, BatteryState, MappedBattery, MappedBatteryInput,
    MappedBatteryOutput, MappedBatteryState, RcBranch, RcBranchInput, RcBranchOutput,
    RcBranchState,
};
use plant_core::control::driver::{Driver, DriverInput, DriverOutput, DriverState};
use plant_core::control::pid::{Pid, PidInput, PidOutput, PidParams, PidState};
use plant_core::converter::{Converter, ConverterInput, ConverterOutput};
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorOutput, DcMotorState};
use plant_core::machine::pmsm::PmsmDrive;
use plant_core::mechanics::body::{Body, BodyInput, BodyOutput, BodyState};
use plant_core::mechanics::gearbox::{Gearbox, GearboxInput, GearboxOutput, GearboxState};
use plant_core::mechanics::rotational::{
    Axis, AxisInput, AxisOutput, AxisState, RotationalLoad, RotationalLoadInput,
    RotationalLoadOutput, RotationalLoadState,
};
use plant_core::mechanics::slope::{Slope, SlopeInput, SlopeOutput, SlopeParams, SlopeState};
use plant_core::mechanics::wheel::{Wheel, WheelInput, WheelOutput, WheelState};
use plant_core::must;
use plant_core::powertrain::ledger::{EnergyLedger, NoLedger};
use plant_core::powertrain::{
    Axles, Drive, Drives, Powertrain, PowertrainInput, PowertrainOutput, PowertrainState,
};
use plant_core::presets::{
    BMW_I3_60AH, BMW_I3_60AH_CONSTANT, CONVERTER_BENCH_LOAD, EPOWERTRAIN_UDDS,
};
use plant_core::signal::sensors::{
    AxialSpeedSensor, AxialSpeedSensorInput, AxialSpeedSensorOutput, AxialSpeedSensorParams,
    AxialSpeedSensorState, CurrentSensor, CurrentSensorInput, CurrentSensorOutput, SensorParams,
    VoltageSensor, VoltageSensorInput, VoltageSensorOutput,
};
use plant_core::signal::sources::{
    PhaseState, Sine, SineParams, TimeTable, TimeTableOutput, TimeTableState,
};
use voltstep_trace::{
    BMW_I3, BMW_I3_CONSTANT, BMW_I3_CONSTANT_LEDGER, BMW_I3_LEDGER, BMW_I3_PMSM, BothAxles,
    Composed, DT, EPOWERTRAIN, EPOWERTRAIN_LEDGER, REFERENCE, Rig, RigState, TWO_AXLED,
};

/// A driver and its plant in a closed loop, what the driver sees kept in the state.
macro_rules! rig {
    ($name:ident, $rig:expr, $ledger:ty, $battery:ident, $state:ident) => {
        rig!($name, $rig, $ledger, $state, Accum, Rig<$ledger, $battery>);
    };
    ($name:ident, $rig:expr, $ledger:ty, $state:ident, $drives:ty, $type:ty) => {
        #[doc = concat!("`", stringify!($rig), "`.")]
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $name(
            state: &mut RigState<$ledger, $state, $drives>,
            input: &TimeTableOutput,
            _: &mut (),
        ) {
            const RIG: $type = $rig;
            RIG.step(state, *input);
        }
    };
}

/// A model on its own, its whole output stored.
macro_rules! model {
    ($name:ident, $model:ty, $value:expr, $state:ty, $input:ty, $output:ty) => {
        #[doc = concat!("`", stringify!($model), "`.")]
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $name(state: &mut $state, input: &$input, output: &mut $output) {
            const MODEL: $model = $value;
            *output = MODEL.step(state, *input);
        }
    };
}

/// Nothing: `bx lr`. It must count as one instruction.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_nothing(_: &mut (), _: &(), _: &mut ()) {}

rig!(bench_plant_pid_off, EPOWERTRAIN, NoLedger, Battery, BatteryState);
rig!(bench_plant_pid_on, EPOWERTRAIN_LEDGER, EnergyLedger, Battery, BatteryState);
rig!(bench_plant_torque_off, BMW_I3_CONSTANT, NoLedger, Battery, BatteryState);
rig!(bench_plant_torque_on, BMW_I3_CONSTANT_LEDGER, EnergyLedger, Battery, BatteryState);
rig!(bench_plant_mapped_off, BMW_I3, NoLedger, MappedBattery, MappedBatteryState);
rig!(bench_plant_mapped_on, BMW_I3_LEDGER, EnergyLedger, MappedBattery, MappedBatteryState);

/// Drives asked for a torque: a synchronous machine, both, a DC machine, two of them.
macro_rules! composed {
    ($name:ident, $rig:expr, $drives:ty) => {
        rig!($name, $rig, NoLedger, BatteryState, <$drives as Drives>::State, Composed<$drives>);
    };
}

composed!(bench_plant_pmsm_off, BMW_I3_PMSM, Drive<PmsmDrive>);
composed!(bench_plant_axles_off, TWO_AXLED, BothAxles);
composed!(bench_plant_dc_off, ONE_DC, Drive);
composed!(bench_plant_dcs_off, TWO_DC, (Drive, Drive));

const DC_AXLE: Axles<Drive> = must!(I3.drives.on(I3.wheel, DT));
/// The car of `bmw-i3-60ah-constant`, its DC machine asked for a torque.
pub const ONE_DC: Composed<Drive> = must!(Rig::composed(&BMW_I3_60AH_CONSTANT, DC_AXLE, DT));
/// The same car with another drive like its own.
pub const TWO_DC: Composed<(Drive, Drive)> =
    must!(Rig::composed(&BMW_I3_60AH_CONSTANT, DC_AXLE.and(DC_AXLE), DT));

const I3: plant_core::powertrain::PowertrainParams = BMW_I3_60AH_CONSTANT.powertrain;
const PID: PidParams = match EPOWERTRAIN_UDDS.driver {
    plant_core::control::driver::DriverParams::Duty(pid) => pid,
    plant_core::control::driver::DriverParams::Torque(_) => PidParams::DEFAULT,
};
const QUANTISED: SensorParams = SensorParams { quantum: 0.1, ..SensorParams::IDEAL };
/// Another one, or the linker sees that both sensors are one function.
const COARSER: SensorParams = SensorParams { quantum: 0.2, ..SensorParams::IDEAL };

model!(
    bench_powertrain,
    Powertrain,
    must!(Powertrain::new(I3, DT)),
    PowertrainState,
    PowertrainInput,
    PowertrainOutput
);
model!(
    bench_battery,
    Battery,
    must!(Battery::new(I3.battery, DT)),
    BatteryState,
    BatteryInput,
    BatteryOutput
);
model!(
    bench_mapped_battery,
    MappedBattery,
    must!(MappedBattery::new(BMW_I3_60AH.powertrain.battery, DT)),
    MappedBatteryState,
    MappedBatteryInput,
    MappedBatteryOutput
);
model!(
    bench_rc_branch,
    RcBranch,
    must!(RcBranch::new(I3.battery.polarisation, DT)),
    RcBranchState,
    RcBranchInput,
    RcBranchOutput
);
model!(
    bench_auxiliary,
    Auxiliary,
    must!(Auxiliary::new(I3.auxiliary)),
    (),
    AuxiliaryInput,
    AuxiliaryOutput
);
model!(
    bench_converter,
    Converter,
    must!(Converter::new(I3.drives.converter)),
    (),
    ConverterInput,
    ConverterOutput
);
model!(
    bench_dc_motor,
    DcMotor,
    must!(DcMotor::new(I3.drives.motor, DT)),
    DcMotorState,
    DcMotorInput,
    DcMotorOutput
);
model!(
    bench_gearbox,
    Gearbox,
    must!(Gearbox::new(I3.drives.gearbox, DT)),
    GearboxState,
    GearboxInput,
    GearboxOutput
);
model!(bench_wheel, Wheel, must!(Wheel::new(I3.wheel, DT)), WheelState, WheelInput, WheelOutput);
model!(bench_body, Body, must!(Body::new(I3.body, DT)), BodyState, BodyInput, BodyOutput);
model!(
    bench_rotational_load,
    RotationalLoad,
    must!(RotationalLoad::new(CONVERTER_BENCH_LOAD, DT)),
    RotationalLoadState,
    RotationalLoadInput,
    RotationalLoadOutput
);
model!(bench_axis, Axis, Axis::new(DT), AxisState, AxisInput, AxisOutput);
model!(
    bench_slope,
    Slope,
    must!(Slope::new(SlopeParams { window_m: 10.0, largest_sin: 0.3 })),
    SlopeState,
    SlopeInput,
    SlopeOutput
);
model!(bench_pid, Pid, must!(Pid::new(PID, DT)), PidState, PidInput, PidOutput);
model!(
    bench_torque_driver,
    Driver,
    must!(Driver::new(BMW_I3_60AH_CONSTANT.driver, &I3, DT)),
    DriverState,
    DriverInput,
    DriverOutput
);
model!(
    bench_voltage_sensor,
    VoltageSensor,
    must!(VoltageSensor::new(QUANTISED)),
    (),
    VoltageSensorInput,
    VoltageSensorOutput
);
model!(
    bench_current_sensor,
    CurrentSensor,
    must!(CurrentSensor::new(COARSER)),
    (),
    CurrentSensorInput,
    CurrentSensorOutput
);
model!(
    bench_speed_sensor,
    AxialSpeedSensor,
    must!(AxialSpeedSensor::new(AxialSpeedSensorParams { speed: QUANTISED, pole_pairs: 6 }, DT)),
    AxialSpeedSensorState,
    AxialSpeedSensorInput,
    AxialSpeedSensorOutput
);
model!(bench_time_table, TimeTable<'static>, REFERENCE, TimeTableState, (), TimeTableOutput);
model!(
    bench_sine,
    Sine,
    must!(Sine::new(
        SineParams { amplitude: 1.0, offset: 0.0, frequency_hz: 0.5, phase_turns: 0.0 },
        DT
    )),
    PhaseState,
    (),
    f32
);
