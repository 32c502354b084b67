//! The pack and its BMS behind a CAN bus, for whoever wants to talk to one.

use plant_core::ParamError;
use voltstep_bms::comm::can::Message;
use voltstep_bms::limit::Mode;
use voltstep_bms::manage::Bus;

use super::demand::Demand;
use super::{BMS, Drive};

/// A battery that is not there: cells, contactors, sensors and a whole BMS.
pub struct VirtualPack {
    drive: Drive,
    bus: Bus,
}

impl VirtualPack {
    /// At a state of charge, 0..1, and 25 °C.
    ///
    /// # Errors
    /// [`ParamError`] for a state of charge that is none.
    pub fn at(soc: f32) -> Result<Self, ParamError> {
        Ok(Self { drive: Drive::new((soc, 25.0), Demand::Pulses, 1, Vec::new())?, bus: Bus::NEW })
    }

    /// A millisecond: takes what was heard, sends what is due. In the mode for driving it is driven, in
    /// that for charging it is charged, within its limits.
    pub fn millisecond(&mut self, heard: &[Message], send: impl FnMut(&Message)) {
        for message in heard {
            self.bus.hear(message);
        }
        let Drive { rig, state, .. } = &mut self.drive;
        let mode = BMS.report(state).mode;
        let limits = *state.limits();
        rig.drive(&limits, &Demand::of(mode == Mode::Charge));
        rig.advance();
        BMS.request(state, self.bus.asked(0.001));
        BMS.tick(state, rig);
        self.bus.send(&BMS, state, send);
    }
}
