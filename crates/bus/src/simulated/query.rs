//! A query on its way to those who answer it, and until it is answered.

use crate::parcel::Parcel;
use std::sync::Arc;

/// What is asked for.
#[derive(Clone, Debug)]
pub(super) enum Asked {
    Payload(Parcel),
    /// Which tokens are there, as a list in JSON.
    Tokens,
}

/// A query that has reached a session which answers at its key.
pub(super) struct RoutedQuery {
    pub(super) session: usize,
    pub(super) query: u64,
    pub(super) key: String,
    pub(super) payload: Parcel,
}

/// A query that has not been answered to the end.
pub(super) struct PendingQuery {
    pub(super) asker: usize,
    /// How many may still answer.
    pub(super) open: usize,
    /// What is called with each answer, and with none when no more will come.
    pub(super) take: Arc<dyn Fn(Option<Parcel>) + Send + Sync>,
}
