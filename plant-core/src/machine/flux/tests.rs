//! A map against the functions that its points were taken from.

extern crate std;
use super::*;
use std::boxed::Box;
use std::vec::Vec;

const D: FluxAxis = FluxAxis { start_a: -30.0, step_a: 5.0, points: 11 };
const Q: FluxAxis = FluxAxis { start_a: -40.0, step_a: 8.0, points: 11 };

fn map(flux: impl Fn(Dq) -> Dq) -> FluxMap {
    let mut table = Vec::new();
    for n in 0..D.points {
        for m in 0..Q.points {
            let d = D.start_a + D.step_a * Real::from(n);
            let psi = flux(Dq { d, q: Q.start_a + Q.step_a * Real::from(m) });
            table.push([psi.d, psi.q]);
        }
    }
    FluxMap { d: D, q: Q, flux_wb: Box::leak(table.into_boxed_slice()) }
}

/// The gradient of a co-energy, of second order in both currents.
fn quadratic(i: Dq) -> Dq {
    Dq {
        d: 0.3 + 0.01 * i.d - 1e-5 * i.d * i.d - 2e-5 * i.q * i.q,
        q: 0.02 * i.q - 4e-5 * i.d * i.q,
    }
}

fn near(a: Real, b: Real) {
    assert!((a - b).abs() < 2e-6, "{a} against {b}");
}

#[test]
fn a_linear_machine_is_what_its_two_inductances_say() {
    let flux = Flux::Linear(LinearFlux { magnet_wb: 0.1, d_h: 1e-3, q_h: 2e-3 });
    let p = flux.at(Dq { d: -10.0, q: 20.0 });
    near(p.flux_wb.d, 0.09);
    near(p.flux_wb.q, 0.04);
    assert_eq!((p.dd_h, p.qq_h, p.dq_h, p.qd_h, p.beyond_map), (1e-3, 2e-3, 0.0, 0.0, false));
    near(flux.energy_j(Dq { d: -10.0, q: 20.0 }), 0.75 * (0.1 + 0.8));
    assert!((flux.mean_h() - 1.5e-3).abs() < 1e-9);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn within_its_outer_cells_a_map_is_exact_for_parabolas_and_its_slopes_are_theirs() {
    let flux = Flux::Map(map(quadratic)).checked().unwrap();
    for n in 0..200_u16 {
        let along = Real::from(n) / 199.0;
        let i = Dq { d: -25.0 + 40.0 * along, q: 32.0 - 64.0 * (7.0 * along).fract() };
        let (p, exact) = (flux.at(i), quadratic(i));
        near(p.flux_wb.d, exact.d);
        near(p.flux_wb.q, exact.q);
        near(p.dd_h, 0.01 - 2e-5 * i.d);
        near(p.dq_h, -4e-5 * i.q);
        near(p.qd_h, -4e-5 * i.q);
        near(p.qq_h, 0.02 - 4e-5 * i.d);
        assert!(!p.beyond_map);
        let linear = flux.near(i);
        near(linear.magnet_wb + linear.d_h * i.d, exact.d);
        near(linear.q_h * i.q, exact.q);
        // W' = 0.3·d + 0.005·d² − d³/3·1e-5 − 2e-5·d·q² + 0.01·q².
        let Dq { d, q } = i;
        let co = 0.3 * d + 0.005 * d * d - d * d * d / 3.0 * 1e-5 - 2e-5 * d * q * q + 0.01 * q * q;
        let energy = 1.5 * (i.dot(exact) - co);
        assert!((flux.energy_j(i) - energy).abs() < 1e-4 * energy + 1e-4, "{i:?}");
    }
}

#[test]
fn every_point_of_the_table_is_kept_and_beyond_it_goes_on_straight() {
    let map = map(quadratic);
    for n in 0..D.points {
        for m in 0..Q.points {
            let i = Dq {
                d: D.start_a + D.step_a * Real::from(n),
                q: Q.start_a + Q.step_a * Real::from(m),
            };
            near(map.at(i).flux_wb.d, quadratic(i).d);
            near(map.at(i).flux_wb.q, quadratic(i).q);
        }
    }
    for (inside, beyond) in [
        (Dq { d: 20.0, q: 3.0 }, Dq { d: 26.0, q: 3.0 }),
        (Dq { d: 1.0, q: -40.0 }, Dq { d: 1.0, q: -52.0 }),
        (Dq { d: -30.0, q: 40.0 }, Dq { d: -31.0, q: 47.0 }),
    ] {
        let (p, out, step) = (map.at(inside), map.at(beyond), beyond - inside);
        assert!(out.beyond_map && !p.beyond_map);
        near(out.flux_wb.d, p.flux_wb.d + p.dd_h * step.d + p.dq_h * step.q);
        near(out.flux_wb.q, p.flux_wb.q + p.qd_h * step.d + p.qq_h * step.q);
        assert_eq!((out.dd_h, out.qq_h), (p.dd_h, p.qq_h));
    }
    // A table of the wrong length is refused; asked all the same, it gives no nonsense.
    let short = FluxMap { flux_wb: &map.flux_wb[..30], ..map };
    assert!(short.at(Dq { d: 19.0, q: 0.0 }).flux_wb.length().is_finite());
}

#[test]
fn the_slopes_are_continuous_and_those_of_the_values() {
    let saturating =
        map(|i| Dq { d: 0.3 + 0.2 * (i.d / 20.0) / (1.0 + (i.d / 20.0).abs()), q: 0.01 * i.q });
    let (mut last, step) = (saturating.at(Dq { d: -30.0, q: 4.0 }), 0.125);
    for n in 1..=400_u16 {
        let p = saturating.at(Dq { d: -30.0 + step * Real::from(n), q: 4.0 });
        let mean = 0.5 * (p.dd_h + last.dd_h);
        let rise = (p.flux_wb.d - last.flux_wb.d) / step;
        assert!((rise - mean).abs() < 2e-2 * mean, "{n}: {rise} {mean}");
        assert!((p.dd_h - last.dd_h).abs() < 0.1 * mean, "{n}");
        last = p;
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let good = map(quadratic);
    let refused = |map: FluxMap| Flux::Map(map).checked().unwrap_err();
    assert!(Flux::Map(good).checked().is_ok());
    for bad in [Real::NAN, Real::INFINITY, -1e13] {
        let d = FluxAxis { start_a: bad, ..D };
        assert_eq!(refused(FluxMap { d, ..good }), ParamError::NotFinite("pmsm.flux.d.start_a"));
        let q = FluxAxis { step_a: bad, ..Q };
        assert_eq!(refused(FluxMap { q, ..good }), ParamError::NotPositive("pmsm.flux.q.step_a"));
        let mut table = good.flux_wb.to_vec();
        table[17][1] = bad;
        let flux_wb = Box::leak(table.into_boxed_slice());
        assert_eq!(
            refused(FluxMap { flux_wb, ..good }),
            ParamError::NotFinite("pmsm.flux.flux_wb")
        );
    }
    let few = FluxAxis { points: 3, ..D };
    assert_eq!(refused(FluxMap { d: few, ..good }), ParamError::OutOfRange("pmsm.flux.d.points"));
    let more = FluxAxis { points: 12, ..D };
    assert_eq!(
        refused(FluxMap { d: more, ..good }),
        ParamError::LengthsDiffer("pmsm.flux.flux_wb")
    );
    // Less flux for more current; and axes that move each other more than themselves.
    let falling = map(|i| Dq { d: -0.01 * i.d, q: 0.02 * i.q });
    let crossed = map(|i| Dq { d: 0.01 * i.d + 0.02 * i.q, q: 0.01 * i.q + 0.02 * i.d });
    for bad in [falling, crossed] {
        assert_eq!(refused(bad), ParamError::Decreasing("pmsm.flux.flux_wb"));
    }
    let linear = LinearFlux { magnet_wb: 0.1, d_h: 1e-3, q_h: 2e-3 };
    for (bad, error) in [
        (LinearFlux { magnet_wb: -0.1, ..linear }, ParamError::Negative("pmsm.flux.magnet_wb")),
        (LinearFlux { d_h: 0.0, ..linear }, ParamError::NotPositive("pmsm.flux.d_h")),
        (LinearFlux { q_h: Real::NAN, ..linear }, ParamError::NotPositive("pmsm.flux.q_h")),
        (
            LinearFlux { magnet_wb: 0.0, q_h: 1e-3, ..linear },
            ParamError::OutOfRange("pmsm.flux.magnet_wb"),
        ),
    ] {
        assert_eq!(Flux::Linear(bad).checked(), Err(error));
    }
}
