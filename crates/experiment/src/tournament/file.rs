//! Tournament files: the entries, and the game they play against each other.

use scenario::keys::{FilePath, Name};
use scenario::sea::Sea;
use scenario::strategy::{Behaviour, Strategy, Task};
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
    /// Sea files, in place of `sea`: all games are played in each of them.
    #[serde(default)]
    #[schemars(with = "Vec<FilePath>", length(max = 16))]
    pub seas: Vec<PathBuf>,
    /// Games per pairing and sea, half of them on each side; odd numbers are rounded up.
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
    /// Strategy of all its boats: a strategy file, a trained model (`FILE.onnx`) or a competition
    /// entry (`host:FOLDER`).
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
    /// Group in the tables. Default: public for a competition entry, learned for a strategy with a
    /// model, otherwise rule_based.
    #[serde(default)]
    pub kind: Option<EntryKind>,
}

/// How an entry decides.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum EntryKind {
    /// By rules and behaviours.
    #[default]
    RuleBased,
    /// By a trained policy.
    Learned,
    /// By a search over plans.
    Planner,
    /// A published competition entry or policy.
    Public,
}

impl EntryKind {
    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            EntryKind::RuleBased => "rule_based",
            EntryKind::Learned => "learned",
            EntryKind::Planner => "planner",
            EntryKind::Public => "public",
        }
    }

    /// The default for an entry with this strategy.
    pub(super) fn of(strategy: &Strategy) -> EntryKind {
        let behaviours = strategy.roles.iter().flat_map(|role| &role.behaviours);
        let kind = |behaviour: &Behaviour| match &behaviour.task {
            Task::Policy(policy) if policy.host.is_some() => EntryKind::Public,
            Task::Policy(policy) if policy.model.is_some() => EntryKind::Learned,
            _ => EntryKind::RuleBased,
        };
        behaviours.map(kind).max().unwrap_or_default()
    }
}

impl Tournament {
    /// The seas in which every pairing plays; `None` is the game's own.
    pub fn seas(&self) -> Vec<Option<&PathBuf>> {
        if self.seas.is_empty() {
            return vec![self.sea.as_ref()];
        }
        self.seas.iter().map(Some).collect()
    }
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
        check_seas(document, &mut tournament);
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

/// Checks and resolves the seas, whose names must differ.
fn check_seas(document: &Document<Tournament>, tournament: &mut Tournament) {
    let mut names = BTreeSet::new();
    for (i, sea) in tournament.seas.iter_mut().enumerate() {
        let path = format!("seas.{i}");
        document.resolved::<Sea>(&path, sea);
        if !names.insert(sea.file_stem().map(ToOwned::to_owned)) {
            let message = format!("{} is named twice, expected different seas", sea.display());
            document.note(&path, message);
        }
    }
    if !names.is_empty() && tournament.sea.is_some() {
        document.note("sea", "is given with seas, expected one of them");
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
