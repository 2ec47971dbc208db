//! A session on a network, as [`Bus`](crate::Bus) uses it: publish, subscribe, queries, liveliness tokens.

use crate::parcel::Parcel;
use crate::{BusError, Priority};
use std::time::Duration;

/// Something declared that lasts as long as this is kept.
pub struct Declaration(#[expect(dead_code, reason = "kept for its drop")] Box<dyn Send + Sync>);

impl Declaration {
    /// Keeps `declared`, which ends when it is dropped.
    pub fn new(declared: impl Send + Sync + 'static) -> Declaration {
        Declaration(Box::new(declared))
    }
}

/// Receives the bytes of a message.
pub type OnBytes = Box<dyn Fn(&[u8]) + Send + Sync>;
/// Receives a question, and what answers it.
pub type OnQuery = Box<dyn Fn(Parcel, Box<dyn PendingQuery>) + Send + Sync>;
/// Receives the key of a node, and whether it has come (`true`) or gone.
pub type OnToken = Box<dyn Fn(&str, bool) + Send + Sync>;
/// Receives the identifier of a node whose link is gone.
pub type OnLinkLost = Box<dyn Fn(String) + Send + Sync>;

/// How bytes are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// CDR, of a message of this schema and version.
    Cdr {
        /// The name of the schema, as ROS 2 has it.
        schema: &'static str,
        /// The version of the layout.
        version: u8,
    },
    /// JSON.
    Json,
    /// Of no kind that is stated.
    Bytes,
}

/// A session. Callbacks run on its threads and must only hand over. All methods fail if the session is closed.
#[expect(clippy::missing_errors_doc, reason = "all for the same reason")]
pub trait Session: Send + Sync {
    /// Its own identifier, unique on the network.
    fn id(&self) -> String;

    /// Prepares to publish on `key`.
    fn publisher(&self, key: String, priority: Priority) -> Result<Box<dyn Sender>, BusError>;

    /// Calls `receive` with everything that is published on `key`; where `hears_own`, also with what this session publishes.
    fn subscribe(&self, key: String, hears_own: bool, receive: OnBytes) -> Result<Declaration, BusError>;

    /// Calls `receive` with every query at `key`.
    fn answer(&self, key: String, receive: OnQuery) -> Result<Declaration, BusError>;

    /// Asks at `key`, and gives the first answer within `limit` that `accept` says yes to. If it is not urgent, it goes behind everything
    /// that is published.
    fn ask(
        &self,
        priority: Priority,
        key: &str,
        question: Parcel,
        limit: Duration,
        accept: &mut dyn FnMut(&Parcel) -> bool,
    ) -> Result<Option<Parcel>, BusError>;

    /// Shows a liveliness token under `key`, until dropped or dead.
    fn show_alive(&self, key: String) -> Result<Declaration, BusError>;

    /// Calls `receive` with every token under `key`, beginning with those that are there.
    fn watch_alive(&self, key: String, receive: OnToken) -> Result<Declaration, BusError>;

    /// Calls `receive` with every node whose link to this hub is gone.
    fn watch_links(&self, receive: OnLinkLost) -> Result<Declaration, BusError>;

    /// All tokens under `key` that are there now.
    fn who_is_alive(&self, key: &str, limit: Duration) -> Result<Vec<String>, BusError>;

    /// Closes the session, so that the others need not find out.
    fn close(&self);
}

/// Sends on one key.
pub trait Sender: Send + Sync {
    /// Whether anybody listens.
    fn is_heard(&self) -> bool;

    /// Sends bytes.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    fn send(&self, bytes: Vec<u8>, encoding: Encoding) -> Result<(), BusError>;
}

/// A query that has not been answered yet. Dropped, it will not be.
pub trait PendingQuery: Send + Sync {
    /// The key that was asked.
    fn key(&self) -> &str;

    /// Answers with JSON. Whoever asked may be gone by now; then nobody misses the answer.
    fn answer(self: Box<Self>, answer: Parcel);
}

/// Whether two key expressions have a key in common.
#[must_use]
pub fn keys_meet(one: &str, other: &str) -> bool {
    use zenoh::key_expr::keyexpr;
    one == other || matches!((keyexpr::new(one), keyexpr::new(other)), (Ok(one), Ok(other)) if one.intersects(other))
}
