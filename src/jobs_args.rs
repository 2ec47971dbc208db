//! `--jobs`: how many threads work.

use std::num::NonZeroUsize;

/// Threads, from the command line.
#[derive(clap::Args)]
pub(crate) struct JobsArgs {
    /// Worker threads; does not affect results [default: one for each core; at most four for each]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

impl JobsArgs {
    /// The threads that are worth having for so many games.
    pub(crate) fn threads(&self, games: usize) -> NonZeroUsize {
        experiment::threads(self.jobs, games)
    }
}
