//! Files that take the place of those a game names.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What is put in the place of a game's own files. What is replaced is not read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Overrides {
    /// The sea file.
    pub sea: Option<PathBuf>,
    /// Strategy files by team name: all boats of that team follow it, those that name one of their own too.
    pub strategies: BTreeMap<String, PathBuf>,
}
