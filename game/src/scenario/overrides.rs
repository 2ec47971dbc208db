//! What takes the place of what a game says: files of those it names, simulated boats of real ones.

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
}
