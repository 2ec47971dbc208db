//! A stage of a training as a setup.

use super::raw::{decisions_per_step, steps_max};
use super::setup::{Control, Player, Setup, SetupError};
use agent::Spaces;
use game::scenario::{self, Overrides};
use game::training::{Stage, Training};

impl Setup {
    /// What is played in a stage: first against the policy itself, if it ever is, then against the stage's strategies. Nobody is
    /// drawn yet but the first.
    ///
    /// # Errors
    /// [`SetupError`]: what is wrong with a file, or makes it impossible to play.
    pub fn of_stage(training: &Training, stage: &Stage) -> Result<Setup, SetupError> {
        let overrides = Overrides { sea: stage.sea.clone(), ..Overrides::default() };
        let scenario = scenario::load_with(&stage.game, &overrides)?;
        let strategy = |file| scenario::load_strategy(file).map(Box::new);
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
        let setup = Setup {
            spaces: Spaces { observation: training.observation, action: training.action },
            control: match &stage.helm {
                Some(helm) => Control::Helm(strategy(helm)?),
                None => Control::Direct,
            },
            decisions_per_step,
            steps_max: stage.episode_max_s.map(|s| steps_max(s, &scenario, decisions_per_step)).transpose()?,
            starts: stage.starts,
            learner: None,
            mates: None,
            opponents,
            rewards: scenario::load_rewards(&stage.rewards)?,
            discount: f64::from(training.algorithm().discount()),
            scenario,
        };
        setup.check()?;
        Ok(setup)
    }
}
