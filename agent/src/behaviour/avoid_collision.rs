//! Collision avoidance: keeps clear of other boats by the closest point of approach, with a function for each.

use super::{CPA_MIN_UTILITY, Conduct, Nearest, is_meant, lag, nearness};
use crate::helm::{Bid, Scene};
use crate::ivp::{Approach, Closest, Objective};
use game::strategy::{AvoidCollision, Grade};

pub(super) struct Conductor(pub(super) AvoidCollision);

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let task = &self.0;
        let (inner_m, outer_m) = (task.inner_m.value(scene), task.outer_m.value(scene));
        let (min_m, max_m) = (task.cpa_min_m.value(scene), task.cpa_max_m.value(scene));
        let horizon_s = task.time_on_leg_s.value(scene);
        let near = scene.others.iter().enumerate().map(|(i, other)| (scene.at.distance(other.at), i));
        let meant = |i: usize| is_meant(task.contacts, scene, &scene.others[i]);
        for (distance_m, i) in Nearest::of(near.filter(|(distance_m, i)| *distance_m < outer_m && meant(*i))).iter() {
            let other = &scene.others[i];
            let line = other.at - scene.at;
            let closest = Closest {
                north_m: line.north,
                east_m: line.east,
                velocity_north_m_s: other.velocity.north,
                velocity_east_m_s: other.velocity.east,
                horizon_s,
                min_m,
                max_m: max_m.max(min_m),
                touch_m: 0.0,
                approach: Approach::Avoid { at_min: CPA_MIN_UTILITY },
                lag: Some(lag(scene)),
            };
            let share = graded(task.grade, nearness(distance_m, inner_m, outer_m));
            bid.ask_for(share, Some(other.vehicle), &Objective::Closest(closest));
        }
    }
}

/// How much of the weight is left: all of it at the inner distance and nearer, never more.
fn graded(grade: Grade, nearness: f64) -> f64 {
    match grade {
        Grade::Linear => nearness,
        Grade::Quasi => nearness * nearness.sqrt(),
        Grade::Quadratic => nearness * nearness,
    }
}
