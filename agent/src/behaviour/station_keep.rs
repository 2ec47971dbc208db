//! Station keeping: holds a place, the more eagerly the farther it has drifted off.

use super::Conduct;
use crate::helm::{Bid, Scene, Spot};
use crate::ivp::{Objective, Peak, Peaks};
use game::Ned;
use game::strategy::StationKeep;
use std::f64::consts::PI;

/// From the peak of the speed down to nothing, m/s.
const SPEED_BASE_M_S: f64 = 0.8;

pub(super) struct Conductor {
    task: StationKeep,
    /// Where the boat was when it began.
    anchor: Ned,
}

impl Conductor {
    pub(super) fn new(task: StationKeep) -> Conductor {
        Conductor { task, anchor: Ned::default() }
    }

    /// The speed so far away from the station, m/s.
    fn speed_m_s(&self, scene: &Scene, distance_m: f64) -> f64 {
        let (inner_m, outer_m) = (self.task.inner_radius_m.value(scene), self.task.outer_radius_m.value(scene));
        if distance_m <= inner_m {
            0.0
        } else if distance_m < outer_m {
            self.task.outer_speed_m_s.value(scene) * (distance_m - inner_m) / (outer_m - inner_m)
        } else {
            self.task.transit_speed_m_s.value(scene)
        }
    }
}

impl Conduct for Conductor {
    fn begin(&mut self, scene: &Scene) {
        self.anchor = scene.at;
    }

    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let here = Some(Spot { at: self.anchor, velocity: Ned::default() });
        let Some(spot) = self.task.at.as_ref().map_or(here, |place| scene.spot(place)) else { return };
        let distance_m = scene.at.distance(spot.at);
        let speed_m_s = self.speed_m_s(scene, distance_m).min(scene.chart.speed_max_m_s);
        // At the station itself every course is as good as the present one.
        let course_rad = if speed_m_s > 0.0 { scene.at.bearing_rad(spot.at) } else { scene.own.nav.psi_rad };
        bid.ask(&Objective::Coupled {
            course: Peaks::one(Peak::tent(course_rad, PI)),
            speed: Peaks::one(Peak::tent(speed_m_s, SPEED_BASE_M_S)),
            course_share: 0.5,
        });
    }
}
