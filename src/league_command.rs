//! `squall league`: a tournament of all known strategies that keeps its results.

use crate::screen;
use crate::tournament_command::{self as tournament, GamesArgs};
use anyhow::Result;
use scenario::argument_for;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Strategies that join the entries of the file: files or names, FILE.onnx for a trained policy,
    /// host:FOLDER for a competition entry
    #[arg(value_name = "STRATEGY")]
    strategies: Vec<String>,
    /// Tournament with the entries: a file or a name
    #[arg(long, value_name = "TOURNAMENT", default_value = "league")]
    file: String,
    /// Folder for the results
    #[arg(long, value_name = "FOLDER", default_value = "runs/league")]
    folder: PathBuf,
    #[command(flatten)]
    games: GamesArgs,
}

pub(crate) fn run(args: Args) -> Result<ExitCode> {
    let mut file = tournament::read(&args.file)?;
    file.entries.extend(tournament::entrants(&args.strategies)?);
    tournament::names_of(&file.entries)?;
    let page = format!("squall view {}", argument_for(&args.folder));
    let all = tournament::Args {
        entries: vec![],
        game: None,
        games: args.games,
        json: None,
        csv: None,
        league: Some(args.folder),
        quality: false,
    };
    let code = tournament::run_file(file, &all)?;
    screen::remark(&format!("to see ratings, cycles and games: {page}"));
    Ok(code)
}
