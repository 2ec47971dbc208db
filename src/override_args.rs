//! What takes the place of what a game says: what `run` and `sim` ask alike.

use crate::water_args::names_in;
use anyhow::{Result, bail};
use game::scenario::{Kind, Overrides};
use std::path::{Path, PathBuf};

/// Files and boats, from the command line.
#[derive(clap::Args)]
pub(crate) struct OverrideArgs {
    /// A sea file in place of the game's own
    #[arg(long, value_name = "FILE")]
    sea: Option<PathBuf>,
    /// The strategy of all boats of the team blue, also of those that the game gives one of their own: a file, or the
    /// name of one in the folder strategies beside the game's
    #[arg(long, value_name = "FILE")]
    blue: Option<String>,
    /// The same for the team red
    #[arg(long, value_name = "FILE")]
    red: Option<String>,
    /// The same for a team of any name; may be given again for another
    #[arg(long, value_name = "TEAM=FILE", value_parser = team_and_file)]
    strategy: Vec<(String, String)>,
    /// Plays external boats as simulated ones: a rehearsal
    #[arg(long)]
    rehearse: bool,
}

impl OverrideArgs {
    /// What takes the place of what the game at `game` says.
    pub(crate) fn overrides(&self, game: &Path) -> Result<Overrides> {
        let mut overrides = Overrides { sea: self.sea.clone(), simulate_all: self.rehearse, ..Overrides::default() };
        let named = [("blue", &self.blue), ("red", &self.red)];
        let named = named.into_iter().filter_map(|(team, file)| Some((team, file.as_deref()?)));
        for (team, file) in named.chain(self.strategy.iter().map(|(team, file)| (team.as_str(), file.as_str()))) {
            let path = strategy_file(file, game)?;
            if overrides.strategies.insert(team.to_owned(), path).is_some() {
                bail!("the strategy of team {team} is given twice, expected one");
            }
        }
        Ok(overrides)
    }
}

/// The same as arguments of another process of this program.
pub(crate) fn words(overrides: &Overrides) -> Vec<String> {
    let sea = overrides.sea.iter().flat_map(|sea| ["--sea".to_owned(), sea.display().to_string()]);
    let strategies = overrides.strategies.iter();
    let strategies =
        strategies.flat_map(|(team, path)| ["--strategy".to_owned(), format!("{team}={}", path.display())]);
    let rehearse = overrides.simulate_all.then(|| "--rehearse".to_owned());
    sea.chain(strategies).chain(rehearse).collect()
}

/// A team and its file from the command line.
fn team_and_file(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((team, file)) if !team.is_empty() && !file.is_empty() => Ok((team.to_owned(), file.to_owned())),
        _ => Err(format!("{text:?} is not TEAM=FILE")),
    }
}

/// A file, or the name of one in the folder of strategies that lies beside that of the game.
fn strategy_file(named: &str, game: &Path) -> Result<PathBuf> {
    let given = PathBuf::from(named);
    if given.is_file() {
        return Ok(given);
    }
    if named.ends_with(".toml") || named.contains(['/', '\\']) {
        bail!("there is no strategy file {named}");
    }
    let folder = game.parent().unwrap_or(Path::new("")).join("..").join(Kind::Strategy.folder());
    let path = folder.join(format!("{named}.toml"));
    if !path.is_file() {
        let names = names_in(&folder).join(", ");
        bail!("there is no file {named}, and no strategy of that name in {}: {names}", folder.display());
    }
    Ok(path)
}
