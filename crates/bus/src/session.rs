//! The session interface behind [`Bus`](crate::Bus): publishing, subscriptions, queries, liveliness
//! tokens.

use crate::parcel::Parcel;
use crate::{BusError, Delivery, Priority};
use std::time::Duration;

/// A declaration that lasts until dropped.
pub struct Declaration(#[expect(dead_code, reason = "kept for its drop")] Box<dyn Send + Sync>);

impl Declaration {
    /// Keeps `declared`, and drops it when dropped itself.
    pub fn new(declared: impl Send + Sync + 'static) -> Declaration {
        Declaration(Box::new(declared))
    }
}

/// Receives the bytes of a message.
pub type OnBytes = Box<dyn Fn(&[u8]) + Send + Sync>;
/// Receives a query and a handle to answer it.
pub type OnQuery = Box<dyn Fn(Parcel, Box<dyn PendingQuery>) + Send + Sync>;
/// Receives the key of a liveliness token, and whether the token has appeared (`true`) or
/// disappeared.
pub type OnToken = Box<dyn Fn(&str, bool) + Send + Sync>;
/// Receives the identifier of a node that has lost its link.
pub type OnLinkLost = Box<dyn Fn(String) + Send + Sync>;

/// The encoding of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// CDR of a message with this schema and version.
    Cdr {
        /// The schema's name, as in ROS 2.
        schema: &'static str,
        /// The version of the layout.
        version: u8,
    },
    /// JSON.
    Json,
    /// No stated encoding.
    Bytes,
}

/// A session. Callbacks run on its threads and must only pass data on. All methods that return a
/// result fail if the session is closed.
#[expect(clippy::missing_errors_doc, reason = "all for the same reason")]
pub trait Session: Send + Sync {
    /// The session's identifier, unique on the network.
    fn id(&self) -> String;

    /// Prepares to publish on `key`.
    fn publisher(
        &self,
        key: String,
        priority: Priority,
        delivery: Delivery,
    ) -> Result<Box<dyn Sender>, BusError>;

    /// Calls `receive` with every message published on `key`, including this session's own if
    /// `hears_own` is set.
    fn subscribe(
        &self,
        key: String,
        hears_own: bool,
        receive: OnBytes,
    ) -> Result<Declaration, BusError>;

    /// Calls `receive` with every query at `key`.
    fn answer(&self, key: String, receive: OnQuery) -> Result<Declaration, BusError>;

    /// Queries `key`, and returns the bytes of the first answer within `limit` that `accept`
    /// accepts. A query that is not urgent has lower priority than all published messages.
    fn ask(
        &self,
        priority: Priority,
        key: &str,
        question: Parcel,
        limit: Duration,
        accept: &mut dyn FnMut(&Parcel) -> bool,
    ) -> Result<Option<Vec<u8>>, BusError>;

    /// Declares a liveliness token under `key`. It lasts until it is dropped or the node dies.
    fn show_alive(&self, key: String) -> Result<Declaration, BusError>;

    /// Calls `receive` with every token that appears or disappears under `key`, starting with the
    /// tokens already present.
    fn watch_alive(&self, key: String, receive: OnToken) -> Result<Declaration, BusError>;

    /// Calls `receive` with every node that loses its link to this hub.
    fn watch_links(&self, receive: OnLinkLost) -> Result<Declaration, BusError>;

    /// All tokens present under `key`.
    fn who_is_alive(&self, key: &str, limit: Duration) -> Result<Vec<String>, BusError>;

    /// Closes the session; other nodes learn of this immediately.
    fn close(&self);
}

/// Sends on one key.
pub trait Sender: Send + Sync {
    /// Whether the key has a subscriber.
    fn is_heard(&self) -> bool;

    /// Sends bytes.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    fn send(&self, bytes: Vec<u8>, encoding: Encoding) -> Result<(), BusError>;
}

/// A query that has not been answered yet. Dropping it leaves it unanswered.
pub trait PendingQuery: Send + Sync {
    /// The key of the query.
    fn key(&self) -> &str;

    /// Answers with JSON. If the querying node has left, the answer is dropped.
    fn answer(self: Box<Self>, answer: Parcel);
}

/// Whether two key expressions intersect.
pub fn keys_meet(one: &str, other: &str) -> bool {
    use zenoh::key_expr::keyexpr;
    one == other
        || matches!((keyexpr::new(one), keyexpr::new(other)), (Ok(one), Ok(other)) if one.intersects(other))
}
