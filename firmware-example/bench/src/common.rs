//! What is stepped on every processor: plants with their drivers, components on what a plant shows.

use plant_core::battery::{BatteryState, RcBranchState};
use plant_core::control::pid::PidState;
use plant_core::machine::dc::DcMotorState;
use plant_core::powertrain::ledger::{EnergyLedger, NoLedger};
use plant_core::signal::sources::TimeTableState;
use voltstep_trace::{BMW_I3_CONSTANT, EPOWERTRAIN, EPOWERTRAIN_LEDGER, RigState};

/// The states at the start of UDDS.
pub struct Common {
    /// How far the reference is.
    pub clock: TimeTableState,
    /// The plant with its PID.
    pub pid_off: RigState<NoLedger>,
    /// The same with its energy ledger.
    pub pid_on: RigState<EnergyLedger>,
    /// The plant that is driven by torque.
    pub torque_off: RigState<NoLedger>,
    /// A battery on its own.
    pub battery: BatteryState,
    /// An RC branch.
    pub rc_branch: RcBranchState,
    /// A motor.
    pub dc_motor: DcMotorState,
    /// A controller.
    pub pid: PidState,
}

impl Common {
    /// Everything at rest; `None` where a preset does not start.
    #[must_use]
    pub fn new() -> Option<Self> {
        Some(Self {
            clock: TimeTableState::default(),
            pid_off: EPOWERTRAIN.start().ok()?,
            pid_on: EPOWERTRAIN_LEDGER.start().ok()?,
            torque_off: BMW_I3_CONSTANT.start().ok()?,
            battery: BatteryState::rested(0.9).ok()?,
            rc_branch: RcBranchState::default(),
            dc_motor: DcMotorState::default(),
            pid: PidState::default(),
        })
    }
}
