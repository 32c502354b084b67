#![no_std]
#![no_main]
//! The same vehicle on a board, Nucleo-F411RE, as hardware in the loop: a potentiometer at PA0
//! (A0) sets the speed to follow, 0 to 30 m/s; the speed reached comes out as a PWM at PA8 (D7),
//! full scale 40 m/s. A timer gives the 1 kHz.
//!
//! ```text
//! cargo build --release --no-default-features --features board --bin board
//! probe-rs run --chip STM32F411RETx <target folder>/thumbv7em-none-eabihf/release/board
//! ```

use cortex_m_rt::entry;
use defmt_rtt as _;
use embedded_hal::pwm::SetDutyCycle;
use panic_halt as _;
use plant_core::num::clamp;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::signal::sources::TimeTableOutput;
use stm32f4xx_hal::adc::Adc;
use stm32f4xx_hal::adc::config::{AdcConfig, SampleTime};
use stm32f4xx_hal::gpio::{Analog, PA0};
use stm32f4xx_hal::pac::{self, ADC1, TIM2};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::timer::CounterUs;
use voltstep_trace::{BMW_I3_CONSTANT, Rig, RigState};

const RIG: Rig<NoLedger> = BMW_I3_CONSTANT;
const PEDAL_FULL_M_S: f32 = 30.0;
const METER_FULL_M_S: f32 = 40.0;
const ADC_FULL: f32 = 4095.0;
const STEPS_PER_LINE: u32 = 1000;

/// What the loop needs of a board; the speedometer is any PWM channel.
struct Board<P> {
    tick: CounterUs<TIM2>,
    adc: Adc<ADC1>,
    pedal: PA0<Analog>,
    meter: P,
}

impl<P: SetDutyCycle> Board<P> {
    /// Waits for the next millisecond.
    fn wait(&mut self) {
        while self.tick.wait().is_err() {}
    }

    /// The speed that the pedal asks for \[m/s\].
    fn reference_m_s(&mut self) -> f32 {
        let reading = self.adc.convert(&self.pedal, SampleTime::Cycles_84);
        f32::from(reading) * (PEDAL_FULL_M_S / ADC_FULL)
    }

    /// Shows a speed.
    fn show(&mut self, speed_m_s: f32) {
        let full = self.meter.max_duty_cycle();
        let share = clamp(speed_m_s * (1.0 / METER_FULL_M_S), 0.0, 1.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to full")]
        let duty = (share * f32::from(full)) as u16;
        if self.meter.set_duty_cycle(duty).is_err() {
            defmt::warn!("the speedometer refused {=u16}", duty);
        }
    }
}

#[entry]
fn main() -> ! {
    if let (Some(device), Ok(state)) = (pac::Peripherals::take(), RIG.start()) {
        run(device, state);
    }
    defmt::error!("cannot start");
    loop {
        cortex_m::asm::wfi();
    }
}

fn run(device: pac::Peripherals, mut state: RigState<NoLedger>) {
    let mut rcc = device.RCC.freeze(Config::hsi().sysclk(84.MHz()));
    let pins = device.GPIOA.split(&mut rcc);
    let (_, (channel, ..)) = device.TIM1.pwm_hz(1.kHz(), &mut rcc);
    let mut meter = channel.with(pins.pa8);
    meter.enable();
    let mut tick = device.TIM2.counter_us(&mut rcc);
    if tick.start(1.millis()).is_err() {
        return;
    }
    let adc = Adc::new(device.ADC1, true, AdcConfig::default(), &mut rcc);
    let mut board = Board { tick, adc, pedal: pins.pa0.into_analog(), meter };

    let mut steps: u32 = 0;
    loop {
        board.wait();
        let value = board.reference_m_s();
        // The rate is not known, and the pedal has no end.
        let accepted = !RIG
            .step(&mut state, TimeTableOutput { value, rate_per_s: 0.0, ended: false })
            .rejected;
        board.show(state.seen.speed_m_s);
        steps = steps.wrapping_add(1);
        if steps.is_multiple_of(STEPS_PER_LINE) || !accepted {
            defmt::info!(
                "reference {=f32} m/s, speed {=f32} m/s, soc {=f32}, accepted {=bool}",
                value,
                state.seen.speed_m_s,
                state.seen.soc,
                accepted
            );
        }
    }
}
