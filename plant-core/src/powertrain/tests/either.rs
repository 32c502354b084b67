//! Drives told apart at run time.

use crate::battery::{Battery, CurrentLimits};
use crate::machine::dc::DcDrive;
use crate::machine::pmsm::PmsmDrive;
use crate::machine::{Footing, Seen};
use crate::powertrain::ledger::NoLedger;
use crate::powertrain::{Drive, Drives, Either, Powertrain, PowertrainInput};
use crate::presets::TWO_AXLES;
use crate::{Dt, Real};

type Any = Either<Drive<DcDrive>, Drive<PmsmDrive>>;

type Named = Powertrain<NoLedger, Battery, (Drive<PmsmDrive>, Drive)>;
type Chosen = Powertrain<NoLedger, Battery, (Any, Any)>;

fn plants() -> (Named, Chosen) {
    let (params, dt) = (TWO_AXLES.powertrain, Dt::from_s(1e-3).unwrap());
    let rear = params.drives.0.on(params.wheel, dt).unwrap();
    let front = params.drives.1.on(params.wheel, dt).unwrap();
    let battery = Battery::new(params.battery, dt).unwrap();
    let any = rear.map(Either::Other).and(front.map(Either::One));
    let plain = Powertrain::of(battery, rear.and(front), &params, dt).unwrap();
    (plain, Powertrain::of(battery, any, &params, dt).unwrap())
}

#[test]
fn the_bits_are_those_of_drives_that_the_program_names() {
    let (plain, any) = plants();
    let (mut a, mut b) = (plain.at_speed(0.6, 8.0).unwrap(), any.at_speed(0.6, 8.0).unwrap());
    assert_eq!(plain.motor_rad_per_m(), any.motor_rad_per_m());
    let mut limited = 0;
    for n in 0..4000_u16 {
        let torque_nm = if n % 1000 < 500 { 200.0 } else { -150.0 };
        // Gates off for a while; battery limits in both directions, some of which act.
        let limits = CurrentLimits { discharge_a: 60.0 + Real::from(n), charge_a: 30.0 };
        let off = (2200..2300).contains(&n);
        let (mut one, mut other) = (PowertrainInput::default(), PowertrainInput::default());
        if !off {
            one.gates = plain.drives().command(torque_nm);
            other.gates = any.drives().command(torque_nm);
        }
        (one.limits, other.limits) = (limits, limits);
        let (x, y) = (plain.step(&mut a, one), any.step(&mut b, other));
        assert!(!x.rejected && !y.rejected, "{n}");
        limited += u16::from(x.limited != crate::powertrain::Limited::No);
        assert_eq!((a.battery, a.body, a.battery_v), (b.battery, b.body, b.battery_v), "{n}");
        assert_eq!(a.drives, (b.drives.0.1, b.drives.1.0), "{n}");
        assert_eq!((x.limited, x.flows), (y.limited, y.flows), "{n}");
        assert_eq!(plain.seen_of(&x), any.seen_of(&y), "{n}");
    }
    assert!(limited > 100 && limited < 3900, "{limited}");
}

#[test]
fn what_is_the_others_counts_as_nothing() {
    let (_, any) = plants();
    let (rear, front) = *any.drives();
    let footing = Footing { speed_m_s: 5.0, mobility: 1e-6 };
    let seen = Seen { bus_v: 380.0, from_v: 380.0, speed_m_s: 5.0, footing };
    let (mut state, command) = (Default::default(), rear.command(100.0));
    let (_, link) = rear.law(&state, command, seen);
    let link = rear.close(link, 0.0, 0.0);
    front.settle(&mut state, &link);
    assert_eq!(state, Default::default());
    assert!(!front.review(&state, &link, 380.0, 0.0).fits);
    assert_eq!(front.torque_nm(&rear.output(&state, &link, 5.0)), 0.0);
    rear.settle(&mut state, &link);
    assert_ne!(state, Default::default());
    assert!(rear.torque_nm(&rear.output(&state, &link, 5.0)) > 0.0);
}
