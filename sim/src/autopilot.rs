//! The front seat: converts an order to settings for the two thrusters.
//!
//! A proportional-derivative loop controls the heading; its gains follow from the desired natural
//! frequency and the hull's inertia and damping. The speed is controlled by feed-forward of the
//! calibrated resistance and a proportional-integral correction. If the thrust does not suffice for
//! both, yaw has priority.

use crate::hull::{HullModel, Planar};
use crate::thruster::ThrusterModel;
use scenario::boat::Autopilot;

/// The control loops for one kind of boat.
#[derive(Clone, Debug)]
pub struct AutopilotModel {
    /// Maximum speed, m/s; faster orders are reduced to it.
    pub speed_max_m_s: f64,
    yaw_per_rad: f64,
    yaw_per_rad_s: f64,
    surge_per_m_s: f64,
    /// Integral gain per tick, N per m/s.
    surge_integral: f64,
}

/// Ratio of the integral time to the proportional time constant.
const INTEGRAL_SLOWNESS: f64 = 4.0;

impl AutopilotModel {
    /// The loops for this hull with ticks of `dt_s`.
    pub fn new(autopilot: &Autopilot, hull: &HullModel, dt_s: f64) -> AutopilotModel {
        let inertia = hull.m_yaw;
        let omega = autopilot.heading_bandwidth_rad_s;
        // Pole placement for a second-order system: the thrusters need not add damping that the
        // hull already provides.
        let wanted_damping = 2.0 * autopilot.heading_damping * omega * inertia;
        let surge_per_m_s = hull.m_surge / autopilot.speed_time_s;
        AutopilotModel {
            speed_max_m_s: autopilot.speed_max_m_s,
            yaw_per_rad: inertia * omega * omega,
            yaw_per_rad_s: (wanted_damping - hull.hull.yaw_linear_kg_m2_s).max(0.0),
            surge_per_m_s,
            surge_integral: surge_per_m_s * dt_s / (INTEGRAL_SLOWNESS * autopilot.speed_time_s),
        }
    }

    /// Settings for the port and starboard thrusters that turn the boat by `turn_rad` clockwise and
    /// drive it at `speed_m_s`.
    ///
    /// `integral_newton` is the state of the speed loop.
    #[inline]
    pub fn steer(
        &self,
        boat: (&HullModel, &ThrusterModel),
        nu: Planar,
        (turn_rad, speed_m_s): (f64, f64),
        integral_newton: &mut f64,
    ) -> [f64; 2] {
        let (hull, thruster) = boat;
        let wanted_m_s = speed_m_s.min(self.speed_max_m_s);
        let error_m_s = wanted_m_s - nu.surge;
        // Feed-forward first: the loop only corrects errors in the calibrated resistance, so a new
        // order does not have to wait for the integral.
        let surge = hull.surge_resistance_newton(wanted_m_s)
            + self.surge_per_m_s * error_m_s
            + *integral_newton;
        let yaw = self.yaw_per_rad * turn_rad - self.yaw_per_rad_s * nu.yaw;

        // Yaw first; surge gets the remaining range.
        let reach = 0.5 * (thruster.newton_max - thruster.newton_min);
        let difference = (0.5 * yaw / thruster.arm_m).clamp(-reach, reach);
        let least = thruster.newton_min + difference.abs();
        let most = thruster.newton_max - difference.abs();
        let each = (0.5 * surge).clamp(least, most);
        // Anti-windup: at the thrust limit the integral would grow without effect.
        if each == 0.5 * surge {
            *integral_newton += self.surge_integral * error_m_s;
        }
        [
            thruster.setting(each + difference),
            thruster.setting(each - difference),
        ]
    }
}
