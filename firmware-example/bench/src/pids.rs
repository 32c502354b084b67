//! Published PID controllers beside ours, on the job that all of them do: proportional and integral
//! part within limits, one output kept.

use dsp_process::SplitProcess;
use idsp::Build;
use idsp::iir::{Biquad, BiquadClamp, DirectForm1};
use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core::must;
use plant_core::num::{LARGEST, max};
use voltstep_trace::DT;

use crate::hprintln;

const PROPORTIONAL: f32 = 2.0;
const INTEGRAL_PER_S: f32 = 0.5;
const LIMIT: f32 = 1.0;

/// The job in our words: no dead zone, no derivative, no smoothing.
const PARAMS: PidParams = PidParams {
    proportional: PROPORTIONAL,
    integral_per_s: INTEGRAL_PER_S,
    output_min: -LIMIT,
    output_max: LIMIT,
    smoothing_per_s: f32::INFINITY,
    ..PidParams::DEFAULT
};
const OURS: Pid = must!(Pid::new(PARAMS, DT));

/// The same as a biquad: what `idsp` makes of the gains, which it cannot make in a constant.
const BIQUAD: BiquadClamp<f32> = BiquadClamp {
    coeff: Biquad { ba: [PROPORTIONAL + INTEGRAL_PER_S * DT.s(), -PROPORTIONAL, 0.0, 1.0, 0.0] },
    u: 0.0,
    min: -LIMIT,
    max: LIMIT,
};

/// What is counted, and the same for what is not: a call of the item would be counted.
macro_rules! controller {
    ($item:ident, $name:ident, $about:literal, $state:ty, |$s:ident, $i:ident| $output:expr) => {
        #[inline(always)]
        fn $name($s: &mut $state, $i: &PidInput) -> f32 {
            $output
        }

        #[doc = $about]
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $item(state: &mut $state, input: &PidInput, output: &mut f32) {
            *output = $name(state, input);
        }
    };
}

controller!(bench_pi, ours, "Ours, parameters known to the compiler.", PidState, |s, i| {
    OURS.step(s, *i).output
});
controller!(bench_pi_ram, ours_ram, "Ours, parameters in RAM.", (Pid, PidState), |s, i| {
    s.0.step(&mut s.1, *i).output
});
controller!(bench_pi_pid, pid_crate, "That of `pid`.", pid::Pid<f32>, |s, i| {
    s.setpoint(i.reference).next_control_output(i.measurement).output
});
controller!(
    bench_pi_idsp,
    idsp_crate,
    "That of `idsp`, coefficients known to the compiler.",
    DirectForm1<f32>,
    |s, i| BIQUAD.process(s, i.reference - i.measurement)
);
controller!(
    bench_pi_idsp_ram,
    idsp_ram,
    "That of `idsp`, coefficients in RAM.",
    (BiquadClamp<f32>, DirectForm1<f32>),
    |s, i| s.0.process(&mut s.1, i.reference - i.measurement)
);

/// The items of [`Pids::step`].
const NAMES: [&str; 3] = ["pi", "pi_pid", "pi_idsp"];

/// One of each.
pub struct Pids {
    /// Ours.
    pub ours: PidState,
    /// Ours, parameters in RAM.
    pub ours_ram: (Pid, PidState),
    /// That of `pid`.
    pub pid: pid::Pid<f32>,
    /// That of `idsp`.
    pub idsp: DirectForm1<f32>,
    /// That of `idsp`, coefficients in RAM.
    pub idsp_ram: (BiquadClamp<f32>, DirectForm1<f32>),
}

impl Pids {
    /// All of them fresh; `None` where `idsp` makes another biquad of the gains than we did.
    #[must_use]
    pub fn new() -> Option<Self> {
        let units = idsp::iir::pid::Units { t: DT.s(), ..Default::default() };
        let gains = idsp::iir::pid::Pid::<f32>::default().kp(PROPORTIONAL).ki(INTEGRAL_PER_S);
        let biquad: BiquadClamp<f32> = gains.output_limits(-LIMIT, LIMIT).build(&units);
        let pairs = biquad.coeff.ba.iter().zip(&BIQUAD.coeff.ba);
        let same = pairs.fold(true, |same, (a, b)| same && (a - b).abs() <= 1e-5);
        let mut pid = pid::Pid::new(0.0, LIMIT);
        pid.p(PROPORTIONAL, LARGEST).i(INTEGRAL_PER_S * DT.s(), LIMIT);
        same.then_some(Self {
            ours: PidState::default(),
            ours_ram: (OURS, PidState::default()),
            pid,
            idsp: DirectForm1::default(),
            idsp_ram: (biquad, DirectForm1::default()),
        })
    }

    /// What ours, that of `pid` and that of `idsp` say at an input.
    pub fn step(&mut self, input: PidInput) -> [f32; 3] {
        [
            ours(&mut self.ours, &input),
            pid_crate(&mut self.pid, &input),
            idsp_crate(&mut self.idsp, &input),
        ]
    }
}

/// How far the others have been from ours.
#[derive(Default)]
pub struct Apart([f32; 3]);

impl Apart {
    /// Looks at one step.
    pub fn look(&mut self, outputs: [f32; 3]) {
        for (most, output) in self.0.iter_mut().zip(outputs) {
            *most = max((output - outputs[0]).abs(), *most);
        }
    }

    /// In lines, for xtask.
    pub fn say(&self) {
        for (name, most) in NAMES.iter().zip(self.0) {
            hprintln!("apart {} {}", name, most);
        }
    }
}

/// Steps at and beyond a limit that are counted too, or the dearest step would not be among them.
pub const SATURATED: u32 = 1000;

/// The n-th input of those: to and fro.
#[must_use]
pub fn saturating(n: u32) -> PidInput {
    PidInput { reference: if (n / 100).is_multiple_of(2) { 1.0 } else { -1.0 }, measurement: 0.0 }
}

/// What each says of two hard cases: long in saturation, then a small error in the other direction; and a
/// measurement that is not a number, then a good one. `None` where [`Pids::new`] fails.
#[must_use]
pub fn say_hard_cases() -> Option<()> {
    let error = |reference| PidInput { reference, measurement: 0.0 };
    let mut pids = Pids::new()?;
    for _ in 0..10_000 {
        pids.step(error(1.0));
    }
    let saturated = pids.step(error(-0.01));
    let mut pids = Pids::new()?;
    pids.step(error(f32::NAN));
    let after_nan = pids.step(error(0.01));
    for (i, name) in NAMES.iter().enumerate() {
        let finite = after_nan[i].is_finite();
        hprintln!("hard {} {:.2} {}", name, saturated[i], finite);
    }
    Some(())
}
