//! Obstacles: boats that hit an obstacle or a wall are tagged and lose their flags.

use super::{Referee, Standing};
use crate::event::{Event, TagCause};
use crate::field::{Obstacle, Walls};
use primitives::frame::Ned;
use primitives::id::VehicleId;

impl Referee {
    /// Tags boats that are too close to an obstacle or a wall, as with `tag_on_collision` of
    /// Pyquaticus, where the distance is a boat's radius.
    pub(super) fn watch_obstacles(
        &self,
        standing: &mut Standing,
        at: &impl Fn(usize) -> Ned,
        events: &mut Vec<Event>,
    ) {
        let reach_m = self.rules.obstacle_tag_m;
        if reach_m <= 0.0 {
            return;
        }
        let plan = &self.field.plan;
        let hits = |here: Ned| {
            let is_hit = |obstacle: &Obstacle| obstacle.distance(here) < reach_m;
            plan.walls == Walls::AllRound && self.field.inside_by_m(here) < reach_m
                || plan.obstacles.iter().any(is_hit)
        };
        for i in 0..standing.vehicles.len() {
            if !standing.vehicles[i].in_play || !hits(at(i)) {
                continue;
            }
            let vehicle = VehicleId::at(i);
            if !standing.vehicles[i].tagged {
                standing.put_tag(vehicle, TagCause::Obstacle, events);
            }
            standing.drop_flag(vehicle, events);
        }
    }
}
