//! `squall check` and `squall schema`: validate scenario files and print their schemas.

use crate::kinds::KINDS;
use crate::{explain, scenario_files, screen, style};
use anyhow::{Result, bail};
use scenario::{Kind, check_file, did_you_mean, load, schema};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario files of any kind, or their names
    #[arg(required = true, value_name = "SCENARIO", value_parser = scenario_files::find_any)]
    files: Vec<Vec<PathBuf>>,
}

#[derive(clap::Args)]
pub(crate) struct SchemaArgs {
    /// Kind of file: game, field, rules, boat, sea, strategy, tournament, gateway, rewards,
    /// training or sweep
    #[arg(value_parser = kind)]
    kind: Kind,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut errors = 0;
    for file in args.files.iter().flatten() {
        if !scenario_files::is_toml(file) {
            errors += 1;
            screen::print(&format!(
                "{}: not a scenario file, expected NAME.toml\n",
                file.display()
            ));
            continue;
        }
        match check_file(KINDS, file) {
            Ok(kind) => {
                screen::show(&format!(
                    "{}: {} {kind}\n",
                    file.display(),
                    style::good("valid")
                ));
                for warning in warnings(file, kind) {
                    screen::show(&format!("  {} {warning}\n", style::warning("warning:")));
                }
            }
            Err(problems) => {
                errors += problems.0.len();
                screen::show(&format!("{}\n", explain::problems(&problems)));
            }
        }
    }
    match errors {
        0 => Ok(ExitCode::SUCCESS),
        1 => bail!("1 error"),
        _ => bail!("{errors} errors"),
    }
}

/// Warnings about requirements that the boats of a valid game cannot meet.
fn warnings(file: &Path, kind: Kind) -> Vec<String> {
    if kind != Kind::GAME {
        return Vec::new();
    }
    load(file)
        .map(|scenario| agent::warnings(&scenario))
        .unwrap_or_default()
}

pub(crate) fn print_schema(args: &SchemaArgs) -> Result<ExitCode> {
    screen::print(&(serde_json::to_string_pretty(&schema(args.kind))? + "\n"));
    Ok(ExitCode::SUCCESS)
}

/// Parses the name of a kind, or of its folder.
pub(crate) fn kind(word: &str) -> Result<Kind, String> {
    let names: Vec<&str> = KINDS.iter().map(|kind| kind.name()).collect();
    let found = KINDS
        .iter()
        .copied()
        .find(|kind| [kind.name(), kind.folder()].contains(&word));
    found.ok_or_else(|| {
        format!(
            "expected one of {}{}",
            names.join(", "),
            did_you_mean(word, &names)
        )
    })
}
