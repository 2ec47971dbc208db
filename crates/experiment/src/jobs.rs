//! How many threads play games.

use std::num::NonZeroUsize;

/// Threads for each core, at most: more of them only take turns.
const PER_CORE_MAX: usize = 4;

/// The threads that are worth having for so many games: as many as somebody asked for, or one for each core; no more than four for each core,
/// nor than there are games.
#[must_use]
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
        for (asked, cores, games, want) in
            [(3, 2, 100, 3), (10_000, 2, 1_000_000, 8), (10_000, 2, 5, 5), (2, 16, 1, 1), (1, 1, 0, 1)]
        {
            assert_eq!(capped(of(asked), of(cores), games), of(want), "{asked} for {games} games on {cores} cores");
        }
    }
}
