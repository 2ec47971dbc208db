//! Converts a training stage to a setup.

use super::raw::{RawObservation, RawSetup};
use super::setup::{Setup, SetupError, Teacher, wrong};
use crate::training::{self, Stage, Training};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

impl Setup {
    /// The setup of a stage. Its opponents are the policy itself, if the stage has self-play, then
    /// the stage's strategies. Only the first opponent has a draw weight yet.
    ///
    /// # Errors
    /// [`SetupError`]: the faults in a file, or why the setup cannot be played.
    pub fn of_stage(training: &Training, stage: &Stage) -> Result<Setup, SetupError> {
        let itself = (stage.self_play > 0.0 || stage.past_selves > 0.0).then_some(None);
        let strategies = stage
            .opponent
            .iter()
            .map(|opponent| Some(opponent.strategy.clone()));
        let weighted = |(i, file): (usize, Option<PathBuf>)| (if i == 0 { 1.0 } else { 0.0 }, file);
        let raw = RawSetup {
            game: stage.game.clone(),
            sea: stage.sea.clone(),
            team_sizes: stage.team_sizes.map(|range| [range; 2]),
            observation: RawObservation::Space(training.observation),
            action: training.action,
            helm: stage.helm.clone(),
            decision_s: Some(training.period_s),
            decision_min_s: 0.0,
            episode_max_s: stage.episode_max_s,
            starts: stage.starts,
            team: None,
            mates: stage.mates.clone(),
            opponents: itself
                .into_iter()
                .chain(strategies)
                .enumerate()
                .map(weighted)
                .collect(),
            rewards: Some(stage.rewards.clone()),
            discount: f64::from(training.algorithm().discount()),
            critic: training.network.critic,
        };
        let mut setup = raw.check()?;
        setup.teacher = stage
            .teacher
            .as_ref()
            .map(|teacher| setup.teacher_of(teacher))
            .transpose()?;
        Ok(setup)
    }

    /// The teacher, with its modes mapped to the options.
    fn teacher_of(&self, said: &training::Teacher) -> Result<Teacher, SetupError> {
        let strategy = Box::new(scenario::load_file::<scenario::strategy::Strategy>(
            &said.strategy,
        )?);
        let modes: BTreeSet<String> = strategy
            .roles
            .iter()
            .flat_map(|role| role.leaves().map(|mode| role.path(mode)))
            .collect();
        let listed = |names: &mut dyn Iterator<Item = &String>| {
            names.cloned().collect::<Vec<_>>().join(", ")
        };
        if let Some(unknown) = said.options.keys().find(|mode| !modes.contains(*mode)) {
            let allowed = format!("a mode of {}: {}", strategy.name, listed(&mut modes.iter()));
            return Err(wrong("a mode in the teacher's options", unknown, &allowed));
        }
        let (mut options, drives) = (BTreeMap::new(), said.drives);
        let Some(names) = self.options() else {
            if let Some(option) = said.options.values().next() {
                return Err(wrong(
                    "the teacher's options",
                    option,
                    "none, because action is not \"options\"",
                ));
            }
            return Ok(Teacher {
                strategy,
                drives,
                options,
            });
        };
        for mode in modes {
            let name = said.options.get(&mode).unwrap_or(&mode);
            match names.iter().position(|option| option == name) {
                Some(option) => drop(options.insert(mode, option)),
                None if said.options.contains_key(&mode) => {
                    return Err(wrong(
                        "an option of the teacher",
                        format!("{name:?}"),
                        &listed(&mut names.iter()),
                    ));
                }
                None => {}
            }
        }
        if options.is_empty() {
            let found = format!("{}, whose modes match no option", strategy.name);
            let allowed = format!("options for its modes from {}", listed(&mut names.iter()));
            return Err(wrong("the teacher", found, &allowed));
        }
        Ok(Teacher {
            strategy,
            drives,
            options,
        })
    }
}
