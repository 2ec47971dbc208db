//! A helm's report, sent on request: its mode, its behaviours and the reasons for its decision.

use primitives::id::VehicleId;
use primitives::time::SimTime;
use scenario::Scenario;
use serde::{Deserialize, Serialize};

/// The state of a helm at one decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HelmReport {
    /// The helm's boat.
    pub vehicle: VehicleId,
    /// The time of the decision.
    pub at: SimTime,
    /// The name of the helm's program.
    pub program: String,
    /// The mode with its parent modes: `defending:loitering`.
    pub mode: String,
    /// Chosen heading, compass degrees; `None` if the boat holds. Heading plus drift gives the
    /// course.
    pub course_deg: Option<f64>,
    /// Chosen speed through the water, m/s; `None` if the boat holds.
    pub speed_m_s: Option<f64>,
    /// Estimated offset of the boat's heading from the ordered heading, degrees clockwise. The helm
    /// subtracts it from the chosen heading. Recordings of earlier versions have neither this nor
    /// the drift.
    #[serde(default)]
    pub heading_offset_deg: f64,
    /// The estimated drift.
    #[serde(default)]
    pub drift: DriftReport,
    /// Why the boat holds, if it does.
    pub hold: Option<String>,
    /// The weighted sum of utilities at the decision.
    pub value: Option<f64>,
    /// Number of candidate courses, clockwise from north.
    pub courses: usize,
    /// Number of candidate speeds, from 0.
    pub speeds: usize,
    /// The highest candidate speed, m/s.
    pub speed_max_m_s: f64,
    /// All behaviours, sorted by name.
    pub behaviours: Vec<BehaviourReport>,
    /// The helm's variables.
    pub variables: Vec<VariableReport>,
    /// The trained policies that the helm's behaviours query.
    #[serde(default)]
    pub policies: Vec<PolicyReport>,
    /// The objective functions of the decision.
    pub functions: Vec<FunctionReport>,
}

/// Velocity that wind, waves and current add to a boat's motion through the water, as estimated by
/// its helm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriftReport {
    /// Towards north, m/s.
    pub north_m_s: f64,
    /// Towards east, m/s.
    pub east_m_s: f64,
    /// Standard deviation of the velocity around the drift, m/s.
    pub spread_m_s: f64,
}

impl HelmReport {
    /// The weighted sum of these functions by course and speed; functions without utilities are
    /// ignored.
    pub fn sum<'a>(&self, functions: impl Iterator<Item = &'a FunctionReport>) -> Vec<f64> {
        let mut total = vec![0.0; self.courses * self.speeds];
        for function in functions {
            total
                .iter_mut()
                .zip(&function.utilities)
                .for_each(|(sum, u)| *sum += function.weight * f64::from(*u));
        }
        total
    }
}

/// A behaviour at one decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BehaviourReport {
    /// The behaviour's name.
    pub name: String,
    /// The behaviour's kind.
    pub kind: String,
    /// Whether the behaviour runs, and whether it influences the helm.
    pub run_state: RunState,
    /// Current weight; 0 unless the behaviour runs.
    pub weight: f64,
}

/// The run state of a behaviour, in the terms of MOOS-IvP.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunState {
    /// The behaviour's conditions prevent it from running.
    Idle,
    /// The behaviour runs but produces no objective function.
    Running,
    /// The behaviour runs and influences the helm.
    Active,
    /// The behaviour has completed.
    Complete,
}

/// A trained policy at its last decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyReport {
    /// The behaviour that queries it.
    pub behaviour: String,
    /// The policy's model file.
    pub model: String,
    /// The proposed course, compass degrees; `None` without a proposal.
    pub course_deg: Option<f64>,
    /// The proposed speed, m/s.
    pub speed_m_s: Option<f64>,
    /// The chosen option, if the policy chooses among options.
    #[serde(default)]
    pub option: Option<String>,
    /// Why the policy makes no proposal, if it makes none.
    pub fault: Option<String>,
    /// Probability of each discrete action; empty for continuous actions.
    pub probabilities: Vec<f32>,
    /// The policy's inputs at the last decision, in the order of its observation space.
    pub observed: Vec<f32>,
}

impl PolicyReport {
    /// Labels the inputs, and the discrete actions with their probabilities, most probable first.
    /// Empty if the scenario lacks the model.
    pub fn words(&self, scenario: &Scenario, vehicle: VehicleId) -> PolicyWords {
        let Some(model) = scenario
            .strategy_of(vehicle)
            .models()
            .find(|model| model.name == self.model)
        else {
            return PolicyWords::default();
        };
        let mut actions: Vec<(String, f32)> = self
            .probabilities
            .iter()
            .enumerate()
            .map(|(i, share)| (model.words(i), *share))
            .collect();
        actions.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (mates, enemies) = scenario.sides_of(vehicle);
        let names = model.spec.observation.names(mates, enemies);
        PolicyWords {
            actions,
            observed: names
                .into_iter()
                .zip(self.observed.iter().copied())
                .collect(),
        }
    }
}

/// Labelled actions and inputs of a policy's decision.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolicyWords {
    /// Meaning and probability of each discrete action.
    pub actions: Vec<(String, f32)>,
    /// Name and value of each input.
    pub observed: Vec<(String, f32)>,
}

/// A variable and its value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableReport {
    /// The variable's name.
    pub name: String,
    /// The variable's value.
    pub value: String,
}

/// An objective function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FunctionReport {
    /// The behaviour that produced it.
    pub behaviour: String,
    /// The contact that the function is about, if any.
    pub contact: Option<VehicleId>,
    /// The function's weight.
    pub weight: f64,
    /// The function's utility at the decision, 0 to 100; `None` until evaluated.
    pub utility: Option<f32>,
    /// The function's utilities, one row of speeds per course; empty unless requested.
    pub utilities: Vec<f32>,
}

/// A query to a helm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct HelmQuestion {
    /// Whether to include the utilities, not only the weights.
    pub functions: bool,
}
