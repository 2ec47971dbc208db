//! `squall runs`: lists recorded games.

use crate::{explain, recording_file, screen};
use anyhow::Result;
use command_line::number::whole;
use recording::{Recording, utc};
use scenario::Outcome;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder with recordings
    #[arg(default_value = recording_file::FOLDER)]
    folder: PathBuf,
    /// Maximum number of games to list
    #[arg(long, value_name = "COUNT", default_value_t = 20, value_parser = whole::<usize>(1, u64::MAX))]
    count: usize,
}

/// The columns: name, when (UTC), length, score and strategies.
type Row = [String; 5];

pub(crate) fn run(args: &Args) -> ExitCode {
    let runs = recording_file::runs(&args.folder);
    if runs.is_empty() {
        screen::remark(&recording_file::none_in(&args.folder));
        return ExitCode::SUCCESS;
    }
    let mut rows = vec![["name", "when (UTC)", "length", "score", "strategies"].map(str::to_owned)];
    rows.extend(runs.iter().take(args.count).map(|path| {
        let unreadable = |error: anyhow::Error| {
            [
                recording_file::stem(path),
                String::new(),
                String::new(),
                String::new(),
                explain::line(&error),
            ]
        };
        row(path).unwrap_or_else(unreadable)
    }));
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let [name_width, when_width, length_width, score_width] = [0, 1, 2, 3].map(width);
    for [name, when, length, score, who] in &rows {
        let line = format!(
            "{name:name_width$}  {when:when_width$}  {length:>length_width$}  {score:>score_width$}  {who}"
        );
        screen::print(&(screen::cut(line.trim_end()) + "\n"));
    }
    if runs.len() > args.count {
        screen::print(&format!(
            "{} older games: list them with --count {}\n",
            runs.len() - args.count,
            runs.len()
        ));
    }
    ExitCode::SUCCESS
}

fn row(path: &Path) -> Result<Row> {
    let recording = Recording::open(path)?;
    let scenario = recording.scenario();
    let ending = recording.ending().map(|ending| &ending.outcome);
    let points = |outcome: &Outcome| -> Vec<String> {
        scenario
            .teams
            .iter()
            .map(|team| {
                outcome
                    .score
                    .teams
                    .get(&team.name)
                    .unwrap_or(&0)
                    .to_string()
            })
            .collect()
    };
    let strategy = |team: usize| {
        let boats = scenario
            .vehicles
            .iter()
            .filter(|vehicle| vehicle.team.index() == team);
        let mut names: Vec<&str> = boats
            .map(|boat| scenario.strategies[boat.strategy].name.as_str())
            .collect();
        names.dedup();
        names.join("+")
    };
    Ok([
        recording_file::stem(path),
        utc::text(recording.header().began_utc_ns)[5..16].to_owned(),
        ending.map_or("cut short".to_owned(), |outcome| {
            format!("{:.0} s", outcome.duration_s)
        }),
        ending.map_or_else(String::new, |outcome| points(outcome).join(" : ")),
        (0..scenario.teams.len())
            .map(strategy)
            .collect::<Vec<_>>()
            .join(" : "),
    ])
}
