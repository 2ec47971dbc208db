//! Checks a training file and all files that it names.

use super::{Stage, Training};
use crate::rewards::Rewards;
use scenario::sea::Sea;
use scenario::strategy::Strategy;
use scenario::{Document, Scenario};
use std::path::PathBuf;

pub(super) fn training(document: &Document<Training>) -> Option<Training> {
    let mut training = document.raw.clone();
    let strategy = |key: &str, path: &mut PathBuf| {
        document.resolved::<Strategy>(key, path);
    };
    for (i, path) in training.evaluation.opponents.iter_mut().enumerate() {
        strategy(&format!("evaluation.opponents.{i}"), path);
    }
    super::check_algorithm::check(document);
    let mut scenarios = vec![];
    for (i, stage) in training.stage.iter_mut().enumerate() {
        let at = format!("stage.{i}");
        if let Some(helm) = &mut stage.helm {
            strategy(&format!("{at}.helm"), helm);
        }
        if let Some(teacher) = &mut stage.teacher {
            strategy(&format!("{at}.teacher.strategy"), &mut teacher.strategy);
        }
        if let Some(mates) = &mut stage.mates {
            strategy(&format!("{at}.mates"), mates);
        }
        for (k, opponent) in stage.opponent.iter_mut().enumerate() {
            strategy(
                &format!("{at}.opponent.{k}.strategy"),
                &mut opponent.strategy,
            );
        }
        if let Some(sea) = &mut stage.sea {
            document.resolved::<Sea>(&format!("{at}.sea"), sea);
        }
        document.resolved::<Rewards>(&format!("{at}.rewards"), &mut stage.rewards);
        scenarios.push(document.resolved::<Scenario>(&format!("{at}.game"), &mut stage.game));
        check_opponents(document, &at, stage, i);
    }
    for (i, scenario) in scenarios.iter().enumerate() {
        let Some(scenario) = scenario else { continue };
        check_teams(document, &format!("stage.{i}.game"), scenario);
        let decision_s = scenario.decision().as_s();
        let times = (training.period_s / decision_s).round();
        if document.is_sound("period_s")
            && (times < 1.0 || (times * decision_s - training.period_s).abs() > 1e-9)
        {
            let message = format!(
                "period_s is {}, expected a multiple of decision_s of {}, which is {decision_s}",
                training.period_s, scenario.name
            );
            document.note("period_s", message);
        }
    }
    document.is_faultless().then_some(training)
}

fn check_opponents(document: &Document<Training>, at: &str, stage: &Stage, i: usize) {
    if !document.is_sound(at) {
        return;
    }
    let has_strategies = stage.strategies > 0.0 && !stage.opponent.is_empty();
    // The first stage may start without past policies; then the policy plays against itself.
    if !has_strategies && stage.self_play == 0.0 && stage.past_selves == 0.0 {
        let message = format!(
            "stage {:?} has no opponents, expected opponent, self_play or past_selves",
            stage.name
        );
        document.note(at, message);
    }
    let names = &document.raw.stage[..i];
    if names.iter().any(|other| other.name == stage.name) {
        let message = format!(
            "name {:?} is used twice, expected a unique name for each stage",
            stage.name
        );
        document.note(&format!("{at}.name"), message);
    }
}

fn check_teams(document: &Document<Training>, at: &str, scenario: &Scenario) {
    let count = |team: usize| {
        scenario
            .vehicles
            .iter()
            .filter(|vehicle| vehicle.team.index() == team)
            .count()
    };
    if scenario.teams.len() != 2 || count(0) != count(1) {
        let sizes: Vec<String> = (0..scenario.teams.len())
            .map(|team| count(team).to_string())
            .collect();
        let message = format!(
            "game {} has teams of {} boats, expected two teams of equal size, because policies play both sides",
            scenario.name,
            sizes.join(" and ")
        );
        document.note(at, message);
    }
}
