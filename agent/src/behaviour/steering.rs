//! Objective functions that several behaviours produce: a course at a speed, and keeping clear of something.

use crate::ivp::{Approach, Closest, Lag, Objective, Peak, Side};
use crate::situation::{MovingPoint, Situation};
use primitives::{Ned, angle, math};
use std::f64::consts::{FRAC_PI_2, PI};

/// From the peak of a speed down to nothing, m/s: MOOS-IvP's for waypoints.
const SPEED_BASE_M_S: f64 = 1.6;
/// How much less the edge of a peak of speed is worth than its summit: so that the desired speed itself is best.
const SPEED_SUMMIT_DELTA: f64 = 20.0;

/// What a closest point of approach at the least distance is worth; below that it falls to nothing, so that a boat which is
/// too near comes no nearer.
pub(super) const CPA_MIN_UTILITY: f64 = 50.0;

/// How slow the boat is to follow a decision: its velocity is that through the water, as decisions are.
pub(super) fn lag(situation: &Situation) -> Lag {
    let handling = situation.motion.handling();
    Lag {
        velocity: situation.velocity_through_water(),
        heading: situation.ahead,
        reaction_s: handling.reaction_s,
        // As the boat is seen to turn, not only as its file says: wind and speed change it.
        turn_rad_s: handling.turn_rad_s,
        acceleration_m_s2: handling.acceleration_m_s2,
        deceleration_m_s2: handling.deceleration_m_s2,
    }
}

/// Straight for a place at a speed, both alike: the function of MOOS-IvP's waypoints.
pub(super) fn toward(situation: &Situation, to: Ned, speed_m_s: f64) -> Objective<'static> {
    steer(situation, situation.at.bearing_rad(to), speed_m_s, 0.5)
}

/// A course, rad, and a speed over the ground, with the course's share of the utility; more speed than the boat can is the
/// most that it can.
pub(super) fn steer(situation: &Situation, course_rad: f64, speed_m_s: f64, course_share: f64) -> Objective<'static> {
    let (heading_rad, summit) = situation.motion.steer(course_rad, speed_m_s);
    steer_heading(heading_rad, summit, course_share)
}

/// A heading, rad, and a speed through the water, with the heading's share of the utility.
pub(super) fn steer_heading(heading_rad: f64, summit: f64, course_share: f64) -> Objective<'static> {
    let (peak_width, summit_delta) = (0.5 * summit, SPEED_SUMMIT_DELTA);
    Objective::Coupled {
        course: Peak::tent(angle::wrap_pi(heading_rad), PI),
        speed: Peak { peak_width, summit_delta, ..Peak::tent(summit, SPEED_BASE_M_S) },
        course_share,
    }
}

/// The highest speed at which the boat can turn onto a place, m/s: one that is faster goes round and round it. The circle through
/// the place that begins along the bow has the diameter of its distance over the sine of its bearing.
pub(super) fn speed_to_turn_onto(situation: &Situation, to: Ned) -> f64 {
    let off_bow_rad = angle::wrap_pi(situation.at.bearing_rad(to) - situation.own.nav.psi_rad).abs();
    let (sin, _) = math::sin_cos(off_bow_rad.min(FRAC_PI_2));
    0.5 * situation.motion.handling().turn_rad_s * situation.at.distance(to) / sin
}

/// Keeping clear of a disc: of its edge by `min_m` at least, and by `max_m` at best, for as long as a leg lasts, and by more
/// where it is left on the other side than `leave_to`.
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
        // Candidates are through the water, and own ship and contact are carried by the same
        // water: with the drift taken off the contact all distances are exact.
        velocity: disc.velocity - situation.motion.drift(),
        horizon_s,
        min_m: min_m + radius_m,
        max_m: max_m.max(min_m) + radius_m,
        // Worth nothing where hulls touch and half at the least distance. In MOOS-IvP a boat
        // that is too near is indifferent to coming nearer, so that the smallest preference to
        // pursue decides. In 150 games hulls touched a sixth as often with the slope.
        touch_m: radius_m,
        approach: Approach::Avoid { at_min: CPA_MIN_UTILITY, leave_to },
        lag: Some(lag(situation)),
    })
}
