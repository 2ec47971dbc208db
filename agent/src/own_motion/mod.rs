//! The boat's response to orders: its drift, its heading offset and its handling.
//!
//! Everything is derived from the boat file, the boat's own navigation and its own orders, so it
//! works the same on a real boat and in simulation. A decision is a heading and a speed through the
//! water; adding the drift gives the velocity over the ground.

mod drift;
mod handling;
mod heading_offset;

pub(crate) use handling::Handling;

use drift::DriftEstimate;
use handling::SeenTurn;
use heading_offset::HeadingOffset;
use messages::Order;
use messages::picture::{Nav, OwnBoat};
use primitives::angle::wrap_pi;
use primitives::{Ned, SimTime, math};
use scenario::boat::{Boat, Drive};
use std::f64::consts::PI;

/// Maximum turn in one order, rad: a front seat turns the shorter way, which is ambiguous for half
/// a turn.
const TURN_MAX_RAD: f64 = 2.6;
/// A point boat whose thrust follows the order brakes fully if the order is lower than its speed by
/// at least the speed that it can lose in this time, s.
const BRAKES_S: f64 = 1.0;
/// Turn angle from which a point boat is ordered more than its current speed, to have thrust for
/// turning, and the angle from which it is ordered full speed, rad.
const STEERS_FROM_RAD: (f64, f64) = (0.35, 1.0);
/// Minimum ordered speed and maximum speed over the ground of a boat that counts as stopped, m/s.
const STOPPED_M_S: (f64, f64) = (1.0, 0.2);
/// Minimum turn that keeps its initial side, rad.
const LARGE_TURN_RAD: f64 = 2.2;

/// The speed reference of a front seat.
#[derive(Clone, Copy, Debug)]
enum SpeedReference {
    /// Forward speed over the ground.
    Ground,
    /// Speed through the water, as for point boats.
    Water {
        /// For a boat whose thrust is proportional to the ordered speed: how far below the boat's
        /// speed the order must be for full deceleration, m/s.
        brakes_by_m_s: Option<f64>,
        /// How much more speed to order in a turn, m/s.
        steers_by_m_s: f64,
    },
}

#[derive(Clone, Debug)]
pub(crate) struct OwnMotion {
    file: Handling,
    reference: SpeedReference,
    speed_max_m_s: f64,
    /// Whether orders compensate for drift and offset; if not, both estimates keep their defaults.
    compensates: bool,
    drift: DriftEstimate,
    offset: HeadingOffset,
    turn: SeenTurn,
    /// The desired heading and the heading ordered for it, rad; `None` after any other order.
    ordered: Option<(f64, f64)>,
    /// The ordered speed, m/s, and how long the boat has stood still despite it, s.
    ordered_m_s: f64,
    stopped_s: f64,
    /// Distance from the navigation point to the bow, m.
    bow_m: f64,
    fix_at: SimTime,
    psi_rad: f64,
    surge_m_s: f64,
    /// The side of the last large turn ordered: 1 for starboard, -1 for port; otherwise 0.
    side: f64,
}

impl OwnMotion {
    pub(crate) fn new(boat: &Boat, speed_max_m_s: f64, compensates: bool) -> OwnMotion {
        // Front seats steer by speed over the ground, from a satellite receiver; point boats by
        // speed through the water, as in MOOS.
        let reference = match &boat.drive {
            Drive::Thrusters { .. } => SpeedReference::Ground,
            Drive::Kinematic(point) => {
                let brakes = point.speed_factor > 0.0 && point.deceleration_max_m_s2 > 0.0;
                SpeedReference::Water {
                    brakes_by_m_s: brakes.then_some(BRAKES_S * point.deceleration_max_m_s2),
                    steers_by_m_s: 0.5 * point.speed_max_m_s,
                }
            }
        };
        OwnMotion {
            file: Handling::of(boat),
            reference,
            speed_max_m_s,
            compensates,
            drift: DriftEstimate::default(),
            offset: HeadingOffset::default(),
            turn: SeenTurn::default(),
            ordered: None,
            ordered_m_s: 0.0,
            stopped_s: 0.0,
            bow_m: 0.5 * boat.length_m,
            fix_at: SimTime::ZERO,
            psi_rad: 0.0,
            surge_m_s: 0.0,
            side: 0.0,
        }
    }

    /// Processes the boat's state `step_s` after the last call. `obeys` states whether the rules
    /// let the boat follow its orders.
    pub(crate) fn observe(&mut self, own: &OwnBoat, step_s: f64, obeys: bool) {
        (self.psi_rad, self.surge_m_s) = (own.nav.psi_rad, own.nav.surge_m_s);
        let (ordered_m_s, still_m_s) = STOPPED_M_S;
        let is_stopped =
            obeys && self.ordered_m_s > ordered_m_s && own.nav.surge_m_s.abs() < still_m_s;
        self.stopped_s = if is_stopped {
            self.stopped_s + step_s
        } else {
            0.0
        };
        if !self.compensates || step_s <= 0.0 {
            return;
        }
        // A repeated velocity carries no new information.
        if own.fix_ns > self.fix_at {
            // Count at most a second: after a gap in navigation, one velocity must not count as
            // several.
            self.drift.observe(
                &own.nav,
                &self.file,
                (own.fix_ns - self.fix_at).as_s().min(1.0),
            );
            self.fix_at = own.fix_ns;
        }
        match self.ordered.filter(|_| obeys) {
            Some((_, ordered_rad)) => {
                self.offset
                    .observe(ordered_rad, own.nav.psi_rad, &self.file, step_s);
                let error_rad = wrap_pi(ordered_rad + self.offset.offset_rad - own.nav.psi_rad);
                self.turn
                    .observe(error_rad, own.nav.yaw_rate_rad_s, &self.file, step_s);
            }
            None => self.offset.forget(),
        }
    }

    /// Velocity over the ground minus velocity through the water, m/s.
    pub(crate) fn drift(&self) -> Ned {
        self.drift.drift
    }

    /// The velocity to add to that of a decision, m/s: the estimated drift, or the boat's current
    /// sway if drift is not estimated.
    pub(crate) fn drift_now(&self, nav: &Nav) -> Ned {
        if self.compensates {
            self.drift.drift
        } else {
            nav.pose().rotation().starboard().scaled(nav.sway_m_s)
        }
    }

    /// How long the boat has stood still contrary to its orders, s.
    pub(crate) fn stopped_s(&self) -> f64 {
        self.stopped_s
    }

    /// The distance from the navigation point to the bow, m.
    pub(crate) fn bow_m(&self) -> f64 {
        self.bow_m
    }

    /// Standard deviation of the velocity around the drift, m/s.
    pub(crate) fn spread_m_s(&self) -> f64 {
        self.drift.spread_m_s()
    }

    /// The offset of the heading from the ordered heading, rad clockwise.
    pub(crate) fn heading_offset_rad(&self) -> f64 {
        self.offset.offset_rad
    }

    /// The observed handling.
    pub(crate) fn handling(&self) -> Handling {
        self.file.turning(self.turn.share(&self.file))
    }

    /// Heading (rad) and speed through the water for a course (rad) and a speed over the ground: |U
    /// c - d|, limited to the boat's top speed. A boat that cannot reach the speed keeps the
    /// course. If it cannot keep the course either, it points as close to the course as it can.
    pub(crate) fn steer(&self, course_rad: f64, speed_m_s: f64) -> (f64, f64) {
        let drift = self.drift();
        if drift == Ned::default() {
            return (wrap_pi(course_rad), speed_m_s.min(self.speed_max_m_s));
        }
        let (east, north) = math::sin_cos(course_rad);
        let course = Ned { north, east };
        let along_m_s = drift.dot(course);
        let across = drift - course.scaled(along_m_s);
        // The triangle of velocities: compensating for the drift across the course uses part of the
        // boat's speed, and the rest acts along the course.
        let room = self.speed_max_m_s * self.speed_max_m_s - across.dot(across);
        // A grid of courses over the ground would need the heading of each point for its turn, and
        // would interpret an order to stop as no motion through the water. The crab angle is
        // therefore computed here, once, for a behaviour that wants a course.
        let fastest_m_s = along_m_s + room.max(0.0).sqrt();
        let way = course.scaled(speed_m_s.min(fastest_m_s)) - drift;
        let through_m_s = way.length();
        if through_m_s < 1e-6 {
            return (wrap_pi(course_rad), 0.0);
        }
        (
            math::atan2(way.east, way.north),
            through_m_s.min(self.speed_max_m_s),
        )
    }

    /// The order for a heading (rad) and a speed through the water.
    pub(crate) fn order(&mut self, heading_rad: f64, speed_m_s: f64) -> Order {
        let heading_rad = wrap_pi(heading_rad);
        self.ordered_m_s = speed_m_s;
        if !self.compensates {
            return Order::Steer {
                heading_rad,
                speed_m_s,
            };
        }
        if let Some((wanted_rad, _)) = self.ordered {
            self.offset.turn(wrap_pi(heading_rad - wanted_rad));
        }
        let ordered_rad = wrap_pi(self.turn_toward(heading_rad) - self.offset.offset_rad);
        self.ordered = Some((heading_rad, ordered_rad));
        let ahead_m_s = match self.reference {
            SpeedReference::Ground => {
                let (east, north) = math::sin_cos(heading_rad);
                (speed_m_s + self.drift().dot(Ned { north, east })).clamp(0.0, self.speed_max_m_s)
            }
            // A point boat needs thrust to turn. If its low final speed were ordered at once, it
            // would cut its thrust and coast straight on while braking; at rest, it would not turn
            // at all. It needs no lower order in a turn, because full rudder costs it most of its
            // speed.
            SpeedReference::Water {
                brakes_by_m_s,
                steers_by_m_s,
            } => {
                let turn_rad = wrap_pi(ordered_rad - self.psi_rad).abs();
                let (from_rad, to_rad) = STEERS_FROM_RAD;
                let share = ((turn_rad - from_rad) / (to_rad - from_rad)).min(1.0);
                let steers_m_s = if share > 0.0 && speed_m_s > 0.0 {
                    (self.surge_m_s + share * steers_by_m_s).min(self.speed_max_m_s)
                } else {
                    0.0
                };
                let brakes_m_s = brakes_by_m_s.map_or(0.0, |by| self.surge_m_s - by);
                speed_m_s.max(brakes_m_s).max(steers_m_s)
            }
        };
        Order::Steer {
            heading_rad: ordered_rad,
            speed_m_s: ahead_m_s,
        }
    }

    /// The heading to order: the desired heading or, for nearly half a turn, an intermediate one,
    /// always on the same side. Otherwise the slightest yaw would reverse the turn.
    fn turn_toward(&mut self, heading_rad: f64) -> f64 {
        let turn_rad = wrap_pi(heading_rad - self.psi_rad);
        if turn_rad.abs() < LARGE_TURN_RAD {
            self.side = 0.0;
            return heading_rad;
        }
        if self.side == 0.0 {
            self.side = turn_rad.signum();
        }
        let to_side_rad = if turn_rad * self.side > 0.0 {
            turn_rad.abs()
        } else {
            PI
        };
        self.psi_rad + self.side * to_side_rad.min(TURN_MAX_RAD)
    }

    /// Called for an order other than steering.
    pub(crate) fn hold(&mut self) {
        (self.ordered, self.ordered_m_s, self.side) = (None, 0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::picture::Nav;
    use primitives::VehicleId;
    use std::path::Path;

    fn motion(boat: &str) -> OwnMotion {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/boats/{boat}.toml"));
        let boat = scenario::load_file::<scenario::Boat>(&file).unwrap_or_else(|e| panic!("{e}"));
        OwnMotion::new(&boat, boat.speed_max_m_s(), true)
    }

    /// Feeds navigation data ten times per second for `for_s`, starting at `after_s`.
    fn show(motion: &mut OwnMotion, after_s: f64, for_s: f64, nav: Nav) {
        for i in 0..(10.0 * for_s) as u32 {
            let at_s = 0.1 * f64::from(i);
            let mut own = OwnBoat::new(VehicleId(0), nav);
            own.fix_ns = SimTime::from_s(after_s + at_s + 0.1);
            motion.observe(&own, 0.1, true);
        }
    }

    #[test]
    fn a_course_over_the_ground_is_kept_with_a_crab_angle() {
        let mut motion = motion("surveyor_m1_8");
        // Northward with an eastward drift of 0.5 m/s.
        show(
            &mut motion,
            0.0,
            60.0,
            Nav {
                surge_m_s: 2.0,
                sway_m_s: 0.5,
                ..Nav::default()
            },
        );
        assert!(
            motion.drift().distance(Ned {
                north: 0.0,
                east: 0.5
            }) < 0.01,
            "{:?}",
            motion.drift()
        );
        let drift_m_s = motion.drift().length();
        let (heading_rad, speed_m_s) = motion.steer(0.0, 1.5);
        assert!(
            (heading_rad + libm::asin(drift_m_s / speed_m_s)).abs() < 0.01,
            "the sine of the crab angle is d / V"
        );
        assert!((speed_m_s - math::length(1.5, drift_m_s)).abs() < 0.01);
        // A speed beyond the boat's capability becomes the maximum on that course.
        let (heading_rad, speed_m_s) = motion.steer(0.0, 5.0);
        assert!(
            (speed_m_s - 3.0).abs() < 1e-9
                && (heading_rad + libm::asin(drift_m_s / 3.0)).abs() < 0.01
        );
        // To stop over the ground, the boat points against the drift.
        let (heading_rad, speed_m_s) = motion.steer(0.0, 0.0);
        assert!((heading_rad + 0.5 * PI).abs() < 0.03 && (speed_m_s - drift_m_s).abs() < 1e-9);
    }

    #[test]
    fn a_boat_that_lies_beside_its_heading_is_ordered_so_much_less() {
        let mut motion = motion("surveyor_m1_8");
        let mut ordered_rad = 0.0;
        for i in 0..600 {
            // A lasting moment holds the boat 0.3 rad to starboard of its order.
            show(
                &mut motion,
                0.1 * f64::from(i),
                0.1,
                Nav {
                    psi_rad: ordered_rad + 0.3,
                    ..Nav::default()
                },
            );
            if let Order::Steer { heading_rad, .. } = motion.order(1.0, 2.0) {
                ordered_rad = heading_rad;
            }
        }
        assert!(
            (ordered_rad + 0.3 - 1.0).abs() < 0.02,
            "heading {} rad, want 1",
            ordered_rad + 0.3
        );
    }

    #[test]
    fn a_boat_that_steers_by_its_thrust_keeps_some_while_it_brakes_and_more_in_a_turn() {
        for (boat, surge_m_s, turn_rad, speed_m_s, want_m_s) in [
            ("large_usv_kinematic", 6.0, 0.1, 0.3, 5.5),
            ("large_usv_kinematic", 6.0, 0.1, 7.0, 7.0),
            ("surveyor_kinematic", 2.0, 0.1, 0.3, 0.3),
            // Otherwise the boat would cut its thrust, and with it the effect of its rudder, until
            // it has slowed down.
            ("surveyor_kinematic", 1.0, 2.0, 0.3, 2.5),
            ("surveyor_kinematic", 2.0, 2.0, 0.3, 3.0),
            ("surveyor_kinematic", 0.0, 0.675, 0.1, 0.75),
            // A boat that has to stop need not turn, and one with two thrusters can turn at rest.
            ("surveyor_kinematic", 1.0, 2.0, 0.0, 0.0),
            ("surveyor_m1_8", 0.0, 2.0, 0.3, 0.3),
        ] {
            let mut motion = motion(boat);
            show(
                &mut motion,
                0.0,
                1.0,
                Nav {
                    surge_m_s,
                    ..Nav::default()
                },
            );
            let Order::Steer {
                speed_m_s: got_m_s, ..
            } = motion.order(turn_rad, speed_m_s)
            else {
                panic!("expected a steer order")
            };
            assert!(
                (got_m_s - want_m_s).abs() < 1e-9,
                "{boat} at {surge_m_s}, {turn_rad} rad to turn, {speed_m_s} wanted: ordered {got_m_s}, want {want_m_s}"
            );
        }
    }

    #[test]
    fn half_a_turn_goes_on_to_the_side_on_which_it_began() {
        let mut motion = motion("surveyor_m1_8");
        let mut sides = vec![];
        // The heading wavers about the opposite of the desired one.
        for (i, psi_rad) in [0.1, -0.1, 0.2, -0.3, 0.1].into_iter().enumerate() {
            show(
                &mut motion,
                i as f64,
                0.1,
                Nav {
                    psi_rad,
                    ..Nav::default()
                },
            );
            if let Order::Steer { heading_rad, .. } = motion.order(PI, 2.0) {
                sides.push(wrap_pi(heading_rad - psi_rad).signum());
            }
        }
        assert_eq!(sides, [1.0; 5]);
    }

    #[test]
    fn a_boat_is_known_by_its_file_and_then_by_how_it_turns() {
        // Reaction, s, and yaw rate, rad/s: constants once used for all boats, measured on this
        // boat.
        let surveyor = motion("surveyor_m1_8").handling();
        assert!(
            (surveyor.reaction_s - 0.7).abs() < 0.1 && (surveyor.turn_rad_s - 0.35).abs() < 0.05,
            "{surveyor:?}"
        );
        // The point boat reaches half of the 0.5 m/s² in its file: from 12 m/s it takes 48 s to
        // stop.
        let large = motion("large_usv_kinematic").handling();
        assert!((large.deceleration_m_s2 - 0.25).abs() < 1e-9, "{large:?}");
        // An error of half a radian sets a rudder of 0.35 % per degree, less 0.07 % per degree a
        // second, which at 70 % thrust turns the boat at 0.117 rad/s.
        assert!(
            (large.yaw_rate_rad_s(0.5) - 0.1168).abs() < 0.001,
            "{large:?}"
        );
        let mut motion = motion("surveyor_m1_8");
        let before_rad_s = motion.handling().turn_rad_s;
        for i in 0..200 {
            motion.order(2.0, 2.0);
            let nav = Nav {
                psi_rad: 0.0,
                yaw_rate_rad_s: 0.4 * before_rad_s,
                ..Nav::default()
            };
            show(&mut motion, 0.1 * f64::from(i), 0.1, nav);
        }
        let seen = motion.handling().turn_rad_s / before_rad_s;
        assert!(
            (0.35..0.65).contains(&seen),
            "observed turn rate is {seen} of that in its file"
        );
    }
}
