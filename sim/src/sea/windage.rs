//! The wind's force on a hull.
//!
//! Fossen (Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed. 2021, ch. 10), for
//! hulls symmetric fore and aft:
//!
//! ```text
//! X = −½ ρ V² C_x A_F cos γ      Y = ½ ρ V² C_y A_L sin γ      N = ½ ρ V² C_n A_L L sin 2γ
//! γ = −atan2(v_rw, u_rw)         u_rw = u − u_w                v_rw = v − v_w
//! ```
//!
//! The air's velocity past the boat (a ahead, s to starboard) is (−u_rw, −v_rw). Then cos γ = −a /
//! V and sin γ = s / V, so no angle is needed. Wind pushes the bow away: N < 0 for a wind from fine
//! on the starboard bow, so a free boat ends up beam to the wind.

use crate::hull::Planar;
use primitives::frame::{Body, Ned, Rotation, body_from_ned};
use scenario::boat::Windage;

/// Density of air at 15 °C and sea level, kg/m³.
const AIR_DENSITY_KG_M3: f64 = 1.225;

/// The air's velocity past a boat, in body axes, from the wind over the ground, m/s.
#[inline]
pub fn wind_past_boat(rotation: Rotation, wind_m_s: Ned, nu: Planar) -> Body {
    let wind = body_from_ned(rotation, wind_m_s);
    Body {
        ahead: wind.ahead - nu.surge,
        starboard: wind.starboard - nu.sway,
    }
}

/// The force (N, N, N m) on a hull of `length_m` for this air velocity (m/s) in body axes.
#[inline]
pub fn wind_force(windage: &Windage, length_m: f64, past: Body) -> Planar {
    let Body {
        ahead: a,
        starboard: s,
    } = past;
    let half_rho = 0.5 * AIR_DENSITY_KG_M3;
    // Compute the force relative to the boat, in its axes. VRX applies the wind component by
    // component in world axes, which makes the force depend on the compass heading.
    let speed_m_s = (a * a + s * s).sqrt();
    Planar {
        surge: half_rho * windage.surge_coefficient * windage.frontal_area_m2 * speed_m_s * a,
        sway: half_rho * windage.sway_coefficient * windage.lateral_area_m2 * speed_m_s * s,
        // Subtract from zero, so that calm air gives +0 as elsewhere.
        yaw: 0.0
            - half_rho
                * windage.yaw_coefficient
                * windage.lateral_area_m2
                * length_m
                * 2.0
                * (a * s),
    }
}
