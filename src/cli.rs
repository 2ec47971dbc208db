//! The command line as a whole: grouped help, first steps, shell completion scripts, man pages.

use crate::kinds::KINDS;
use crate::new_command::TEMPLATES;
use crate::{Cli, scenario_files, screen};
use anyhow::{Context, Result, bail};
use clap::builder::PossibleValuesParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, ArgMatches, Command, CommandFactory};
use command_line::explain::UsageError;
use command_line::number;
use experiment::tournament::Tournament;
use scenario::Kind;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::ExitCode;

/// The subcommands by purpose, in help order. Some builds lack the commands that need a network.
const GROUPS: [(&str, &[&str]); 6] = [
    ("Play", &["demo", "run", "tournament", "league", "sweep"]),
    ("Learn", &["train", "policy"]),
    (
        "Watch",
        &[
            "view", "watch", "list", "runs", "replay", "log", "import", "whatif", "helm",
        ],
    ),
    (
        "Over a network, and real boats",
        &["sim", "agent", "gateway", "moos", "ros", "keys"],
    ),
    ("Boats and seas", &["sea", "trial", "identify", "gap"]),
    (
        "Files",
        &[
            "files",
            "copy",
            "new",
            "strategy",
            "check",
            "schema",
            "completions",
            "man",
        ],
    ),
];

/// First steps, printed when no subcommand is given.
const FIRST: &str = "\
Squall simulates boats that play capture the flag.

  squall demo                         a windy game in the browser
  squall run strategy_4_vs_3          a game in the terminal
  squall run surveyor_2v2 --sea fresh_breeze --blue learned --view
  squall files                        games, seas and strategies by name
  squall new strategy mine            your own strategy file, to edit and play:
  squall run surveyor_2v2 --blue mine
  squall help                         everything else
";

#[derive(clap::Args)]
pub(crate) struct CompletionArgs {
    /// Shell to print the script for
    shell: clap_complete::Shell,
}

#[derive(clap::Args)]
pub(crate) struct ManArgs {
    /// Folder for the man pages
    folder: PathBuf,
}

/// The command line with its subcommands in groups.
pub(crate) fn command() -> Command {
    let command = Cli::command();
    let width = command
        .get_subcommands()
        .map(|one| one.get_name().len())
        .max()
        .unwrap_or(0);
    let mut text = String::new();
    for (group, names) in GROUPS {
        let mut lines = String::new();
        for one in names
            .iter()
            .filter_map(|name| command.find_subcommand(name))
        {
            // Use only the first sentence; the command's own help has the rest.
            let about = one.get_about().map(ToString::to_string).unwrap_or_default();
            let about = about.split([':', ';', ',']).next().unwrap_or_default();
            lines.push_str(&format!("  {:width$}  {about}\n", one.get_name()));
        }
        if !lines.is_empty() {
            text.push_str(&format!("{group}:\n{lines}\n"));
        }
    }
    text.push_str("`squall COMMAND --help` prints details and examples.\n");
    text.push_str("Exit codes: 0 success, 1 failure, 2 a mistake in the command line, 130 Ctrl-C.");
    command
        .help_template("{about}\n\n{usage-heading} {usage}{after-help}\n\nOptions:\n{options}")
        .after_help(text)
}

/// Parses the command line. If only a different build has the command, exits and names that build.
pub(crate) fn matches() -> ArgMatches {
    let mut command = number::with_negative_numbers(command());
    command
        .try_get_matches_from_mut(std::env::args_os())
        .unwrap_or_else(|mut error| {
            // For an unknown option, clap would suggest passing it as a recording.
            error.remove(ContextKind::Suggested);
            if let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand)
                && GROUPS
                    .iter()
                    .any(|(_, names)| names.contains(&name.as_str()))
                && command.find_subcommand(name).is_none()
            {
                screen::complain(&not_built(&format!("the command {name}")));
                std::process::exit(error.exit_code());
            }
            error.exit()
        })
}

/// The message for a command that this build does not include.
pub(crate) fn not_built(what: &str) -> String {
    format!(
        "{what} is unavailable because this program was built with --no-default-features; build it without that option"
    )
}

pub(crate) fn first() -> ExitCode {
    // Skip commands that only a different build understands.
    let command = |line: &str| {
        Some(
            line.trim()
                .strip_prefix("squall ")?
                .split("  ")
                .next()?
                .to_owned(),
        )
    };
    let is_known = |line: &&str| command(line).and_then(|words| refused(&words)).is_none();
    let lines: Vec<&str> = FIRST.lines().filter(is_known).collect();
    screen::print(&(lines.join("\n") + "\n"));
    ExitCode::SUCCESS
}

/// The error with which this build rejects a command line, if it does.
fn refused(words: &str) -> Option<clap::Error> {
    let words = std::iter::once("squall").chain(words.split_whitespace());
    let refused = Cli::command().try_get_matches_from(words).err()?;
    (refused.kind() != ErrorKind::DisplayHelp).then_some(refused)
}

/// Prints a script that completes commands, options, and names of the files that exist now.
pub(crate) fn completions(args: &CompletionArgs) -> ExitCode {
    let mut command = with_names(command());
    let mut script = vec![];
    clap_complete::generate(args.shell, &mut command, "squall", &mut script);
    screen::print(&String::from_utf8_lossy(&script));
    if args.shell == clap_complete::Shell::Fish {
        // clap_complete omits positional arguments for fish.
        for one in command.get_subcommands() {
            let values = one.get_positionals().flat_map(Arg::get_possible_values);
            let names: Vec<String> = values.map(|value| value.get_name().to_owned()).collect();
            if !names.is_empty() {
                let is_used = format!("__fish_squall_using_subcommand {}", one.get_name());
                screen::print(&format!(
                    "complete -c squall -n \"{is_used}\" -a \"{}\"\n",
                    names.join(" ")
                ));
            }
        }
    }
    ExitCode::SUCCESS
}

/// The command line, with the names of files as possible values of arguments.
fn with_names(command: Command) -> Command {
    let with_names_of = |arg: Arg| {
        let value = arg
            .get_value_names()
            .and_then(|names| names.first())
            .map(|name| name.to_lowercase());
        match value
            .map(|value| names_for(&value))
            .filter(|names| !names.is_empty())
        {
            // clap requires static names, and this process ends soon.
            Some(names) => arg.value_parser(PossibleValuesParser::new(
                names.into_iter().map(|name| &*name.leak()),
            )),
            None => arg,
        }
    };
    command.mut_args(with_names_of).mut_subcommands(with_names)
}

/// The possible names for a value with this placeholder in the help.
fn names_for(value: &str) -> BTreeSet<String> {
    let all = |kinds: &[Kind]| {
        kinds
            .iter()
            .flat_map(|kind| scenario_files::all_names(*kind))
            .collect()
    };
    match value {
        "kind" => KINDS.iter().map(|kind| kind.name().to_owned()).collect(),
        "template" => TEMPLATES.map(|(kind, _)| kind.name().to_owned()).into(),
        "scenario" => all(KINDS),
        "policy" => scenario_files::policies(),
        "tournament" => all(&[Kind::of::<Tournament>(), Kind::STRATEGY]),
        _ => all(KINDS
            .iter()
            .find(|kind| kind.name() == value)
            .map_or(&[], std::slice::from_ref)),
    }
}

pub(crate) fn man(args: &ManArgs) -> Result<ExitCode> {
    if let Some(command) = args
        .folder
        .to_str()
        .filter(|name| command().find_subcommand(name).is_some())
    {
        bail!(UsageError(format!(
            "expected a folder for the man pages, such as man1, found the command {command}; for its help, run: squall {command} --help"
        )));
    }
    crate::output_file::make_folder(&args.folder)?;
    clap_mangen::generate_to(Cli::command(), &args.folder)
        .with_context(|| format!("cannot write man pages to {}", args.folder.display()))?;
    screen::print(&format!(
        "wrote man pages to {}; read the first with: man {}/squall.1\n",
        args.folder.display(),
        args.folder.display()
    ));
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subcommand_is_in_one_group_and_its_help_has_an_example() {
        let command = Cli::command();
        let grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| names.iter().copied())
            .collect();
        let known: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        assert!(
            known.iter().all(|name| grouped.contains(name)),
            "{grouped:?} lacks one of {known:?}"
        );
        // Builds without the network lack the other commands.
        assert_eq!(
            grouped.len() == known.len(),
            cfg!(feature = "network"),
            "{grouped:?} and {known:?}"
        );
        for one in command.get_subcommands() {
            let examples = one
                .get_after_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            let example = format!("squall {}", one.get_name());
            assert!(
                examples.starts_with("Examples:") && examples.contains(&example),
                "{}: {examples:?}",
                one.get_name()
            );
        }
    }

    /// All options that take a value, each preceded by its subcommands.
    fn options(command: &Command, before: &[String]) -> Vec<Vec<String>> {
        let own = command
            .get_arguments()
            .filter(|arg| arg.get_action().takes_values());
        let own =
            own.filter_map(|arg| Some([before, &[format!("--{}", arg.get_long()?)]].concat()));
        let below = command.get_subcommands();
        let below =
            below.flat_map(|one| options(one, &[before, &[one.get_name().to_owned()]].concat()));
        own.chain(below).collect()
    }

    #[test]
    fn every_option_names_the_values_that_it_allows() {
        const RAW: [&str; 7] = [
            "invalid digit",
            "number too",
            "zero for non",
            "float literal",
            "empty string",
            "socket",
            "tip:",
        ];
        let all = number::with_negative_numbers(command());
        let options = options(&all, &[]);
        assert!(options.len() > 100, "{}", options.len());
        for option in options {
            for value in ["-1", "abc", "1e999", "99999999999999999999999", "1.5.", ""] {
                let line = ["squall".to_owned()]
                    .into_iter()
                    .chain(option.clone())
                    .chain([value.to_owned()]);
                let Err(error) = all.clone().try_get_matches_from(line) else {
                    continue;
                };
                let text = error.to_string();
                let is_explained = error.kind() != ErrorKind::ValueValidation
                    || ["expected", "allowed", "no recording", "there is no"]
                        .iter()
                        .any(|words| text.contains(words));
                assert!(
                    is_explained && !RAW.iter().any(|raw| text.contains(raw)),
                    "{option:?} {value:?}: {text}"
                );
            }
        }
    }

    #[test]
    fn the_lines_of_the_help_fit_a_terminal() {
        let help = command().render_help().to_string();
        let mut wrong: Vec<&str> = help.lines().chain(FIRST.lines()).collect();
        wrong.retain(|line| line.chars().count() > 80);
        assert_eq!(wrong, Vec::<&str>::new());
    }
}
