//! Obstacle avoidance: keeps clear of fixed obstacles.

use super::nearest::{Nearest, nearness};
use super::outline::{Outline, Passes};
use super::steering::{keep_clear, lag, steer_heading};
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Table};
use crate::situation::{MovingPoint, Situation};
use primitives::angle::wrap_pi;
use primitives::instructions::Instructions;
use primitives::{Ned, SimTime};
use rules::field::Obstacle;
use scenario::strategy::{AvoidObstacle, NEAREST_MAX};
use std::f64::consts::PI;

/// How long a boat must stand still, contrary to its orders, to count as stopped by an obstacle, s.
const STOPPED_S: f64 = 2.0;
/// Maximum distance from the boat's estimated position to the obstacle that stopped it, m: a large
/// receiver error.
const ERROR_MAX_M: f64 = 10.0;
/// Distance within which another boat may be the cause of the stop, m.
const BOAT_M: f64 = 4.0;
/// How long the boat then backs off, s, and its speed, m/s: it turns around and gains 5 m.
const BACKS_OFF_S: f64 = 8.0;
const BACKS_OFF_M_S: f64 = 2.0;
/// How long it then avoids the place, s, and within what radius, m.
const FELT_S: f64 = 60.0;
const FELT_M: f64 = 2.0;

#[derive(Clone)]
pub(super) struct AvoidObstacleBehaviour {
    task: AvoidObstacle,
    /// The last stop by an obstacle: its time, the centre of the place, and the heading away from
    /// it.
    felt: Option<(SimTime, Ned, f64)>,
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
            felt: None,
            outlines: Vec::new(),
            table,
            instructions,
        }
    }
}

impl AvoidObstacleBehaviour {
    /// Backs off from an obstacle that stops the boat, then avoids the place. Without this, boats
    /// with a position error of some metres pushed for minutes against obstacles that they appeared
    /// to be passing.
    fn feel(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) -> Option<Ned> {
        let since_s = |(since, ..): &(SimTime, Ned, f64)| (situation.now - *since).as_s();
        self.felt.take_if(|felt| since_s(felt) > FELT_S);
        let backs_off = |felt: &(SimTime, Ned, f64)| since_s(felt) < BACKS_OFF_S;
        if situation.motion.stopped_s() >= STOPPED_S && !self.felt.as_ref().is_some_and(backs_off) {
            let mut is_alone = true;
            situation.near(BOAT_M, |_, _| is_alone = false);
            let obstacles = &situation.model.field.plan.obstacles;
            let is_near = |obstacle: &Obstacle| obstacle.distance(situation.at) < ERROR_MAX_M;
            if is_alone && obstacles.iter().any(is_near) {
                let ahead_m = situation.motion.bow_m() + FELT_M;
                let centre = situation.at + situation.ahead.scaled(ahead_m);
                let away_rad = wrap_pi(situation.own.nav.psi_rad + PI);
                self.felt = Some((situation.now, centre, away_rad));
            }
        }
        if let Some((.., away_rad)) = self.felt.as_ref().filter(|felt| backs_off(felt)) {
            output.add(&steer_heading(*away_rad, BACKS_OFF_M_S, 0.5));
        }
        self.felt.map(|(_, centre, _)| centre)
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
        let felt = self.feel(situation, output);
        let add_disc =
            |output: &mut BehaviourOutput<'_>, share: f64, centre: Ned, radius_m: f64| {
                let disc = MovingPoint {
                    at: centre,
                    velocity: Ned::default(),
                };
                // A circle counts as a stationary contact that own ship touches at this radius, so
                // the closed form applies. Polygons have no closed form and need a table.
                let limits_m = (min_m, max_m);
                let function = keep_clear(situation, disc, radius_m, limits_m, horizon_s, None);
                output.add_share(share, None, &function);
            };
        if let Some(centre) = felt {
            let distance_m = situation.at.distance(centre) - FELT_M;
            add_disc(
                output,
                nearness(distance_m, inner_m, outer_m),
                centre,
                FELT_M,
            );
        }
        let distances = obstacles
            .iter()
            .enumerate()
            .map(|(i, obstacle)| (obstacle.distance(situation.at), i));
        // Backing off and avoiding the place use two of the functions that a program may have.
        let most = NEAREST_MAX - if felt.is_some() { 2 } else { 0 };
        let nearest = Nearest::of(distances.filter(|(distance_m, _)| *distance_m < outer_m));
        for (distance_m, i) in nearest.iter().take(most) {
            let share = nearness(distance_m, inner_m, outer_m);
            match &obstacles[i] {
                Obstacle::Circle { centre, radius_m } => {
                    add_disc(output, share, *centre, *radius_m);
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
