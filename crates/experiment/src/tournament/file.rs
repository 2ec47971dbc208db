//! Tournament files: the entries, and the game they play against each other.

use scenario::keys::{FilePath, Name};
use scenario::sea::Sea;
use scenario::strategy::Strategy;
use scenario::{Document, Scenario, ScenarioFile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::PathBuf;

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

impl ScenarioFile for Tournament {
    type Keys = Tournament;
    const NAME: &'static str = "tournament";
    const FOLDER: &'static str = "tournaments";

    fn check(document: &Document<Tournament>) -> Option<Tournament> {
        let mut tournament = document.raw.clone();
        document.resolved::<Scenario>("game", &mut tournament.game);
        if let Some(sea) = &mut tournament.sea {
            document.resolved::<Sea>("sea", sea);
        }
        let names = check_entries(document, &mut tournament.entries);
        if let Some(challenger) = tournament
            .challenger
            .as_ref()
            .filter(|name| !names.contains(name))
        {
            let listed: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
            let message = format!(
                "challenger is {challenger:?}, expected an entry: {}",
                listed.join(", ")
            );
            document.note("challenger", message);
        }
        document.is_faultless().then_some(tournament)
    }
}

/// Checks and resolves the strategies of entries. Returns their names, which must differ.
pub(crate) fn check_entries<'a, K>(
    document: &Document<K>,
    entries: &'a mut [Entrant],
) -> BTreeSet<&'a String> {
    let mut names = BTreeSet::new();
    for (i, entry) in entries.iter_mut().enumerate() {
        let [name_path, path] = ["name", "strategy"].map(|key| format!("entry.{i}.{key}"));
        document.resolved::<Strategy>(&path, &mut entry.strategy);
        if document.is_sound(&name_path) && !names.insert(&entry.name) {
            let message = format!(
                "the name {:?} is used twice, expected a unique name for each entry",
                entry.name
            );
            document.note(&name_path, message);
        }
    }
    names
}
