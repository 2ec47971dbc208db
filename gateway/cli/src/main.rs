//! `squall-gateway`: the gateway commands as a separate program, for the small computer on a boat.

use clap::{ColorChoice, CommandFactory, FromArgMatches, Parser};
use command_line::{explain, leaf_args, number, program, scenario_files, terminal};
use std::process::ExitCode;

/// The commit that the program was built from.
const COMMIT: &str = env!("SQUALL_COMMIT");
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("SQUALL_COMMIT"), ")");

/// Connects a real boat to Squall's games: checks, drives and stops it.
#[derive(Parser)]
#[command(name = "squall-gateway", version = VERSION, max_term_width = 100)]
struct Cli {
    /// When to use colours: auto, always or never
    #[arg(long, global = true, value_name = "WHEN", default_value_t = ColorChoice::Auto, hide_possible_values = true, display_order = 1000)]
    color: ColorChoice,
    #[command(subcommand)]
    command: gateway_cli::Command,
}

fn main() -> ExitCode {
    program::set("squall-gateway", "squall-gateway");
    scenario_files::install(gateway_cli::KINDS);
    let matches = number::with_negative_numbers(Cli::command()).get_matches();
    let Cli { color, command } =
        Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    terminal::set_colour(color);
    let done = leaf_args::restart_with_threads_for_keys()
        .and_then(|()| gateway_cli::run(&command, COMMIT));
    done.and_then(|code| terminal::check_output().map(|()| code))
        .unwrap_or_else(|error| explain::report(&error))
}
