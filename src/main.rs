//! `squall`: one program with many subcommands.

mod both_sides;
mod check_command;
mod cli;
mod game_args;
mod gap_command;
mod helm_text;
mod identify_command;
mod import_command;
mod in_process;
mod jobs_args;
mod kinds;
mod league_command;
mod league_file;
mod log_command;
mod minds;
#[cfg(feature = "network")]
mod network;
mod new_command;
mod plot;
mod policy_command;
mod progress;
mod record_args;
mod replay_command;
mod result_table;
mod run_command;
mod runs_command;
mod screen;
mod sea_command;
mod strategy_command;
mod submission;
mod sweep_command;
mod tournament_command;
mod train_command;
mod trial_command;
mod watch_files;
mod water_args;
mod whatif_command;

use anyhow::Result;
use clap::{ColorChoice, FromArgMatches, Parser, Subcommand};
use command_line::{
    clock, explain, output_file, program, recording_file, scenario_files, stop, style,
};
use std::process::ExitCode;

/// The version, and the commit from which it was built.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("SQUALL_COMMIT"), ")");

/// A simulator for unmanned surface vehicles that play capture the flag.
#[derive(Parser)]
#[command(name = "squall", version = VERSION, max_term_width = 100)]
struct Cli {
    /// When to use colours: auto, always or never
    #[arg(long, global = true, value_name = "WHEN", default_value_t = ColorChoice::Auto, hide_possible_values = true, display_order = 1000)]
    color: ColorChoice,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    #[cfg(feature = "network")]
    #[command(flatten)]
    Network(Box<network::Command>),
    #[cfg(not(feature = "network"))]
    /// Plays a whole game, shows its events, and prints the result.
    #[command(
        after_help = "Examples:\n  squall run strategy_4_vs_3\n  squall run surveyor_2v2 --sea fresh_breeze --blue learned --red strategy_3\n  squall run strategy_4_vs_3 --set link.delay_s=1 --seed 7 --both-sides"
    )]
    Run(Box<run_command::Args>),
    #[cfg(not(feature = "network"))]
    /// Verifies that a rerun reproduces a recorded game.
    #[command(after_help = "Examples:\n  squall replay --check")]
    Replay(replay_command::Args),
    /// Plays every strategy against every other over many seeds, and ranks them with confidence
    /// intervals.
    #[command(
        after_help = "Examples:\n  squall tournament paper_2023 --games 20\n  squall tournament strategy_4 strategy_3 --games 40\n  squall tournament simple --json report.json --quality\n  squall tournament simple --league league"
    )]
    Tournament(tournament_command::Args),
    /// Plays missing games of a league: built-in strategies and yours.
    #[command(
        after_help = "Examples:\n  squall league --games 10\n  squall league mine.onnx host:entry\n  squall view runs/league"
    )]
    League(league_command::Args),
    /// Measures how much disturbance strategies tolerate: wind, noise and failures.
    #[command(after_help = "Examples:\n  squall sweep wind\n  squall sweep wind --resume")]
    Sweep(sweep_command::Args),
    /// Trains a policy against itself, earlier versions of itself and scripted strategies.
    #[command(after_help = "Examples:\n  squall train first\n  squall train first --resume")]
    Train(train_command::Args),
    /// Lists recorded games, newest first.
    #[command(after_help = "Examples:\n  squall runs")]
    Runs(runs_command::Args),
    /// Analyses a recorded game: summary, tables, MOOS logs, comparison with another game.
    #[command(
        after_help = "Examples:\n  squall log\n  squall log strategy_4_vs_3 --csv events\n  squall log --compare strategy_4_vs_3 surveyor_2v2\n  squall log --turning-points --futures 50"
    )]
    Log(log_command::Args),
    /// Imports logs of other programs: MOOS, ArduPilot, ROS, NMEA 0183, CSV.
    #[command(
        after_help = "Examples:\n  squall import alpha.alog bravo.alog --out game.mcap\n  squall import blue_one=00000042.BIN red_one=flight.tlog\n  squall import track.csv --map t=epoch_ms,speed=SOG:kn,heading=HDT:deg"
    )]
    Import(import_command::Args),
    /// Plays futures of a recorded game with changed strategies or sea.
    #[command(
        after_help = "Examples:\n  squall whatif --at 60 --blue strategy_5 --futures 20\n  squall whatif strategy_4_vs_3 --at 60 --vehicle red_1=learned --futures 20 --record future.mcap"
    )]
    Whatif(whatif_command::Args),
    /// Describes and plots a sea and its effects on a boat.
    #[command(
        after_help = "Examples:\n  squall sea gale\n  squall sea gale --boat heron --plot gale.svg\n  squall sea --from field.nmea --out bay.toml"
    )]
    Sea(sea_command::Args),
    /// Drives one boat through recorded commands or a standard manoeuvre.
    #[command(after_help = "Examples:\n  squall trial surveyor_m1_8 --manoeuvre turning_circle")]
    Trial(trial_command::Args),
    /// Fits a boat file to recorded data, and reports the quality of the fit.
    #[command(after_help = "Examples:\n  squall identify --help")]
    Identify(identify_command::Args),
    /// Compares a real boat with simulated ones given the same commands.
    #[command(after_help = "Examples:\n  squall gap --help")]
    Gap(gap_command::Args),
    /// Explains a strategy file: its modes and their behaviours.
    #[command(
        after_help = "Examples:\n  squall strategy strategy_4\n  squall strategy pav01 --dot"
    )]
    Strategy(strategy_command::Args),
    /// Describes a trained policy, and explains a decision that it made in a recorded game.
    #[command(after_help = "Examples:\n  squall policy options")]
    Policy(policy_command::Args),
    /// Checks scenario files and explains every error.
    #[command(after_help = "Examples:\n  squall check mine")]
    Check(check_command::Args),
    /// Prints the JSON Schema of a kind of scenario file, for editors.
    #[command(after_help = "Examples:\n  squall schema game")]
    Schema(check_command::SchemaArgs),
    /// Lists your own and the built-in scenario files.
    #[command(after_help = "Examples:\n  squall files\n  squall files strategy")]
    Files(new_command::FilesArgs),
    /// Copies a built-in file so that you can edit it.
    #[command(after_help = "Examples:\n  squall copy strategy_4 my_team\n  squall copy seas/gale")]
    Copy(new_command::CopyArgs),
    /// Creates a scenario file from a commented template.
    #[command(
        after_help = "Examples:\n  squall new strategy mine\n  squall new sweep how_much_wind"
    )]
    New(new_command::NewArgs),
    /// Prints a shell completion script.
    #[command(
        after_help = "Examples:\n  source <(squall completions bash)\n  source <(squall completions zsh)\n  squall completions fish | source"
    )]
    Completions(cli::CompletionArgs),
    /// Writes man pages to a folder.
    #[command(after_help = "Examples:\n  squall man man1")]
    Man(cli::ManArgs),
}

fn main() -> ExitCode {
    program::set("squall", "squall gateway");
    scenario_files::install(kinds::KINDS);
    let cli = Cli::from_arg_matches(&cli::matches()).unwrap_or_else(|error| error.exit());
    screen::set_colour(cli.color);
    let done = cli.command.map_or_else(|| Ok(cli::first()), run);
    match done.and_then(|code| screen::check_output().map(|()| code)) {
        Ok(code) => code,
        Err(error) => explain::report(&error),
    }
}

fn run(command: Command) -> Result<ExitCode> {
    match command {
        #[cfg(feature = "network")]
        Command::Network(command) => network::run(&command),
        #[cfg(not(feature = "network"))]
        Command::Run(args) => {
            run_command::run(&args, &mut run_command::InProcess { jobs: args.jobs })
        }
        #[cfg(not(feature = "network"))]
        Command::Replay(args) if args.check => replay_command::check(args.file.as_deref()),
        #[cfg(not(feature = "network"))]
        Command::Replay(_) => Err(anyhow::anyhow!(
            "{}; to verify the recording, use --check",
            cli::not_built("the page that shows recordings")
        )),
        Command::Tournament(args) => tournament_command::run(&args),
        Command::League(args) => league_command::run(args),
        Command::Whatif(args) => whatif_command::run(&args),
        Command::Sweep(args) => sweep_command::run(&args),
        Command::Train(args) => train_command::run(&args),
        Command::Runs(args) => Ok(runs_command::run(&args)),
        Command::Import(args) => import_command::run(&args),
        Command::Log(args) => log_command::run(&args),
        Command::Sea(args) => sea_command::run(&args),
        Command::Trial(args) => trial_command::run(&args),
        Command::Identify(args) => identify_command::run(&args),
        Command::Gap(args) => gap_command::run(&args),
        Command::Strategy(args) => strategy_command::run(&args),
        Command::Policy(args) => policy_command::run(&args),
        Command::Check(args) => check_command::run(&args),
        Command::Schema(args) => check_command::print_schema(&args),
        Command::Files(args) => Ok(new_command::files(&args)),
        Command::Copy(args) => new_command::copy(&args),
        Command::New(args) => new_command::new(&args),
        Command::Completions(args) => Ok(cli::completions(&args)),
        Command::Man(args) => cli::man(&args),
    }
}
