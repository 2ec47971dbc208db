//! One game of an environment: policy steps, rewards, and a new game when one ends.

use super::games::Standing;
use super::setup::{Control, Player, Setup};
use super::watch::{Moment, Watch};
use crate::rewards::{BoatProgress, progress};
use agent::{Action, Mind, MindRunner, Pilot};
use messages::Picture;
use primitives::stream::Stream;
use primitives::{TeamId, VehicleId};
use rules::count::Tally;
use rules::event::{EventCursor, Logged};
use scenario::Scenario;
use scenario::policy::PolicyModel;
use sim::Contest;
use std::any::Any;

/// The sides of a game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// The team of the learning policy.
    pub learner: TeamId,
    /// Index in the setup of the opponent that plays the other team.
    pub opponent: usize,
}

pub(super) struct Game {
    seed: u64,
    side: Side,
    steps: u32,
    contest: Contest,
    runner: MindRunner,
    /// By row, the boat that receives the row's actions.
    rows: Vec<Option<VehicleId>>,
    read: EventCursor,
    /// The number of events before the last step.
    events_before: usize,
    tally: Tally,
    /// By vehicle index.
    boats: Vec<BoatProgress>,
    rewards: Vec<f64>,
    watch: Option<Watch>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// The game continues.
    None,
    Over,
    /// The episode reached its maximum length before the end of the game.
    CutOff,
}

impl Game {
    pub(super) fn new(setup: &Setup, contest: Contest, seed: u64, watch: Option<Watch>) -> Game {
        let side = draw_side(setup, seed);
        let scenario = contest.scenario();
        let enemy = TeamId(1 - side.learner.0);
        let is_self_play = matches!(setup.opponents[side.opponent].1, Player::Policy);
        let of_team = |team| {
            let boats = setup.pilots_of(scenario, team, seed).map(Some);
            boats
                .chain(std::iter::repeat(None))
                .take(setup.rows_per_team())
        };
        let enemies = of_team(enemy).map(|boat| boat.filter(|_| is_self_play));
        let rows = of_team(side.learner).chain(enemies);
        let rows: Vec<_> = rows.take(setup.rows_per_game()).collect();
        let mind = |vehicle: VehicleId| -> Box<dyn Mind> {
            let is_learner = scenario.team_of(vehicle) == side.learner;
            match (is_learner, &setup.opponents[side.opponent].1, &setup.mates) {
                (false, Player::Strategy(strategy), _) => {
                    agent::mind_by(scenario, vehicle, strategy)
                }
                (_, _, Some(strategy)) if !rows.contains(&Some(vehicle)) => {
                    agent::mind_by(scenario, vehicle, strategy)
                }
                (false, Player::Model(model), _) => {
                    let pilot = policy_pilot(setup, scenario, vehicle);
                    Box::new(pilot.by_model(PolicyModel::clone(model), false))
                }
                // As in the arena, but with pilots as minds: a test plays the same game in the
                // arena and compares digests.
                _ => Box::new(pilot(setup, scenario, vehicle)),
            }
        };
        let count = scenario.vehicles.len();
        let runner = arena::runner_of((0..count).map(|i| mind(VehicleId::at(i))).collect());
        let mut game = Game {
            seed,
            side,
            steps: 0,
            runner,
            rows,
            contest,
            read: EventCursor::default(),
            events_before: 0,
            tally: Tally::new(count),
            boats: vec![],
            rewards: vec![0.0; count],
            watch,
        };
        // Called before the first pictures, so that the watch sees all inputs of the game.
        game.show(Moment::Decision);
        game.contest.pictures();
        game.boats = progress(&game.contest, setup.rewards.depend_on_others());
        game
    }

    pub(super) fn rows(&self) -> &[Option<VehicleId>] {
        &self.rows
    }

    /// The pilot of a row's boat, and its team's picture.
    fn pilot(&mut self, row: usize) -> Option<(&mut Pilot, &Picture)> {
        let vehicle = self.rows[row]?;
        let mind: &mut dyn Any = self.runner.mind_mut(vehicle)?;
        Some((mind.downcast_mut()?, self.contest.picture_of(vehicle)))
    }

    pub(super) fn act(&mut self, row: usize, action: Action) {
        if let Some((pilot, _)) = self.pilot(row) {
            pilot.act(action);
        }
    }

    pub(super) fn step(&mut self, setup: &Setup) -> Ending {
        self.events_before = self.contest.events().len();
        for _ in 0..setup.decisions_per_step {
            if self.contest.is_over() {
                break;
            }
            arena::decide(&mut self.contest, &mut self.runner);
            self.contest.advance();
            self.show(Moment::Decision);
        }
        self.steps += 1;
        let ending = if self.contest.is_over() {
            Ending::Over
        } else if setup.steps_max.is_some_and(|most| self.steps >= most) {
            Ending::CutOff
        } else {
            Ending::None
        };
        if ending != Ending::None {
            self.show(Moment::End);
            self.end_watch();
        }
        self.contest.pictures();
        self.reward(setup, ending);
        ending
    }

    fn show(&mut self, moment: Moment) {
        if let Some(watch) = &mut self.watch {
            watch(&mut self.contest, moment);
        }
    }

    pub(super) fn end_watch(&mut self) {
        self.watch = None;
    }

    /// Removes the watch without signalling the end.
    pub(super) fn forget_watch(&mut self) {
        std::mem::forget(self.watch.take());
    }

    /// The events of the last step.
    pub(super) fn events(&self) -> &[Logged] {
        self.contest
            .events()
            .get(self.events_before..)
            .unwrap_or_default()
    }

    /// The reward of a row's boat in the last step; 0 without a boat.
    pub(super) fn reward_of(&self, row: usize) -> f64 {
        self.rows[row].map_or(0.0, |boat| self.rewards[boat.index()])
    }

    /// Writes the boat's observation. Returns whether the boat's next action takes effect.
    pub(super) fn observe(&mut self, row: usize, out: &mut [f32]) -> bool {
        let Some((pilot, picture)) = self.pilot(row) else {
            out.fill(0.0);
            return false;
        };
        out.copy_from_slice(pilot.observe(picture));
        pilot.obeys()
    }

    pub(super) fn taught(&mut self, row: usize) -> Option<Action> {
        self.pilot(row).and_then(|(pilot, _)| pilot.taught())
    }

    pub(super) fn standing(&self) -> Standing {
        let score = self.contest.score();
        let scenario = self.contest.scenario();
        let teams = [self.side.learner, TeamId(1 - self.side.learner.0)];
        let counts = teams.map(|team| self.tally.team(team, |i| scenario.vehicles[i].team));
        let score = teams.map(|team| score[team.index()]);
        Standing {
            seed: self.seed,
            side: self.side,
            score,
            counts,
            steps: self.steps,
        }
    }

    pub(super) fn contest(&self) -> &Contest {
        &self.contest
    }

    fn reward(&mut self, setup: &Setup, ending: Ending) {
        let rewards = &setup.rewards;
        let carrying: Vec<bool> = self.boats.iter().map(|boat| boat.carrying).collect();
        let before: Vec<f64> = self
            .boats
            .iter()
            .map(|boat| rewards.potential.of(boat) + rewards.place.of(boat))
            .collect();
        self.boats = progress(&self.contest, rewards.depend_on_others());
        let scenario = self.contest.scenario();
        let step_s = scenario.tick.as_s()
            * f64::from(scenario.ticks_per_decision * setup.decisions_per_step);
        for (i, reward) in self.rewards.iter_mut().enumerate() {
            // A potential that depends only on the state, and is 0 at the end, does not change the
            // best policy (Ng, Harada and Russell, ICML 1999). Rewards for places pay the
            // undiscounted gain of a step. Paying them per second failed: half a second on the
            // right course changed the sum by only one per cent, and boats trained to retreat on
            // 300,000 such samples ended no closer to home than stationary ones.
            let after = if ending == Ending::Over {
                0.0
            } else {
                rewards.potential.of(&self.boats[i])
            };
            *reward = setup.discount * after + rewards.place.of(&self.boats[i]) - before[i]
                + rewards.second * step_s;
        }
        let events = self.read.read(self.contest.events());
        rewards.add_events(scenario, events, &carrying, &mut self.rewards);
        events
            .iter()
            .for_each(|logged| self.tally.add(logged.event));
        if ending == Ending::Over {
            for (i, reward) in self.rewards.iter_mut().enumerate() {
                *reward += rewards.of_end(self.contest.score(), scenario.team_of(VehicleId::at(i)));
            }
        }
    }
}

/// The pilot of a boat that receives actions, or that demonstrates a teacher's actions.
fn pilot(setup: &Setup, scenario: &Scenario, vehicle: VehicleId) -> Pilot {
    let Some(teacher) = &setup.teacher else {
        return policy_pilot(setup, scenario, vehicle);
    };
    let program = agent::roles::role_in(scenario, vehicle, &teacher.strategy);
    if teacher.drives {
        Pilot::by_teacher(scenario, vehicle, program, &teacher.options, setup.spaces)
    } else {
        let pilot = policy_pilot(setup, scenario, vehicle);
        pilot.advised_by(scenario, vehicle, program, &teacher.options)
    }
}

fn policy_pilot(setup: &Setup, scenario: &Scenario, vehicle: VehicleId) -> Pilot {
    match &setup.control {
        Control::Direct => Pilot::direct(scenario, vehicle, setup.spaces),
        Control::Helm(strategy) => {
            let program = agent::roles::role_in(scenario, vehicle, strategy);
            Pilot::helm(scenario, vehicle, program, setup.spaces)
        }
    }
}

/// Draws the opponent and the sides. Consecutive games alternate sides unless the side is fixed.
fn draw_side(setup: &Setup, seed: u64) -> Side {
    let total: f64 = setup
        .opponents
        .iter()
        .map(|(weight, _)| weight.max(0.0))
        .sum();
    let mut left = Stream::new(seed, "opponent").between(0.0, total);
    let chosen = setup.opponents.iter().position(|(weight, _)| {
        left -= weight.max(0.0);
        left < 0.0
    });
    let last = || {
        setup
            .opponents
            .iter()
            .rposition(|(weight, _)| *weight > 0.0)
            .unwrap_or_default()
    };
    // Alternate, because the ends of the field differ: the wind has a direction.
    let learner = setup.learner.unwrap_or(TeamId((seed % 2) as u8));
    Side {
        learner,
        opponent: chosen.unwrap_or_else(last),
    }
}
