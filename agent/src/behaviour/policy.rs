//! Policy: a model or an external program proposes course and speed, which the helm weighs like any
//! other preference.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::mind::Proposal;
use crate::policy::{BoardPolicy, Chosen};
use crate::situation::Situation;
use scenario::strategy::Policy;

/// Width over which utility falls from the proposed speed to zero, m/s.
const SPEED_BASE_M_S: f64 = 1.0;

#[derive(Clone)]
pub(super) struct PolicyBehaviour {
    task: Policy,
    /// The proposing model; `None` for an external source.
    policy: Option<BoardPolicy>,
}

impl PolicyBehaviour {
    pub(super) fn new(mut task: Policy) -> PolicyBehaviour {
        let is_sampled = task.sampled;
        let policy = task.model.take();
        let policy = policy.map(|model| BoardPolicy::new(model, is_sampled));
        PolicyBehaviour { task, policy }
    }

    /// The current proposal.
    fn proposed(&self, situation: &Situation) -> Option<Proposal> {
        match &self.policy {
            Some(policy) => match policy.chosen {
                Ok(Chosen::SetPoint(chosen)) => Some(Proposal {
                    at: situation.now,
                    course_rad: chosen.course_rad,
                    speed_m_s: chosen.speed_m_s,
                }),
                Ok(Chosen::Option(_)) | Err(_) => None,
            },
            None => {
                let proposal = situation.proposed?;
                // A proposal expires after `ttl_s`: if the program dies, the other behaviours keep
                // the boat safe.
                let is_fresh =
                    (situation.now - proposal.at).as_s() <= self.task.ttl_s.value(situation);
                is_fresh.then_some(proposal)
            }
        }
    }
}

impl BehaviourLogic for PolicyBehaviour {
    fn observe(&mut self, situation: &Situation) {
        if let Some(policy) = &mut self.policy {
            policy.choose_if_due(situation);
        }
    }

    fn option(&self) -> Option<(u16, usize)> {
        let variable = self.task.sets?;
        match self.policy.as_ref()?.chosen {
            Ok(Chosen::Option(option)) => Some((variable, option)),
            _ => None,
        }
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        if self.task.sets.is_some() {
            return;
        }
        let Some(Proposal {
            course_rad,
            speed_m_s,
            ..
        }) = self.proposed(situation)
        else {
            return;
        };
        // A policy proposes and the helm decides: external proposals are only weighed, and limited
        // to the boat's capabilities.
        let speed_m_s = speed_m_s.clamp(0.0, situation.model.speed_max_m_s);
        let (heading_rad, speed_m_s) = situation.motion.steer(course_rad, speed_m_s);
        output.add(&Objective::Coupled {
            course: Peak {
                summit: heading_rad,
                peak_width: self.task.peak_width_deg.value(situation).to_radians(),
                base_width: self.task.base_width_deg.value(situation).to_radians(),
                summit_delta: 10.0,
                height: 100.0,
            },
            speed: Peak::tent(speed_m_s, SPEED_BASE_M_S),
            course_share: self.task.course_share.value(situation),
        });
    }

    fn policy(&self) -> Option<&BoardPolicy> {
        self.policy.as_ref()
    }
}
