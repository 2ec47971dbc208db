//! A query on its way to those who answer it, and until it is answered.

use bus::Parcel;
use std::sync::Arc;

/// What is asked for.
#[derive(Clone, Debug)]
pub(crate) enum Asked {
    Payload(Parcel),
    /// Which tokens are there, as a list in JSON.
    Tokens,
}

/// A query that has reached a session which answers at its key.
pub(crate) struct RoutedQuery {
    pub(crate) session: usize,
    pub(crate) query: u64,
    pub(crate) key: String,
    pub(crate) payload: Parcel,
}

/// A query that has not been answered to the end.
pub(crate) struct PendingQuery {
    pub(crate) asker: usize,
    /// How many may still answer.
    pub(crate) open: usize,
    /// What is called with each answer, and with none when no more will come.
    pub(crate) take: Arc<dyn Fn(Option<Parcel>) + Send + Sync>,
}
