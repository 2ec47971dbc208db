//! Evaluation of a policy in games against an opponent, from both sides.

use super::learner::greedy;
use super::{outputs, pool};
use crate::environment::{Finished, Setup, SetupError, VectorEnvironment};
use crate::nn::Perceptron;
use agent::Action;
use serde::{Deserialize, Serialize};

/// The results of games.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Played {
    /// The numbers of games won, drawn and lost.
    pub results: [u32; 3],
    /// Mean points per game, the policy's first.
    pub points: [f64; 2],
    /// Mean number of times per game that a boat of the policy left the field.
    pub left_field: f64,
}

impl Played {
    fn of(games: &[Finished]) -> Played {
        let mut played = Played::default();
        let count = games.len().max(1) as f64;
        for Finished { standing, .. } in games {
            let [own, theirs] = standing.score;
            let result = own.cmp(&theirs).reverse() as i8 + 1;
            played.results[result as usize] += 1;
            played.points[0] += f64::from(own) / count;
            played.points[1] += f64::from(theirs) / count;
            played.left_field += f64::from(standing.counts[0].out_of_bounds) / count;
        }
        played
    }

    /// The fraction of games won; a draw counts half.
    pub fn won(&self) -> f64 {
        let [won, drawn, lost] = self.results.map(f64::from);
        (won + 0.5 * drawn) / (won + drawn + lost).max(1.0)
    }
}

/// Plays one game per seed with a policy's most likely actions, or its continuous actions.
///
/// # Errors
/// [`SetupError`] if the setup cannot be played.
pub fn evaluate(
    actor: &Perceptron,
    setup: Setup,
    games: usize,
    threads: usize,
    seed: u64,
) -> Result<Played, SetupError> {
    let pool = pool(threads);
    let is_discrete = setup.spaces.action.is_discrete();
    let mut environment = VectorEnvironment::new(setup, games, threads, seed, None)?;
    let (rows, _) = environment.rows();
    let mut ended: Vec<Option<Finished>> = vec![None; games];
    while ended.iter().any(Option::is_none) {
        let observations = environment.observations();
        let logits = pool.install(|| outputs(actor, observations));
        // Greedy rather than sampled, as on a boat.
        let chosen = logits
            .chunks_exact(logits.len() / rows)
            .map(|output| greedy(is_discrete, output));
        let actions: Vec<Action> = chosen.collect();
        environment.step(&actions)?;
        for one in environment.finished() {
            ended[one.game].get_or_insert(*one);
        }
    }
    let ended: Vec<Finished> = ended.into_iter().flatten().collect();
    Ok(Played::of(&ended))
}
