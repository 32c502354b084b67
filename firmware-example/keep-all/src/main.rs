#![no_std]
#![no_main]
//! Every public function of plant-core and voltstep-bms in one image, compiled for parameters that
//! are not known: what could panic, allocate or compute in double precision would be in it. `cargo
//! xtask image` looks, and demands that this list names every public function.

mod flash;
mod frame;

use core::hint::black_box;

use cortex_m_rt::entry;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use panic_halt as _;
use plant_core::auxiliary::Auxiliary;
use plant_core::battery::{
    self, Battery, BatteryParams, BatteryState, BranchMap, CurrentLimits, IdentifiedRange,
    MappedBattery, MappedBatteryParams, OpenCircuit, OverSoc, Pack, RcBranch, ResistanceMap,
};
use plant_core::circuit::{self, CircuitInput, Phases};
use plant_core::control::driver::{Driver, TorqueDriver};
use plant_core::control::foc::reference::Torque;
use plant_core::control::foc::{Foc, FocState};
use plant_core::control::pid::{Pid, PidState};
use plant_core::converter::{Converter, Gates};
use plant_core::error;
use plant_core::link::{Contactor, Insulation, Link, LinkState};
use plant_core::machine::dc::{CurrentLaw, DcDrive, DcMotor, DcMotorParams, Winding};
use plant_core::machine::flux::Flux;
use plant_core::machine::heated::Heated;
use plant_core::machine::pmsm::{
    DqCurrents, DqLaw, DqWinding, Pmsm, PmsmDrive, PmsmInput, PmsmParams, PmsmState,
};
use plant_core::machine::transform::{self, Abc, AlphaBeta, Dq, RotorAngle};
use plant_core::machine::{MachineFlows, Solved, Temperatures};
use plant_core::mechanics::body::{Body, Resistance};
use plant_core::mechanics::gearbox::Gearbox;
use plant_core::mechanics::rotational::{Axis, RotAxis, RotationalLoad};
use plant_core::mechanics::slope::{Grade, Slope, SlopeState};
use plant_core::mechanics::wheel::Wheel;
use plant_core::num::{self, SocTable};
use plant_core::port::{self, BusLaw, BusRise, Coast, Slip, Source};
use plant_core::powertrain::ledger::{EnergyLedger, EnergyReport, NoLedger};
use plant_core::powertrain::{
    Axles, Drive, DriveParams, Drives, Either, HeatedDriveParams, Powertrain, PowertrainInput,
    PowertrainParams,
};
use plant_core::signal::faults::{Drift, Lapse, Noise, Random};
use plant_core::signal::sensors::{AxialSpeedSensor, CurrentSensor, VoltageSensor};
use plant_core::signal::sources::{Ramp, Saturation, Sine, Square, Step, TimeTable, UnitDelay};
use plant_core::thermal::{
    Conductor, Derating, DriveLosses, ThermalNode, ThermalNodeState, ThermalPair, ThermalPairState,
};
use plant_core::{Accum, Dt, Model, ParamError};
use voltstep_bms::Estimate;
use voltstep_bms::balance::{self, Balancer};
use voltstep_bms::comm::can::inverter::{Alarm, Alarms, InverterView};
use voltstep_bms::comm::can::{
    self, CellExtremes, CellGroup, Command, FaultPage, LogReader, LogRequest, Message,
    RequestWatch, RequestWatchState, Status, TemperatureExtremes,
};
use voltstep_bms::contactor::{
    self, Cause, ContactorControl, ContactorState, LinkTrend, PinFaults, PrechargeState,
    PrechargeWatch,
};
use voltstep_bms::estimate::cells::{self, CellResistances, Cells};
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombState};
use voltstep_bms::estimate::ekf::{Ekf, EkfParams, EkfState, Uncertainty};
use voltstep_bms::estimate::energy::EnergyGauge;
use voltstep_bms::estimate::power::{PowerLimits, PowerWalk, TemperatureWindow};
use voltstep_bms::estimate::series::Series;
use voltstep_bms::estimate::soh::{CapacityEstimator, Health, ResistanceEstimator};
use voltstep_bms::limit::{self, Limiter};
use voltstep_bms::log::{self, Entry, Log};
use voltstep_bms::manage::recorder::Recorder;
use voltstep_bms::manage::{self, Asked, BmsParams, Board, Bus, Description};
use voltstep_bms::measure::{self, Reading, Spread};
use voltstep_bms::protect::{
    self, Debounce, DebounceState, Faults, Id, PackSheet, Reaction, Row, Seen, Table, Verdict,
};
use voltstep_bms::store::record::{self, Found, Record, Slot};

type Plain = Powertrain<NoLedger>;
type Ledgered = Powertrain<EnergyLedger>;
type WithBattery = PowertrainParams<BatteryParams>;
type Mapped = Powertrain<NoLedger, MappedBattery>;
type MappedLedgered = Powertrain<EnergyLedger, MappedBattery>;

/// Synchronous and DC machines alone, in pairs, in pairs of pairs.
type Synchronous = Drive<PmsmDrive>;
type Warm = Drive<Heated<DcDrive>>;
type WarmSynchronous = Drive<Heated<PmsmDrive>>;
type OneOfEach = (Synchronous, Drive);
type Four = ((Synchronous, Synchronous), (Drive, Drive));
/// One of two, told apart at run time.
type AnyDrive = Either<Drive, Synchronous>;
/// What drives them, and the same with a battery that depends on temperature and a ledger.
type Composed<D> = Powertrain<NoLedger, Battery, D>;
type ComposedLedgered<D> = Powertrain<EnergyLedger, MappedBattery, D>;

/// Cells of the pack, and its temperature sensors.
const CELLS: usize = 18;
const SENSORS: usize = 4;
type CellsState = cells::CellsState<CELLS>;
type SeriesPack = plant_core::battery::SeriesPack<CELLS>;
/// A bridge of four transistors, solved in each step.
type Circuit = circuit::Circuit<4, 6>;
type Delay = plant_core::signal::faults::Delay<3>;
type CellResistancesState = cells::CellResistancesState<CELLS>;
type Measurements = measure::Measurements<CELLS, SENSORS>;
type RecordStore = record::RecordStore<flash::Flash>;
type LogStore = log::LogStore<flash::Flash>;
type Contactors = contactor::Contactors<Pin, Pin>;
type BalancerState = balance::BalancerState<CELLS>;
type Protection = protect::Protection<'static, CELLS, SENSORS>;
type ProtectionState = protect::ProtectionState<CELLS, SENSORS>;
type Bms = manage::Bms<CELLS, SENSORS>;
type BmsState = manage::BmsState<CELLS, SENSORS>;

/// Keeps functions that the linker would drop.
macro_rules! keep {
    ($($function:expr),+ $(,)?) => { $(black_box($function as *const ());)+ };
}

#[entry]
fn main() -> ! {
    components();
    drive();
    composed();
    numbers();
    management();
    protection();
    bus();
    whole();
    recorded();
    controls();
    loop {
        cortex_m::asm::nop();
    }
}

#[rustfmt::skip]
fn components() {
    keep!(
        Contactor::new, Contactor::step, plant_core::link::ContactorState::is_closed, <Contactor as Model>::step, LinkState::charged_to, Link::new,
        Link::step, <Link as Model>::step, Insulation::new, Insulation::step, <Insulation as Model>::step,
        Circuit::new, circuit::Circuit::<4, 6, 6, 16>::tabled, Circuit::branches, Circuit::step, circuit::Circuit::<4, 6, 6, 16>::step, Circuit::books, <Circuit as Model>::step,
        Phases::new, Phases::coil, Phases::constants_nm_per_a, CircuitInput::<6>::of, circuit::sources::<6>, circuit::two_states::<6>, circuit::Branch::new, circuit::h_bridge, circuit::three_phase,
        Auxiliary::new, Auxiliary::constant_power_a, Auxiliary::cut_out_s, Auxiliary::step,
        BatteryState::rested, Battery::new, Battery::offer, Battery::limits, Battery::faded,
        Battery::next, CurrentLimits::within, Battery::allows, Battery::settle, Battery::stored_energy_j, Battery::discharged_energy_j,
        Battery::is_depleted, Battery::is_full, Battery::step,
        MappedBattery::new, MappedBattery::rested, MappedBattery::rested_at,
        MappedBattery::params, MappedBattery::resistances, MappedBattery::set_temperature,
        MappedBattery::offer, MappedBattery::limits, MappedBattery::faded, MappedBattery::next, MappedBattery::allows,
        MappedBattery::settle, MappedBattery::refresh, MappedBattery::open_circuit,
        MappedBattery::step, <Battery as Pack>::losses, <MappedBattery as Pack>::losses,
        <MappedBattery as Pack>::discharged_energy_j,
        OverSoc::at, ResistanceMap::at, BranchMap::at, BranchMap::resistance,
        IdentifiedRange::holds, IdentifiedRange::nearest_c,
        OpenCircuit::at, OpenCircuit::mean,
        OpenCircuit::with_slope, OpenCircuit::soc_at, MappedBatteryParams::constant,
        BatteryParams::pack, MappedBatteryParams::pack, SeriesPack::new, SeriesPack::rested, SeriesPack::offer, SeriesPack::limits,
        SeriesPack::faded, SeriesPack::next, SeriesPack::allows, SeriesPack::settle, SeriesPack::refresh, SeriesPack::cell, SeriesPack::step,
        <SeriesPack as Pack>::losses, <SeriesPack as Pack>::discharged_energy_j, <SeriesPack as Pack>::set_temperature,
        <SeriesPack as Pack>::magnitude, <SeriesPack as Pack>::is_outside, RcBranch::new, RcBranch::step,
        Resistance::solve, Body::new, Body::coast, Body::resistance, Body::settle, Body::step,
        Gates::<f32>::modulation, Converter::new, Converter::allowed_duty, Converter::shunt_s,
        Converter::seen_through, Converter::step,
        CurrentLaw::increment_a, Winding::reflected, Winding::law,
        DcMotor::new, DcMotor::winding, DcMotor::coast, DcMotor::step, DcMotor::step_at_speed,
        Flux::at, Flux::near, Flux::energy_j,
        DqWinding::reflected, DqWinding::flux, DqWinding::pole_pairs, DqWinding::is_coarse,
        DqWinding::law, DqLaw::increment_a, DqLaw::admit, DqLaw::voltage_v, DqLaw::field_v, DqLaw::diode_v,
        DqLaw::torque_nm, Pmsm::new, Pmsm::winding, Pmsm::coast, Pmsm::step, Pmsm::step_at_speed,
        PmsmInput::cold, PmsmState::current_a, DqCurrents::get, MachineFlows::times, Temperatures::worse, Solved::<()>::of,
        Dq::dot, Dq::turned, Dq::length, Dq::within, Dq::to_stator, AlphaBeta::to_rotor,
        AlphaBeta::to_phases, Abc::to_vector, RotorAngle::of_turns, transform::duties,
        transform::averaged_inverter,
        battery::temperature_factor, Gearbox::new, Gearbox::coast, Gearbox::loss_ratio, Gearbox::step,
        Wheel::new, Wheel::axle_rad_s, Wheel::coast, Wheel::step,
        Axis::new, Axis::step, RotAxis::new, RotAxis::coast, RotAxis::step,
        ThermalNode::new, ThermalNode::step, ThermalNodeState::at, ThermalPair::new, ThermalPair::step,
        ThermalPairState::at, Derating::checked, Derating::factor, Conductor::checked, Conductor::factor,
        DriveLosses::checked, DriveLosses::of_dc_machine, DriveLosses::loss_w,
        DriveLosses::resistance_ohm, DriveLosses::voltage_drop_v,
        RotationalLoad::new, RotationalLoad::solve, RotationalLoad::settle, RotationalLoad::step,
        VoltageSensor::new, VoltageSensor::step, CurrentSensor::new, CurrentSensor::step,
        AxialSpeedSensor::new, AxialSpeedSensor::step,
        Random::new, Random::bits, Random::ratio, Random::normal, Noise::new, Noise::start, Noise::step,
        Drift::new, Drift::step, Delay::new, Delay::start, Delay::step, Lapse::new, Lapse::start, Lapse::step,
        Grade::from_sin, Grade::from_ratio, SlopeState::starting_at, SlopeState::starting_on, Slope::new, Slope::step,
    );
}

#[rustfmt::skip]
fn drive() {
    keep!(
        Driver::new::<BatteryParams>, Driver::step, TorqueDriver::new::<BatteryParams>, TorqueDriver::fitted, TorqueDriver::step,
        Foc::new, Foc::step, FocState::lacking_v, Torque::currents,
        PidState::integral, PidState::output, PidState::reset,
        Pid::new, Pid::preload, Pid::feed_back, Pid::saturate, Pid::step,
        Plain::new, Plain::with_ledger, Ledgered::energy, WithBattery::with_battery::<MappedBatteryParams>,
        Mapped::at_speed, Mapped::step,
        MappedLedgered::step, MappedLedgered::energy,
        Plain::at_rest, Plain::at_speed, Plain::feedback, Plain::battery, Plain::motor_rad_per_m,
        Plain::moving_mass_kg, PowertrainInput::on, Plain::step, Ledgered::at_rest, Ledgered::at_speed,
        Ledgered::step,
        EnergyReport::terms, EnergyReport::residual_rel,
        Step::new, Step::step, Ramp::new, Ramp::step, Sine::new, Sine::step, Square::new,
        Square::step, UnitDelay::new, UnitDelay::step, Saturation::new, Saturation::step,
        TimeTable::new, TimeTable::step,
    );
}

/// The plants of all kinds of drives.
fn composed() {
    keep!(
        DriveParams::<DcMotorParams>::new,
        DriveParams::<DcMotorParams>::on,
        DriveParams::<PmsmParams>::on,
        HeatedDriveParams::<DcMotorParams>::on,
        HeatedDriveParams::<PmsmParams>::on,
        Axles::<Drive>::and::<Synchronous>,
        Axles::<Drive>::motor_rad_per_m,
        unchanged,
        PowertrainParams::<BatteryParams>::with_drives::<DriveParams<PmsmParams>>,
        PowertrainParams::<BatteryParams, (DriveParams<PmsmParams>, DriveParams)>::build,
        PowertrainInput::<(f32, f32)>::with,
    );
    plants::<Drive>();
    plants::<Synchronous>();
    plants::<(Drive, Drive)>();
    plants::<(Synchronous, Synchronous)>();
    plants::<OneOfEach>();
    plants::<Four>();
    plants::<(AnyDrive, AnyDrive)>();
    plants::<Warm>();
    plants::<WarmSynchronous>();
    plants::<(WarmSynchronous, Warm)>();
}

/// Axles of other drives, which are the same.
fn unchanged(axles: Axles<Drive>) -> Axles<Drive> {
    Axles::map(axles, core::convert::identity)
}

/// All that a plant with these drives does.
fn plants<D: Drives>() {
    keep!(
        D::command,
        Composed::<D>::of::<BatteryParams, DriveParams>,
        Composed::<D>::with_ledger,
        Composed::<D>::drives,
        Composed::<D>::at_rest,
        Composed::<D>::motor_rad_per_m,
        Composed::<D>::feedback,
        Composed::<D>::temperatures,
        Composed::<D>::seen_of,
        Composed::<D>::step,
        ComposedLedgered::<D>::step,
        ComposedLedgered::<D>::energy,
    );
}

#[rustfmt::skip]
fn numbers() {
    keep!(
        ParamError::field, ParamError::message, Dt::from_s, Dt::s,
        Accum::new, Accum::get, Accum::add, Accum::since, Accum::add_sum, Accum::scaled,
        Accum::clamp,
        num::max, num::min, num::clamp, num::sane, num::sound, num::sign, num::lag_gain, num::sqrt,
        num::exp, num::ln, num::floor, num::wrap_turns, num::sin_cos_turns,
        SocTable::new, SocTable::from_points, SocTable::at, SocTable::mean, SocTable::values,
        SocTable::is_monotone, SocTable::with_slope,
        Source::stiff, Source::voltage_v, Source::loaded, BusLaw::on, BusRise::at, Coast::plus, Coast::reflected,
        Coast::slope, Slip::sign, port::project,
        error::positive, error::not_negative, error::finite, error::limit, error::ratio,
        error::efficiency, error::above,
    );
}

#[rustfmt::skip]
fn management() {
    keep!(
        Reading::new, Reading::usable, Reading::usable_or_nan, Reading::elapse, Spread::of,
        Measurements::elapse, Measurements::cells_or_nan, Measurements::cell_spread, Measurements::fits_in_series,
        Measurements::temperature_spread, <Measurements as Default>::default,
        Uncertainty::typical, EkfParams::typical, EkfState::soc, EkfState::variance, Ekf::new, Ekf::params,
        Ekf::start, Ekf::start_unknown, Ekf::start_rested, Ekf::step, Ekf::update, Ekf::refresh,
        Ekf::estimate, Ekf::status, Ekf::remember, Ekf::resume, Ekf::pause, Ekf::adopt,
        <Ekf as Model>::step,
        CoulombState::known, <CoulombState as Default>::default, CoulombCounter::new,
        CoulombCounter::rested, CoulombCounter::step, CoulombCounter::soc, CoulombCounter::soc_sd,
        CoulombCounter::review, CoulombCounter::pause, CoulombCounter::adopt,
        <CoulombCounter as Model>::step,
        Cells::new, Cells::adopt::<CELLS>, Cells::start::<CELLS>, Cells::step::<CELLS>, CellsState::cell,
        Series::resume::<CELLS>, Series::step::<CELLS>,
        CellsState::spread, CellsState::book, CellResistances::new, CellResistances::start::<CELLS>,
        CellResistances::step::<CELLS>, CellResistancesState::ratio,
        Estimate::rested, Health::as_new, Health::capacity_ratio, CapacityEstimator::new, CapacityEstimator::unknown,
        CapacityEstimator::known, CapacityEstimator::step, ResistanceEstimator::new,
        ResistanceEstimator::unknown, ResistanceEstimator::known, ResistanceEstimator::step,
        EnergyGauge::new, EnergyGauge::params, EnergyGauge::step, EnergyGauge::report, EnergyGauge::walk, EnergyGauge::left,
        TemperatureWindow::share, PowerLimits::new, PowerLimits::ahead,
        PowerLimits::ahead_of_cells::<CELLS>, PowerLimits::walk, PowerLimits::walk_of_cells::<CELLS>,
        <PowerWalk as Default>::default,
        Slot::other, Record::checked, Record::encode, Record::decode, Found::in_slots, Found::next,
        Record::of, Record::health, Record::memory, Record::age_s, Record::filter, Record::counter,
        RecordStore::new, RecordStore::load, RecordStore::save, RecordStore::release,
    );
}

#[rustfmt::skip]
fn protection() {
    keep!(
        BalancerState::bleeding, BalancerState::to_bleed_as, BalancerState::disturbs, Balancer::new,
        Balancer::step::<CELLS>,
        contactor::current_class, LinkTrend::new, LinkTrend::of, PinFaults::any, Contactors::apply, Contactors::read,
        ContactorControl::new, ContactorControl::start, ContactorControl::resume, ContactorControl::step,
        PrechargeState::heat_j, PrechargeWatch::new, PrechargeWatch::cold, PrechargeWatch::warmed,
        PrechargeWatch::ready, PrechargeWatch::begin, PrechargeWatch::cool, PrechargeWatch::step,
        Cause::needs, Cause::code, Cause::at, Cause::faults, ContactorState::phase, ContactorState::cause,
        ContactorState::tries, ContactorState::coils, ContactorState::power_allowed,
        Limiter::new, Limiter::step, limit::arbitrate,
        Entry::encode, Entry::decode, Log::new, Log::follow, Log::write, Log::newest, Log::entries, Log::occurrences, Log::pending,
        Log::stored, Log::lost, LogStore::new, LogStore::newest, LogStore::slots, LogStore::entry,
        LogStore::append, LogStore::release,
        DebounceState::tripped, DebounceState::quiet, Debounce::step, Id::index, Id::at, Id::flow, Id::side,
        Faults::with, Faults::without, Faults::has, Faults::is_empty, Faults::union, Faults::minus,
        Faults::bits, Faults::iter,
        ProtectionState::locked_by, ProtectionState::latched, ProtectionState::cell_extremes_v, ProtectionState::heat_share,
        ProtectionState::temperature_extremes_c, Protection::new, Protection::table, Protection::step,
        Reaction::trip, Seen::all, Seen::flag, Row::judge, PackSheet::sweep_s, Verdict::bars,
        Verdict::derates, Table::new, Table::with, Table::supposing, Table::rows, Table::row, Table::sheet, Table::period_s,
        Table::longest_s,
    );
}

#[rustfmt::skip]
fn bus() {
    keep!(
        CellExtremes::of, CellExtremes::encode, CellExtremes::decode,
        TemperatureExtremes::of, TemperatureExtremes::encode, TemperatureExtremes::decode,
        CellGroup::of, CellGroup::encode, CellGroup::decode,
        FaultPage::of, FaultPage::latched, FaultPage::encode, FaultPage::decode,
        Message::new, Message::frame::<frame::CanFrame>, Message::of::<frame::CanFrame>, Message::id, Message::data,
        can::alive_after, Alarm::of, Alarms::with, Alarms::has,
        InverterView::alarms_of, InverterView::encode, InverterView::hear,
        LogRequest::encode, LogRequest::decode, can::log_parts, LogReader::read,
        Command::encode_vehicle, Command::encode_charger,
        RequestWatchState::request, RequestWatchState::take_clear,
        RequestWatch::elapse, RequestWatch::hear, RequestWatch::faults,
        Status::encode, Status::decode, can::Pack::encode, can::Pack::decode,
        can::encode_limits, can::decode_limits,
        find_in_log as fn(&LogRequest, &'static Log) -> Option<&'static Entry>,
    );
}

#[rustfmt::skip]
fn whole() {
    keep!(
        BmsParams::typical, BmsParams::per_second, BmsParams::ticks_per_sample,
        Description::new, Description::supposing, Description::params, Description::table, Description::battery,
        Bms::new, Bms::description, Bms::start, Bms::request, Bms::fast::<Idle>, Bms::filter::<Idle>,
        Bms::slow, Bms::tick::<Idle>, Bms::report, Bms::record, Bms::worth_keeping,
        BmsState::measurements, BmsState::uptime_us, BmsState::verdict, BmsState::contactors, BmsState::limits, BmsState::log, BmsState::log_mut, BmsState::series, Asked::heard,
        Bus::hear, Bus::asked, send_all as fn(&mut Bus, &Bms, &BmsState),
    );
}

#[rustfmt::skip]
fn recorded() {
    keep!(
        Recorder::new::<CELLS, SENSORS>, Recorder::call::<CELLS, SENSORS, Idle>,
        Recorder::checkpoint::<CELLS, SENSORS>, Recorder::freeze::<CELLS, SENSORS>, Recorder::calls,
        write_all as fn(&Recorder, &Bms) -> bool,
    );
}

/// What is written goes nowhere.
fn write_all(recorder: &Recorder, bms: &Bms) -> bool {
    Recorder::write(recorder, bms, |bytes| {
        black_box(bytes);
    })
}

/// What is sent goes nowhere.
fn send_all(bus: &mut Bus, bms: &Bms, state: &BmsState) {
    Bus::send(bus, bms, state, |message| {
        black_box(message);
    });
}

/// A board of which nothing is known.
struct Idle;

impl Board<CELLS, SENSORS> for Idle {
    fn uptime_us(&mut self) -> u64 {
        black_box(0)
    }

    fn measure(&mut self, into: &mut Measurements) {
        black_box(into);
    }

    fn feedback(&mut self) -> [contactor::Feedback; 3] {
        black_box([contactor::Feedback::Unknown; 3])
    }

    fn drive(&mut self, coils: contactor::Coils) -> bool {
        black_box(coils);
        black_box(true)
    }

    fn bleed(&mut self, cells: &[bool; CELLS]) {
        black_box(cells);
    }
}

/// The log's iterator has no name.
fn find_in_log(request: &LogRequest, log: &'static Log) -> Option<&'static Entry> {
    LogRequest::find(request, log.entries())
}

/// A pin that does nothing.
struct Pin;

impl ErrorType for Pin {
    type Error = core::convert::Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Self::Error> {
        Ok(black_box(true))
    }

    fn is_low(&mut self) -> Result<bool, Self::Error> {
        Ok(black_box(false))
    }
}

/// What the checks must find when asked to: each of them sees that it can fail.
fn controls() {
    #[cfg(feature = "control-panic")]
    {
        let squares = black_box(&[1, 4, 9][..]);
        black_box(squares[black_box(2)]);
    }
    #[cfg(feature = "control-double")]
    black_box(black_box(1.5_f64) * 1.1);
    #[cfg(feature = "control-alloc")]
    {
        let boxed = alloc::boxed::Box::new(black_box(7));
        black_box(boxed);
    }
}

#[cfg(feature = "control-alloc")]
mod heap {
    use core::alloc::{GlobalAlloc, Layout};

    /// Gives nothing: it only has to be linked.
    struct Empty;

    // SAFETY: it never gives memory away.
    unsafe impl GlobalAlloc for Empty {
        unsafe fn alloc(&self, _layout: Layout) -> *mut u8 {
            core::ptr::null_mut()
        }

        unsafe fn dealloc(&self, _memory: *mut u8, _layout: Layout) {}
    }

    #[global_allocator]
    static HEAP: Empty = Empty;
}

#[cfg(feature = "control-alloc")]
extern crate alloc;
