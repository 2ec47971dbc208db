//! A hull in surge, sway and yaw: inertia, resistance, and one step of motion.
//!
//! The equation of motion is Fossen's (Handbook of Marine Craft Hydrodynamics and Motion Control,
//! 2nd ed. 2021, ch. 6), in the velocity relative to the water, `nu_r`:
//!
//! ```text
//! M nu_r' + C(nu_r) nu_r + D(nu_r) nu_r = tau        eta' = R(psi) nu_r + v_c
//! M = | m+A11   0         0        |
//!     | 0       m+A22     m xg+A26 |
//!     | 0       m xg+A26  Iz+A66   |
//! ```
//!
//! Added mass stands in `M`: put on the right as a force from the last acceleration it diverges as
//! soon as it reaches the mass, and in sway it does.

use game::boat::Hull;

/// Surge, sway and yaw: velocities (m/s, m/s, rad/s), accelerations, or forces (N, N, N m).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Planar {
    /// Surge, ahead.
    pub surge: f64,
    /// Sway, to starboard.
    pub sway: f64,
    /// Yaw, clockwise.
    pub yaw: f64,
}

impl Planar {
    /// `self + step * rate`.
    #[inline]
    #[must_use]
    pub fn plus(self, step: f64, rate: Planar) -> Planar {
        Planar {
            surge: self.surge + step * rate.surge,
            sway: self.sway + step * rate.sway,
            yaw: self.yaw + step * rate.yaw,
        }
    }
}

/// A hull ready for computing: the constants of the equation, and the inverse of `M`.
#[derive(Clone, Debug)]
pub struct HullModel {
    hull: Hull,
    /// m + A11.
    m_surge: f64,
    /// m + A22.
    m_sway: f64,
    /// Iz + A66.
    m_yaw: f64,
    /// m xg + A26.
    m_cross: f64,
    /// What stands for A22 in the Coriolis terms: A11 + munk (A22 − A11).
    ///
    /// Used in surge and in the Munk moment alike, so that these terms do no work whatever the factor.
    munk_sway: f64,
    inverse_surge: f64,
    /// The sway-yaw block of the inverse: sway-sway, sway-yaw, yaw-yaw.
    inverse: (f64, f64, f64),
    /// ½ ρ C_d T of the cross-flow, kg/m².
    crossflow: f64,
}

impl HullModel {
    /// The model of `hull` in water of this density.
    #[must_use]
    pub fn new(hull: &Hull, water_density_kg_m3: f64) -> HullModel {
        let m_surge = hull.mass_kg + hull.added_surge_kg;
        let m_sway = hull.mass_kg + hull.added_sway_kg;
        let m_yaw = hull.yaw_inertia_kg_m2 + hull.added_yaw_kg_m2;
        let m_cross = hull.mass_kg * hull.x_g_m + hull.added_sway_yaw_kg_m;
        let determinant = m_sway * m_yaw - m_cross * m_cross;
        HullModel {
            m_surge,
            m_sway,
            m_yaw,
            m_cross,
            munk_sway: hull.added_surge_kg + hull.munk_factor * (hull.added_sway_kg - hull.added_surge_kg),
            inverse_surge: 1.0 / m_surge,
            inverse: (m_yaw / determinant, -m_cross / determinant, m_sway / determinant),
            crossflow: 0.5 * water_density_kg_m3 * hull.crossflow_coefficient * hull.crossflow_draught_m,
            hull: hull.clone(),
        }
    }

    /// The acceleration under `tau` at the velocity `nu_r` through the water.
    #[inline(always)]
    #[must_use]
    pub fn acceleration(&self, nu_r: Planar, tau: Planar) -> Planar {
        let Planar { surge: u, sway: v, yaw: r } = nu_r;
        let h = &self.hull;
        let (y_cross, n_cross) = self.crossflow(v, r);
        let x = tau.surge + (h.mass_kg + self.munk_sway) * v * r + self.m_cross * r * r
            - (h.surge_linear_kg_s + h.surge_quadratic_kg_m * u.abs()) * u;
        let y = tau.sway - self.m_surge * u * r - (h.sway_linear_kg_s + h.sway_lift_kg_m * u.abs()) * v - y_cross;
        let n = tau.yaw
            - self.m_cross * u * r
            - (self.munk_sway - h.added_surge_kg) * u * v
            - (h.yaw_linear_kg_m2_s + h.yaw_quadratic_kg_m2 * r.abs() + h.yaw_lift_kg_m * u.abs()) * r
            - n_cross;
        self.kick(Planar { surge: x, sway: y, yaw: n })
    }

    /// The change of velocity by an impulse (N s, N s, N m s), or the acceleration by a force.
    #[inline]
    #[must_use]
    pub fn kick(&self, push: Planar) -> Planar {
        let (sway_sway, sway_yaw, yaw_yaw) = self.inverse;
        Planar {
            surge: self.inverse_surge * push.surge,
            sway: sway_sway * push.sway + sway_yaw * push.yaw,
            yaw: sway_yaw * push.sway + yaw_yaw * push.yaw,
        }
    }

    /// Cross-flow drag in sway and yaw (strip theory): ½ρ C_d T ∫ [1, x] |v + x r| (v + x r) dx.
    ///
    /// The integral is done in closed form instead of over strips. Where the flow does not change
    /// its side along the hull it is a polynomial; where it does, |r| L/2 ≥ |v| and dividing by r is safe.
    #[inline]
    fn crossflow(&self, v: f64, r: f64) -> (f64, f64) {
        let half = 0.5 * self.hull.crossflow_length_m;
        let swing = r * half;
        if v.abs() >= swing.abs() {
            let side = self.crossflow * if v < 0.0 { -1.0 } else { 1.0 };
            let sway = 2.0 * half * (v * v + swing * swing / 3.0);
            let yaw = 4.0 / 3.0 * half * half * swing * v;
            return (side * sway, side * yaw);
        }
        // With s = v + x r: ∫ |s| s dx = [|s|³]/3r and ∫ x |s| s dx = ([s³|s|]/4 − v [|s|³]/3) / r².
        let (bow, stern) = (v + swing, v - swing);
        let (bow_3, stern_3) = (bow * bow * bow.abs(), stern * stern * stern.abs());
        let cubes = (bow_3 - stern_3) / 3.0;
        let fourths = (bow_3 * bow - stern_3 * stern) / 4.0;
        let per_r = 1.0 / r;
        (self.crossflow * cubes * per_r, self.crossflow * (fourths - v * cubes) * per_r * per_r)
    }

    /// Kinetic energy of hull and added mass, J.
    #[must_use]
    pub fn energy_joule(&self, nu_r: Planar) -> f64 {
        let Planar { surge: u, sway: v, yaw: r } = nu_r;
        0.5 * (self.m_surge * u * u + self.m_sway * v * v + self.m_yaw * r * r) + self.m_cross * v * r
    }

    /// The mass with which the hull answers a push along the unit vector (`ahead`, `starboard`) of its body, kg.
    #[must_use]
    pub fn mass_along_kg(&self, ahead: f64, starboard: f64) -> f64 {
        1.0 / (ahead * ahead / self.m_surge + starboard * starboard / self.m_sway)
    }

    /// Moment of inertia with added mass, kg m².
    #[must_use]
    pub fn yaw_inertia_kg_m2(&self) -> f64 {
        self.m_yaw
    }

    /// Mass with added mass in surge, kg.
    #[must_use]
    pub fn surge_mass_kg(&self) -> f64 {
        self.m_surge
    }

    /// Thrust that holds `speed_m_s` straight ahead, N.
    #[must_use]
    pub fn surge_resistance_newton(&self, speed_m_s: f64) -> f64 {
        (self.hull.surge_linear_kg_s + self.hull.surge_quadratic_kg_m * speed_m_s.abs()) * speed_m_s
    }

    /// Linear yaw damping, kg m²/s.
    #[must_use]
    pub fn yaw_damping_kg_m2_s(&self) -> f64 {
        self.hull.yaw_linear_kg_m2_s
    }
}

/// Motion over one tick, as [`advance`] finds it.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Velocity through the water at the end.
    pub nu_r: Planar,
    /// Velocity through the water half-way.
    pub nu_r_half: Planar,
    /// Change of heading half-way and at the end, rad.
    pub turn_half_rad: f64,
    /// Change of heading at the end, rad.
    pub turn_rad: f64,
}

/// Moves the velocity on by `dt_s`: the classical Runge-Kutta step of fourth order, with the force at
/// the beginning, half-way and at the end given.
///
/// The equation in `nu_r` does not know the heading, so this needs no sine or cosine.
#[inline]
#[must_use]
pub fn advance(model: &HullModel, nu_r: Planar, tau: [Planar; 3], dt_s: f64) -> Motion {
    let half = 0.5 * dt_s;
    let k1 = model.acceleration(nu_r, tau[0]);
    let k2 = model.acceleration(nu_r.plus(half, k1), tau[1]);
    let k3 = model.acceleration(nu_r.plus(half, k2), tau[1]);
    let k4 = model.acceleration(nu_r.plus(dt_s, k3), tau[2]);
    let sixth = dt_s / 6.0;
    let step = |a: f64, b: f64, c: f64, d: f64| sixth * (a + 2.0 * (b + c) + d);
    let end = Planar {
        surge: nu_r.surge + step(k1.surge, k2.surge, k3.surge, k4.surge),
        sway: nu_r.sway + step(k1.sway, k2.sway, k3.sway, k4.sway),
        yaw: nu_r.yaw + step(k1.yaw, k2.yaw, k3.yaw, k4.yaw),
    };
    // Cubic through both ends and their slopes; k4 is the slope at the end to third order.
    let eighth = dt_s / 8.0;
    let middle = |a: f64, b: f64, slope_a: f64, slope_b: f64| 0.5 * (a + b) + eighth * (slope_a - slope_b);
    let nu_r_half = Planar {
        surge: middle(nu_r.surge, end.surge, k1.surge, k4.surge),
        sway: middle(nu_r.sway, end.sway, k1.sway, k4.sway),
        yaw: middle(nu_r.yaw, end.yaw, k1.yaw, k4.yaw),
    };
    // Integrals of the yaw rate's cubic: Simpson over the whole tick, and its first half exactly.
    let turn_rad = sixth * (nu_r.yaw + 4.0 * nu_r_half.yaw + end.yaw);
    let turn_half_rad = dt_s / 24.0 * (5.0 * nu_r.yaw + 8.0 * nu_r_half.yaw - end.yaw);
    Motion { nu_r: end, nu_r_half, turn_half_rad, turn_rad }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> HullModel {
        let hull = Hull {
            mass_kg: 80.0,
            yaw_inertia_kg_m2: 16.0125,
            x_g_m: 0.153_125,
            added_surge_kg: 5.2815,
            added_sway_kg: 82.5,
            added_yaw_kg_m2: 24.0324,
            added_sway_yaw_kg_m: 0.0,
            surge_linear_kg_s: 77.5544,
            surge_quadratic_kg_m: 0.0,
            sway_linear_kg_s: 162.5,
            sway_lift_kg_m: 0.0,
            yaw_linear_kg_m2_s: 40.0449,
            yaw_quadratic_kg_m2: 400.449,
            yaw_lift_kg_m: 0.0,
            crossflow_coefficient: 1.004_21,
            crossflow_draught_m: 0.195_122,
            crossflow_length_m: 2.1,
            munk_factor: 1.0,
        };
        HullModel::new(&hull, 1025.0)
    }

    #[test]
    fn the_closed_form_of_the_cross_flow_agrees_with_many_strips() {
        let model = model();
        let half = 1.05;
        for (v, r) in
            [(0.5, 0.1), (-0.5, 0.1), (0.1, 1.0), (-0.1, 1.0), (0.0, -0.7), (0.3, 0.0), (0.3, -0.285), (0.0, 0.0)]
        {
            let n = 20_000;
            let dx = 2.0 * half / f64::from(n);
            let (mut sway, mut yaw) = (0.0, 0.0);
            for i in 0..n {
                let x = -half + (f64::from(i) + 0.5) * dx;
                let s: f64 = v + x * r;
                sway += s.abs() * s * dx;
                yaw += x * s.abs() * s * dx;
            }
            let (got_sway, got_yaw) = model.crossflow(v, r);
            let scale = model.crossflow;
            assert!((got_sway - scale * sway).abs() < 1e-5 * scale, "v {v} r {r}: {got_sway} {}", scale * sway);
            assert!((got_yaw - scale * yaw).abs() < 1e-5 * scale, "v {v} r {r}: {got_yaw} {}", scale * yaw);
        }
    }

    #[test]
    fn inertia_terms_do_no_work_whatever_the_munk_factor() {
        for munk_factor in [0.0, 0.5, 1.0] {
            let mut hull = model().hull;
            hull.munk_factor = munk_factor;
            for zero in [&mut hull.surge_linear_kg_s, &mut hull.sway_linear_kg_s, &mut hull.yaw_linear_kg_m2_s] {
                *zero = 0.0;
            }
            (hull.yaw_quadratic_kg_m2, hull.crossflow_coefficient) = (0.0, 0.0);
            let model = HullModel::new(&hull, 1025.0);
            let mut nu = Planar { surge: 1.5, sway: -0.4, yaw: 0.6 };
            let before = model.energy_joule(nu);
            for _ in 0..2000 {
                nu = advance(&model, nu, [Planar::default(); 3], 0.005).nu_r;
            }
            let drift = (model.energy_joule(nu) - before).abs() / before;
            assert!(drift < 1e-8, "munk {munk_factor}: energy drifts by {drift}");
        }
    }

    #[test]
    fn without_thrust_the_energy_only_falls() {
        let model = model();
        for start in [(2.0, 0.5, 1.0), (-1.0, 1.0, -2.0), (0.0, 0.0, 3.0)] {
            let mut nu = Planar { surge: start.0, sway: start.1, yaw: start.2 };
            for tick in 0..400 {
                let next = advance(&model, nu, [Planar::default(); 3], 0.05).nu_r;
                assert!(model.energy_joule(next) < model.energy_joule(nu), "{start:?} tick {tick}");
                nu = next;
            }
        }
    }

    #[test]
    fn an_added_mass_of_three_times_the_mass_stays_stable() {
        let mut hull = model().hull;
        hull.added_sway_kg = 3.0 * hull.mass_kg;
        let model = HullModel::new(&hull, 1025.0);
        let mut nu = Planar { surge: 0.5, sway: 1.0, yaw: 0.5 };
        for _ in 0..1200 {
            nu = advance(&model, nu, [Planar::default(); 3], 0.05).nu_r;
        }
        assert!(model.energy_joule(nu) < 1e-6, "{nu:?}");
    }

    #[test]
    fn halving_the_tick_divides_the_error_by_sixteen() {
        let model = model();
        let run = |dt_s: f64| {
            let mut nu = Planar { surge: 1.0, sway: 0.2, yaw: 0.5 };
            let tau = [Planar { surge: 80.0, sway: 0.0, yaw: 10.0 }; 3];
            for _ in 0..(2.0 / dt_s).round() as u32 {
                nu = advance(&model, nu, tau, dt_s).nu_r;
            }
            nu.yaw
        };
        let truth = run(0.0005);
        let (coarse, fine) = ((run(0.04) - truth).abs(), (run(0.02) - truth).abs());
        assert!((10.0..24.0).contains(&(coarse / fine)), "{coarse} {fine}");
    }
}
