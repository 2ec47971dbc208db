//! Checks a boat's motion against its commands: does it turn, make way, and follow its heading?

use messages::picture::Nav;
use primitives::angle::wrap_pi;
use primitives::{SimTime, math};
use thiserror::Error;

/// The expected effect of a set-point on a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ordered {
    /// The expected forward speed, m/s.
    pub ahead_m_s: f64,
    /// Thrust difference, per cent, positive to starboard; 0 if the boat steers by itself.
    pub turn_pct: f64,
    /// The expected true heading, rad; `None` if a rate of turn or thrust is ordered.
    pub heading_rad: Option<f64>,
}

/// An order that a boat does not follow.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ThrustFault {
    /// The boat's heading does not respond to the thrust difference: rate of turn in degrees/s at
    /// half of the full difference.
    #[error(
        "the thrusters: the heading does not respond to differential thrust: {0:.0} degrees/s at half difference"
    )]
    NoTurn(f64),
    /// The mean forward speed (m/s) over 40 s under thrust is too low.
    #[error(
        "the thrusters: the boat makes no way under thrust: {0:.1} m/s ahead on average over {WAY_S} s"
    )]
    NoWay(f64),
    /// The boat goes astern instead of ahead, or does not turn to its ordered heading. This is the
    /// error of its course, degrees.
    #[error("the boat moves against its orders: its course is off by {0:.0} degrees")]
    Against(f64),
}

/// Minimum ordered speed (m/s) at which a boat must make way.
const WAY_FROM_M_S: f64 = 1.2;
/// Time (s) for which the order must be in force.
const WAY_S: f64 = 40.0;
/// Minimum mean fraction of the ordered speed over that time; a healthy boat falls below it only in
/// a head current of about its own speed.
const WAY_SHARE_MIN: f64 = 0.1;
/// Minimum ordered speed (m/s) at which a boat can count as moving against its orders.
const AGAINST_FROM_M_S: f64 = 0.8;
/// Distance astern that counts as a fault (m), and the speed astern that wind and current may cause
/// (m/s).
const ASTERN_M: f64 = 6.0;
const ASTERN_DRIFT_M_S: f64 = 0.4;
/// A heading error of this angle (rad) from a held order counts as a fault after this time (s) at
/// this speed or more (m/s). Time in which the boat turns to the ordered heading at this rate
/// (rad/s) or faster does not count. Time in which the error exceeds the last angle (rad), so that
/// the boat moves away, counts twice.
const ASTRAY_RAD: f64 = 0.45;
const ASTRAY_S: f64 = 10.0;
const ASTRAY_FROM_M_S: f64 = 0.5;
const ASTRAY_TURN_RAD_S: f64 = 0.05;
const ASTRAY_AWAY_RAD: f64 = 1.4;
/// In waves, both limits grow with the variance of the sway velocity over about this time (s): by
/// these amounts (m and s) for each m²/s². A gale (0.1 to 0.3 m²/s²) can hold a healthy boat for 40
/// s, or drive it 30 m away. In a simulated day (`tests/gale`), half of this growth is enough.
const SWAY_MEMORY_S: f64 = 10.0;
const ASTERN_UNREST_M: f64 = 40.0;
const ASTRAY_UNREST_S: f64 = 1500.0;
/// Averaging time of rates of turn, s.
const PIECE_S: f64 = 0.5;
/// Approximate lag with which a boat reaches its rate of turn, s.
const TURN_LAG_S: f64 = 0.7;
/// Time over which rates and orders are compared (s), and the minimum number of rates.
const TURN_MEMORY_S: f64 = 60.0;
const PIECES_MIN: f64 = 20.0;
/// Number of consecutive rates that count as one: waves and gusts last, so the rates are
/// correlated.
const PIECES_ALIKE: f64 = 8.0;
/// Minimum scatter of the rates, rad/s.
const TURN_SCATTER_MIN_RAD_S: f64 = 0.03;
/// Minimum rate of turn, rad/s, of a healthy boat with a thrust difference of 100 %.
const TURN_MIN_RAD_S: f64 = 0.15;
/// Number of standard deviations below the minimum that makes a rate a fault. In a gale the wind
/// may hold a healthy boat for more than a minute, or turn it the other way, so the check is
/// whether a larger order makes it turn more.
const SIGMAS: f64 = 5.0;
/// Maximum gap between continuous orders, s.
const GAP_MAX_S: f64 = 1.5;

/// A held speed, and the boat's motion in the meantime.
#[derive(Clone, Copy, Debug)]
struct Way {
    since: SimTime,
    count: f64,
    /// Sums over the steps so far, m/s.
    ordered: f64,
    seen: f64,
}

/// The rate of turn against the thrust difference: a regression with exponential memory.
#[derive(Clone, Copy, Debug, Default)]
struct Turn {
    /// The ordered difference, as a fraction of the full one, delayed by the boat's lag.
    difference: f64,
    /// The current piece: its duration (s) and the turn in it (rad).
    piece_s: f64,
    turned_rad: f64,
    /// Sums of 1, x, y, xx, xy and yy, where x is the difference and y the rate of turn (rad/s).
    sums: [f64; 6],
}

impl Turn {
    /// Adds a step of this length. Returns the rate of turn at full difference (rad/s) and its
    /// standard deviation.
    fn observe(&mut self, difference: f64, step_s: f64, turned_rad: f64) -> Option<(f64, f64)> {
        self.difference += (difference - self.difference) * (step_s / TURN_LAG_S).min(1.0);
        self.piece_s += step_s;
        self.turned_rad += turned_rad;
        if self.piece_s < PIECE_S {
            return None;
        }
        let x = self.difference;
        let y = self.turned_rad / self.piece_s;
        // Exponential memory in six sums: the same regression over a window would store hundreds of
        // pieces.
        let keep = 1.0 - (self.piece_s / TURN_MEMORY_S).min(1.0);
        for (sum, new) in self.sums.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
            *sum = keep * *sum + new;
        }
        (self.piece_s, self.turned_rad) = (0.0, 0.0);
        let count = self.sums[0];
        let [mean_x, mean_y, xx, xy, yy] = std::array::from_fn(|i| self.sums[i + 1] / count);
        let spread = xx - mean_x * mean_x;
        let slope = (xy - mean_x * mean_y) / spread;
        let rest = (yy - mean_y * mean_y - slope * slope * spread)
            .max(TURN_SCATTER_MIN_RAD_S * TURN_SCATTER_MIN_RAD_S);
        let sigma = (rest * PIECES_ALIKE / (spread * count)).sqrt();
        (count >= PIECES_MIN && sigma.is_finite()).then_some((slope, sigma))
    }
}

/// The recent mean and mean square of the sway, m/s and m²/s².
#[derive(Clone, Copy, Debug, Default)]
struct Sway {
    mean: f64,
    square: f64,
}

impl Sway {
    /// Adds the sway after a step of this length; returns its variance, m²/s².
    fn observe(&mut self, step_s: f64, sway_m_s: f64) -> f64 {
        let share = (step_s / SWAY_MEMORY_S).min(1.0);
        self.mean += (sway_m_s - self.mean) * share;
        self.square += (sway_m_s * sway_m_s - self.square) * share;
        self.square - self.mean * self.mean
    }
}

/// Recent orders, and the boat's response.
#[derive(Clone, Debug, Default)]
pub(crate) struct ThrustCheck {
    /// When the last order was recorded, and the heading then (rad).
    last: Option<(SimTime, f64)>,
    turn: Turn,
    way: Option<Way>,
    /// How far the boat has gone astern instead of ahead, m.
    astern_m: f64,
    /// The ordered heading (rad), and how long the boat has been off it (s).
    astray: Option<(f64, f64)>,
    sway: Sway,
    /// The boat's rate of turn, with the waves filtered out, rad/s.
    turn_rad_s: f64,
    fault: Option<ThrustFault>,
}

impl ThrustCheck {
    /// Records the current command and the boat's motion: heading (rad) and forward speed over the
    /// ground (m/s).
    pub(crate) fn observe(&mut self, now: SimTime, ordered: Ordered, nav: &Nav) {
        let Nav {
            psi_rad,
            surge_m_s: ahead_m_s,
            ..
        } = *nav;
        let before = self
            .last
            .replace((now, psi_rad))
            .filter(|(at, _)| (now - *at).as_s() <= GAP_MAX_S);
        let Some((before, before_rad)) = before else {
            // The boat's motion during a gap is unknown.
            *self = ThrustCheck {
                last: self.last,
                ..ThrustCheck::default()
            };
            return;
        };
        let turned_rad = wrap_pi(psi_rad - before_rad);
        let known = self
            .turn
            .observe(0.01 * ordered.turn_pct, (now - before).as_s(), turned_rad);
        if let Some((slope, sigma)) = known
            // A plain limit such as "full difference for 8 s and no turn" does not work: in a gale,
            // four simulated Surveyors were held like this, or turned the other way, for 15 s on 28
            // occasions in two hours.
            && slope + SIGMAS * sigma < TURN_MIN_RAD_S
        {
            self.fault = Some(ThrustFault::NoTurn((0.5 * slope).to_degrees()));
        }
        self.take_way(now, ordered.ahead_m_s, ahead_m_s);
        self.take_against((now - before).as_s(), ordered, nav, turned_rad);
    }

    /// Detects a boat that goes astern instead of ahead, or holds a heading other than the ordered
    /// one.
    fn take_against(&mut self, step_s: f64, ordered: Ordered, nav: &Nav, turned_rad: f64) {
        let Nav {
            surge_m_s,
            sway_m_s,
            psi_rad,
            ..
        } = *nav;
        self.turn_rad_s += (turned_rad - step_s * self.turn_rad_s) / step_s.max(TURN_LAG_S);
        let unrest = self.sway.observe(step_s, sway_m_s);
        let heading_rad = ordered
            .heading_rad
            .filter(|_| ordered.ahead_m_s >= AGAINST_FROM_M_S);
        // Measure along the bow: a boat that turns around moves against its ordered heading, but
        // never astern.
        let astern_m = self.astern_m - (surge_m_s + ASTERN_DRIFT_M_S) * step_s;
        self.astern_m = if ordered.ahead_m_s < AGAINST_FROM_M_S {
            0.0
        } else {
            astern_m.max(0.0)
        };
        let is_held = |(held_rad, _): &(f64, f64)| {
            heading_rad.is_some_and(|now| wrap_pi(now - held_rad).abs() < ASTRAY_RAD)
        };
        let before = self.astray.filter(is_held);
        let off_rad = heading_rad.map_or(0.0, |heading_rad| wrap_pi(heading_rad - psi_rad));
        let growth = match math::length(surge_m_s, sway_m_s) {
            speed_m_s if off_rad.abs() < ASTRAY_RAD || speed_m_s < ASTRAY_FROM_M_S => -2.0,
            _ if self.turn_rad_s * off_rad.signum() > ASTRAY_TURN_RAD_S => 0.0,
            // The boat keeps moving away from its destination.
            _ if off_rad.abs() > ASTRAY_AWAY_RAD => 2.0,
            _ => 1.0,
        };
        self.astray = before.or(heading_rad.map(|heading_rad| (heading_rad, 0.0)));
        let astray_s = self.astray.as_mut().map_or(0.0, |(_, astray_s)| {
            *astray_s = (*astray_s + growth * step_s).max(0.0);
            *astray_s
        });
        if self.astern_m > ASTERN_M + ASTERN_UNREST_M * unrest
            || astray_s > ASTRAY_S + ASTRAY_UNREST_S * unrest
        {
            let course_rad = psi_rad + math::atan2(sway_m_s, surge_m_s);
            let course_off_rad = wrap_pi(course_rad - ordered.heading_rad.unwrap_or(psi_rad)).abs();
            self.fault = Some(ThrustFault::Against(course_off_rad.to_degrees()));
        }
    }

    fn take_way(&mut self, now: SimTime, ordered_m_s: f64, ahead_m_s: f64) {
        if ordered_m_s < WAY_FROM_M_S {
            self.way = None;
            return;
        }
        let held = self.way.get_or_insert(Way {
            since: now,
            count: 0.0,
            ordered: 0.0,
            seen: 0.0,
        });
        held.count += 1.0;
        held.ordered += ordered_m_s;
        held.seen += ahead_m_s;
        if (now - held.since).as_s() >= WAY_S {
            // No current or gale alone reduces the speed to a tenth for 40 s. A gradual loss of
            // power is not detected.
            if held.seen < WAY_SHARE_MIN * held.ordered {
                self.fault = Some(ThrustFault::NoWay(held.seen / held.count));
            }
            self.way = None;
        }
    }

    /// The fault of a boat that is driven and fails to follow its orders, if any.
    pub(crate) fn fault(&self, now: SimTime) -> Option<ThrustFault> {
        self.fault.filter(|_| {
            self.last
                .is_some_and(|(at, _)| (now - at).as_s() <= GAP_MAX_S)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nav(psi_rad: f64, surge_m_s: f64) -> Nav {
        Nav {
            psi_rad,
            surge_m_s,
            ..Nav::default()
        }
    }

    /// The first fault, and when it occurs (s), for this order and motion of the boat.
    fn first_fault(
        ordered: impl Fn(f64) -> Ordered,
        turn_deg_s: impl Fn(f64) -> f64,
        ahead_m_s: f64,
    ) -> Option<(f64, ThrustFault)> {
        let mut check = ThrustCheck::default();
        let mut psi_deg = 0.0;
        (0..1000).find_map(|i| {
            let time_s = 0.1 * f64::from(i);
            psi_deg += 0.1 * turn_deg_s(time_s);
            let psi_rad = wrap_pi(f64::to_radians(psi_deg));
            check.observe(
                SimTime::from_s(time_s),
                ordered(time_s),
                &nav(psi_rad, ahead_m_s),
            );
            check
                .fault(SimTime::from_s(time_s))
                .map(|fault| (time_s, fault))
        })
    }

    fn held(ahead_m_s: f64, turn_pct: f64) -> impl Fn(f64) -> Ordered {
        move |_| Ordered {
            ahead_m_s,
            turn_pct,
            heading_rad: None,
        }
    }

    /// Turns to each side alternately, five seconds each.
    fn weaving(time_s: f64) -> Ordered {
        held(0.5, if time_s % 10.0 < 5.0 { 40.0 } else { -40.0 })(time_s)
    }

    #[test]
    fn a_heading_that_does_not_follow_the_thrust_difference_is_found_in_its_time() {
        for (turn_deg_s, words) in [(0.0, "held by the wind"), (5.0, "turned by the wind")] {
            let (after_s, fault) = first_fault(weaving, |_| turn_deg_s, 0.5).expect(words);
            assert!(
                after_s < 60.0 && matches!(fault, ThrustFault::NoTurn(_)),
                "{words}: {after_s} {fault}"
            );
        }
        let thwart = |time_s: f64| -0.2 * weaving(time_s).turn_pct;
        assert!(
            first_fault(weaving, thwart, 0.5).is_some(),
            "the thrusters are exchanged"
        );
        assert_eq!(
            first_fault(weaving, |time_s| 0.5 * weaving(time_s).turn_pct, 0.5),
            None,
            "it turns"
        );
        assert_eq!(
            first_fault(held(0.5, 40.0), |_| -3.0, 0.5),
            None,
            "one order alone shows nothing in the wind"
        );
    }

    #[test]
    fn a_boat_that_makes_no_way_under_thrust_is_found_in_its_time() {
        let (after_s, fault) = first_fault(held(2.0, 0.0), |_| 0.0, 0.1).expect("it lies still");
        assert!(
            (after_s - WAY_S).abs() < 0.3 && matches!(fault, ThrustFault::NoWay(_)),
            "{after_s} {fault}"
        );
        assert_eq!(
            first_fault(held(2.0, 0.0), |_| 0.0, 0.5),
            None,
            "slow, against the wind"
        );
        assert_eq!(
            first_fault(held(0.8, 0.0), |_| 0.0, 0.0),
            None,
            "too little to tell"
        );
    }

    /// When a fault occurs (s) for a boat ordered to this heading at 2 m/s, with this heading
    /// (degrees) and forward speed (m/s).
    fn against(heading_deg: f64, motion: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        let mut check = ThrustCheck::default();
        let heading_rad = Some(f64::to_radians(heading_deg));
        (0..300).map(|i| 0.1 * f64::from(i)).find(|time_s| {
            let (psi_deg, ahead_m_s) = motion(*time_s);
            let nav = nav(wrap_pi(psi_deg.to_radians()), ahead_m_s);
            check.observe(
                SimTime::from_s(*time_s),
                Ordered {
                    ahead_m_s: 2.0,
                    turn_pct: 0.0,
                    heading_rad,
                },
                &nav,
            );
            matches!(
                check.fault(SimTime::from_s(*time_s)),
                Some(ThrustFault::Against(_))
            )
        })
    }

    #[test]
    fn a_boat_that_moves_against_its_orders_is_found_in_its_time() {
        let taken_up = |time_s: f64| (0.5 * time_s).min(2.0);
        for (what, motion) in [
            (
                "astern",
                &(|time_s| (180.0, -taken_up(time_s))) as &dyn Fn(f64) -> (f64, f64),
            ),
            ("the wrong way", &|time_s| (0.0, taken_up(time_s))),
            ("the wrong way, and slow", &|_| (30.0, 0.6)),
            ("astern, as it turns", &|time_s| {
                (20.0 * f64::min(time_s, 9.0), -2.0)
            }),
        ] {
            let after_s = against(180.0, motion);
            assert!(
                after_s.is_some_and(|after_s| after_s < 10.0),
                "{what}: {after_s:?}"
            );
        }
        let across_s = against(180.0, |_| (130.0, 1.5));
        assert!(
            across_s.is_some_and(|after_s| after_s < 20.0),
            "50 degrees off: {across_s:?}"
        );
        for (what, motion) in [
            (
                "a turn about, slow",
                &(|time_s| (10.0 * f64::min(time_s, 18.0), 2.0)) as &dyn Fn(f64) -> (f64, f64),
            ),
            ("it went astern before", &|time_s| {
                (180.0, -2.0 + time_s.min(4.0))
            }),
            ("a current astern", &|_| (180.0, -0.4)),
            ("waves", &|time_s| {
                (180.0, 0.2 + 2.0 * math::sin_cos(time_s).0)
            }),
            ("some degrees off", &|_| (160.0, 2.0)),
        ] {
            assert_eq!(against(180.0, motion), None, "{what}");
        }
        assert!(
            first_fault(held(2.0, 0.0), |_| 10.0, -1.5).is_some_and(|(after_s, _)| after_s < 10.0),
            "by thrust"
        );
    }

    #[test]
    fn a_fault_is_over_when_the_boat_is_not_driven_and_begins_anew() {
        let mut check = ThrustCheck::default();
        let at = |tenths: i32| SimTime::from_s(0.1 * f64::from(tenths));
        (0..410).for_each(|i| check.observe(at(i), held(2.0, 0.0)(0.0), &nav(0.0, 0.0)));
        assert!(check.fault(at(410)).is_some() && check.fault(at(430)).is_none());
        check.observe(at(430), held(2.0, 0.0)(0.0), &nav(0.0, 0.0));
        assert_eq!(check.fault(at(430)), None);
    }
}
