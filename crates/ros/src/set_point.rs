//! Converts requests from ROS 2 for a boat to orders, for as long as the requests are valid.

use crate::message::Twist;
use messages::order::Order;
use messages::picture::Nav;
use messages::refusal::Refusal;
use messages::{VehicleOrder, order};
use primitives::{SimTime, VehicleId, angle::wrap_pi};
use std::f64::consts::FRAC_PI_3;

/// Maximum lead of the ordered heading over the boat's own, rad. Without this limit, a boat that
/// cannot turn as fast as requested would continue turning after the end of the request.
const LEAD_MAX_RAD: f64 = FRAC_PI_3;
/// Maximum yaw rate that a twist may request, rad/s.
const YAW_RATE_MAX_RAD_S: f64 = 10.0;

/// A request for a boat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetPoint {
    /// A speed ahead and a yaw rate.
    Twist {
        /// Speed ahead, m/s; at least 0.
        surge_m_s: f64,
        /// Yaw rate, rad/s clockwise.
        yaw_rate_rad_s: f64,
    },
    /// An order in Squall's own form.
    Order(Order),
}

impl SetPoint {
    /// The request in a `geometry_msgs/Twist`: `linear.x` and `angular.z`. Boats cannot follow the
    /// other components.
    ///
    /// # Errors
    /// [`Refusal::BadNumber`] if a number is out of range. Boats have no controlled speed astern.
    pub fn of_twist(twist: &Twist) -> Result<SetPoint, Refusal> {
        let (surge_m_s, yaw_rate_rad_s) = (twist.linear[0], -twist.angular[2]);
        let steer = Order::Steer {
            heading_rad: 0.0,
            speed_m_s: surge_m_s,
        };
        if steer.check().is_err()
            || !(-YAW_RATE_MAX_RAD_S..=YAW_RATE_MAX_RAD_S).contains(&yaw_rate_rad_s)
        {
            return Err(Refusal::BadNumber);
        }
        Ok(SetPoint::Twist {
            surge_m_s,
            yaw_rate_rad_s,
        })
    }

    /// The request in a `squall_msgs/VehicleOrder` for this boat.
    ///
    /// # Errors
    /// [`Refusal::NotYours`] if it names a different boat, [`Refusal::BadNumber`] if its kind is
    /// unknown or a number is out of range.
    pub fn of_order(boat: VehicleId, order: &VehicleOrder) -> Result<SetPoint, Refusal> {
        if order.vehicle != boat {
            return Err(Refusal::NotYours);
        }
        let checked = order
            .order()
            .map(Order::check)
            .transpose()
            .map_err(|_: order::BadOrder| Refusal::BadNumber)?;
        checked.map(SetPoint::Order).ok_or(Refusal::BadNumber)
    }
}

/// A request with a number that distinguishes it from later ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbered {
    /// Increases with every request.
    pub number: u64,
    /// The request.
    pub set_point: SetPoint,
}

/// Follows the requests for one boat.
#[derive(Clone, Debug)]
pub struct Follower {
    /// How long a request is valid, in game time.
    ttl: SimTime,
    /// The number of the newest request, and the first decision that used it.
    newest: Option<(u64, SimTime)>,
    /// While a twist is valid: the ordered heading (rad), and the time of the decision that set it.
    heading: Option<(f64, SimTime)>,
}

impl Follower {
    /// A follower without a request.
    pub fn new(ttl: SimTime) -> Follower {
        Follower {
            ttl,
            newest: None,
            heading: None,
        }
    }

    /// The order at this decision, given the boat's navigation and the newest request. A boat
    /// without a valid request holds.
    pub fn order(&mut self, now: SimTime, nav: &Nav, request: Option<Numbered>) -> Order {
        let Some(request) = request else {
            return self.hold();
        };
        let used = self
            .newest
            .filter(|(number, _)| *number == request.number)
            .map_or(now, |(_, used)| used);
        self.newest = Some((request.number, used));
        if now - used > self.ttl {
            return self.hold();
        }
        match request.set_point {
            SetPoint::Order(order) => {
                self.heading = None;
                order
            }
            SetPoint::Twist {
                surge_m_s,
                yaw_rate_rad_s,
            } => {
                let heading_rad = self.heading(now, nav.psi_rad, yaw_rate_rad_s);
                Order::Steer {
                    heading_rad,
                    speed_m_s: surge_m_s,
                }
            }
        }
    }

    fn hold(&mut self) -> Order {
        self.heading = None;
        Order::Hold
    }

    /// Advances the ordered heading at the requested yaw rate. The boat follows this heading, so
    /// that the rate is the same for every hull and controller.
    fn heading(&mut self, now: SimTime, psi_rad: f64, yaw_rate_rad_s: f64) -> f64 {
        let (before_rad, then) = self.heading.unwrap_or((psi_rad, now));
        let ahead_rad = wrap_pi(before_rad - psi_rad) + yaw_rate_rad_s * (now - then).as_s();
        let heading_rad = wrap_pi(psi_rad + ahead_rad.clamp(-LEAD_MAX_RAD, LEAD_MAX_RAD));
        self.heading = Some((heading_rad, now));
        heading_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TTL: SimTime = SimTime(500_000_000);

    fn twist(x: f64, z: f64) -> Twist {
        Twist {
            linear: [x, 0.0, 0.0],
            angular: [0.0, 0.0, z],
        }
    }

    fn request(number: u64, x: f64, z: f64) -> Option<Numbered> {
        Some(Numbered {
            number,
            set_point: SetPoint::of_twist(&twist(x, z)).unwrap_or_else(|e| panic!("{e:?}")),
        })
    }

    fn heading_deg(order: Order) -> f64 {
        let Order::Steer { heading_rad, .. } = order else {
            panic!("{order:?}")
        };
        heading_rad.to_degrees()
    }

    #[test]
    fn a_twist_to_port_turns_the_ordered_heading_anticlockwise() {
        let mut follower = Follower::new(TTL);
        let nav = Nav {
            psi_rad: 10_f64.to_radians(),
            ..Nav::default()
        };
        // 0.5 rad/s is 2.86 degrees in 0.1 s, to port from a heading of 10 degrees.
        let headings: Vec<f64> = (0..4)
            .map(|i| {
                heading_deg(follower.order(SimTime(100_000_000 * i), &nav, request(1, 1.5, 0.5)))
            })
            .collect();
        for (heading, want) in headings.iter().zip([10.0, 7.135_211, 4.270_422, 1.405_633]) {
            assert!((heading - want).abs() < 1e-6, "{headings:?}");
        }
        let last = follower.order(SimTime(400_000_000), &nav, request(2, 1.5, 0.0));
        assert!(
            (heading_deg(last) - 1.405_633).abs() < 1e-6,
            "without a rate the heading stays: {last:?}"
        );
    }

    #[test]
    fn a_boat_that_cannot_turn_is_not_left_far_behind() {
        let mut follower = Follower::new(TTL);
        let mut order = Order::Hold;
        for i in 0..100_u64 {
            let now = SimTime(100_000_000 * i as i64);
            order = follower.order(now, &Nav::default(), request(i, 1.0, -1.0));
        }
        assert!((heading_deg(order) - 60.0).abs() < 1e-9, "{order:?}");
    }

    #[test]
    fn a_stale_twist_is_not_repeated() {
        let mut follower = Follower::new(TTL);
        let mut at =
            |ms: i64, request| follower.order(SimTime(1_000_000 * ms), &Nav::default(), request);
        assert_eq!(at(0, None), Order::Hold);
        for (ms, number, holds) in [
            (100, 1, false),
            (600, 1, false),
            (700, 1, true),
            (800, 1, true),
            (900, 2, false),
            (1400, 2, false),
            (1500, 2, true),
        ] {
            assert_eq!(
                at(ms, request(number, 1.0, 0.0)) == Order::Hold,
                holds,
                "at {ms} ms"
            );
        }
        assert_eq!(at(1600, None), Order::Hold);
    }

    #[test]
    fn only_sound_requests_are_followed() {
        for (x, z) in [
            (f64::NAN, 0.0),
            (0.0, f64::NAN),
            (f64::INFINITY, 0.0),
            (-0.1, 0.0),
            (101.0, 0.0),
            (1.0, 10.1),
        ] {
            assert_eq!(
                SetPoint::of_twist(&twist(x, z)),
                Err(Refusal::BadNumber),
                "{x} {z}"
            );
        }
        let boat = VehicleId(1);
        let steer = Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 2.0,
        };
        let good = VehicleOrder::new(boat, steer);
        assert_eq!(SetPoint::of_order(boat, &good), Ok(SetPoint::Order(steer)));
        for (order, want) in [
            (
                VehicleOrder {
                    vehicle: VehicleId(2),
                    ..good
                },
                Refusal::NotYours,
            ),
            (VehicleOrder { kind: 9, ..good }, Refusal::BadNumber),
            (
                VehicleOrder {
                    speed_m_s: f64::NAN,
                    ..good
                },
                Refusal::BadNumber,
            ),
        ] {
            assert_eq!(SetPoint::of_order(boat, &order), Err(want), "{order:?}");
        }
    }
}
