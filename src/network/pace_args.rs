//! Command line arguments for the pace of a game and the nodes that it waits for; shared by `run`
//! and `sim`.

use super::child_process::{self, option};
use crate::game_args::GameArgs;
use anyhow::Result;
use command_line::number::seconds;
use scenario::Setting;
use sim::node::Pace;
use std::process::Command;

#[derive(Clone, clap::Args)]
pub(crate) struct PaceArgs {
    /// Pace of the game: lockstep, realtime, or a multiple of real time, such as 4x
    #[arg(long, default_value = "lockstep", allow_hyphen_values = true)]
    pub(crate) pace: Pace,
    /// In lockstep: initial speed limit, as a multiple of real time; the page can change it
    /// [default: none]
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = speed)]
    pub(crate) speed: Option<f64>,
    /// How long to wait for missing agents and gateways before starting without them, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    pub(crate) join_s: f64,
}

impl PaceArgs {
    /// A process that serves this game, or a part of it, under a name.
    pub(crate) fn sim(&self, game: &GameArgs, name: &str, endpoint: &str) -> Result<Command> {
        let runtime = if self.pace == Pace::Lockstep {
            bus::RUNTIME
        } else {
            bus::HUB_RUNTIME
        };
        let mut command =
            child_process::squall_with(runtime, &["sim", "--game", name, "--listen", endpoint])?;
        command.arg(game.file());
        let overrides = game.overrides()?;
        option(
            &mut command,
            "--sea",
            overrides.sea.as_ref().map(|sea| sea.display()),
        );
        for (team, path) in &overrides.strategies {
            option(
                &mut command,
                "--strategy",
                Some(format!("{team}={}", path.display())),
            );
        }
        command.args(
            overrides
                .exchange_strategies
                .then_some("--exchange-strategies"),
        );
        command.args(overrides.simulate_all.then_some("--rehearse"));
        for Setting { key, value, .. } in &overrides.settings {
            option(&mut command, "--set", Some(format!("{key}={value}")));
        }
        option(&mut command, "--pace", Some(self.pace));
        option(&mut command, "--seed", game.seed);
        Ok(command)
    }
}

/// Parses a speed such as `10x` or `0.5`.
fn speed(text: &str) -> Result<f64, String> {
    let factor = text.strip_suffix('x').unwrap_or(text).parse().ok();
    let factor = factor.filter(|factor| (0.01..=1000.0).contains(factor));
    factor.ok_or_else(|| "expected a factor from 0.01x to 1000x, such as 10x".to_owned())
}
