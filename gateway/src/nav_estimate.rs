//! The navigation estimate of a real boat, computed from its reports, and the faults in them.
//!
//! Position and velocity over the ground come from the last good fix, heading and rate of turn from
//! the last attitude. Bad data is reported as a [`NavFault`], never hidden: a repeated or doubtful
//! fix does not refresh the last good one.

use crate::compass_check::CompassCheck;
use crate::config::NavWatch;
use crate::geodesy::LocalFrame;
use crate::motion_check::MotionCheck;
use crate::nmea::{FixQuality, TimeOfDay};
use crate::protocol::{self, North, Report};
use crate::supervisor::NavFault;
use crate::thrust_check::{Ordered, ThrustCheck, ThrustFault};
use messages::picture::Nav;
use primitives::SimTime;
use primitives::angle::{rad_from_compass_deg, wrap_pi};
use primitives::frame::{Body, LatLon, Ned, Rotation, body_from_ned};

/// Time (s) for which the position must be consistent after a jump to be trusted again.
const JUMP_MEMORY_S: f64 = 2.0;
/// Lifetime of a reported velocity, s; after that, velocity is computed from positions.
const VELOCITY_AGE_MAX_S: f64 = 1.5;
/// Valid compass readings, degrees; other values count as missing.
pub(crate) const HEADINGS_DEG: std::ops::RangeInclusive<f64> = -180.0..=360.0;
/// Time (s) after the last command with thrust for which the boat counts as under thrust.
const THRUST_MEMORY_S: f64 = 0.5;
/// Minimum commanded speed (m/s) at which the position must change.
const THRUST_FROM_M_S: f64 = 0.5;
/// Lifetime of a command, s.
const ORDERED_MEMORY_S: f64 = 1.5;

/// A valid fix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fix {
    at: SimTime,
    raw: LatLon,
    place: Ned,
}

/// A true heading.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Heading {
    at: SimTime,
    psi_rad: f64,
    yaw_rate_rad_s: f64,
}

/// Estimates a boat's motion from its reports.
#[derive(Clone, Debug)]
pub(crate) struct NavEstimator {
    frame: LocalFrame,
    watch: NavWatch,
    /// Correction from the boat's compass reference, such as magnetic north, to true north, rad.
    compass_to_true_rad: f64,
    speed_max_m_s: f64,
    known: Known,
}

/// The variable state.
#[derive(Clone, Debug, Default)]
struct Known {
    fix: Option<Fix>,
    /// Velocity over the ground, and when it was reported; `None` if it was computed from
    /// positions.
    velocity: Option<(Option<SimTime>, Ned)>,
    /// Heading (true) and rate of turn.
    heading: Option<Heading>,
    /// The fault of the receiver's last fix, if any.
    doubt: Option<NavFault>,
    /// Quality and dilution from the last fix that reported them.
    told: Option<(Option<FixQuality>, Option<f64>)>,
    jumped: Option<(SimTime, f64)>,
    time_of_fix: Option<TimeOfDay>,
    /// When the position last changed in any digit under thrust.
    still_since: Option<SimTime>,
    motion: MotionCheck,
    compass: CompassCheck,
    thrust: ThrustCheck,
    /// The boat's last command and its time; the time of the last command with thrust.
    ordered: Option<(SimTime, Ordered)>,
    thrust_at: Option<SimTime>,
}

impl NavEstimator {
    /// An estimate without data.
    pub(crate) fn new(
        frame: LocalFrame,
        watch: NavWatch,
        compass_to_true_rad: f64,
        speed_max_m_s: f64,
    ) -> NavEstimator {
        NavEstimator {
            frame,
            watch,
            compass_to_true_rad,
            speed_max_m_s,
            known: Known::default(),
        }
    }

    /// A position on the field.
    pub(crate) fn place(&self, lat_deg: f64, lon_deg: f64) -> Ned {
        self.frame.ned(LatLon { lat_deg, lon_deg })
    }

    /// Discards all data: the next data may come from a different boat, or from the same boat
    /// elsewhere.
    pub(crate) fn forget(&mut self) {
        self.known = Known::default();
    }

    /// Adds a report; returns whether it changed the estimate.
    pub(crate) fn update(&mut self, now: SimTime, report: &Report) -> bool {
        match report {
            Report::Fix(fix) => self.take_fix(now, fix),
            Report::Velocity(velocity) => {
                self.known.velocity = Some((Some(now), *velocity));
                true
            }
            Report::Heading(heading) => self.take_heading(now, heading),
            _ => false,
        }
    }

    /// Records a command just sent to the boat.
    pub(crate) fn note_order(&mut self, now: SimTime, ordered: Ordered) {
        self.known.ordered = Some((now, ordered));
        if ordered.ahead_m_s.abs() >= THRUST_FROM_M_S {
            self.known.thrust_at = Some(now);
        }
        if let Some((nav, _)) = self.nav(now) {
            self.known.thrust.observe(now, ordered, &nav);
        }
    }

    /// The fault of a boat that fails to follow its orders, if any.
    pub(crate) fn thrust_fault(&self, now: SimTime) -> Option<ThrustFault> {
        self.known.thrust.fault(now)
    }

    /// The boat's motion, and the age of its fix, s; `None` before the first fix and heading.
    pub(crate) fn nav(&self, now: SimTime) -> Option<(Nav, f64)> {
        let (
            fix,
            Heading {
                psi_rad,
                yaw_rate_rad_s,
                ..
            },
        ) = (self.known.fix?, self.known.heading?);
        let velocity = self.velocity_m_s();
        let body: Body = body_from_ned(Rotation::from_heading(psi_rad), velocity);
        let nav = Nav {
            north_m: fix.place.north,
            east_m: fix.place.east,
            psi_rad,
            surge_m_s: body.ahead,
            sway_m_s: body.starboard,
            yaw_rate_rad_s,
        };
        Some((nav, (now - fix.at).as_s()))
    }

    /// Velocity over the ground, m/s.
    pub(crate) fn velocity_m_s(&self) -> Ned {
        self.known
            .velocity
            .map_or_else(Ned::default, |(_, velocity)| velocity)
    }

    /// Velocity over the ground for predicting the stopping distance, m/s: the reported velocity or
    /// that from positions, whichever is faster.
    pub(crate) fn fastest_velocity_m_s(&self) -> Ned {
        let reported = self.velocity_m_s();
        let measured = self.known.motion.velocity_m_s().unwrap_or_default();
        if measured.length() > reported.length() {
            measured
        } else {
            reported
        }
    }

    /// The current navigation fault, if any.
    pub(crate) fn fault(&self, now: SimTime) -> Option<NavFault> {
        let Some(fix) = &self.known.fix else {
            return Some(self.known.doubt.unwrap_or(NavFault::NoFix));
        };
        let Some(heading) = self.known.heading else {
            return Some(NavFault::NoHeading);
        };
        let fix_age_s = (now - fix.at).as_s();
        let heading_age_s = (now - heading.at).as_s();
        let jump = self
            .known
            .jumped
            .filter(|(at, _)| (now - *at).as_s() < JUMP_MEMORY_S);
        let still_s = self
            .known
            .still_since
            .map_or(0.0, |since| (now - since).as_s());
        self.known
            .doubt
            // In this order, because operators see only one cause: first the receiver's own report,
            // then old data, then contradictions.
            .or(jump.map(|(_, by_m)| NavFault::Jump(by_m)))
            .or((fix_age_s > self.watch.age_max_s).then_some(NavFault::FixStale(fix_age_s)))
            .or((heading_age_s > self.watch.age_max_s)
                .then_some(NavFault::HeadingStale(heading_age_s)))
            .or((still_s > self.watch.frozen_s).then_some(NavFault::Frozen(still_s)))
            .or_else(|| self.known.motion.fault(now))
            .or_else(|| {
                self.known
                    .compass
                    .fault_rad()
                    .map(|off_rad| NavFault::CompassOff(off_rad.to_degrees()))
            })
    }

    fn take_fix(&mut self, now: SimTime, fix: &protocol::Fix) -> bool {
        let doubt = self.doubt_of(fix);
        // A boat may send the same fix in two sentences. Sometimes only the second one shows that
        // the fix is bad.
        if self.is_repeated(fix.time, fix.at) {
            self.known.doubt = doubt.or(self.known.doubt);
            return false;
        }
        self.known.time_of_fix = fix.time;
        self.take_position(now, fix.at, doubt)
    }

    /// The receiver's own evidence against its fix.
    fn doubt_of(&mut self, fix: &protocol::Fix) -> Option<NavFault> {
        // RMC reports neither quality nor dilution, so those of the preceding GGA also apply to it;
        // otherwise each RMC would clear a position fault. Either sentence alone can report that
        // there is no fix.
        let told = self
            .known
            .told
            .filter(|_| fix.quality.is_none())
            .unwrap_or((fix.quality, fix.hdop));
        if fix
            .quality
            .is_some_and(|quality| quality != FixQuality::NONE)
        {
            self.known.told = Some(told);
        }
        let (quality, hdop) = told;
        let poor = quality.filter(|quality| !quality.meets(self.watch.quality_min));
        let bad_hdop = hdop.filter(|hdop| *hdop > self.watch.hdop_max);
        match (poor, fix.at) {
            (Some(quality), _) => Some(NavFault::Quality(quality)),
            (None, None) => Some(NavFault::Quality(FixQuality::NONE)),
            (None, Some(_)) => bad_hdop.map(NavFault::Dilution),
        }
    }

    /// Whether a fix repeats the last one. Receivers that stamp whole seconds may send several new
    /// fixes in one second.
    fn is_repeated(&self, time: Option<TimeOfDay>, at: Option<LatLon>) -> bool {
        let same_place = self.known.fix.map(|fix| fix.raw) == at || self.known.fix.is_none();
        time.is_some() && time == self.known.time_of_fix && same_place
    }

    fn take_position(&mut self, now: SimTime, at: Option<LatLon>, doubt: Option<NavFault>) -> bool {
        let at = match (doubt, at) {
            (None, Some(at)) if at.lat_deg == 0.0 && at.lon_deg == 0.0 => {
                self.known.doubt = Some(NavFault::ZeroZero);
                return false;
            }
            (None, Some(at)) => at,
            (doubt, _) => {
                self.known.doubt = doubt;
                return false;
            }
        };
        self.known.doubt = None;
        let place = self.frame.ned(at);
        if let Some(before) = self.known.fix {
            let since_s = (now - before.at).as_s();
            let moved = place - before.place;
            // The fix itself is used from now on, because the new position may be right. The fault
            // lasts until positions have agreed for two seconds.
            if moved.length() > self.speed_max_m_s * since_s + self.watch.jump_m {
                self.known.jumped = Some((now, moved.length()));
                // The earlier velocity belongs to the old position.
                self.known.velocity = None;
                self.known.motion.jump();
                self.known.compass.interrupt();
            // Not in a burst of fixes, where the noise would be divided by nearly zero.
            } else if !self.is_velocity_reported(now) && since_s > 0.05 {
                self.known.velocity = Some((None, moved.scaled(1.0 / since_s)));
            }
            let pushed = self
                .known
                .thrust_at
                .is_some_and(|at| (now - at).as_s() < THRUST_MEMORY_S);
            // Without thrust, the position of a boat at rest may well stay the same in every digit.
            self.known.still_since =
                (before.raw == at && pushed).then(|| self.known.still_since.unwrap_or(before.at));
        }
        let reported = self.is_velocity_reported(now).then(|| self.velocity_m_s());
        self.known.motion.take_fix(now, place, reported);
        self.known.fix = Some(Fix {
            at: now,
            raw: at,
            place,
        });
        let ordered = self
            .known
            .ordered
            .filter(|(at, _)| (now - *at).as_s() <= ORDERED_MEMORY_S);
        if let (Some((_, ordered)), Some(heading), Some(velocity)) =
            (ordered, self.known.heading, reported)
        {
            self.known
                .compass
                .observe(now, heading.psi_rad, velocity, ordered.ahead_m_s);
        }
        true
    }

    fn is_velocity_reported(&self, now: SimTime) -> bool {
        let reported = self.known.velocity.and_then(|(reported, _)| reported);
        reported.is_some_and(|at| (now - at).as_s() <= VELOCITY_AGE_MAX_S)
    }

    fn take_heading(&mut self, now: SimTime, heading: &protocol::Heading) -> bool {
        if !HEADINGS_DEG.contains(&heading.deg) {
            return false;
        }
        let psi_rad = match heading.north {
            North::True => rad_from_compass_deg(heading.deg),
            // A Surveyor's headings are magnetic; its receiver's courses are true.
            North::Compass => wrap_pi(rad_from_compass_deg(heading.deg) + self.compass_to_true_rad),
        };
        self.known.motion.take_heading(psi_rad);
        let turned_rad_s = || {
            let Some(before) = self.known.heading else {
                return 0.0;
            };
            let since_s = (now - before.at).as_s();
            if since_s > 0.02 {
                wrap_pi(psi_rad - before.psi_rad) / since_s
            } else {
                before.yaw_rate_rad_s
            }
        };
        let yaw_rate_rad_s = heading
            .yaw_rate_deg_s
            .map_or_else(turned_rad_s, f64::to_radians);
        self.known.heading = Some(Heading {
            at: now,
            psi_rad,
            yaw_rate_rad_s,
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rmc_takes_back_nothing_that_gga_says_against_a_fix_in_either_order() {
        let origin = LatLon {
            lat_deg: 42.0,
            lon_deg: -71.0,
        };
        let watch = crate::config::default_gateway().nav;
        for (quality, hdop, is_first) in [
            (6, 0.9, true),
            (6, 0.9, false),
            (1, 9.0, true),
            (1, 9.0, false),
        ] {
            let mut estimator = NavEstimator::new(LocalFrame::new(origin), watch, 0.0, 3.0);
            for second in 1..=3_u32 {
                let time = Some(TimeOfDay(1000 * second));
                let at = Some(LatLon {
                    lat_deg: 42.0 + 1e-5 * f64::from(second),
                    ..origin
                });
                let rmc = protocol::Fix {
                    time,
                    at,
                    ..protocol::Fix::default()
                };
                let gga = protocol::Fix {
                    quality: Some(FixQuality::from_gga(quality)),
                    hdop: Some(hdop),
                    ..rmc
                };
                let now = SimTime::from_s(f64::from(second));
                for fix in if is_first { [gga, rmc] } else { [rmc, gga] } {
                    estimator.update(now, &Report::Fix(fix));
                    let is_known = second > 1 || fix.quality.is_some();
                    let fault = estimator.known.doubt;
                    assert!(
                        fault.is_some() || !is_known,
                        "{quality} {hdop} {is_first}: {fix:?}"
                    );
                }
            }
        }
    }
}
