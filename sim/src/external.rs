//! Real boats in a game: their estimated position between reports.
//!
//! A real boat has no simulated physics. Its gateway reports position and motion; until the next
//! report, the boat is extrapolated with that motion, tick by tick.

use crate::hull::Planar;
use messages::picture::{Nav, OwnBoat};
use primitives::angle::wrap_pi;
use primitives::frame::Rotation;
use primitives::{Pose, SimTime, VehicleId, math};
use rules::Event;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How long a boat is dead reckoned with constant motion after its last fix. After that it is
/// assumed to stay at its position. The error grows with the square of the time: for a boat that
/// decelerates at 1 m/s², it is half a metre after one second and two metres after two. A boat that
/// reports nothing probably slows down: it receives nothing either, and its own watchdog stops its
/// thrusters. Also, an extrapolated boat must not reach a flag.
pub const DEAD_RECKONING_MAX: SimTime = SimTime(1_000_000_000);
/// A boat whose last fix is older than this is lost. The margin over [`DEAD_RECKONING_MAX`] makes
/// one fix per second with the usual delays sufficient. The margin is small, because during that
/// time the boat's mind does not know its position.
pub const NAV_TTL: SimTime = SimTime(1_500_000_000);

/// Maximum distance north or east of the datum, m: the limit of scenario files.
const ABSURD_M: f64 = 1e6;
/// Maximum speed over the ground, m/s: above that of any boat in these games.
const ABSURD_M_S: f64 = 30.0;
/// Maximum yaw rate, rad/s: one turn per second.
const ABSURD_RAD_S: f64 = std::f64::consts::TAU;

/// A reason to reject a boat's report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum BadReport {
    /// The boat is simulated.
    #[error("the vehicle is simulated: only real boats send position reports")]
    Simulated,
    /// A number is outside its plausible range.
    #[error(
        "a number is non-finite or implausible (limits: position 1000 km, heading 1000 rad, speed 30 m/s, yaw rate 2π rad/s)"
    )]
    BadNumber,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Track {
    fix: Option<Fix>,
    /// Whether the last event reported the boat as lost.
    reported_lost: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Fix {
    nav: Nav,
    at: SimTime,
}

impl Track {
    pub(crate) fn update(&mut self, nav: Nav, at: SimTime) {
        self.fix = Some(Fix { nav, at });
    }

    /// Whether the boat has ever reported a valid fix.
    pub(crate) fn has_fix(&self) -> bool {
        self.fix.is_some()
    }

    /// Whether the last fix is too old or missing.
    pub(crate) fn is_lost(&self, now: SimTime) -> bool {
        self.fix.is_none_or(|fix| now > fix.at + NAV_TTL)
    }

    /// Position and motion over the ground, extrapolated from the last fix.
    pub(crate) fn estimate(&self, now: SimTime) -> Option<(Pose, Planar)> {
        let Fix { nav, at } = self.fix?;
        let since = now - at;
        let nu = Planar {
            surge: nav.surge_m_s,
            sway: nav.sway_m_s,
            yaw: nav.yaw_rate_rad_s,
        };
        // A fix may be later than the world's tick; then the position is extrapolated back a
        // little. After a second the boat is assumed to stay at its position.
        let span = since.clamp(SimTime::ZERO - DEAD_RECKONING_MAX, DEAD_RECKONING_MAX);
        let pose = dead_reckoned(nav.pose(), nu, span.as_s());
        Some((
            pose,
            if since < DEAD_RECKONING_MAX {
                nu
            } else {
                Planar::default()
            },
        ))
    }

    /// An event when the boat is lost or back, once for each change.
    pub(crate) fn event(&mut self, vehicle: VehicleId, now: SimTime) -> Option<Event> {
        let is_lost = self.is_lost(now);
        let was_lost = std::mem::replace(&mut self.reported_lost, is_lost);
        (is_lost != was_lost).then_some(if is_lost {
            Event::NavLost(vehicle)
        } else {
            Event::NavBack(vehicle)
        })
    }

    /// Replaces the world's estimate with the boat's own fix.
    pub(crate) fn put_fix(&self, own: &mut OwnBoat) {
        match self.fix {
            Some(Fix { nav, at }) => (own.nav, own.fix_ns) = (nav, at),
            None => own.fix_ns = SimTime::LONG_AGO,
        }
    }
}

/// The pose after `span_s` with constant velocity over the ground (in body axes) and yaw rate:
/// motion along an arc.
pub(crate) fn dead_reckoned(from: Pose, nu: Planar, span_s: f64) -> Pose {
    let half_turn_rad = 0.5 * nu.yaw * span_s;
    // The chord of the arc points half-way between the two headings, and is shorter than the arc by
    // a factor of sin(x) / x.
    let chord = if half_turn_rad.abs() < 1e-4 {
        1.0 - half_turn_rad * half_turn_rad / 6.0
    } else {
        math::sin_cos(half_turn_rad).0 / half_turn_rad
    };
    let velocity = nu.in_ned(Rotation::from_heading(from.psi_rad + half_turn_rad));
    Pose {
        at: from.at + velocity.scaled(chord * span_s),
        psi_rad: wrap_pi(from.psi_rad + 2.0 * half_turn_rad),
    }
}

/// The navigation with its heading wrapped to ±π, if all numbers are plausible.
pub(crate) fn sound(nav: Nav) -> Result<Nav, BadReport> {
    // A NaN fails every comparison.
    let is_sound = nav.north_m.abs() <= ABSURD_M
        && nav.east_m.abs() <= ABSURD_M
        // Limit the number of turns before wrapping: reducing a huge angle would lose all digits.
        && nav.psi_rad.abs() <= 1e3
        && nav.speed_m_s() <= ABSURD_M_S
        && nav.yaw_rate_rad_s.abs() <= ABSURD_RAD_S;
    if is_sound {
        Ok(Nav {
            psi_rad: wrap_pi(nav.psi_rad),
            ..nav
        })
    } else {
        Err(BadReport::BadNumber)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::Ned;

    #[test]
    fn a_boat_that_goes_on_turning_sails_round_a_circle() {
        let from = Pose {
            at: Ned {
                north: 3.0,
                east: -4.0,
            },
            psi_rad: 0.7,
        };
        let nu = Planar {
            surge: 2.0,
            sway: -0.5,
            yaw: 0.4,
        };
        let once_round_s = std::f64::consts::TAU / nu.yaw;
        let back = dead_reckoned(from, nu, once_round_s);
        assert!(
            back.at.distance(from.at) < 1e-9 && (back.psi_rad - from.psi_rad).abs() < 1e-9,
            "{back:?}"
        );
        // Many steps reach the same place as one step, and backward steps return to the start.
        for yaw in [0.4, 0.0, 1e-6, -3.0] {
            let nu = Planar { yaw, ..nu };
            let stepped = (0..20).fold(from, |pose, _| dead_reckoned(pose, nu, 0.05));
            let at_once = dead_reckoned(from, nu, 1.0);
            assert!(
                stepped.at.distance(at_once.at) < 1e-9,
                "{stepped:?} {at_once:?}"
            );
            assert!(wrap_pi(stepped.psi_rad - at_once.psi_rad).abs() < 1e-9);
            assert!(dead_reckoned(at_once, nu, -1.0).at.distance(from.at) < 1e-9);
        }
    }

    #[test]
    fn numbers_that_no_boat_has_are_refused() {
        let good = Nav {
            north_m: 5.0,
            psi_rad: 7.0,
            surge_m_s: -1.0,
            ..Nav::default()
        };
        assert_eq!(
            sound(good),
            Ok(Nav {
                psi_rad: wrap_pi(7.0),
                ..good
            })
        );
        for bad in [
            Nav {
                north_m: f64::NAN,
                ..good
            },
            Nav {
                east_m: f64::INFINITY,
                ..good
            },
            Nav {
                east_m: -1.1e6,
                ..good
            },
            Nav {
                psi_rad: f64::NAN,
                ..good
            },
            Nav {
                psi_rad: 1e4,
                ..good
            },
            Nav {
                surge_m_s: 40.0,
                ..good
            },
            Nav {
                sway_m_s: f64::NAN,
                ..good
            },
            Nav {
                yaw_rate_rad_s: -7.0,
                ..good
            },
        ] {
            assert_eq!(sound(bad), Err(BadReport::BadNumber), "{bad:?}");
        }
    }
}
