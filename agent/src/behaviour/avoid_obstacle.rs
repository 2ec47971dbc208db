//! Obstacle avoidance: keeps clear of fixed obstacles.

use super::nearest::{Nearest, nearness};
use super::outline::{Outline, Passes};
use super::steering::{keep_clear, lag};
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Table};
use crate::situation::{MovingPoint, Situation};
use primitives::Ned;
use primitives::instructions::Instructions;
use rules::field::Obstacle;
use scenario::strategy::AvoidObstacle;

#[derive(Clone)]
pub(super) struct AvoidObstacleBehaviour {
    task: AvoidObstacle,
    /// Precomputed outlines of polygonal obstacles, by obstacle; empty before the first decision.
    outlines: Vec<Outline>,
    /// Utilities of all courses and speeds, for obstacles without a closed form.
    table: Table,
    instructions: Instructions,
}

impl AvoidObstacleBehaviour {
    pub(super) fn new(task: AvoidObstacle) -> AvoidObstacleBehaviour {
        let table = Table::default();
        let instructions = Instructions::best();
        AvoidObstacleBehaviour {
            task,
            outlines: Vec::new(),
            table,
            instructions,
        }
    }
}

impl BehaviourLogic for AvoidObstacleBehaviour {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let inner_m = self.task.inner_m.value(situation);
        let outer_m = self.task.outer_m.value(situation);
        let min_m = self.task.cpa_min_m.value(situation);
        let max_m = self.task.cpa_max_m.value(situation).max(min_m);
        let horizon_s = self.task.time_on_leg_s.value(situation);
        let obstacles = &situation.model.field.plan.obstacles;
        // Compute the outlines only once: obstacles do not move, and the half planes around a
        // polygon are expensive.
        if self.outlines.is_empty() {
            let corners = |obstacle: &Obstacle| match obstacle {
                Obstacle::Circle { .. } => Outline::new(&[]),
                Obstacle::Polygon { corners } => Outline::new(corners),
            };
            self.outlines = obstacles.iter().map(corners).collect();
        }
        let distances = obstacles
            .iter()
            .enumerate()
            .map(|(i, obstacle)| (obstacle.distance(situation.at), i));
        for (distance_m, i) in
            Nearest::of(distances.filter(|(distance_m, _)| *distance_m < outer_m)).iter()
        {
            let share = nearness(distance_m, inner_m, outer_m);
            match &obstacles[i] {
                Obstacle::Circle { centre, radius_m } => {
                    let disc = MovingPoint {
                        at: *centre,
                        velocity: Ned::default(),
                    };
                    // A circle counts as a stationary contact that own ship touches at this radius,
                    // so the closed form applies. Polygons have no closed form and need a table.
                    let function =
                        keep_clear(situation, disc, *radius_m, (min_m, max_m), horizon_s, None);
                    output.add_share(share, None, &function);
                }
                Obstacle::Polygon { .. } => {
                    self.table.clear(output.grid());
                    self.instructions.run(Passes {
                        table: &mut self.table,
                        grid: output.grid(),
                        outline: &mut self.outlines[i],
                        at: situation.at,
                        velocity: situation.velocity,
                        drift: situation.motion.drift(),
                        lag: lag(situation),
                        horizon_s,
                        min_m,
                        max_m,
                    });
                    output.add_share(share, None, &Objective::Table(&self.table));
                }
            }
        }
    }
}
