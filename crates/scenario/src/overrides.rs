//! What takes the place of what a game says: files of those it names, simulated boats of real ones.

use super::kind::Kind;
use super::setting::Setting;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What is put in the place of what a game says. Files that are replaced are not read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Overrides {
    /// The sea file.
    pub sea: Option<PathBuf>,
    /// Strategy files by team name: all boats of that team follow it, those that name one of their own too.
    pub strategies: BTreeMap<String, PathBuf>,
    /// Each of the two teams follows the strategy of the other; the game must give no boat one of its own.
    #[serde(default)]
    pub exchange_strategies: bool,
    /// A rehearsal: every boat is simulated, whatever the game says of its source.
    pub simulate_all: bool,
    /// Single values in the place of what files say; of several for one key the last counts.
    #[serde(default)]
    pub settings: Vec<Setting>,
}

impl Overrides {
    /// Whether a single value takes the place of what files of this kind say.
    pub(super) fn has_settings(&self, kind: Kind) -> bool {
        self.settings.iter().any(|setting| setting.target().is_some_and(|(target, _)| target == kind))
    }

    /// The name of this team if a single value takes the place of what its strategy says, or else none: who owns the strategy's file,
    /// which teams share that change nothing in it.
    pub(super) fn owner_of_strategy<'a>(&self, team: &'a str) -> &'a str {
        if self.settings.iter().any(|setting| setting.team() == Some(team)) { team } else { "" }
    }
}
