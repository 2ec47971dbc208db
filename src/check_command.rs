//! `squall check` and `squall schema`: validate scenario files and print their schemas.

use crate::kinds::KINDS;
use crate::{explain, screen, style};
use anyhow::{Result, anyhow, bail};
use scenario::{Kind, check_file, load, schema};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario files of any kind
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

#[derive(clap::Args)]
pub(crate) struct SchemaArgs {
    /// Kind of file: game, field, rules, boat, sea, strategy, tournament, gateway, rewards, training or sweep
    kind: String,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut errors = 0;
    for file in &args.files {
        if file.extension().is_none_or(|end| end != "toml") {
            errors += 1;
            screen::print(&format!("{}: not a scenario file, expected NAME.toml\n", file.display()));
            continue;
        }
        match check_file(KINDS, file) {
            Ok(kind) => {
                screen::show(&format!("{}: {} {kind}\n", file.display(), style::good("valid")));
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

/// Demands of a valid game that its boats cannot meet.
fn warnings(file: &Path, kind: Kind) -> Vec<String> {
    if kind != Kind::GAME {
        return Vec::new();
    }
    load(file).map(|scenario| agent::warnings(&scenario)).unwrap_or_default()
}

pub(crate) fn print_schema(args: &SchemaArgs) -> Result<ExitCode> {
    let kinds = || KINDS.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
    let kind = KINDS.iter().copied().find(|kind| kind.name() == args.kind);
    let kind =
        kind.ok_or_else(|| anyhow!("unknown kind of scenario file {:?}; expected one of {}", args.kind, kinds()))?;
    screen::print(&(serde_json::to_string_pretty(&schema(kind))? + "\n"));
    Ok(ExitCode::SUCCESS)
}
