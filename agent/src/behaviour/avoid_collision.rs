//! Collision avoidance: keeps clear of other boats by the closest point of approach, with a function for each.

use super::nearest::{Nearest, is_meant, nearness};
use super::steering::keep_clear;
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::{MovingPoint, Situation};
use game::strategy::{AvoidCollision, Grade};

impl BehaviourLogic for AvoidCollision {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let (inner_m, outer_m) = (self.inner_m.value(situation), self.outer_m.value(situation));
        let (min_m, max_m) = (self.cpa_min_m.value(situation), self.cpa_max_m.value(situation));
        let horizon_s = self.time_on_leg_s.value(situation);
        // Of a large fleet nearly all are far off, which is told without a root; the rest is told exactly below.
        let far_m2 = outer_m * outer_m * (1.0 + 1e-9);
        let near = situation.others.iter().enumerate();
        let near = near.filter(|(_, other)| situation.at.distance_squared(other.at) <= far_m2);
        let near = near.map(|(i, other)| (situation.at.distance(other.at), i));
        let meant = |i: usize| is_meant(self.contacts, situation, &situation.others[i]);
        for (distance_m, i) in Nearest::of(near.filter(|(distance_m, i)| *distance_m < outer_m && meant(*i))).iter() {
            let other = &situation.others[i];
            let disc = MovingPoint { at: other.at, velocity: other.velocity() };
            let function = keep_clear(situation, disc, 0.0, (min_m, max_m), horizon_s);
            let share = graded(self.grade, nearness(distance_m, inner_m, outer_m));
            output.add_share(share, Some(other.vehicle), &function);
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
