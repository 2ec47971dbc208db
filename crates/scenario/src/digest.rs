//! Digests that identify games independently of the location of their files.

use super::Scenario;
use std::path::PathBuf;
use std::sync::Arc;

/// The digest of a tournament or sweep, in hex. It covers the version of Squall, the parsed
/// content, `meaning`, and the files of the games.
pub fn digest_of(meaning: &str, files: &[(PathBuf, Arc<[u8]>)]) -> String {
    let contents = files
        .iter()
        .map(|(_, bytes)| xxhash_rust::xxh3::xxh3_128(bytes));
    let contents: Vec<u128> = contents.collect();
    let text = format!("{} {meaning} {contents:x?}", primitives::VERSION);
    format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()))
}

impl Scenario {
    /// The digest, in hex, that identifies this scenario's games for all seeds with this version of
    /// Squall. It does not depend on file locations.
    ///
    /// # Panics
    /// If the scenario cannot be serialised as JSON, as with map keys that are not strings.
    pub fn digest(&self) -> String {
        let files = self.recipe.iter().flat_map(|recipe| &recipe.files);
        let texts = files.map(|(path, text)| (path.clone(), text.as_bytes().into()));
        let texts: Vec<(PathBuf, Arc<[u8]>)> = texts.collect();
        let meant = Scenario {
            seed: 0,
            recipe: None,
            ..self.clone()
        };
        digest_of(
            &serde_json::to_string(&meant).expect("its map keys are strings"),
            &texts,
        )
    }
}
