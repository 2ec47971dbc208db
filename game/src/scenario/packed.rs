//! A plan of many games with all that they need, for a process on another machine.

use super::{Files, Problems};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;

/// A sweep or a tournament with all that its games need: where it is unpacked no file is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed {
    /// The checked file, JSON.
    pub spec: String,
    /// Every file that its games need, in the order in which it asks for them: those that name others first.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// The plan's digest.
    pub digest: String,
}

/// Why a plan cannot be unpacked.
#[derive(Debug, Error)]
pub enum UnpackError {
    /// The checked file is none.
    #[error("the packed plan cannot be read: {0}")]
    Spec(#[from] serde_json::Error),
    /// The game cannot be read from the packed files.
    #[error("{0}")]
    Game(#[from] Problems),
    /// It is another one here.
    #[error(
        "the games are others here than where they were packed: expected digest {expected}, found {found}; \
         both need the same version of Squall, here it is {}",
        crate::VERSION
    )]
    Other {
        /// The digest where it was packed.
        expected: String,
        /// The one here.
        found: String,
    },
}

impl Packed {
    /// Packs the plan of a checked file.
    ///
    /// # Panics
    /// If `spec` is no JSON: its maps have keys that are no texts.
    #[must_use]
    pub fn new(spec: &impl Serialize, files: Vec<(PathBuf, Arc<[u8]>)>, digest: String) -> Packed {
        Packed {
            spec: serde_json::to_string(spec).expect("it has names for keys"),
            files: files.into_iter().map(|(path, bytes)| (path, bytes.to_vec())).collect(),
            digest,
        }
    }

    /// The plan that `plan` makes of the checked file and its files; `digest` identifies it.
    ///
    /// # Errors
    /// [`UnpackError`]: it is damaged, or another version of Squall packed it.
    pub fn unpack<S: DeserializeOwned, P>(
        self,
        plan: impl FnOnce(&S, Arc<Files>) -> Result<P, Problems>,
        digest: impl FnOnce(&P) -> String,
    ) -> Result<P, UnpackError> {
        let plan = plan(&serde_json::from_str(&self.spec)?, Arc::new(Files::kept(self.files)))?;
        let found = digest(&plan);
        if found == self.digest { Ok(plan) } else { Err(UnpackError::Other { expected: self.digest, found }) }
    }
}

/// Identifies a plan by what its file means and what the files of its games say: hex.
#[must_use]
pub fn digest_of(meaning: &str, files: &[(PathBuf, Arc<[u8]>)]) -> String {
    let contents: Vec<u128> = files.iter().map(|(_, bytes)| xxhash_rust::xxh3::xxh3_128(bytes)).collect();
    let text = format!("{} {meaning} {contents:x?}", crate::VERSION);
    format!("{:032x}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()))
}
