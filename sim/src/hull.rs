//! A hull in surge, sway and yaw: inertia and resistance.
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
//! Added mass is part of `M`. If it were a force on the right-hand side, computed from the last
//! acceleration, the integration would diverge once the added mass reaches the hull's own mass, as
//! it does in sway.

use primitives::frame::{Body, Ned, Rotation, ned_from_body};
use scenario::boat::Hull;

/// Surge, sway and yaw: velocities (m/s, m/s, rad/s), accelerations, or forces (N, N, N m).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Planar<T = f64> {
    /// Surge, ahead.
    pub surge: T,
    /// Sway, to starboard.
    pub sway: T,
    /// Yaw, clockwise.
    pub yaw: T,
}

impl Planar {
    /// `self + step * rate`.
    #[inline]
    pub fn plus(self, step: f64, rate: Planar) -> Planar {
        Planar {
            surge: self.surge + step * rate.surge,
            sway: self.sway + step * rate.sway,
            yaw: self.yaw + step * rate.yaw,
        }
    }

    /// Surge and sway velocity in the field's frame, for a boat with this rotation.
    #[inline]
    pub fn in_ned(self, rotation: Rotation) -> Ned {
        ned_from_body(
            rotation,
            Body {
                ahead: self.surge,
                starboard: self.sway,
            },
        )
    }
}

/// A hull with precomputed constants and the inverse of `M`.
#[derive(Clone, Debug)]
pub struct HullModel {
    pub(crate) hull: Hull,
    /// m + A11.
    pub(crate) m_surge: f64,
    /// m + A22.
    pub(crate) m_sway: f64,
    /// Iz + A66.
    pub(crate) m_yaw: f64,
    /// m xg + A26.
    pub(crate) m_cross: f64,
    /// Replaces A22 in the Coriolis terms: A11 + munk (A22 − A11).
    ///
    /// Used both in surge and in the Munk moment, so that these terms do no work whatever the
    /// factor.
    pub(crate) munk_sway: f64,
    /// The inverse of `M`: surge, then the sway-yaw block.
    pub(crate) inverse_surge: f64,
    pub(crate) inverse_sway: f64,
    pub(crate) inverse_cross: f64,
    pub(crate) inverse_yaw: f64,
    /// ½ ρ C_d T of the cross-flow, kg/m².
    pub(crate) crossflow: f64,
}

impl HullModel {
    /// The model of `hull` in water of the given density.
    pub fn new(hull: &Hull, water_density_kg_m3: f64) -> HullModel {
        let m_surge = hull.mass_kg + hull.added_surge_kg;
        let m_sway = hull.mass_kg + hull.added_sway_kg;
        let m_yaw = hull.yaw_inertia_kg_m2 + hull.added_yaw_kg_m2;
        let m_cross = hull.mass_kg * hull.x_g_m + hull.added_sway_yaw_kg_m;
        // The mass matrix is one number and a symmetric 2 x 2 block, so its inverse takes three
        // numbers, computed once. A matrix library would be slower to read and to build.
        let determinant = m_sway * m_yaw - m_cross * m_cross;
        HullModel {
            m_surge,
            m_sway,
            m_yaw,
            m_cross,
            // The full Munk moment applies to a bare hull in ideal flow; with it, the Otter model
            // starts to spin by itself at 1.2 m/s. Scaling the moment alone would create energy.
            // The factor therefore modifies A22 everywhere in the Coriolis terms, which stay
            // skew-symmetric.
            munk_sway: hull.added_surge_kg
                + hull.munk_factor * (hull.added_sway_kg - hull.added_surge_kg),
            inverse_surge: 1.0 / m_surge,
            inverse_sway: m_yaw / determinant,
            inverse_cross: -m_cross / determinant,
            inverse_yaw: m_sway / determinant,
            crossflow: 0.5
                * water_density_kg_m3
                * hull.crossflow_coefficient
                * hull.crossflow_draught_m,
            hull: hull.clone(),
        }
    }

    /// The velocity change from an impulse (N s, N s, N m s).
    #[inline]
    pub fn velocity_change(&self, impulse: Planar) -> Planar {
        Planar {
            surge: self.inverse_surge * impulse.surge,
            sway: self.inverse_sway * impulse.sway + self.inverse_cross * impulse.yaw,
            yaw: self.inverse_cross * impulse.sway + self.inverse_yaw * impulse.yaw,
        }
    }

    /// The force (N, N, N m) for an acceleration of hull and added mass.
    #[inline]
    pub fn force_of(&self, acceleration: Planar) -> Planar {
        Planar {
            surge: self.m_surge * acceleration.surge,
            sway: self.m_sway * acceleration.sway + self.m_cross * acceleration.yaw,
            yaw: self.m_cross * acceleration.sway + self.m_yaw * acceleration.yaw,
        }
    }

    /// Kinetic energy of hull and added mass, J.
    pub fn energy_joule(&self, nu_r: Planar) -> f64 {
        let Planar {
            surge: u,
            sway: v,
            yaw: r,
        } = nu_r;
        0.5 * (self.m_surge * u * u + self.m_sway * v * v + self.m_yaw * r * r)
            + self.m_cross * v * r
    }

    /// The effective mass for a push along a unit vector in body axes (`ahead`, `starboard`), kg.
    pub fn mass_along_kg(&self, ahead: f64, starboard: f64) -> f64 {
        1.0 / (ahead * ahead / self.m_surge + starboard * starboard / self.m_sway)
    }

    /// Thrust that maintains `speed_m_s` straight ahead, N.
    pub fn surge_resistance_newton(&self, speed_m_s: f64) -> f64 {
        (self.hull.surge_linear_kg_s + self.hull.surge_quadratic_kg_m * speed_m_s.abs()) * speed_m_s
    }
}
