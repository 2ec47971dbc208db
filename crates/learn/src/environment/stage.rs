//! Converts a training stage to a setup.

use super::raw::{decisions_per_step, steps_max};
use super::setup::{Control, Player, Setup, SetupError, Teacher};
use crate::training::{self, Stage, Training};
use agent::Spaces;
use scenario::Overrides;
use std::collections::{BTreeMap, BTreeSet};

impl Setup {
    /// The setup of a stage. Its opponents are the policy itself, if the stage has self-play, and
    /// then the stage's strategies. Only the first has a draw weight yet.
    ///
    /// # Errors
    /// [`SetupError`]: the faults of a file, or why the setup cannot be played.
    pub fn of_stage(training: &Training, stage: &Stage) -> Result<Setup, SetupError> {
        let overrides = Overrides { sea: stage.sea.clone(), ..Overrides::default() };
        let scenario = scenario::load_with(&stage.game, &overrides)?;
        let strategy = |file| scenario::load_file::<scenario::strategy::Strategy>(file).map(Box::new);
        let plays_itself = stage.self_play > 0.0 || stage.past_selves > 0.0;
        let mut opponents = vec![];
        opponents.extend(plays_itself.then_some((0.0, Player::Policy)));
        for opponent in &stage.opponent {
            opponents.push((0.0, Player::Strategy(strategy(&opponent.strategy)?)));
        }
        if let Some((weight, _)) = opponents.first_mut() {
            *weight = 1.0;
        }
        let decisions_per_step = decisions_per_step(training.period_s, &scenario)?;
        let mut setup = Setup {
            spaces: Spaces { observation: training.observation, action: training.action },
            control: match &stage.helm {
                Some(helm) => Control::Helm(strategy(helm)?),
                None => Control::Direct,
            },
            teacher: None,
            critic: training.network.critic,
            decisions_per_step,
            steps_max: stage.episode_max_s.map(|s| steps_max(s, &scenario, decisions_per_step)).transpose()?,
            starts: stage.starts,
            learner: None,
            mates: stage.mates.as_deref().map(strategy).transpose()?,
            opponents,
            rewards: scenario::load_file::<crate::rewards::Rewards>(&stage.rewards)?,
            discount: f64::from(training.algorithm().discount()),
            scenario,
        };
        setup.check()?;
        setup.teacher = stage.teacher.as_ref().map(|teacher| setup.teacher_of(teacher)).transpose()?;
        Ok(setup)
    }

    /// The teacher, with its modes mapped to the options.
    fn teacher_of(&self, said: &training::Teacher) -> Result<Teacher, SetupError> {
        let strategy = Box::new(scenario::load_file::<scenario::strategy::Strategy>(&said.strategy)?);
        let modes: BTreeSet<String> =
            strategy.roles.iter().flat_map(|role| role.leaves().map(|mode| role.path(mode))).collect();
        let listed = |names: &mut dyn Iterator<Item = &String>| names.cloned().collect::<Vec<_>>().join(", ");
        if let Some(unknown) = said.options.keys().find(|mode| !modes.contains(*mode)) {
            let allowed = format!("a mode of {}: {}", strategy.name, listed(&mut modes.iter()));
            return Err(SetupError::Field {
                field: "a mode in the teacher's options",
                found: unknown.clone(),
                allowed,
            });
        }
        let mut options = BTreeMap::new();
        let Some(names) = self.options() else {
            if let Some(option) = said.options.values().next() {
                let allowed = "none, because action is not \"options\"".to_owned();
                return Err(SetupError::Field { field: "the teacher's options", found: option.clone(), allowed });
            }
            return Ok(Teacher { strategy, options });
        };
        for mode in modes {
            let name = said.options.get(&mode).unwrap_or(&mode);
            match names.iter().position(|option| option == name) {
                Some(option) => drop(options.insert(mode, option)),
                None if said.options.contains_key(&mode) => {
                    let (found, allowed) = (format!("{name:?}"), listed(&mut names.iter()));
                    return Err(SetupError::Field { field: "an option of the teacher", found, allowed });
                }
                None => {}
            }
        }
        if options.is_empty() {
            let found = format!("{}, whose modes match no option", strategy.name);
            let allowed = format!("options for its modes from {}", listed(&mut names.iter()));
            return Err(SetupError::Field { field: "the teacher", found, allowed });
        }
        Ok(Teacher { strategy, options })
    }
}
