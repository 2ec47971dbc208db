//! Digests that identify games wherever their files lie.

use super::Scenario;
use std::path::PathBuf;
use std::sync::Arc;

/// Identifies a plan by what its file means and what the files of its games say: hex.
#[must_use]
pub fn digest_of(meaning: &str, files: &[(PathBuf, Arc<[u8]>)]) -> String {
    let contents: Vec<u128> = files.iter().map(|(_, bytes)| xxhash_rust::xxh3::xxh3_128(bytes)).collect();
    let text = format!("{} {meaning} {contents:x?}", primitives::VERSION);
    format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()))
}

impl Scenario {
    /// Identifies the games of all seeds that can be played of it with this version of Squall, wherever its files lie: hex.
    ///
    /// # Panics
    /// If it is no JSON: its maps have keys that are no texts.
    #[must_use]
    pub fn digest(&self) -> String {
        let texts: Vec<(PathBuf, Arc<[u8]>)> = match &self.recipe {
            None => vec![],
            Some(recipe) => recipe.files.iter().map(|(path, text)| (path.clone(), text.as_bytes().into())).collect(),
        };
        let meant = Scenario { seed: 0, recipe: None, ..self.clone() };
        digest_of(&serde_json::to_string(&meant).expect("it has names for keys"), &texts)
    }
}
