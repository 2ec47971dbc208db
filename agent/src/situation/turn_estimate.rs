//! Turn estimates: the yaw rates of boats, and their extrapolated motion.

use super::moving_point::MovingPoint;
use messages::picture::Contact;
use primitives::SimTime;
use primitives::angle::wrap_pi;
use primitives::frame::{Body, Rotation, ned_from_body};

/// How long a boat is assumed to keep turning, s.
const TURNS_ON_S: f64 = 2.0;
/// Upper bound of the assumed turn, rad.
const TURN_MAX_RAD: f64 = 1.5;
/// Time constant for smoothing a contact's yaw rate, s.
const SMOOTHED_S: f64 = 0.5;

/// A contact's yaw rate, estimated from its observed headings.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurnEstimate {
    seen: SimTime,
    psi_rad: f64,
    yaw_rate_rad_s: f64,
}

impl TurnEstimate {
    /// The estimate, updated with the contact's current state.
    pub(super) fn seen(before: Option<TurnEstimate>, contact: &Contact) -> TurnEstimate {
        let seen = contact.seen_ns;
        let psi_rad = contact.psi_rad;
        let Some(before) = before else {
            return TurnEstimate {
                seen,
                psi_rad,
                yaw_rate_rad_s: 0.0,
            };
        };
        // A contact shown again unchanged was not observed again; counting it would make the
        // contact appear to have stopped turning.
        if seen <= before.seen {
            return before;
        }
        let gone_s = (seen - before.seen).as_s();
        let now_rad_s = wrap_pi(psi_rad - before.psi_rad) / gone_s;
        let share = (gone_s / SMOOTHED_S).min(1.0);
        TurnEstimate {
            seen,
            psi_rad,
            yaw_rate_rad_s: before.yaw_rate_rad_s + share * (now_rad_s - before.yaw_rate_rad_s),
        }
    }

    /// The yaw rate, rad/s clockwise; 0 if the contact has not been seen for longer than the
    /// assumed turn.
    pub(super) fn yaw_rate_rad_s(&self, now: SimTime) -> f64 {
        if (now - self.seen).as_s() > TURNS_ON_S {
            0.0
        } else {
            self.yaw_rate_rad_s
        }
    }
}

/// The straight-line equivalent of a boat with this yaw rate (rad/s): its position and velocity
/// after a brief continued turn.
pub(super) fn turning_on(boat: MovingPoint, yaw_rate_rad_s: f64) -> MovingPoint {
    let turn_rad = (yaw_rate_rad_s * TURNS_ON_S).clamp(-TURN_MAX_RAD, TURN_MAX_RAD);
    let half_rad = 0.5 * turn_rad;
    let half = Rotation::from_heading(half_rad);
    // The ratio of an arc's chord to its length: the sine of half the angle over half the angle,
    // which is 1 for a straight line.
    let chord = if half_rad.abs() > 1e-6 {
        half.ahead().east / half_rad
    } else {
        1.0
    };
    let clockwise = |by| {
        ned_from_body(
            by,
            Body {
                ahead: boat.velocity.north,
                starboard: boat.velocity.east,
            },
        )
    };
    let velocity = clockwise(Rotation::from_heading(turn_rad));
    MovingPoint {
        at: boat.at + clockwise(half).scaled(chord * TURNS_ON_S) - velocity.scaled(TURNS_ON_S),
        velocity,
    }
}

#[cfg(test)]
mod tests {
    use super::{TURNS_ON_S, TurnEstimate, turning_on};
    use crate::situation::MovingPoint;
    use messages::picture::Contact;
    use primitives::{Ned, SimTime, TeamId, VehicleId};

    #[test]
    fn a_boat_on_a_circle_is_where_the_circle_leads() {
        // 2 m/s north at 0.4 rad/s: a circle of radius 5 m around a point 5 m to the east.
        let boat = MovingPoint {
            at: Ned {
                north: 10.0,
                east: 20.0,
            },
            velocity: Ned {
                north: 2.0,
                east: 0.0,
            },
        };
        for yaw_rate_rad_s in [0.4, -0.4] {
            let turned = turning_on(boat, yaw_rate_rad_s);
            let (sin, cos) = primitives::math::sin_cos(0.4 * TURNS_ON_S);
            let side = f64::signum(yaw_rate_rad_s);
            let want = boat.at
                + Ned {
                    north: 5.0 * sin,
                    east: side * 5.0 * (1.0 - cos),
                };
            let got = turned.at + turned.velocity.scaled(TURNS_ON_S);
            assert!(got.distance(want) < 1e-9, "{got:?}, {want:?}");
            let goes = Ned {
                north: 2.0 * cos,
                east: side * 2.0 * sin,
            };
            assert!(turned.velocity.distance(goes) < 1e-9, "{turned:?}");
        }
        let straight = turning_on(boat, 0.0);
        assert!(
            straight.at.distance(boat.at) < 1e-12
                && straight.velocity.distance(boat.velocity) < 1e-12
        );
    }

    #[test]
    fn the_yaw_rate_of_a_contact_is_that_of_its_headings() {
        let contact = |ms: i64, psi_rad: f64| Contact {
            vehicle: VehicleId(1),
            team: TeamId(1),
            seen_ns: SimTime::from_s(0.001 * ms as f64),
            north_m: 0.0,
            east_m: 0.0,
            psi_rad,
            velocity_north_m_s: 0.0,
            velocity_east_m_s: 0.0,
            tagged: false,
            carrying: -1,
        };
        let mut turn = TurnEstimate::seen(None, &contact(0, 3.0));
        // The boat turns through south, where headings wrap, and each heading is shown twice.
        for ms in (100..5_000).step_by(100) {
            let psi_rad = primitives::angle::wrap_pi(3.0 + 0.3 * 0.001 * ms as f64);
            for _ in 0..2 {
                turn = TurnEstimate::seen(Some(turn), &contact(ms, psi_rad));
            }
        }
        let rate = |ms: i64| turn.yaw_rate_rad_s(SimTime::from_s(0.001 * ms as f64));
        assert!((rate(4_900) - 0.3).abs() < 1e-3, "{}", rate(4_900));
        assert_eq!(rate(9_000), 0.0, "the contact is out of sight");
    }
}
