//! The helm report, for people and programs that inspect a helm.

use super::{Decided, HelmMind};
use crate::policy::{BoardPolicy, Chosen};
use messages::helm::{
    BehaviourReport, DriftReport, FunctionReport, HelmReport, PolicyReport, VariableReport,
};
use primitives::angle::compass_deg_from_rad;

impl HelmMind {
    pub(super) fn reported(&self) -> HelmReport {
        let grid = self.functions.problem.grid();
        let steered = match self.decided {
            Decided::Steer(choice) => Some(choice),
            Decided::Hold(_) => None,
        };
        let at = steered.map(|choice| (choice.decision.course, choice.decision.speed));
        let utility =
            |utilities: &[f32]| at.and_then(|(k, j)| utilities.get(k * grid.speeds() + j).copied());
        let functions = self.functions.list.iter().map(|function| FunctionReport {
            behaviour: self.program.behaviours[function.behaviour].name.clone(),
            contact: function.contact,
            weight: function.weight,
            utility: utility(&function.utilities),
            // Empty unless requested, which keeps most reports small.
            utilities: function.utilities.clone(),
        });
        let behaviours =
            self.program
                .behaviours
                .iter()
                .zip(&self.instances)
                .map(|(behaviour, instance)| BehaviourReport {
                    name: behaviour.name.clone(),
                    kind: behaviour.task.kind().to_owned(),
                    run_state: instance.run.state,
                    weight: instance.weight,
                });
        let variables = self
            .program
            .variables
            .iter()
            .zip(&self.situation.variables)
            .map(|(variable, value)| VariableReport {
                name: variable.name.clone(),
                value: variable.kind.text_of(*value),
            });
        let named = self.program.behaviours.iter().zip(&self.instances);
        let policies =
            named.filter_map(|(behaviour, instance)| Some((behaviour, instance.logic.policy()?)));
        let policies = policies.map(|(behaviour, policy)| policy_report(&behaviour.name, policy));
        let motion = &self.situation.motion;
        let drift = motion.drift();
        HelmReport {
            vehicle: self.situation.model.me,
            at: self.situation.now,
            program: self.program.name.clone(),
            mode: self
                .mode
                .map(|mode| self.program.path(mode))
                .unwrap_or_default(),
            course_deg: at.map(|(k, _)| compass_deg_from_rad(grid.course_rad(k))),
            speed_m_s: at.map(|(_, j)| grid.speed_m_s(j)),
            heading_offset_deg: motion.heading_offset_rad().to_degrees(),
            drift: DriftReport {
                north_m_s: drift.north,
                east_m_s: drift.east,
                spread_m_s: motion.spread_m_s(),
            },
            hold: match self.decided {
                Decided::Hold(why) => Some(why.to_owned()),
                Decided::Steer(_) => None,
            },
            value: steered.map(|choice| choice.value),
            courses: grid.courses(),
            speeds: grid.speeds(),
            speed_max_m_s: grid.speed_max_m_s(),
            behaviours: behaviours.collect(),
            variables: variables.collect(),
            policies: policies.collect(),
            functions: functions.collect(),
        }
    }
}

fn policy_report(behaviour: &str, policy: &BoardPolicy) -> PolicyReport {
    let (set_point, option, fault) = match policy.chosen {
        Ok(Chosen::SetPoint(set_point)) => (Some(set_point), None, None),
        Ok(Chosen::Option(option)) => (None, Some(policy.model.words(option)), None),
        Err(fault) => (None, None, Some(fault.to_string())),
    };
    PolicyReport {
        behaviour: behaviour.to_owned(),
        model: policy.model.name.clone(),
        course_deg: set_point.map(|chosen| compass_deg_from_rad(chosen.course_rad)),
        speed_m_s: set_point.map(|chosen| chosen.speed_m_s),
        option,
        fault,
        probabilities: policy.probabilities(),
        observed: policy.observed().to_vec(),
    }
}
