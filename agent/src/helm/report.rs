//! What a helm tells those who look inside.

use super::life::Stage;
use super::{Decided, HelmMind};
use game::angle::compass_deg_from_rad;
use game::helm::{BehaviourReport, FunctionReport, HelmReport, StageReport, VariableReport};
use game::strategy::Kind;

impl HelmMind {
    pub(super) fn reported(&self) -> HelmReport {
        let grid = self.problem.grid();
        let steered = match self.decided {
            Decided::Steer(choice) => Some(choice),
            Decided::Hold(_) => None,
        };
        let at = steered.map(|choice| (usize::from(choice.decision.course), usize::from(choice.decision.speed)));
        let utility = |utilities: &[f32]| at.and_then(|(k, j)| utilities.get(k * grid.speeds() + j).copied());
        let functions = self.entries.iter().map(|entry| FunctionReport {
            behaviour: self.program.behaviours[entry.behaviour].name.clone(),
            contact: entry.contact,
            weight: entry.weight,
            utility: utility(&entry.utilities),
            utilities: entry.utilities.clone(),
        });
        let behaviours = self.program.behaviours.iter().zip(&self.workers).map(|(behaviour, worker)| BehaviourReport {
            name: behaviour.name.clone(),
            kind: behaviour.task.kind().to_owned(),
            stage: match worker.life.stage {
                Stage::Idle => StageReport::Idle,
                Stage::Running => StageReport::Running,
                Stage::Active => StageReport::Active,
                Stage::Complete => StageReport::Complete,
            },
            weight: worker.weight,
        });
        let variables =
            self.program.variables.iter().zip(&self.scene.variables).map(|(variable, value)| VariableReport {
                name: variable.name.clone(),
                value: match &variable.kind {
                    Kind::Truth => (*value != 0.0).to_string(),
                    Kind::Number => value.to_string(),
                    Kind::Text(values) => values.get(*value as usize).cloned().unwrap_or_default(),
                },
            });
        HelmReport {
            vehicle: self.scene.chart.me,
            at: self.scene.now,
            program: self.program.name.clone(),
            mode: self.mode.map(|mode| self.program.path(mode)).unwrap_or_default(),
            course_deg: at.map(|(k, _)| compass_deg_from_rad(grid.course_rad(k))),
            speed_m_s: at.map(|(_, j)| grid.speed_m_s(j)),
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
            functions: functions.collect(),
        }
    }
}
