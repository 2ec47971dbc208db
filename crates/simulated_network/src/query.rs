//! Queries in flight and queries not fully answered.

use bus::Parcel;
use std::sync::Arc;

/// The subject of a query.
#[derive(Clone, Debug)]
pub(crate) enum Asked {
    Payload(Parcel),
    /// The tokens present, as a JSON list.
    Tokens,
}

/// A query that has reached a session with a matching queryable.
pub(crate) struct RoutedQuery {
    pub(crate) session: usize,
    pub(crate) query: u64,
    pub(crate) key: String,
    pub(crate) payload: Parcel,
}

/// A query whose answers are not complete.
pub(crate) struct PendingQuery {
    pub(crate) asker: usize,
    /// How many sessions may still answer.
    pub(crate) open: usize,
    /// Called with each answer, and with `None` after the last one.
    pub(crate) take: Arc<dyn Fn(Option<Parcel>) + Send + Sync>,
}
