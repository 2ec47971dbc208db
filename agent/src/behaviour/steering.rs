//! Objective functions shared by several behaviours: a course at a speed, and keeping clear of an
//! object.

use crate::ivp::{Approach, Closest, Lag, Objective, Peak, Side};
use crate::situation::{MovingPoint, Situation};
use primitives::{Ned, angle, math};
use std::f64::consts::{FRAC_PI_2, PI};

/// Width over which utility falls from a speed peak to zero, m/s: as for MOOS-IvP's waypoints.
const SPEED_BASE_M_S: f64 = 1.6;
/// Utility drop from the summit of a speed peak to its edge, so that the desired speed itself is
/// best.
const SPEED_SUMMIT_DELTA: f64 = 20.0;

/// Utility of a closest point of approach at exactly the minimum distance. Below that it falls to
/// zero, so that a boat already too close comes no closer.
pub(super) const CPA_MIN_UTILITY: f64 = 50.0;

/// The boat's delay in following a decision. Like candidate courses and speeds, the lag's
/// `velocity` is relative to the water.
pub(super) fn lag(situation: &Situation) -> Lag {
    let handling = situation.motion.handling();
    Lag {
        velocity: situation.velocity - situation.motion.drift(),
        heading: situation.ahead,
        reaction_s: handling.reaction_s,
        // Use the observed turn rate, not only that in the boat file: wind and speed change it.
        turn_rad_s: handling.turn_rad_s,
        acceleration_m_s2: handling.acceleration_m_s2,
        deceleration_m_s2: handling.deceleration_m_s2,
    }
}

/// A course straight to a place and a given speed, with equal weights, as for MOOS-IvP's waypoints.
pub(super) fn toward(situation: &Situation, to: Ned, speed_m_s: f64) -> Objective<'static> {
    steer(situation, situation.at.bearing_rad(to), speed_m_s, 0.5)
}

/// A course (rad) and a speed over the ground, limited to the boat's maximum. `course_share` is the
/// course's fraction of the utility.
pub(super) fn steer(
    situation: &Situation,
    course_rad: f64,
    speed_m_s: f64,
    course_share: f64,
) -> Objective<'static> {
    let (heading_rad, summit) = situation.motion.steer(course_rad, speed_m_s);
    steer_heading(heading_rad, summit, course_share)
}

/// A heading (rad) and a speed through the water, with the heading's fraction of the utility.
pub(super) fn steer_heading(
    heading_rad: f64,
    summit: f64,
    course_share: f64,
) -> Objective<'static> {
    let peak_width = 0.5 * summit;
    let summit_delta = SPEED_SUMMIT_DELTA;
    Objective::Coupled {
        course: Peak::tent(angle::wrap_pi(heading_rad), PI),
        speed: Peak {
            peak_width,
            summit_delta,
            ..Peak::tent(summit, SPEED_BASE_M_S)
        },
        course_share,
    }
}

/// The maximum speed at which the boat can reach a place by turning, m/s; a faster boat circles it.
/// The diameter of the circle that is tangent to the heading and passes through the place is the
/// distance divided by the sine of the relative bearing.
pub(super) fn speed_to_turn_onto(situation: &Situation, to: Ned) -> f64 {
    let off_bow_rad =
        angle::wrap_pi(situation.at.bearing_rad(to) - situation.own.nav.psi_rad).abs();
    let (sin, _) = math::sin_cos(off_bow_rad.min(FRAC_PI_2));
    0.5 * situation.motion.handling().turn_rad_s * situation.at.distance(to) / sin
}

/// Keeps clear of the edge of a disc by at least `min_m`, ideally by `max_m`, for the duration of a
/// leg. If `leave_to` is given, the same distance on the other side is worth less.
pub(super) fn keep_clear(
    situation: &Situation,
    disc: MovingPoint,
    radius_m: f64,
    (min_m, max_m): (f64, f64),
    horizon_s: f64,
    leave_to: Option<Side>,
) -> Objective<'static> {
    Objective::Closest(Closest {
        offset: disc.at - situation.at,
        // Candidate velocities are relative to the water, and the same water carries both boats:
        // with the drift subtracted from the contact's velocity, all distances are exact.
        velocity: disc.velocity - situation.motion.drift(),
        horizon_s,
        min_m: min_m + radius_m,
        max_m: max_m.max(min_m) + radius_m,
        // The utility is zero where hulls touch, and half of the maximum at the minimum distance.
        // In MOOS-IvP, a boat that is already too close is indifferent to coming closer, so even
        // the slightest preference to pursue tips the balance. With the slope, hulls touched a
        // sixth as often in 150 games.
        touch_m: radius_m,
        approach: Approach::Avoid {
            at_min: CPA_MIN_UTILITY,
            leave_to,
        },
        lag: Some(lag(situation)),
    })
}
