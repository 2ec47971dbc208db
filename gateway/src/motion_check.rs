//! Checks a boat's instruments against each other: its compass against its course, its reported
//! speed against its positions.
//!
//! It checks only for faults that waves, leeway and current cannot imitate: a compass that does not
//! change in any digit while the course turns far, and positions that move faster than the reported
//! speed.

use crate::supervisor::NavFault;
use primitives::SimTime;
use primitives::angle::wrap_pi;
use primitives::frame::Ned;
use std::collections::VecDeque;

/// Maximum and minimum time (s) over which positions yield a speed.
const WINDOW_S: f64 = 4.0;
const WINDOW_MIN_S: f64 = 2.0;
/// Maximum number of positions stored: 20 a second.
const FIXES_MAX: usize = 80;
/// How far (m/s) and for how long (s) the reported speed may be below the speed from positions: a
/// fix may step by a few metres.
// At these limits, no sea, wind or position step alone triggers an alarm: a false alarm stops a
// boat in a game.
const SPEED_GAP_M_S: f64 = 1.2;
const SPEED_GAP_S: f64 = 2.5;
/// Minimum speed at which a course is meaningful, m/s.
const COURSE_FROM_M_S: f64 = 0.8;
/// Maximum time (s) between two fixes whose courses are compared.
const COURSE_GAP_MAX_S: f64 = 1.0;
/// Turn of the course (rad) that counts as a fault if the compass does not change.
const TURN_MAX_RAD: f64 = std::f64::consts::FRAC_PI_3;

/// A boat's motion according to each instrument.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionCheck {
    /// Positions, the newest last.
    fixes: VecDeque<(SimTime, Ned)>,
    /// When the reported speed first fell below the speed from positions.
    slow_since: Option<SimTime>,
    /// The compass heading, and the turn of the course since the heading last changed, rad.
    shown: Option<(f64, f64)>,
    /// The last course (rad), its time, and whether it was reported.
    course: Option<(SimTime, bool, f64)>,
}

impl MotionCheck {
    /// Adds a position, with the reported velocity if any.
    pub(crate) fn take_fix(&mut self, now: SimTime, place: Ned, reported: Option<Ned>) {
        while self
            .fixes
            .front()
            .is_some_and(|(at, _)| (now - *at).as_s() > WINDOW_S)
            || self.fixes.len() >= FIXES_MAX
        {
            self.fixes.pop_front();
        }
        self.fixes.push_back((now, place));
        let measured = self.velocity_m_s();
        let is_slow = reported.zip(measured).is_some_and(|(reported, measured)| {
            measured.length() - reported.length() > SPEED_GAP_M_S
        });
        self.slow_since = is_slow.then(|| self.slow_since.unwrap_or(now));
        // A position step gives a wrong course, so the reported velocity takes precedence.
        self.take_course(
            now,
            reported.is_some(),
            reported
                .or(measured)
                .filter(|velocity| velocity.length() >= COURSE_FROM_M_S),
        );
    }

    fn take_course(&mut self, now: SimTime, is_reported: bool, velocity: Option<Ned>) {
        let course_rad = velocity.map(Ned::direction_rad);
        // Between fixes far apart in time, a boat may have gone astern. Courses from different
        // sources are not compared: positions may step when the reported velocity does not.
        let is_like = |at: SimTime, reported: bool| {
            (now - at).as_s() <= COURSE_GAP_MAX_S && reported == is_reported
        };
        let before = self
            .course
            .filter(|(at, reported, _)| is_like(*at, *reported));
        if let (Some((_, turned_rad)), Some((.., before_rad)), Some(now_rad)) =
            (&mut self.shown, before, course_rad)
        {
            // Sum with signs: waves swing the course back and forth by more than 60 degrees in
            // total, whereas a turn accumulates.
            *turned_rad += wrap_pi(now_rad - before_rad);
        }
        self.course = course_rad.map(|course_rad| (now, is_reported, course_rad));
    }

    /// Adds a compass heading (rad).
    pub(crate) fn take_heading(&mut self, psi_rad: f64) {
        // Compare exactly: the last digit of a working compass changes all the time.
        if self.shown.is_none_or(|(shown_rad, _)| shown_rad != psi_rad) {
            self.shown = Some((psi_rad, 0.0));
        }
    }

    /// Records that the receiver's position has jumped: older positions no longer yield a speed.
    pub(crate) fn jump(&mut self) {
        self.fixes.clear();
        (self.slow_since, self.course) = (None, None);
    }

    /// Velocity over the ground from positions alone, m/s: from the centre of the older positions
    /// to that of the newer ones.
    pub(crate) fn velocity_m_s(&self) -> Option<Ned> {
        let (first, _) = self.fixes.front()?;
        let (last, _) = self.fixes.back()?;
        if (*last - *first).as_s() < WINDOW_MIN_S {
            return None;
        }
        // Use the means of both halves, not the first and last fix: a single position step would
        // look like speed.
        let half = self.fixes.len() / 2;
        let middle = |fixes: &mut dyn Iterator<Item = &(SimTime, Ned)>| {
            let mut count = 0.0;
            let mut time_s = 0.0;
            let mut place = Ned::default();
            for (at, fix) in fixes {
                (count, time_s, place) =
                    (count + 1.0, time_s + (*at - *first).as_s(), place + *fix);
            }
            (time_s / count, place.scaled(1.0 / count))
        };
        let (older_s, older) = middle(&mut self.fixes.iter().take(half));
        let (newer_s, newer) = middle(&mut self.fixes.iter().skip(half));
        Some((newer - older).scaled(1.0 / (newer_s - older_s)))
    }

    /// The current fault, if any.
    pub(crate) fn fault(&self, now: SimTime) -> Option<NavFault> {
        let turned = self
            .shown
            .map(|(_, turned_rad)| turned_rad.abs())
            .filter(|turned_rad| *turned_rad > TURN_MAX_RAD);
        let is_slow = self
            .slow_since
            .is_some_and(|since| (now - since).as_s() > SPEED_GAP_S);
        turned
            .map(|turned_rad| NavFault::CompassFrozen(turned_rad.to_degrees()))
            .or_else(|| {
                is_slow.then(|| NavFault::SpeedTooLow(self.velocity_m_s().map_or(0.0, Ned::length)))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drives a circle at this speed and rate of turn for 20 s, with these instrument readings;
    /// returns the fault.
    fn circle(
        speed_m_s: f64,
        turn_deg_s: f64,
        compass: impl Fn(f64) -> f64,
        log: impl Fn(Ned) -> Option<Ned>,
    ) -> Option<NavFault> {
        let mut check = MotionCheck::default();
        let mut place = Ned::default();
        (0..200).find_map(|i| {
            let now = SimTime::from_s(0.1 * f64::from(i));
            let course_deg = turn_deg_s * 0.1 * f64::from(i);
            let velocity = Ned::toward_deg(course_deg).scaled(speed_m_s);
            place = place + velocity.scaled(0.1);
            check.take_heading(wrap_pi(compass(course_deg).to_radians()));
            check.take_fix(now, place, log(velocity));
            check.fault(now)
        })
    }

    #[test]
    fn a_compass_that_shows_the_same_on_every_course_is_frozen() {
        let is_frozen =
            |fault| matches!(fault, Some(NavFault::CompassFrozen(turned_deg)) if turned_deg < 64.0);
        for turn_deg_s in [5.0, -5.0, 30.0] {
            assert!(
                is_frozen(circle(2.6, turn_deg_s, |_| 90.0, Some)),
                "{turn_deg_s}"
            );
        }
        // A compass that turns is not stuck, even with a large offset; nor is that of a boat that
        // drives straight or lies still.
        assert_eq!(
            circle(2.6, 20.0, |course_deg| course_deg + 70.0, Some),
            None
        );
        assert_eq!(circle(2.6, 0.0, |_| 90.0, Some), None);
        assert_eq!(circle(0.3, 20.0, |_| 90.0, Some), None);
    }

    #[test]
    fn a_speed_that_is_less_than_that_of_the_positions_is_a_fault_and_one_that_is_more_is_none() {
        let stuck = |speed_m_s, log: fn(Ned) -> Option<Ned>| {
            circle(speed_m_s, 0.0, |course_deg| course_deg, log)
        };
        let Some(NavFault::SpeedTooLow(measured)) = stuck(2.0, |_| Some(Ned::default())) else {
            panic!("no fault")
        };
        assert!((measured - 2.0).abs() < 0.01, "{measured}");
        assert_eq!(
            stuck(2.0, |velocity| Some(velocity.scaled(0.5))),
            None,
            "within the step of a fix"
        );
        assert_eq!(
            stuck(0.0, |_| Some(Ned {
                north: 2.0,
                east: 0.0
            })),
            None
        );
        assert_eq!(stuck(2.0, |_| None), None, "nothing is reported");
    }

    #[test]
    fn a_boat_that_went_astern_while_there_were_no_fixes_has_no_frozen_compass() {
        let mut check = MotionCheck::default();
        for i in 0..100_i32 {
            let now = SimTime::from_s(0.1 * f64::from(i));
            let ahead_m_s = if i < 50 { 1.0 } else { -1.0 };
            check.take_heading(0.5);
            if !(40..60).contains(&i) {
                check.take_fix(
                    now,
                    Ned::default(),
                    Some(Ned {
                        north: ahead_m_s,
                        east: 0.0,
                    }),
                );
            }
            assert_eq!(check.fault(now), None, "at {now}");
        }
    }
}
