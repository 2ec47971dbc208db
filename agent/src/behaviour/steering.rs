//! Objective functions that several behaviours produce: a course at a speed, and keeping clear of something.

use crate::ivp::{Approach, Closest, Lag, Objective, Peak};
use crate::situation::{MovingPoint, Situation};
use game::{Ned, angle, math};
use std::f64::consts::PI;

/// From the peak of a speed down to nothing, m/s: MOOS-IvP's for waypoints.
const SPEED_BASE_M_S: f64 = 1.6;
/// How much less the edge of a peak of speed is worth than its summit: so that the desired speed itself is best.
const SPEED_SUMMIT_DELTA: f64 = 20.0;

/// What a closest point of approach at the least distance is worth; below that it falls to nothing, so that a boat which is
/// too near comes no nearer.
pub(super) const CPA_MIN_UTILITY: f64 = 50.0;

/// How fast a boat is assumed to turn, rad/s. A Surveyor under way does 25 degrees a second.
pub(super) const TURN_RAD_S: f64 = 0.35;
/// How long it takes until a decision shows, s.
pub(super) const REACTION_S: f64 = 0.7;

/// How slow the boat is to follow a decision.
pub(super) fn lag(situation: &Situation) -> Lag {
    let (heading_east, heading_north) = math::sin_cos(situation.own.nav.psi_rad);
    Lag {
        velocity: situation.velocity,
        heading: Ned { north: heading_north, east: heading_east },
        reaction_s: REACTION_S,
        turn_rad_s: TURN_RAD_S,
    }
}

/// Straight for a place at a speed, both alike: the function of MOOS-IvP's waypoints.
pub(super) fn toward(situation: &Situation, to: Ned, speed_m_s: f64) -> Objective<'static> {
    steer(situation, situation.at.bearing_rad(to), speed_m_s, 0.5)
}

/// A course, rad, and a speed, with the course's share of the utility; more speed than the boat can is the most that it can.
pub(super) fn steer(situation: &Situation, course_rad: f64, speed_m_s: f64, course_share: f64) -> Objective<'static> {
    let summit = speed_m_s.min(situation.model.speed_max_m_s);
    let (peak_width, summit_delta) = (0.5 * summit, SPEED_SUMMIT_DELTA);
    Objective::Coupled {
        course: Peak::tent(angle::wrap_pi(course_rad), PI),
        speed: Peak { peak_width, summit_delta, ..Peak::tent(summit, SPEED_BASE_M_S) },
        course_share,
    }
}

/// Keeping clear of a disc: of its edge by `min_m` at least, and by `max_m` at best, for as long as a leg lasts.
pub(super) fn keep_clear(
    situation: &Situation,
    disc: MovingPoint,
    radius_m: f64,
    (min_m, max_m): (f64, f64),
    horizon_s: f64,
) -> Objective<'static> {
    Objective::Closest(Closest {
        offset: disc.at - situation.at,
        velocity: disc.velocity,
        horizon_s,
        min_m: min_m + radius_m,
        max_m: max_m.max(min_m) + radius_m,
        touch_m: radius_m,
        approach: Approach::Avoid { at_min: CPA_MIN_UTILITY },
        lag: Some(lag(situation)),
    })
}
