//! `squall new` and `squall copy`: create a scenario file for editing.

use crate::check_command;
use crate::kinds::KINDS;
use crate::{output_file, scenario_files, screen};
use anyhow::{Result, bail};
use command_line::explain::UsageError;
use experiment::sweep::Sweep;
use experiment::tournament::Tournament;
use scenario::{Kind, did_you_mean};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The kinds of files that have a template.
pub(crate) const TEMPLATES: [(Kind, &str); 7] = [
    (Kind::STRATEGY, include_str!("templates/strategy.toml")),
    (Kind::BOAT, include_str!("templates/boat.toml")),
    (Kind::SEA, include_str!("templates/sea.toml")),
    (Kind::GAME, include_str!("templates/game.toml")),
    (Kind::of::<Sweep>(), include_str!("templates/sweep.toml")),
    (
        Kind::of::<learn::training::Training>(),
        include_str!("templates/training.toml"),
    ),
    (
        Kind::of::<Tournament>(),
        include_str!("templates/tournament.toml"),
    ),
];

#[derive(clap::Args)]
pub(crate) struct NewArgs {
    /// Kind of file: strategy, boat, sea, game, sweep, training or tournament
    #[arg(value_name = "TEMPLATE", value_parser = template)]
    kind: (Kind, &'static str),
    /// Name of the new file: a-z, 0-9 and _
    #[arg(value_parser = name)]
    name: String,
}

#[derive(clap::Args)]
pub(crate) struct CopyArgs {
    /// Name of the file, with its folder if several kinds share the name, as in seas/calm
    #[arg(value_name = "SCENARIO")]
    name: String,
    /// Name of the copy [default: the same name]
    #[arg(value_parser = name)]
    as_name: Option<String>,
}

#[derive(clap::Args)]
pub(crate) struct FilesArgs {
    /// Lists and describes only files of this kind: game, field, rules, boat, sea, strategy,
    /// tournament, gateway, rewards, training or sweep
    #[arg(value_parser = check_command::kind)]
    kind: Option<Kind>,
}

fn template(word: &str) -> Result<(Kind, &'static str), String> {
    let kinds: Vec<&str> = TEMPLATES.iter().map(|(kind, _)| kind.name()).collect();
    let found = TEMPLATES.into_iter().find(|(kind, _)| kind.name() == word);
    found.ok_or_else(|| {
        format!(
            "expected one of {}{}",
            kinds.join(", "),
            did_you_mean(word, &kinds)
        )
    })
}

fn name(word: &str) -> Result<String, String> {
    let is_name = !word.is_empty()
        && word
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if is_name {
        Ok(word.to_owned())
    } else {
        Err("expected a name from a-z, 0-9 and _".to_owned())
    }
}

pub(crate) fn new(
    NewArgs {
        kind: (kind, text),
        name,
    }: &NewArgs,
) -> Result<ExitCode> {
    let path = write(*kind, name, text.replace("NAME", name).as_bytes())?;
    screen::print(&format!(
        "created {}; edit it, then check it with: squall check {name}\n",
        path.display()
    ));
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn copy(args: &CopyArgs) -> Result<ExitCode> {
    let (folder, name) = args
        .name
        .split_once('/')
        .map_or((None, args.name.as_str()), |(f, name)| (Some(f), name));
    let name = name.strip_suffix(".toml").unwrap_or(name);
    let is_asked = |kind: &Kind| folder.is_none_or(|folder| folder == kind.folder());
    let of = |kind: Kind| Some((kind, scenario_files::contents(kind, name)?));
    let found: Vec<(Kind, &[u8])> = KINDS
        .iter()
        .copied()
        .filter(is_asked)
        .filter_map(of)
        .collect();
    let (kind, content) = match found[..] {
        [one] => one,
        [] => {
            let known: Vec<String> = KINDS
                .iter()
                .copied()
                .filter(is_asked)
                .flat_map(scenario_files::names)
                .collect();
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let guess = did_you_mean(name, &known);
            bail!(UsageError(format!(
                "no file named {:?}{guess}; list all files with: squall files",
                args.name
            )));
        }
        [(one, _), (other, _), ..] => {
            let one = one.folder();
            let other = other.folder();
            bail!(UsageError(format!(
                "the name {name:?} is ambiguous: use {one}/{name} or {other}/{name}"
            )));
        }
    };
    let path = write(kind, args.as_name.as_deref().unwrap_or(name), content)?;
    screen::print(&format!(
        "created {}; edit it as you like\n",
        path.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// Writes a file to a folder where its name will be looked up; never overwrites an existing file.
fn write(kind: Kind, name: &str, content: &[u8]) -> Result<PathBuf> {
    let path = Path::new("scenarios")
        .join(kind.folder())
        .join(format!("{name}.toml"));
    if path.exists() {
        bail!(UsageError(format!(
            "the file {} already exists; choose another name",
            path.display()
        )));
    }
    if let Some(folder) = path.parent() {
        output_file::make_folder(folder)?;
    }
    output_file::write(&path, "the file", content)?;
    if scenario_files::contents(kind, name).is_some_and(|built_in| built_in != content) {
        scenario_files::announce(&path);
    }
    Ok(path)
}

/// Lists the user's own files with descriptions, then the names of the built-in ones by kind. For a
/// single kind, also describes the built-in ones.
pub(crate) fn files(args: &FilesArgs) -> ExitCode {
    let kinds = args.kind.as_ref().map_or(KINDS, std::slice::from_ref);
    let mut own: Vec<[String; 2]> = vec![];
    for &kind in kinds {
        for (name, path) in scenario_files::own(kind) {
            let overrides = scenario_files::contents(kind, &name)
                .map_or("", |_| "overrides the built-in file; ");
            let about = std::fs::read(&path)
                .map(|bytes| description(&bytes))
                .unwrap_or_default();
            own.push([path.display().to_string(), format!("{overrides}{about}")]);
        }
    }
    if !own.is_empty() {
        screen::print(&format!("your own files:\n{}\nbuilt in:\n", rows(&own)));
    }
    match args.kind {
        Some(kind) => {
            let row = |name: String| {
                let about = scenario_files::contents(kind, &name)
                    .map(description)
                    .unwrap_or_default();
                [name, about]
            };
            let described: Vec<[String; 2]> =
                scenario_files::names(kind).into_iter().map(row).collect();
            screen::print(&rows(&described));
        }
        None => {
            let kinds = KINDS
                .iter()
                .map(|kind| (kind.folder(), scenario_files::names(*kind)));
            for (folder, names) in kinds.chain([("policies", scenario_files::policies())]) {
                let names: Vec<String> = names.into_iter().collect();
                screen::print(&screen::wrapped(&format!("{folder}: {}", names.join(" "))));
            }
        }
    }
    ExitCode::SUCCESS
}

/// Names and descriptions in columns, each on a line that fits the terminal.
fn rows(rows: &[[String; 2]]) -> String {
    let width = rows
        .iter()
        .map(|[name, _]| name.chars().count())
        .max()
        .unwrap_or(0);
    rows.iter()
        .map(|[name, about]| screen::cut(&format!("  {name:width$}  {about}")) + "\n")
        .collect()
}

/// The description of a scenario file: its key `about`, otherwise the first sentence of its first
/// comment.
fn description(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    if let Some(about) = text
        .lines()
        .find_map(|line| line.strip_prefix("about = \"")?.strip_suffix('"'))
    {
        return about.to_owned();
    }
    let comment = text
        .lines()
        .skip_while(|line| !line.starts_with("# "))
        .map_while(|line| line.strip_prefix("# "));
    let comment = comment.collect::<Vec<_>>().join(" ");
    comment
        .split_once(". ")
        .map_or(comment.as_str(), |(first, _)| first)
        .trim_end_matches('.')
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::check_file;

    #[test]
    fn every_template_is_a_good_file_with_nothing_else_on_the_disk() {
        scenario_files::install(KINDS);
        let folder = tempfile::tempdir().expect("a folder");
        for (kind, text) in TEMPLATES {
            let file = folder
                .path()
                .join("scenarios")
                .join(kind.folder())
                .join("mine.toml");
            std::fs::create_dir_all(file.parent().expect("it has one")).expect("it is made");
            std::fs::write(&file, text.replace("NAME", "mine")).expect("it is written");
            assert_eq!(
                check_file(KINDS, &file).unwrap_or_else(|problems| panic!("{problems}")),
                kind
            );
        }
    }
}
