//! The machines' continuous equations, each behind an averaged converter without losses.

/// A machine's parameters, in the symbols of the reference system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Machine {
    /// `V = R·i + L·di/dt + Ke·ω`, `T = Kt·i` (`EPowertrain2025`, eq. 3.2); only the first of its
    /// two currents is one.
    Dc { r: f64, l: f64, ke: f64, kt: f64 },
    /// `v = R·i + dψ/dt + ω_e·J·ψ`, `T = 3/2·p·(ψ_d·i_q − ψ_q·i_d)` (`EPowertrain2025`, PMSM), iron
    /// as a conductance across the induced voltage, its loss taken from the shaft.
    Pmsm { r: f64, ld: f64, lq: f64, magnet: f64, pairs: f64, iron: f64 },
}

/// A current, or a voltage, of both axes.
pub type Pair = [f64; 2];

impl Machine {
    /// Electrical power over the scalar product of voltage and current.
    pub const fn phases(&self) -> f64 {
        match self {
            Self::Dc { .. } => 1.0,
            Self::Pmsm { .. } => 1.5,
        }
    }

    pub const fn resistance(&self) -> f64 {
        match self {
            Self::Dc { r, .. } | Self::Pmsm { r, .. } => *r,
        }
    }

    /// The largest share of the bus voltage that diodes see.
    pub fn diode_share(&self) -> f64 {
        match self {
            Self::Dc { .. } => 1.0,
            Self::Pmsm { .. } => 1.0 / 3.0_f64.sqrt(),
        }
    }

    /// The direction of a current that diodes carry: of a DC machine that in which it began, also
    /// where a step of the solver leads beyond its end.
    pub fn along(&self, way: f64, i: Pair) -> Pair {
        match self {
            Self::Dc { .. } => [way, 0.0],
            Self::Pmsm { .. } => i.map(|x| x / dot(i, i).sqrt()),
        }
    }

    fn flux(&self, i: Pair) -> Pair {
        match *self {
            Self::Dc { .. } => [0.0; 2],
            Self::Pmsm { ld, lq, magnet, .. } => [ld * i[0] + magnet, lq * i[1]],
        }
    }

    /// What turning induces.
    pub fn back_emf(&self, i: Pair, w: f64) -> Pair {
        match *self {
            Self::Dc { ke, .. } => [ke * w, 0.0],
            Self::Pmsm { pairs, .. } => {
                let [d, q] = self.flux(i);
                [-pairs * w * q, pairs * w * d]
            }
        }
    }

    /// The terminals' voltage at a slope of the currents.
    pub fn volts(&self, i: Pair, w: f64, slope: Pair) -> Pair {
        let (e, r) = (self.back_emf(i, w), self.resistance());
        let l = self.inductances();
        std::array::from_fn(|k| r * i[k] + e[k] + l[k] * slope[k])
    }

    /// The slope of the currents under a voltage.
    pub fn slope(&self, i: Pair, w: f64, v: Pair) -> Pair {
        let (e, r) = (self.back_emf(i, w), self.resistance());
        let l = self.inductances();
        std::array::from_fn(|k| if l[k] > 0.0 { (v[k] - r * i[k] - e[k]) / l[k] } else { 0.0 })
    }

    const fn inductances(&self) -> Pair {
        match *self {
            Self::Dc { l, .. } => [l, 0.0],
            Self::Pmsm { ld, lq, .. } => [ld, lq],
        }
    }

    /// Energy in the field \[J\].
    pub fn field(&self, i: Pair) -> f64 {
        let l = self.inductances();
        0.5 * self.phases() * (l[0] * i[0] * i[0] + l[1] * i[1] * i[1])
    }

    /// Air-gap torque.
    pub fn torque(&self, i: Pair) -> f64 {
        match *self {
            Self::Dc { kt, .. } => kt * i[0],
            Self::Pmsm { pairs, .. } => {
                let [d, q] = self.flux(i);
                1.5 * pairs * (d * i[1] - q * i[0])
            }
        }
    }

    /// What the iron takes from it, per speed.
    pub fn iron(&self, i: Pair) -> f64 {
        match *self {
            Self::Dc { .. } => 0.0,
            Self::Pmsm { pairs, iron, .. } => {
                let [d, q] = self.flux(i);
                1.5 * iron * pairs * pairs * (d * d + q * q)
            }
        }
    }

    /// Heat in the winding and, where Ke is not Kt, what the conversion takes.
    pub fn lost(&self, i: Pair, w: f64) -> f64 {
        let copper = self.phases() * self.resistance() * dot(i, i);
        match *self {
            Self::Dc { ke, kt, .. } => copper + (ke - kt) * w * i[0],
            Self::Pmsm { .. } => copper,
        }
    }

    /// Where an ideal loop leads the currents for a torque: the q axis to what makes it beside the
    /// d axis' current of now, the d axis to what is the least with that. So a torque is exact once
    /// it stands.
    pub fn aim(&self, torque: f64, i: Pair) -> Pair {
        match *self {
            Self::Dc { kt, .. } => [torque / kt, 0.0],
            Self::Pmsm { ld, lq, magnet, pairs, .. } => {
                let more = ld - lq;
                let q = torque / (1.5 * pairs * (magnet + more * i[0]));
                if more == 0.0 {
                    return [0.0, q];
                }
                // Least current: (L_d − L_q)·(i_d² − i_q²) + ψ·i_d = 0.
                let half = magnet / (2.0 * more);
                [-half + more.signum() * half.hypot(q), q]
            }
        }
    }

    /// The axis that makes the torque, and its flux per motor speed without the other one's current.
    pub const fn axis(&self) -> (usize, f64, f64) {
        match *self {
            Self::Dc { l, ke, .. } => (0, l, ke),
            Self::Pmsm { lq, magnet, pairs, .. } => (1, lq, pairs * magnet),
        }
    }
}

pub fn dot(a: Pair, b: Pair) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
