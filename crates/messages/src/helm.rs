//! What a helm tells of itself to those who ask: its mode, its behaviours, and why it steers as it does.

use primitives::id::VehicleId;
use primitives::time::SimTime;
use scenario::Scenario;
use serde::{Deserialize, Serialize};

/// A helm at one decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HelmReport {
    /// Whose helm.
    pub vehicle: VehicleId,
    /// The time of the decision.
    pub at: SimTime,
    /// The program it goes by.
    pub program: String,
    /// The mode, with those that it is a part of: `defending:loitering`.
    pub mode: String,
    /// The chosen heading, compass degrees; none if the boat holds. With the drift it makes the course.
    pub course_deg: Option<f64>,
    /// The chosen speed through the water, m/s; none if the boat holds.
    pub speed_m_s: Option<f64>,
    /// By how much the boat lies beside the heading that it is told, as the helm sees it, degrees clockwise: the order is so
    /// much less than the heading chosen. Recordings of earlier versions have none, nor the drift.
    #[serde(default)]
    pub heading_offset_deg: f64,
    /// The drift as the helm sees it.
    #[serde(default)]
    pub drift: DriftReport,
    /// Why the boat holds, if it does.
    pub hold: Option<String>,
    /// The weighted sum of utilities at the decision.
    pub value: Option<f64>,
    /// How many courses were weighed: the first is north, and they go clockwise.
    pub courses: usize,
    /// How many speeds, from 0.
    pub speeds: usize,
    /// The highest of them, m/s.
    pub speed_max_m_s: f64,
    /// All behaviours, by name.
    pub behaviours: Vec<BehaviourReport>,
    /// The variables.
    pub variables: Vec<VariableReport>,
    /// The trained policies that its behaviours ask.
    #[serde(default)]
    pub policies: Vec<PolicyReport>,
    /// The objective functions of the decision.
    pub functions: Vec<FunctionReport>,
}

/// What wind, waves and current add to a boat's way through the water, as its helm sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriftReport {
    /// Towards north, m/s.
    pub north_m_s: f64,
    /// Towards east, m/s.
    pub east_m_s: f64,
    /// Standard deviation of the velocity about that, m/s.
    pub spread_m_s: f64,
}

impl HelmReport {
    /// The weighted sum of these functions by course and speed; those without utilities add nothing.
    #[must_use]
    pub fn sum<'a>(&self, functions: impl Iterator<Item = &'a FunctionReport>) -> Vec<f64> {
        let mut total = vec![0.0; self.courses * self.speeds];
        for function in functions {
            total.iter_mut().zip(&function.utilities).for_each(|(sum, u)| *sum += function.weight * f64::from(*u));
        }
        total
    }
}

/// A behaviour at one decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BehaviourReport {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Whether it runs, and whether it influences the helm.
    pub run_state: RunState,
    /// Its weight now; 0 if it does not run.
    pub weight: f64,
}

/// The run state of a behaviour, as MOOS-IvP calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// It may not run.
    Idle,
    /// It runs, but produces no objective function.
    Running,
    /// It runs and influences the helm.
    Active,
    /// It is done.
    Complete,
}

/// A trained policy at its last decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyReport {
    /// The behaviour that asks it.
    pub behaviour: String,
    /// Its file.
    pub model: String,
    /// The course that it proposes, compass degrees; none if it proposes nothing.
    pub course_deg: Option<f64>,
    /// The speed that it proposes, m/s.
    pub speed_m_s: Option<f64>,
    /// The option that it chooses, if it chooses among those of the strategy.
    #[serde(default)]
    pub option: Option<String>,
    /// Why it proposes nothing, if it does not.
    pub fault: Option<String>,
    /// How sure it was of each discrete action; empty where actions are continuous.
    pub probabilities: Vec<f32>,
    /// The numbers that it was given at its last decision, in the order of its observation space.
    pub observed: Vec<f32>,
}

impl PolicyReport {
    /// What its actions ask for with how much certainty, the likeliest first, and what its numbers are called; nothing where the scenario
    /// does not have the model.
    #[must_use]
    pub fn words(&self, scenario: &Scenario, vehicle: VehicleId) -> PolicyWords {
        let Some(model) = scenario.strategy_of(vehicle).models().find(|model| model.name == self.model) else {
            return PolicyWords::default();
        };
        let mut actions: Vec<(String, f32)> =
            self.probabilities.iter().enumerate().map(|(i, share)| (model.words(i), *share)).collect();
        actions.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (mates, enemies) = scenario.sides_of(vehicle);
        let names = model.spec.observation.names(mates, enemies);
        PolicyWords { actions, observed: names.into_iter().zip(self.observed.iter().copied()).collect() }
    }
}

/// The numbers of a policy's decision with what they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolicyWords {
    /// What discrete actions ask for, and how sure the policy was of each.
    pub actions: Vec<(String, f32)>,
    /// What it was given.
    pub observed: Vec<(String, f32)>,
}

/// A variable and its value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableReport {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
}

/// An objective function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FunctionReport {
    /// Whose it is.
    pub behaviour: String,
    /// The boat it is about.
    pub contact: Option<VehicleId>,
    /// Its weight.
    pub weight: f64,
    /// Its utility at the decision, 0 to 100; none before somebody looks.
    pub utility: Option<f32>,
    /// Its utilities, a row of speeds for each course; empty unless they were asked for.
    pub utilities: Vec<f32>,
}

/// What is asked of a helm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HelmQuestion {
    /// Whether the utilities are wanted, not only the weights.
    pub functions: bool,
}
