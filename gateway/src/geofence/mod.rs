//! The geofence: where a boat may be, and whether it can stop there.

mod area;
#[cfg(test)]
mod tests;

pub use area::{GeofenceArea, GeofenceError};

use crate::config::Geofence;
use primitives::SimTime;
use primitives::frame::Ned;
use rules::field::Field;

/// Watches that a boat is inside of the geofence and can stop there.
#[derive(Clone, Debug)]
pub struct GeofenceWatch {
    area: GeofenceArea,
    rules: Geofence,
    /// Since when the boat is outside or about to be.
    since: Option<SimTime>,
}

impl GeofenceWatch {
    /// The geofence on this field.
    #[must_use]
    pub fn new(field: &Field, rules: &Geofence) -> GeofenceWatch {
        GeofenceWatch { area: GeofenceArea::new(field, rules), rules: rules.clone(), since: None }
    }

    /// Where the boat may be.
    #[must_use]
    pub fn area(&self) -> &GeofenceArea {
        &self.area
    }

    /// Whether a boat here with this velocity over the ground is inside and can stop inside. A breach counts after the
    /// debounce time.
    pub fn is_inside(&mut self, now: SimTime, at: Ned, velocity_m_s: Ned) -> bool {
        // The whole way is checked and not its end: the end alone could lie beyond a keep-out
        // or an inward corner.
        if self.area.contains_way(at, at + self.stopping_way(velocity_m_s)) {
            self.since = None;
            return true;
        }
        let since = *self.since.get_or_insert(now);
        // A fix that scatters across the line once is no breach.
        (now - since).as_s() < self.rules.debounce_s
    }

    /// The way to rest, m: reaction time at its speed, then v² / (2 a).
    #[must_use]
    pub fn stopping_way(&self, velocity_m_s: Ned) -> Ned {
        let speed_m_s = velocity_m_s.length();
        // v t + v²/2a. From 3 m/s a Surveyor needs some 18 m at the 0.25 m/s² that is estimated
        // for it, which is more than most people expect.
        velocity_m_s.scaled(self.rules.reaction_s + speed_m_s / (2.0 * self.rules.deceleration_m_s2))
    }
}
