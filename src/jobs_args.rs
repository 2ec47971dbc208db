//! `--jobs`: the number of worker threads.

use command_line::number::whole;
use std::num::NonZeroUsize;

#[derive(clap::Args)]
pub(crate) struct JobsArgs {
    /// Number of worker threads, at most four per core; does not affect results [default: one per
    /// core]
    #[arg(long, value_name = "N", value_parser = whole::<NonZeroUsize>(1, u64::MAX))]
    jobs: Option<NonZeroUsize>,
}

impl JobsArgs {
    /// The number of threads that are useful for this many games.
    pub(crate) fn threads(&self, games: usize) -> NonZeroUsize {
        experiment::threads(self.jobs, games)
    }
}
