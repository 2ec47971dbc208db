//! Overrides of a game's content: different files, single values, and simulation of real boats.

use super::setting::Setting;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Overrides of a game's content. Overridden files are not read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Overrides {
    /// The sea file.
    pub sea: Option<PathBuf>,
    /// Strategy files by team name; they also replace the strategies of individual boats.
    pub strategies: BTreeMap<String, PathBuf>,
    /// Whether to exchange the strategies of the two teams; requires that no boat has its own
    /// strategy.
    #[serde(default)]
    pub exchange_strategies: bool,
    /// Whether this is a rehearsal: all boats are simulated, whatever their source.
    pub simulate_all: bool,
    /// Overrides of single values; for each key, the last one counts.
    #[serde(default)]
    pub settings: Vec<Setting>,
}

impl Overrides {
    /// Whether a setting overrides a value in files of the kind with this name.
    pub(super) fn has_settings(&self, kind: &str) -> bool {
        let mut targets = self.settings.iter().filter_map(Setting::target);
        targets.any(|(target, _)| target.name() == kind)
    }

    /// The owner of a team's strategy file: this team if a setting overrides a value of its
    /// strategy, otherwise an empty name, because teams without overrides share a file.
    pub(super) fn owner_of_strategy<'a>(&self, team: &'a str) -> &'a str {
        let mut settings = self.settings.iter();
        let has_own = settings.any(|setting| setting.team() == Some(team));
        if has_own { team } else { "" }
    }
}
