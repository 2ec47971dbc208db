//! A plan with all that its games need, for a process on another machine.

use crate::plan::Plan;
use game::scenario::{Files, Problems};
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;

/// A plan with all that its games need: where it is unpacked no file is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed {
    /// The checked sweep, JSON.
    pub sweep: String,
    /// Every file that its games need, in the order in which it asks for them: those that name others first.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// The plan's digest.
    pub digest: String,
}

/// Why a plan cannot be unpacked.
#[derive(Debug, Error)]
pub enum UnpackError {
    /// The sweep is none.
    #[error("the packed sweep cannot be read: {0}")]
    Sweep(#[from] serde_json::Error),
    /// The game cannot be read from the packed files.
    #[error("{0}")]
    Game(#[from] Problems),
    /// It is another one here.
    #[error(
        "the sweep is another one here than where it was packed: expected digest {expected}, found {found}; \
         both need the same version of Squall, here it is {}",
        game::VERSION
    )]
    Other {
        /// The digest where it was packed.
        expected: String,
        /// The one here.
        found: String,
    },
}

impl Packed {
    /// Packs a plan.
    ///
    /// # Panics
    /// Never: every sweep is JSON.
    #[must_use]
    pub fn new(plan: &Plan) -> Packed {
        Packed {
            sweep: serde_json::to_string(plan.sweep()).expect("it has names for keys"),
            files: plan.files().into_iter().map(|(path, bytes)| (path, bytes.to_vec())).collect(),
            digest: plan.digest(),
        }
    }

    /// The plan. Its points are not looked at again.
    ///
    /// # Errors
    /// [`UnpackError`]: it is damaged, or another version of Squall packed it.
    pub fn unpack(self) -> Result<Plan, UnpackError> {
        let sweep = serde_json::from_str(&self.sweep)?;
        let plan = Plan::unchecked(&sweep, Arc::new(Files::kept(self.files)))?;
        let found = plan.digest();
        if found == self.digest { Ok(plan) } else { Err(UnpackError::Other { expected: self.digest, found }) }
    }
}
