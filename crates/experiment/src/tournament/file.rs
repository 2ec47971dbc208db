//! Tournament files: the entries, and the game they play against each other.

use scenario::keys::{FilePath, Name};
use scenario::sea::Sea;
use scenario::{
    Diagnostics, Document, Files, Overrides, Problems, Scenario, ScenarioFile, StrategyFiles, load_with_files,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

/// Every entry against every other in one game, over many seeds and from both sides.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Tournament {
    /// The tournament file's stem.
    #[schemars(skip)]
    pub name: String,
    /// Game file, whose strategies are replaced by the entries'.
    #[schemars(with = "FilePath")]
    pub game: PathBuf,
    /// Sea file. Default: the game's.
    #[schemars(with = "Option<FilePath>")]
    pub sea: Option<PathBuf>,
    /// Games per pairing, half of them on each side; odd numbers are rounded up.
    #[schemars(range(min = 2, max = 1000000), extend("default" = 200))]
    pub games: u32,
    /// First seed, incremented every two games of a pairing.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub seed: u64,
    /// Whether entries also play against themselves.
    #[schemars(extend("default" = false))]
    pub self_play: bool,
    /// Name of an entry: only its pairings are played. Default: all pairings.
    #[schemars(with = "Option<Name>")]
    pub challenger: Option<String>,
    /// The strategies compared.
    #[serde(rename = "entry")]
    #[schemars(length(min = 2, max = 100))]
    pub entries: Vec<Entrant>,
}

/// An entry.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Entrant {
    /// Name in the tables.
    #[schemars(with = "Name")]
    pub name: String,
    /// Strategy file of all its boats.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
}

impl Tournament {
    /// The names of the game's teams, the first one first.
    ///
    /// # Errors
    /// All problems in the game's files.
    pub fn teams(&self, files: &Arc<Files>) -> Result<Vec<String>, Problems> {
        Ok(load_with_files(&self.game, &Overrides::default(), files)?.teams.into_iter().map(|team| team.name).collect())
    }

    /// The overrides of the game's files when one entry plays as the first of these teams and
    /// another as the second.
    ///
    /// # Panics
    /// If an entry does not exist.
    #[must_use]
    pub fn overrides(&self, teams: &[String], sides: [usize; 2]) -> Overrides {
        let of_side = |side: usize| self.entries[side].strategy.clone();
        let strategies: BTreeMap<String, PathBuf> = teams.iter().cloned().zip(sides.map(of_side)).collect();
        Overrides { sea: self.sea.clone(), strategies, ..Overrides::default() }
    }

    /// The game in which one entry plays as the first team and another as the second.
    ///
    /// # Errors
    /// All problems in any file.
    ///
    /// # Panics
    /// If an entry does not exist.
    pub fn game_of(&self, teams: &[String], sides: [usize; 2], files: &Arc<Files>) -> Result<Scenario, Problems> {
        load_with_files(&self.game, &self.overrides(teams, sides), files)
    }
}

impl ScenarioFile for Tournament {
    type Keys = Tournament;
    const NAME: &'static str = "tournament";
    const FOLDER: &'static str = "tournaments";

    fn check(diagnostics: &mut Diagnostics, document: &Document<Tournament>) -> Option<Tournament> {
        let mut tournament = document.raw.clone();
        diagnostics.referenced::<Scenario, _>(document, "game", &tournament.game);
        tournament.game = diagnostics.resolve(document.at("game"), &tournament.game);
        if let Some(sea) = &mut tournament.sea {
            diagnostics.referenced::<Sea, _>(document, "sea", &*sea);
            *sea = diagnostics.resolve(document.at("sea"), &*sea);
        }
        let mut strategies = StrategyFiles::default();
        let mut names = BTreeSet::new();
        for (i, entry) in tournament.entries.iter_mut().enumerate() {
            let [name_path, path] = ["name", "strategy"].map(|key| format!("entry.{i}.{key}"));
            entry.strategy = strategies.read(diagnostics, document, &path, &entry.strategy);
            if document.is_sound(&name_path) && !names.insert(&entry.name) {
                let message = format!("the name {:?} is used twice, expected a unique name for each entry", entry.name);
                diagnostics.note(document.at(&name_path), message);
            }
        }
        if let Some(challenger) = tournament.challenger.as_ref().filter(|name| !names.contains(name)) {
            let listed: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
            let message = format!("challenger is {challenger:?}, expected an entry: {}", listed.join(", "));
            diagnostics.note(document.at("challenger"), message);
        }
        document.is_faultless(diagnostics).then_some(tournament)
    }
}
