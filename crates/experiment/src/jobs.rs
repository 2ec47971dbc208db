//! The games of an experiment: their files, their number, and the threads that play them.

use scenario::{Files, Overrides, Problem, Problems, Scenario, load_with_files};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// Maximum number of threads per core: more would only take turns.
const PER_CORE_MAX: usize = 4;

/// Maximum number of games in an experiment. All results are kept in memory.
const GAMES_MAX: usize = 4_000_000;

/// The names of a game's teams, the first one first.
pub(crate) fn teams_of(game: &Path, files: &Arc<Files>) -> Result<Vec<String>, Problems> {
    Ok(load_with_files(game, &Overrides::default(), files)?
        .teams
        .into_iter()
        .map(|team| team.name)
        .collect())
}

/// Loads a game, which must have no real boats: these cannot take part in experiments. If it has
/// any, reports a problem in `file`.
pub(crate) fn load_game(
    game: &Path,
    overrides: &Overrides,
    files: &Arc<Files>,
    file: &Path,
) -> Result<Scenario, Problems> {
    let scenario = load_with_files(game, overrides, files)?;
    match scenario.has_no_real_boats() {
        Ok(()) => Ok(scenario),
        Err(real_boats) => Err(Problems(vec![Problem::of_file(
            file.to_owned(),
            real_boats.to_string(),
        )])),
    }
}

/// The problem with an experiment whose file requests too many games.
pub(crate) fn too_many_games(games: usize, file: &Path) -> Option<Problem> {
    let message =
        || format!("{games} games in all, expected at most {GAMES_MAX}; reduce games or entries");
    (games > GAMES_MAX).then(|| Problem::of_file(file.to_owned(), message()))
}

/// The command option that gives a team its strategy, preceded by a space.
pub(crate) fn strategy_option(team: &str, file: &str) -> String {
    if ["blue", "red"].contains(&team) {
        format!(" --{team} {file}")
    } else {
        format!(" --strategy {team}={file}")
    }
}

/// The number of threads for this many games: as requested or one per core, but at most four per
/// core and one per game.
pub fn threads(asked: Option<NonZeroUsize>, games: usize) -> NonZeroUsize {
    let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    capped(asked.unwrap_or(cores), cores, games)
}

fn capped(asked: NonZeroUsize, cores: NonZeroUsize, games: usize) -> NonZeroUsize {
    let most = cores.get().saturating_mul(PER_CORE_MAX).min(games);
    NonZeroUsize::new(most).map_or(NonZeroUsize::MIN, |most| asked.min(most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_no_more_than_four_a_core_nor_than_games() {
        let of = |number: usize| NonZeroUsize::new(number).expect("it is not 0");
        for (asked, cores, games, want) in [
            (3, 2, 100, 3),
            (10_000, 2, 1_000_000, 8),
            (10_000, 2, 5, 5),
            (2, 16, 1, 1),
            (1, 1, 0, 1),
        ] {
            assert_eq!(
                capped(of(asked), of(cores), games),
                of(want),
                "{asked} for {games} games on {cores} cores"
            );
        }
    }
}
