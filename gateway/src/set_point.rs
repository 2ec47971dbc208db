//! The set-point mapper: converts orders to set-points for the boat.
//!
//! With `drive = "thrust"` the heading and speed loops run in the gateway; with `drive = "speed"`
//! they run on the boat. Thrust is in per cent, and its difference is positive for a turn to
//! starboard: port = thrust + difference, starboard = thrust − difference.

use crate::config::{Drive, Gateway, Limits, Loops};
use crate::thrust_check::Ordered;
use messages::Order;
use messages::picture::Nav;
use primitives::SimTime;
use primitives::angle::{compass_deg_from_rad, wrap_pi};
use primitives::math::interpolate;

/// A set-point for the boat's controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetPoint {
    /// Thrust and thrust difference.
    Thrust {
        /// Mean thrust of the two thrusters, per cent.
        thrust_pct: f64,
        /// Difference, positive to starboard, per cent.
        difference_pct: f64,
    },
    /// Heading and speed, for the boat's own loops.
    Speed {
        /// Heading by the reference of the boat's compass, degrees.
        heading_deg: f64,
        /// Speed, m/s.
        speed_m_s: f64,
    },
}

impl SetPoint {
    /// Both thrusters at zero.
    pub const ZERO: SetPoint = SetPoint::Thrust {
        thrust_pct: 0.0,
        difference_pct: 0.0,
    };
}

/// The loops with their state.
#[derive(Clone, Debug)]
pub struct SetPointMapper {
    drive: Drive,
    limits: Limits,
    loops: Loops,
    compass_to_true_rad: f64,
    /// The integral of the speed loop, per cent.
    integral_pct: f64,
    /// The last set-point, and when it was sent.
    last: Option<(SimTime, f64, f64)>,
}

/// Maximum time step of the loops, s.
const STEP_MAX_S: f64 = 0.25;

impl SetPointMapper {
    /// The loops of a boat; a true heading is its compass heading plus `compass_to_true_rad`.
    pub fn new(gateway: &Gateway, compass_to_true_rad: f64) -> SetPointMapper {
        SetPointMapper {
            drive: gateway.drive,
            limits: gateway.limits,
            loops: gateway.loops.clone(),
            compass_to_true_rad,
            integral_pct: 0.0,
            last: None,
        }
    }

    /// Resets the loops, because the boat was stopped.
    pub fn reset(&mut self) {
        (self.integral_pct, self.last) = (0.0, None);
    }

    /// The set-point for a valid order.
    pub fn map(&mut self, now: SimTime, order: Order, nav: &Nav) -> SetPoint {
        let (thrust, difference) = match order {
            Order::Hold => {
                self.integral_pct = 0.0;
                (0.0, 0.0)
            }
            Order::Thrust { port, starboard } => {
                self.integral_pct = 0.0;
                // The manufacturer's definition: thrust is half the sum, and difference is half the
                // difference.
                (50.0 * (port + starboard), 50.0 * (port - starboard))
            }
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => {
                let turn_rad = wrap_pi(heading_rad - nav.psi_rad);
                return self.steered(now, (heading_rad, turn_rad, speed_m_s), nav);
            }
            // A boat with its own heading loop receives only the heading, so it may make a half
            // turn to either side.
            Order::Turn { by_rad, speed_m_s } => {
                return self.steered(now, (nav.psi_rad + by_rad, by_rad, speed_m_s), nav);
            }
        };
        self.within_limits(now, thrust, difference)
    }

    /// The set-point for a heading and a speed. The second number is the clockwise turn from the
    /// boat's heading to the ordered one.
    fn steered(
        &mut self,
        now: SimTime,
        (heading_rad, turn_rad, speed_m_s): (f64, f64, f64),
        nav: &Nav,
    ) -> SetPoint {
        let speed_m_s = speed_m_s.min(self.limits.speed_max_m_s);
        // The boat's own loops are not published, so they are an option rather than the default.
        if self.drive == Drive::Speed {
            let heading_deg = self.compass_deg(heading_rad);
            return SetPoint::Speed {
                heading_deg,
                speed_m_s,
            };
        }
        let (thrust, difference) = self.steer(self.step_s(now), turn_rad, speed_m_s, nav);
        self.within_limits(now, thrust, difference)
    }

    /// The expected effect of an order's set-point. Turns of a boat with its own loops are not
    /// predicted.
    pub fn ordered(&self, order: Order, set_point: SetPoint) -> Ordered {
        let heading_rad = if let Order::Steer { heading_rad, .. } = order {
            Some(heading_rad)
        } else {
            None
        };
        match set_point {
            SetPoint::Thrust {
                thrust_pct,
                difference_pct,
            } => {
                let ahead_m_s = interpolate(self.loops.thrust_map.iter().copied(), thrust_pct);
                Ordered {
                    ahead_m_s,
                    turn_pct: difference_pct,
                    heading_rad,
                }
            }
            SetPoint::Speed { speed_m_s, .. } => Ordered {
                ahead_m_s: speed_m_s,
                turn_pct: 0.0,
                heading_rad,
            },
        }
    }

    /// A true heading in the reference of the boat's compass, degrees.
    pub(crate) fn compass_deg(&self, true_rad: f64) -> f64 {
        compass_deg_from_rad(true_rad - self.compass_to_true_rad)
    }

    fn step_s(&self, now: SimTime) -> f64 {
        self.last
            .map_or(0.0, |(at, ..)| (now - at).as_s().clamp(0.0, STEP_MAX_S))
    }

    /// Our own loops: thrust from the map and the speed error, difference from the heading error;
    /// the difference takes priority.
    fn steer(&mut self, step_s: f64, turn_rad: f64, speed_m_s: f64, nav: &Nav) -> (f64, f64) {
        let Loops {
            speed_pct_per_m_s,
            speed_integral_s,
            heading_pct_per_rad,
            turn_pct_per_rad_s,
            ..
        } = self.loops;
        // P on the heading and D on the measured rate of turn, like pMarinePID on these boats.
        let difference = heading_pct_per_rad * turn_rad - turn_pct_per_rad_s * nav.yaw_rate_rad_s;
        let difference = difference.clamp(
            -self.limits.difference_max_pct,
            self.limits.difference_max_pct,
        );
        let error_m_s = speed_m_s - nav.surge_m_s;
        let asked = thrust_for(&self.loops.thrust_map, speed_m_s)
            + speed_pct_per_m_s * error_m_s
            + self.integral_pct;
        // Turning takes priority: a boat that cannot turn cannot avoid others.
        let room = (100.0 - difference.abs()).min(self.limits.thrust_max_pct);
        // Anti-windup: the integral grows only while the thrust is below its limit, and not at
        // rest.
        if asked.abs() < room && speed_m_s > 0.0 {
            self.integral_pct += speed_pct_per_m_s * error_m_s * step_s / speed_integral_s;
        }
        (asked.clamp(-room, room), difference)
    }

    fn within_limits(&mut self, now: SimTime, thrust: f64, difference: f64) -> SetPoint {
        let Limits {
            thrust_max_pct,
            difference_max_pct,
            slew_pct_s,
            ..
        } = self.limits;
        let (_, thrust_before, difference_before) = self.last.unwrap_or((now, 0.0, 0.0));
        // The first set-point may grow by as much as in a tenth of a second.
        let growth = slew_pct_s
            * if self.last.is_some() {
                self.step_s(now)
            } else {
                0.1
            };
        let difference_pct = slewed(
            difference_before,
            difference.clamp(-difference_max_pct, difference_max_pct),
            growth,
        );
        let room = (100.0 - difference_pct.abs()).min(thrust_max_pct);
        let thrust_pct = slewed(thrust_before, thrust, growth).clamp(-room, room);
        self.last = Some((now, thrust_pct, difference_pct));
        SetPoint::Thrust {
            thrust_pct,
            difference_pct,
        }
    }
}

/// The thrust (per cent) for a speed (m/s): the inverse of the map.
fn thrust_for(map: &[(f64, f64)], speed_m_s: f64) -> f64 {
    interpolate(
        map.iter().map(|(thrust, speed)| (*speed, *thrust)),
        speed_m_s,
    )
}

/// `to`, or the nearest value that `growth` allows; decreases towards zero are not limited.
fn slewed(from: f64, to: f64, growth: f64) -> f64 {
    // Zero is always allowed, so a stop is never slewed.
    let least = from.min(0.0) - growth;
    let most = from.max(0.0) + growth;
    to.clamp(least, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SURVEYOR_THRUST_MAP;

    fn gateway(drive: &str) -> Gateway {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/gateways");
        let name = if drive == "speed" {
            "surveyor_speed.toml"
        } else {
            "surveyor.toml"
        };
        scenario::load_file::<crate::config::Gateway>(&folder.join(name))
            .unwrap_or_else(|problems| panic!("{problems}"))
    }

    fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
        Order::Steer {
            heading_rad: heading_deg.to_radians(),
            speed_m_s,
        }
    }

    fn at(seconds: f64) -> SimTime {
        SimTime::from_s(seconds)
    }

    /// Thrust and difference, per cent.
    fn thrust_of(set_point: SetPoint) -> (f64, f64) {
        let SetPoint::Thrust {
            thrust_pct,
            difference_pct,
        } = set_point
        else {
            panic!("{set_point:?}")
        };
        (thrust_pct, difference_pct)
    }

    #[test]
    fn half_a_turn_to_either_side_is_thrust_to_that_side() {
        let nav = Nav {
            surge_m_s: 1.0,
            psi_rad: 1.0,
            ..Nav::default()
        };
        for side in [1.0, -1.0] {
            let mut mapper = SetPointMapper::new(&gateway("thrust"), 0.0);
            let order = Order::Turn {
                by_rad: side * std::f64::consts::PI,
                speed_m_s: 1.0,
            };
            let (_, difference) = thrust_of(mapper.map(at(0.0), order, &nav));
            assert!(side * difference > 1.0, "{side}: {difference} %");
        }
        let mut mapper = SetPointMapper::new(&gateway("speed"), 0.0);
        let set_point = mapper.map(
            at(0.0),
            Order::Turn {
                by_rad: 0.5,
                speed_m_s: 1.0,
            },
            &nav,
        );
        let SetPoint::Speed { heading_deg, .. } = set_point else {
            panic!("{set_point:?}")
        };
        assert!(
            (heading_deg - 1.5_f64.to_degrees()).abs() < 1e-9,
            "{heading_deg}"
        );
    }

    #[test]
    fn on_course_and_at_speed_the_thrust_is_that_of_the_map() {
        let mut mapper = SetPointMapper::new(&gateway("thrust"), 0.0);
        let nav = Nav {
            surge_m_s: 1.5,
            psi_rad: 1.0,
            ..Nav::default()
        };
        let order = Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 1.5,
        };
        let settings: Vec<SetPoint> = (0..20)
            .map(|i| mapper.map(at(0.1 * f64::from(i)), order, &nav))
            .collect();
        assert_eq!(
            settings[0],
            SetPoint::Thrust {
                thrust_pct: 10.0,
                difference_pct: 0.0
            },
            "100 % a second"
        );
        assert_eq!(
            settings[19],
            SetPoint::Thrust {
                thrust_pct: 40.0,
                difference_pct: 0.0
            }
        );
    }

    #[test]
    fn the_boat_turns_to_the_near_side_and_steering_comes_before_speed() {
        for (psi_deg, heading_deg, sign) in
            [(350.0, 10.0, 1.0), (10.0, 350.0, -1.0), (90.0, 200.0, 1.0)]
        {
            let mut mapper = SetPointMapper::new(&gateway("thrust"), 0.0);
            let nav = Nav {
                psi_rad: f64::to_radians(psi_deg),
                ..Nav::default()
            };
            let mut last = (0.0, 0.0);
            for i in 0..40 {
                last = thrust_of(mapper.map(at(0.1 * f64::from(i)), steer(heading_deg, 3.0), &nav));
                assert!(
                    f64::abs(last.0) + f64::abs(last.1) <= 100.0 + 1e-9 && last.0 <= 70.0,
                    "{last:?}"
                );
            }
            assert!(
                last.1 * sign >= 18.0 - 1e-9,
                "{psi_deg} to {heading_deg}: {last:?}"
            );
        }
    }

    #[test]
    fn growth_is_limited_and_zero_comes_at_once() {
        let mut mapper = SetPointMapper::new(&gateway("thrust"), 0.0);
        let full = Order::Thrust {
            port: 1.0,
            starboard: 1.0,
        };
        let mut before = 0.0;
        for i in 0..12 {
            let (thrust_pct, _) =
                thrust_of(mapper.map(at(0.05 * f64::from(i)), full, &Nav::default()));
            assert!(
                thrust_pct - before <= 10.0 + 1e-9,
                "{before} to {thrust_pct}"
            );
            before = thrust_pct;
        }
        assert!(before > 50.0);
        assert_eq!(
            mapper.map(at(0.6), Order::Hold, &Nav::default()),
            SetPoint::ZERO
        );
        let astern = Order::Thrust {
            port: -1.0,
            starboard: -1.0,
        };
        let (thrust_pct, _) = thrust_of(mapper.map(at(0.65), astern, &Nav::default()));
        assert!((-5.0 - 1e-9..0.0).contains(&thrust_pct), "{thrust_pct}");
    }

    #[test]
    fn the_boats_own_loops_get_a_heading_of_its_own_compass() {
        let east_deg: f64 = -12.5;
        let mut mapper = SetPointMapper::new(&gateway("speed"), east_deg.to_radians());
        let SetPoint::Speed {
            heading_deg,
            speed_m_s,
        } = mapper.map(at(0.0), steer(90.0, 9.0), &Nav::default())
        else {
            panic!("speed")
        };
        // Magnetic north is west of true north, so the compass reads higher.
        assert!((heading_deg - 102.5).abs() < 1e-9, "{heading_deg}");
        assert_eq!(speed_m_s, 3.0);
    }

    #[test]
    fn a_speed_between_two_of_the_map_takes_thrust_between() {
        for (speed, want) in [
            (0.0, 0.0),
            (0.5, 10.0),
            (1.25, 30.0),
            (3.0, 100.0),
            (4.0, 100.0),
            (-2.0, -100.0),
            (-3.0, -100.0),
        ] {
            assert!(
                (thrust_for(&SURVEYOR_THRUST_MAP, speed) - want).abs() < 1e-9,
                "{speed}"
            );
        }
        for thrust in [-100.0, -50.0, 0.0, 10.0, 65.0, 100.0] {
            let there_and_back = thrust_for(
                &SURVEYOR_THRUST_MAP,
                interpolate(SURVEYOR_THRUST_MAP, thrust),
            );
            assert!((there_and_back - thrust).abs() < 1e-9, "{thrust}");
        }
    }
}
