#![no_std]
#![no_main]
//! The whole BMS on a board, Nucleo-F411RE: the pack of `own_pack`, simulated in place of a front end;
//! contactors on pins. The blue button (PC13), held, asks to drive; the coils of minus, precharge and
//! plus are PA5 (D13, the green light), PA6 (D12) and PA7 (D11). Once a second a line says what is known.
//!
//! ```text
//! cargo build --release --no-default-features --features board --bin board_bms
//! probe-rs run --chip STM32F411RETx <target folder>/thumbv7em-none-eabihf/release/board_bms
//! ```

#[path = "../../../bms/examples/own_pack/hardware.rs"]
mod hardware;
#[path = "../../../bms/examples/own_pack/pack.rs"]
#[allow(dead_code, reason = "the loop is this board's own")]
mod pack;

use cortex_m_rt::entry;
use defmt_rtt as _;
use embedded_hal::digital::OutputPin;
use panic_halt as _;
use stm32f4xx_hal::ReadFlags;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::timer::Flag;
use voltstep_bms::ParamError;
use voltstep_bms::limit::Request;
use voltstep_bms::manage::Asked;
use voltstep_trace::Overruns;

use hardware::Hardware;
use pack::BMS;

const SYSTEM_MHZ: u32 = 84;
const START_SOC: f32 = 0.6;
const TICKS_PER_LINE: u32 = 1000;

#[entry]
fn main() -> ! {
    if let Some(device) = pac::Peripherals::take()
        && run(device).is_err()
    {
        defmt::error!("the pack does not start");
    }
    loop {
        cortex_m::asm::wfi();
    }
}

fn run(device: pac::Peripherals) -> Result<(), ParamError> {
    let mut rcc = device.RCC.freeze(Config::hsi().sysclk(SYSTEM_MHZ.MHz()));
    let (a, c) = (device.GPIOA.split(&mut rcc), device.GPIOC.split(&mut rcc));
    let mut minus = a.pa5.into_push_pull_output();
    let mut precharge = a.pa6.into_push_pull_output();
    let mut plus = a.pa7.into_push_pull_output();
    let button = c.pc13.into_input();
    let mut tick = device.TIM2.counter_us(&mut rcc);
    if tick.start(1.millis()).is_err() {
        defmt::error!("no tick of a millisecond");
        return Ok(());
    }

    let mut pack = Hardware::at(START_SOC)?;
    let mut state = BMS.start(None, None, 25.0)?;
    let mut overruns = Overruns::default();
    let mut ticks: u32 = 0;
    loop {
        while tick.wait().is_err() {}
        // It pulls the pin down.
        let pressed = button.is_low();
        let vehicle = if pressed { Request::Drive } else { Request::Off };
        BMS.request(&mut state, Asked { vehicle, ..Asked::NOTHING });
        BMS.tick(&mut state, &mut pack);
        pack.wait_for_the_next_millisecond(state.limits());
        let coils = pack.coils();
        show(&mut minus, coils[0]);
        show(&mut precharge, coils[1]);
        show(&mut plus, coils[2]);
        ticks = ticks.wrapping_add(1);
        if ticks.is_multiple_of(TICKS_PER_LINE) {
            let report = BMS.report(&state);
            defmt::info!(
                "soc {=f32} ± {=f32}, truly {=f32}, {=f32} A, {=f32} V at the link, limits {=f32} A and {=f32} A, late {=u32}",
                report.soc,
                report.soc_sd,
                pack.soc(),
                report.current_a,
                report.link_v,
                report.limits.discharge.current_a,
                report.limits.charge.current_a,
                overruns.count()
            );
        }
        overruns.step_ended(tick.flags().contains(Flag::Update));
    }
}

/// Shows a coil on its pin.
fn show(pin: &mut impl OutputPin, on: bool) {
    if pin.set_state(on.into()).is_err() {
        defmt::warn!("a coil's pin is refused");
    }
}
