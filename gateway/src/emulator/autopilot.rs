//! The emulated boat's own controller: set-points, station keeping, missions.

use crate::config::SURVEYOR_THRUST_MAP;
use messages::Order;
use primitives::angle::wrap_pi;
use primitives::frame::{Ned, Pose};
use primitives::math;
use std::collections::BTreeMap;

/// Distance (m) within which a position counts as reached or kept.
const NEAR_M: f64 = 3.0;
/// Maximum speed of a boat returning to its station, m/s.
const KEEP_M_S: f64 = 1.0;
/// Approach speed per distance from the position, m/s per m.
const APPROACH_PER_S: f64 = 0.2;
/// Thrust difference of a boat going astern: per cent per rad, and maximum per cent.
const ASTERN_PCT_PER_RAD: f64 = 30.0;
const ASTERN_DIFFERENCE_PCT: f64 = 20.0;
/// Throttle of a mission without a specified throttle, per cent.
const THROTTLE_PCT: f64 = 40.0;

/// The state of the controller.
#[derive(Clone, Debug, Default)]
pub(super) struct Autopilot {
    /// Waypoints by index; 0 is the emergency recovery point.
    places: BTreeMap<u16, Ned>,
    throttle_pct: Option<f64>,
    /// Speed of a mission, if specified, m/s.
    pub(super) speed_m_s: Option<f64>,
    /// The mission being uploaded, if any.
    upload: Option<Upload>,
    /// Where the boat stays without a destination.
    pub(super) station: Option<Ned>,
    /// The next waypoint, counted from 1.
    pub(super) next: u16,
}

/// A mission being uploaded.
#[derive(Clone, Debug, Default)]
struct Upload {
    /// Number of announced lines, and of received lines.
    announced: f64,
    lines: u32,
    throttle_pct: Option<f64>,
    places: BTreeMap<u16, Ned>,
}

/// The order for thrust and difference in per cent.
pub(super) fn thrust(thrust_pct: f64, difference_pct: f64) -> Order {
    let share = |pct: f64| (0.01 * pct).clamp(-1.0, 1.0);
    Order::Thrust {
        port: share(thrust_pct + difference_pct),
        starboard: share(thrust_pct - difference_pct),
    }
}

/// The order for a heading and a speed; both must be given.
pub(super) fn steer(heading_rad: Option<f64>, speed_m_s: Option<f64>) -> Order {
    match (heading_rad, speed_m_s) {
        (Some(heading_rad), Some(speed_m_s)) => Order::Steer {
            heading_rad: wrap_pi(heading_rad),
            speed_m_s: speed_m_s.clamp(0.0, 100.0),
        },
        _ => Order::Hold,
    }
}

/// The order to go astern at this speed (m/s) and turn the bow by this angle (rad).
pub(super) fn astern(speed_m_s: f64, turn_rad: f64) -> Order {
    let map = SURVEYOR_THRUST_MAP
        .iter()
        .map(|(thrust, speed)| (*speed, *thrust));
    let difference_pct =
        (ASTERN_PCT_PER_RAD * turn_rad).clamp(-ASTERN_DIFFERENCE_PCT, ASTERN_DIFFERENCE_PCT);
    thrust(math::interpolate(map, speed_m_s), difference_pct)
}

/// The forward speed at a thrust, m/s.
pub(super) fn speed_of_thrust(thrust_pct: f64) -> f64 {
    math::interpolate(SURVEYOR_THRUST_MAP, thrust_pct.clamp(0.0, 100.0))
}

impl Autopilot {
    /// Starts a new task at this position.
    pub(super) fn begin(&mut self, at: Ned) {
        self.station = Some(at);
        self.next = 1;
    }

    /// Sets the recovery point.
    pub(super) fn set_home(&mut self, home: Ned) {
        self.places.insert(0, home);
    }

    /// Sets a complete mission with its speed (m/s), if specified; the recovery point stays.
    pub(super) fn set_mission(&mut self, waypoints: Vec<Ned>, speed_m_s: Option<f64>) {
        // Place 0 is the home, which a mission does not replace.
        self.places.retain(|index, _| *index == 0);
        self.places.extend((1..).zip(waypoints));
        (self.speed_m_s, self.next) = (speed_m_s, 1);
    }

    /// Starts an upload, which deletes the previous mission.
    pub(super) fn begin_download(&mut self, announced: f64) {
        self.places.clear();
        self.throttle_pct = None;
        self.upload = Some(Upload {
            announced,
            ..Upload::default()
        });
    }

    /// Ends the upload; returns a message. If a line is missing, there is no mission.
    pub(super) fn end_download(&mut self) -> Option<String> {
        let upload = self.upload.take()?;
        // It is not known how a real Surveyor handles an incomplete upload. The strictest behaviour
        // tests that our own uploads are complete.
        if f64::from(upload.lines) != upload.announced {
            return Some(format!(
                "mission refused: {} lines were announced, {} could be read",
                upload.announced, upload.lines
            ));
        }
        (self.places, self.throttle_pct) = (upload.places, upload.throttle_pct);
        Some(format!(
            "a mission of {} places is accepted",
            self.places.len()
        ))
    }

    pub(super) fn take_throttle(&mut self, throttle_pct: f64) {
        if let Some(upload) = &mut self.upload {
            upload.lines += 1;
            upload.throttle_pct = Some(throttle_pct);
        }
    }

    /// Sets a waypoint; ignored outside an upload.
    pub(super) fn take_waypoint(&mut self, index: u16, at: Ned) {
        if let Some(upload) = &mut self.upload {
            upload.lines += 1;
            upload.places.insert(index, at);
        }
    }

    /// Keeps station.
    pub(super) fn keep(&mut self, pose: Pose) -> Order {
        let station = *self.station.get_or_insert(pose.at);
        go(pose, station, KEEP_M_S).unwrap_or(Order::Hold)
    }

    /// Goes to a position at the given speed (m/s) and keeps station there.
    pub(super) fn go_to(&mut self, pose: Pose, place: Ned, speed_m_s: f64) -> Order {
        self.station = Some(place);
        go(pose, place, speed_m_s).unwrap_or(Order::Hold)
    }

    /// Goes to the recovery point and stays there; without one, stays where it is.
    pub(super) fn go_to_erp(&mut self, pose: Pose) -> Order {
        match self.places.get(&0) {
            Some(erp) => go(pose, *erp, self.speed_m_s()).unwrap_or(Order::Hold),
            None => self.keep(pose),
        }
    }

    /// Follows the mission, and stays at its end.
    pub(super) fn sail(&mut self, pose: Pose) -> Order {
        while let Some(place) = self.places.get(&self.next.max(1)).copied() {
            if let Some(order) = go(pose, place, self.speed_m_s()) {
                return order;
            }
            // A reached waypoint becomes the station, so that the boat stays where the mission
            // ended.
            self.next = self.next.max(1) + 1;
            self.station = Some(place);
        }
        self.keep(pose)
    }

    fn speed_m_s(&self) -> f64 {
        self.speed_m_s
            .unwrap_or_else(|| speed_of_thrust(self.throttle_pct.unwrap_or(THROTTLE_PCT)))
    }
}

/// The order to go to a position; `None` if the boat has reached it. The speed is low near the
/// position, and while the boat points elsewhere.
fn go(pose: Pose, place: Ned, speed_m_s: f64) -> Option<Order> {
    let distance_m = pose.at.distance(place);
    if distance_m <= NEAR_M {
        return None;
    }
    let heading_rad = pose.at.bearing_rad(place);
    let (_, ahead) = math::sin_cos(wrap_pi(heading_rad - pose.psi_rad));
    // A boat that points elsewhere turns first; at full thrust it would circle its station.
    let share = ahead.max(0.0) * ahead.max(0.0);
    let limit_m_s = (APPROACH_PER_S * distance_m).min(speed_m_s);
    Some(Order::Steer {
        heading_rad,
        speed_m_s: limit_m_s * share,
    })
}
