//! `--jobs`: the number of worker threads.

use std::num::NonZeroUsize;

/// Threads, from the command line.
#[derive(clap::Args)]
pub(crate) struct JobsArgs {
    /// Worker threads; does not affect results [default: one for each core; at most four for each]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

impl JobsArgs {
    /// The number of useful threads for this many games.
    pub(crate) fn threads(&self, games: usize) -> NonZeroUsize {
        experiment::threads(self.jobs, games)
    }
}
