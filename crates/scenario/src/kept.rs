//! Cached results of files: redrawing a game does not read its files again.

use super::diagnostics::Diagnostics;
use super::kind::Kind;
use super::source::Sources;
use super::tree::Node;
use crate::strategy::Strategy;
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the kind, path, and owner: for strategies, a team with its own values in it.
pub(super) type Key = (&'static str, PathBuf, String);

/// The results of files without faults.
#[derive(Clone, Debug, Default)]
pub(super) struct Kept {
    pub(super) documents: BTreeMap<Key, KeptDocument>,
    pub(super) strategies: BTreeMap<Key, Strategy>,
}

/// A file merged with its bases.
#[derive(Clone, Debug)]
pub(super) struct KeptDocument {
    pub(super) tree: Arc<Node>,
    /// Its values by field; none if it has numbers to draw.
    pub(super) value: Option<Json>,
}

pub(super) fn key(kind: Kind, path: &Path, owner: &str) -> Key {
    (
        kind.name(),
        path.to_owned(),
        if kind == Kind::STRATEGY {
            owner.to_owned()
        } else {
            String::new()
        },
    )
}

/// The basis of a game, with the texts that its places refer to. It follows from the texts, so
/// comparisons and recordings exclude it.
#[derive(Clone, Debug, Default)]
pub(super) struct Reading(pub(super) Option<Arc<(Sources, Arc<Kept>)>>);

impl Reading {
    pub(super) fn of(diagnostics: Diagnostics) -> Reading {
        Reading(Some(Arc::new((diagnostics.sources, diagnostics.kept))))
    }

    /// The files whose values no setting overrides.
    pub(super) fn of_unchanged(mut diagnostics: Diagnostics) -> Reading {
        let kept = Arc::make_mut(&mut diagnostics.kept);
        let is_unchanged = |(kind, ..): &Key| !diagnostics.overrides.has_settings(kind);
        kept.documents.retain(|key, _| is_unchanged(key));
        kept.strategies.retain(|key, _| is_unchanged(key));
        Reading::of(diagnostics)
    }
}

impl PartialEq for Reading {
    fn eq(&self, _: &Reading) -> bool {
        true
    }
}
