//! Station keeping: holds a place, with a weight that grows with the distance from it.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::situation::{MovingPoint, Situation};
use primitives::Ned;
use scenario::strategy::StationKeep;
use std::f64::consts::PI;

/// Width over which utility falls from the speed peak to zero, m/s.
const SPEED_BASE_M_S: f64 = 0.8;

#[derive(Clone)]
pub(super) struct StationKeepBehaviour {
    task: StationKeep,
    /// The boat's position at the start of the behaviour.
    anchor: Ned,
}

impl StationKeepBehaviour {
    pub(super) fn new(task: StationKeep) -> StationKeepBehaviour {
        StationKeepBehaviour {
            task,
            anchor: Ned::default(),
        }
    }

    fn speed_m_s(&self, situation: &Situation, distance_m: f64) -> f64 {
        let inner_m = self.task.inner_radius_m.value(situation);
        let outer_m = self.task.outer_radius_m.value(situation);
        if distance_m <= inner_m {
            0.0
        } else if distance_m < outer_m {
            self.task.outer_speed_m_s.value(situation) * (distance_m - inner_m)
                / (outer_m - inner_m)
        } else {
            self.task.transit_speed_m_s.value(situation)
        }
    }
}

impl BehaviourLogic for StationKeepBehaviour {
    fn begin(&mut self, situation: &Situation) {
        self.anchor = situation.at;
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let here = Some(MovingPoint {
            at: self.anchor,
            velocity: Ned::default(),
        });
        let Some(point) = self
            .task
            .at
            .as_ref()
            .map_or(here, |place| situation.locate(place))
        else {
            return;
        };
        let distance_m = situation.at.distance(point.at);
        let speed_m_s = self
            .speed_m_s(situation, distance_m)
            .min(situation.model.speed_max_m_s);
        // At the station itself, every heading is as good as the current one.
        let (heading_rad, speed_m_s) = if speed_m_s > 0.0 {
            // Steer through the water, against the drift: the boat may need full speed ahead to
            // hold its station.
            situation
                .motion
                .steer(situation.at.bearing_rad(point.at), speed_m_s)
        } else {
            (situation.own.nav.psi_rad, 0.0)
        };
        output.add(&Objective::Coupled {
            course: Peak::tent(heading_rad, PI),
            speed: Peak::tent(speed_m_s, SPEED_BASE_M_S),
            course_share: 0.5,
        });
    }
}
