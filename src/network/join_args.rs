//! Command line arguments of a process that controls boats: the game, and how long to wait for it.

use command_line::leaf_args::LeafArgs;
use command_line::number::seconds;

#[derive(clap::Args)]
pub(crate) struct JoinArgs {
    #[command(flatten)]
    pub(crate) leaf: LeafArgs,
    /// How long to look for the sim and wait for its boats to become free, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    pub(crate) wait_s: f64,
    /// How long to wait for a picture before treating the sim as lost, s (5 s if the sim leaves the
    /// network)
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    pub(crate) silence_s: f64,
}
