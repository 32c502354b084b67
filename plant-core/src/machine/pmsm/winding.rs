//! The winding of a synchronous machine over one step, its currents eliminated.

use super::{FINE_STEP_RAD, LARGEST_PER_K, PmsmParams, REFERENCE_C};
use crate::error::{ParamError, check, not_negative, positive};
use crate::machine::flux::{Flux, FluxPoint};
use crate::machine::transform::Dq;
use crate::model::Dt;
use crate::num::{Real, sqrt};

/// Newton steps of [`DqLaw::diode_v`].
const DIODE_STEPS: u8 = 2;

/// The electrical side of a synchronous machine, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DqWinding {
    flux: Flux,
    resistance_ohm: Real,
    resistance_per_k: Real,
    per_h: Real,
    /// An inductance that turns with the frame without doing work.
    mean_h: Real,
    /// Electrical angle per angle of the shaft: the pole pairs.
    pole_pairs: Real,
    /// Torque of the iron loss per speed and square of the flux.
    iron: Real,
}

/// The winding over one step: `v = held_v + Z·Δi + back_emf·Δω`.
///
/// `(ℓ/h + R + ω_e·L̄·J)·Δi = v − R·i − ω_e·J·ψ − p·Δω·γ` with `γ = J·(ψ − L̄·i)`, ℓ the incremental
/// inductances and L̄ any constant. The term of L̄ is skew: it does no work, so it may be implicit,
/// and keeps the solution bounded however far the rotor turns. The shaft gets `3/2·p·γ·i'` at the
/// new current, exactly what γ takes from the winding. With constant inductances what is left
/// over, `3/4·Δiᵀ·ℓ·Δi`, is never negative: passive at any h. At rest of the currents the voltage
/// is `R·i + ω_e·J·ψ`, whatever L̄.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DqLaw {
    /// The voltage under which the currents stay as they are \[V\].
    pub held_v: Dq,
    /// Back-EMF per speed \[V·s/rad\]; `3/2` of its product with the new current is the torque.
    pub back_emf_v_s_per_rad: Dq,
    /// Drag by the iron loss \[N·m·s/rad\].
    pub iron_nm_s_per_rad: Real,
    /// Resistance of one phase \[Ω\].
    pub resistance_ohm: Real,
    /// Flux linkage at the start \[Wb\].
    pub flux_wb: Dq,
    /// The currents lie beyond the flux map.
    pub beyond_map: bool,
    /// `Z` by rows \[Ω\], and one over its determinant.
    impedance: [Dq; 2],
    per_det: Real,
    /// `ω_e·L̄` \[Ω\].
    turning_ohm: Real,
}

impl DqLaw {
    /// The current increment under a voltage, if the speed changes by `dw` \[A\].
    #[inline]
    #[must_use]
    pub fn increment_a(&self, voltage_v: Dq, dw: Real) -> Dq {
        self.admit(voltage_v - self.held_v - self.back_emf_v_s_per_rad * dw)
    }

    /// The current increment for what the voltage is above the one that holds the currents \[A\].
    #[inline]
    #[must_use]
    pub fn admit(&self, excess_v: Dq) -> Dq {
        let [d, q] = self.impedance;
        Dq {
            d: self.per_det * (q.q * excess_v.d - d.q * excess_v.q),
            q: self.per_det * (d.d * excess_v.q - q.d * excess_v.d),
        }
    }

    /// The voltage that makes a current increment at constant speed \[V\]: an ideal current loop.
    #[inline]
    #[must_use]
    pub fn voltage_v(&self, increment_a: Dq) -> Dq {
        self.held_v + self.impede(increment_a)
    }

    /// The voltage at the terminals while the inverter's gates are off and its diodes make at
    /// most `largest_v` ([`LARGEST_PER_BUS`](crate::machine::transform::LARGEST_PER_BUS) of the
    /// bus, some 10 % below six-step conduction); none where they block, so that the currents end.
    ///
    /// Diodes only feed the bus: `v = −largest_v·i'/|i'|`, set-valued like friction. That is a
    /// resistance `c = largest_v/|i'|`, found from a winding of equal axes in closed form and put
    /// right by two Newton steps.
    #[must_use]
    pub fn diode_v(&self, current_a: Dq, largest_v: Real) -> Option<Dq> {
        let free_v = self.impede(current_a) - self.held_v;
        let rest = free_v.dot(free_v) - largest_v * largest_v;
        if rest <= 0.0 {
            return None;
        }
        let [d, q] = self.impedance;
        let (mean, skew) = (0.5 * (d.d + q.q), 0.5 * (q.d - d.q));
        let part = largest_v * mean;
        let mut ohm =
            largest_v * (part + sqrt(part * part + rest * (mean * mean + skew * skew))) / rest;
        let mut reached_a = Dq::ZERO;
        for _ in 0..=DIODE_STEPS {
            let (d_ohm, q_ohm) = (d.d + ohm, q.q + ohm);
            let per_det = 1.0 / (d_ohm * q_ohm - d.q * q.d);
            let solve = |v: Dq| Dq {
                d: per_det * (q_ohm * v.d - d.q * v.q),
                q: per_det * (d_ohm * v.q - q.d * v.d),
            };
            reached_a = solve(free_v);
            let length = reached_a.length();
            // Of 1/|i'| − c/largest_v, which is nearly straight in c.
            let bend = largest_v * reached_a.dot(solve(reached_a)) / (length * length);
            ohm -= (largest_v - ohm * length) / (bend - length);
        }
        Some(reached_a * (-largest_v / reached_a.length()))
    }

    /// `Z·Δi` \[V\].
    #[inline]
    pub(crate) const fn impede(&self, increment_a: Dq) -> Dq {
        let [d, q] = self.impedance;
        Dq { d: d.dot(increment_a), q: q.dot(increment_a) }
    }

    /// The voltage that goes into the field, `ℓ·Δi/h` \[V\].
    #[inline]
    #[must_use]
    pub fn field_v(&self, increment_a: Dq) -> Dq {
        self.impede(increment_a)
            - increment_a * self.resistance_ohm
            - increment_a.turned() * self.turning_ohm
    }

    /// What each axis' own inductance takes over one step \[Ω\].
    #[inline]
    pub(crate) const fn inductance_ohm(&self) -> Dq {
        let [d, q] = self.impedance;
        Dq { d: d.d - self.resistance_ohm, q: q.q - self.resistance_ohm }
    }

    /// The torque at the currents that a step ends with \[N·m\].
    #[inline]
    #[must_use]
    pub const fn torque_nm(&self, current_a: Dq) -> Real {
        1.5 * self.back_emf_v_s_per_rad.dot(current_a)
    }
}

impl DqWinding {
    pub(crate) const fn new(params: &PmsmParams, dt: Dt) -> Result<Self, ParamError> {
        let flux = check!(params.flux.checked());
        let per_k = check!(not_negative("pmsm.resistance_per_k", params.resistance_per_k));
        if per_k > LARGEST_PER_K {
            return Err(ParamError::OutOfRange("pmsm.resistance_per_k"));
        }
        let pole_pairs = check!(positive("pmsm.pole_pairs", params.pole_pairs as Real));
        let iron_s = check!(not_negative("pmsm.iron_s", params.iron_s));
        Ok(Self {
            flux,
            resistance_ohm: check!(positive("pmsm.resistance_ohm", params.resistance_ohm)),
            resistance_per_k: per_k,
            per_h: 1.0 / dt.s(),
            mean_h: flux.mean_h(),
            pole_pairs,
            iron: 1.5 * iron_s * (pole_pairs * pole_pairs),
        })
    }

    /// Seen from a place that moves by 1 where the shaft turns by `ratio`.
    #[must_use]
    pub const fn reflected(self, ratio: Real) -> Self {
        Self { pole_pairs: self.pole_pairs * ratio, iron: self.iron * (ratio * ratio), ..self }
    }

    /// The same with another resistance of a phase \[Ω\].
    #[inline]
    pub(crate) const fn with_resistance(self, resistance_ohm: Real) -> Self {
        Self { resistance_ohm, ..self }
    }

    /// One over the step \[1/s\].
    #[inline]
    pub(crate) const fn per_h(&self) -> Real {
        self.per_h
    }

    /// Its flux linkage over the currents.
    #[must_use]
    pub const fn flux(&self) -> &Flux {
        &self.flux
    }

    /// Electrical angle per unit of speed: the pole pairs at the shaft.
    #[must_use]
    pub const fn pole_pairs(&self) -> Real {
        self.pole_pairs
    }

    /// Whether the rotor turns by more than [`FINE_STEP_RAD`] in a step.
    #[inline]
    #[must_use]
    pub const fn is_coarse(&self, speed: Real) -> bool {
        (self.pole_pairs * speed).abs() > FINE_STEP_RAD * self.per_h
    }

    /// What the winding does over one step that begins with these currents, this speed and a
    /// temperature of the winding.
    #[inline]
    #[must_use]
    pub fn law(&self, current_a: Dq, speed: Real, winding_c: Real) -> DqLaw {
        let FluxPoint { flux_wb, dd_h, dq_h, qd_h, qq_h, beyond_map } = self.flux.at(current_a);
        let ohm = self.resistance_ohm * (1.0 + self.resistance_per_k * (winding_c - REFERENCE_C));
        let electrical_rad_s = self.pole_pairs * speed;
        let turning_ohm = electrical_rad_s * self.mean_h;
        let d = Dq { d: dd_h * self.per_h + ohm, q: dq_h * self.per_h - turning_ohm };
        let q = Dq { d: qd_h * self.per_h + turning_ohm, q: qq_h * self.per_h + ohm };
        DqLaw {
            held_v: current_a * ohm + flux_wb.turned() * electrical_rad_s,
            back_emf_v_s_per_rad: (flux_wb - current_a * self.mean_h).turned() * self.pole_pairs,
            iron_nm_s_per_rad: self.iron * flux_wb.dot(flux_wb),
            resistance_ohm: ohm,
            flux_wb,
            beyond_map,
            impedance: [d, q],
            per_det: 1.0 / (d.d * q.q - d.q * q.d),
            turning_ohm,
        }
    }
}
