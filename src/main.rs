//! `squall`: one program, a table of subcommands.

mod agent_command;
mod both_sides;
mod check_command;
mod child_process;
mod game_args;
mod gateway_command;
mod hardware_loop;
mod helm_command;
mod helm_text;
mod identify_command;
mod keys_command;
mod list_command;
mod log_command;
mod net_args;
mod observer;
mod output_file;
mod page_args;
mod plot;
mod policy_command;
mod printer;
mod record_args;
mod recording_file;
mod replay_command;
mod result_table;
mod run_command;
mod screen;
mod sea_command;
mod sim_command;
mod stop;
mod strategy_command;
mod sweep_command;
mod tournament_command;
mod tournament_progress;
mod train_command;
mod trial_command;
mod view_command;
mod watch_command;
mod water_args;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// The version, and the commit it was built from.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("SQUALL_COMMIT"), ")");

/// A distributed swarm simulator for unmanned surface vehicles that play capture the flag.
#[derive(Parser)]
#[command(name = "squall", version = VERSION, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Plays a whole game: starts the sim and the agents, shows what happens, prints the result.
    Run(run_command::Args),
    /// Plays every strategy against every other over many seeds, and says who is better, and how surely.
    Tournament(tournament_command::Args),
    /// Plays strategies at many points of a space of scenarios: more wind, worse sensors, slower links.
    Sweep(sweep_command::Args),
    /// Trains a policy by playing against itself, strategies and what it was.
    Train(train_command::Args),
    /// Serves one game to agents and gateways that join it.
    Sim(sim_command::Args),
    /// Decides for one or many boats in a game that a sim serves.
    Agent(agent_command::Args),
    /// Shows a running game in the terminal, or one boat's helm.
    Watch(watch_command::Args),
    /// Shows a running game on a page.
    View(view_command::Args),
    /// Shows a recorded game again, or checks that the same comes of it.
    Replay(replay_command::Args),
    /// Says what a recorded game tells: a summary, tables, plots, MOOS logs, and how it differs from another.
    Log(log_command::Args),
    /// Dumps one decision of a boat's helm: a table, numbers, pictures.
    Helm(helm_command::Args),
    /// Brings real boats into games, and lets real back seats drive simulated ones.
    Gateway(gateway_command::Args),
    /// Makes keys for a network with strangers in it: encrypted links, and certificates that say who may do what.
    Keys(keys_command::Args),
    /// Lists the games on the network and how they stand.
    List(list_command::Args),
    /// Says what a sea means for a boat, and draws it.
    Sea(sea_command::Args),
    /// Puts one boat in open water through recorded commands or a standard manoeuvre.
    Trial(trial_command::Args),
    /// Fits a boat file to a recorded series, and says how well.
    Identify(identify_command::Args),
    /// Shows what a strategy file means: its modes, and what may run in each.
    Strategy(strategy_command::Args),
    /// Tells what a trained policy is, and explains a decision of it in a recorded game.
    Policy(policy_command::Args),
    /// Checks scenario files and explains every error.
    Check(check_command::Args),
    /// Prints the JSON Schema of a kind of scenario file, for editors.
    Schema(check_command::SchemaArgs),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    // `run` only hands keys on: what it starts without keys must not have the threads of those with keys.
    let is_run = matches!(cli.command, Command::Run(_));
    if !is_run && let Err(error) = child_process::with_threads_for_keys() {
        screen::complain(&format!("{error:#}"));
        return ExitCode::FAILURE;
    }
    let done = match cli.command {
        Command::Run(args) => run_command::run(&args),
        Command::Tournament(args) => tournament_command::run(&args),
        Command::Sweep(args) => sweep_command::run(&args),
        Command::Train(args) => train_command::run(&args),
        Command::Sim(args) => sim_command::run(&args),
        Command::Agent(args) => agent_command::run(&args),
        Command::Watch(args) => watch_command::run(&args),
        Command::View(args) => view_command::run(&args),
        Command::Replay(args) => replay_command::run(&args),
        Command::Log(args) => log_command::run(&args),
        Command::Helm(args) => helm_command::run(&args),
        Command::Gateway(args) => gateway_command::run(&args),
        Command::Keys(args) => keys_command::run(&args),
        Command::List(args) => list_command::run(&args),
        Command::Sea(args) => sea_command::run(&args),
        Command::Trial(args) => trial_command::run(&args),
        Command::Identify(args) => identify_command::run(&args),
        Command::Strategy(args) => strategy_command::run(&args),
        Command::Policy(args) => policy_command::run(&args),
        Command::Check(args) => check_command::run(&args),
        Command::Schema(args) => check_command::print_schema(&args),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            screen::complain(&format!("{error:#}"));
            ExitCode::FAILURE
        }
    }
}
