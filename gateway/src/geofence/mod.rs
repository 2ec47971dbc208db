//! The geofence: where a boat may be, and whether it can stop there.

mod area;
mod coasting;
#[cfg(test)]
mod tests;

pub use area::{GeofenceArea, GeofenceError};
pub use coasting::Coasting;

use crate::config::Geofence;
use coasting::{DriftEstimate, Glide, Leg};
use primitives::SimTime;
use primitives::frame::Ned;
use rules::field::Field;

/// Time from the end of the debounce time to zero thrust at the boat, s: a tick, the link, the
/// boat's own cycle.
const COMMAND_S: f64 = 0.5;
/// Time (s) for which the path must be clear before a breach by drift ends.
const BREACH_ENDS_S: f64 = 2.0;

/// Checks that a boat is inside the geofence and can stop there.
#[derive(Clone, Debug)]
pub struct GeofenceWatch {
    /// Where the boat may be.
    pub(crate) area: GeofenceArea,
    rules: Geofence,
    /// `None` if no boat file is known.
    coasting: Option<Coasting>,
    drift: DriftEstimate,
    /// Current or imminent breaches: on the straight path, and on the path with drift and turn.
    straight: Breach,
    drifting: Breach,
}

/// A breach, from its start.
#[derive(Clone, Copy, Debug, Default)]
struct Breach {
    /// When the breach began, and when it was last seen.
    between: Option<(SimTime, SimTime)>,
}

impl Breach {
    /// Whether the path is clear, or has been blocked for less than `debounce_s`. A breach ends
    /// when paths have been clear for more than `ends_s`.
    fn is_well(&mut self, now: SimTime, is_clear: bool, (debounce_s, ends_s): (f64, f64)) -> bool {
        if is_clear {
            self.between = self
                .between
                .filter(|(_, last)| (now - *last).as_s() <= ends_s);
            return true;
        }
        let since = self.between.map_or(now, |(since, _)| since);
        self.between = Some((since, now));
        (now - since).as_s() < debounce_s
    }
}

impl GeofenceWatch {
    /// The geofence on this field, for a boat with this coasting model.
    pub fn new(field: &Field, rules: &Geofence, coasting: Option<Coasting>) -> GeofenceWatch {
        GeofenceWatch::of_area(GeofenceArea::new(field, rules), rules, coasting)
    }

    fn of_area(area: GeofenceArea, rules: &Geofence, coasting: Option<Coasting>) -> GeofenceWatch {
        GeofenceWatch {
            area,
            rules: rules.clone(),
            coasting: coasting.map(|coasting| coasting.as_measured(&rules.coast_m)),
            drift: DriftEstimate::default(),
            straight: Breach::default(),
            drifting: Breach::default(),
        }
    }

    /// Records that the boat, at this heading and velocity over the ground, receives a set-point
    /// with this steady forward speed (m/s).
    pub fn note_order(&mut self, now: SimTime, ahead_m_s: f64, motion: (f64, Ned)) {
        if let Some(coasting) = &self.coasting {
            self.drift.observe(coasting, now, ahead_m_s, motion);
        }
    }

    /// Whether a boat at this position, with this velocity over the ground and rate of turn, is
    /// inside and can stop inside. A breach counts after the debounce time.
    pub fn is_inside(&mut self, now: SimTime, at: Ned, motion: (Ned, f64)) -> bool {
        let room_m = self.area.clearance_m(at);
        // Check the whole path, not only its end, which could lie beyond a keep-out or a concave
        // corner.
        let is_clear = |path: &Vec<Leg>| {
            let mut from = at;
            path.iter().all(|leg| {
                let end = at + leg.end;
                let start = std::mem::replace(&mut from, end);
                // In a turn, slack adds up until it exceeds the distance that the boat can travel.
                // Far from the edge, checking that distance is enough.
                room_m > leg.reach_m
                    || self.area.contains_way(start, end)
                        && (leg.slack_m == 0.0 || self.area.clearance_m(end) >= leg.slack_m)
            })
        };
        let is_straight_clear =
            self.area.contains(at) && self.straight_paths(motion.0).iter().all(is_clear);
        let is_drift_clear = self.drifting_path(now, motion).iter().all(is_clear);
        // A single fix scattered across the fence is not a breach. In waves a boat yaws, and its
        // path to rest swings with it, so a momentarily clear path does not end a breach.
        let is_well = [
            self.straight
                .is_well(now, is_straight_clear, (self.rules.debounce_s, 0.0)),
            self.drifting
                .is_well(now, is_drift_clear, (self.rules.debounce_s, BREACH_ENDS_S)),
        ];
        is_well == [true; 2]
    }

    /// The straight paths to rest, as in still water, from the boat's position; all must be clear.
    fn straight_paths(&self, velocity_m_s: Ned) -> Vec<Vec<Leg>> {
        let Geofence {
            deceleration_m_s2,
            coast_m,
            ..
        } = &self.rules;
        let speed_m_s = velocity_m_s.length();
        let reaction_s = self.reaction_s();
        // v t + v²/2a: needs no boat file, and is most accurate at high speed. Water resistance
        // falls with speed, so below 2 m/s boats coast farther than any constant deceleration
        // predicts.
        let braked = velocity_m_s.scaled(reaction_s + speed_m_s / (2.0 * deceleration_m_s2));
        let braked = Leg {
            end: braked,
            slack_m: 0.0,
            reach_m: braked.length(),
        };
        let Some(coasting) = &self.coasting else {
            return vec![vec![braked]];
        };
        let still = Glide {
            water_m_s: velocity_m_s,
            drift_m_s: Ned::default(),
            transient_m_s: Ned::default(),
            thrust_m_s: speed_m_s,
            yaw_rate_rad_s: 0.0,
            reaction_s,
        };
        let mut paths = vec![coasting.path(&still)];
        if coast_m.is_empty() {
            // Measured values, if any, replace this assumed deceleration.
            paths.push(vec![braked]);
        }
        paths
    }

    /// The path to rest that must be clear, with the observed drift and turn.
    fn drifting_path(
        &self,
        now: SimTime,
        (velocity_m_s, yaw_rate_rad_s): (Ned, f64),
    ) -> Option<Vec<Leg>> {
        let coasting = self
            .coasting
            .as_ref()
            .filter(|_| self.drift.is_fresh(now))?;
        let DriftEstimate {
            recent_m_s,
            drift_m_s,
            thrust_m_s,
            ..
        } = self.drift;
        let water_m_s = velocity_m_s - recent_m_s;
        let thrust_m_s = thrust_m_s.abs();
        let reaction_s = self.reaction_s();
        Some(coasting.path(&Glide {
            water_m_s,
            drift_m_s,
            transient_m_s: recent_m_s - drift_m_s,
            thrust_m_s,
            yaw_rate_rad_s,
            reaction_s,
        }))
    }

    fn reaction_s(&self) -> f64 {
        self.rules.reaction_s.max(self.rules.debounce_s + COMMAND_S)
    }

    /// Where the boat comes to rest, relative to its position (m), on the longest of the predicted
    /// paths.
    pub(crate) fn stopping_way(&self, now: SimTime, motion: (Ned, f64)) -> Ned {
        let paths = self
            .straight_paths(motion.0)
            .into_iter()
            .chain(self.drifting_path(now, motion));
        let ends = paths.filter_map(|path| Some(path.last()?.end));
        ends.max_by(|a, b| a.length().total_cmp(&b.length()))
            .unwrap_or_default()
    }
}
