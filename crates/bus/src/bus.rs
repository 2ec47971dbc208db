//! A node on the network: publishing, subscriptions, queries and liveliness tokens, with the node's
//! token and keys.

use crate::keys::Bundle;
use crate::net::is_loopback;
use crate::runtime::runtime;
use crate::session::{Declaration, Encoding, Sender, Session};
use crate::{BusError, Net, Token};
use messages::Message;
use messages::external::GatewayStatus;
use messages::topic::{self, GameName};
use primitives::codec;
use scenario::Scenario;
use serde::Serialize;
use std::ops::Deref;
use std::sync::Arc;

/// Message priority. No message waits for a link: a congested link drops messages that it cannot
/// accept immediately, and senders repeat those that must arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// Stops of boats, and commands and requests: sent immediately, before all other messages.
    Urgent,
    /// All messages sent at every decision.
    Normal,
}

/// How a QUIC link treats the messages of a publisher. All other links are reliable and in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// In order; a lost packet is sent again, and the packets after it wait.
    Reliable,
    /// Each message in its own datagram. A lost one is not sent again and does not delay others.
    Newest,
}

impl Delivery {
    /// For messages sent at every decision: in lockstep each message counts, whereas in real time
    /// the next one replaces it.
    pub fn per_decision(is_lockstep: bool) -> Delivery {
        if is_lockstep {
            Delivery::Reliable
        } else {
            Delivery::Newest
        }
    }
}

/// The session of a node, with its token and keys. Clones share the session.
#[derive(Clone)]
pub struct Bus {
    pub(crate) session: Arc<dyn Session>,
    /// The game's token, if known.
    pub(crate) token: Option<Token>,
    /// The keys of this node, in a game with keys.
    pub keys: Option<Arc<Bundle>>,
    /// Whether the connection to the hub uses loopback.
    pub(crate) is_on_this_machine: bool,
}

/// Operations that need no token, keys or callback are methods of the session.
impl Deref for Bus {
    type Target = dyn Session;

    fn deref(&self) -> &Self::Target {
        &*self.session
    }
}

/// Sends messages on one key.
pub struct Publisher(Box<dyn Sender>);

impl Bus {
    /// Opens the hub of a game.
    ///
    /// # Errors
    /// [`BusError`] if it cannot listen at its endpoints.
    pub fn hub(net: &Net, game: &GameName, scenario: &Scenario) -> Result<Bus, BusError> {
        runtime()
            .open_hub(net, game, scenario)
            .map(|session| Bus::of(session, net))
    }

    /// Connects to a hub.
    ///
    /// # Errors
    /// [`BusError`] if no hub responds there, or if it does not accept this node's keys.
    pub fn leaf(net: &Net) -> Result<Bus, BusError> {
        runtime()
            .open_leaf(net)
            .map(|session| Bus::of(session, net))
    }

    fn of(session: Arc<dyn Session>, net: &Net) -> Bus {
        let is_on_this_machine =
            !net.lan && net.connect.iter().all(|endpoint| is_loopback(endpoint));
        Bus {
            session,
            token: net.token.clone(),
            keys: net.keys.clone(),
            is_on_this_machine,
        }
    }

    /// The same session, with this token for the node.
    pub fn with_token(self, token: Option<Token>) -> Bus {
        Bus { token, ..self }
    }

    /// Prepares to publish on `key`.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn publisher(&self, key: String, priority: Priority) -> Result<Publisher, BusError> {
        self.session
            .publisher(key, priority, Delivery::Reliable)
            .map(Publisher)
    }

    /// Prepares to publish on `key` with the given delivery over QUIC links.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn publisher_with(
        &self,
        key: String,
        priority: Priority,
        delivery: Delivery,
    ) -> Result<Publisher, BusError> {
        self.session
            .publisher(key, priority, delivery)
            .map(Publisher)
    }

    /// Calls `receive` with the bytes of every message published on `key`.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn subscribe(
        &self,
        key: String,
        receive: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        self.session.subscribe(key, true, Box::new(receive))
    }

    /// Like [`Bus::subscribe`], but without this session's own messages.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn subscribe_remote(
        &self,
        key: String,
        receive: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        self.session.subscribe(key, false, Box::new(receive))
    }

    /// Calls `take` with every status of this boat's gateway; drops unreadable statuses and those
    /// of other boats.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn subscribe_status(
        &self,
        game: &GameName,
        vehicle: &str,
        take: impl Fn(GatewayStatus) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        let name = vehicle.to_owned();
        self.subscribe(topic::status(game, vehicle), move |bytes| {
            let status = serde_json::from_slice::<GatewayStatus>(bytes).ok();
            // Operators read the name in the status; a status whose name does not match its key is
            // invalid.
            status
                .filter(|status| status.vehicle == name)
                .into_iter()
                .for_each(&take);
        })
    }

    /// Calls `receive` with the key of every liveliness token under `key` that appears (`true`) or
    /// disappears, starting with the tokens already present.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn watch_alive(
        &self,
        key: String,
        receive: impl Fn(&str, bool) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        self.session.watch_alive(key, Box::new(receive))
    }

    /// Calls `receive` with the identifier of every node that loses its link to this hub.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn watch_links(
        &self,
        receive: impl Fn(String) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        self.session.watch_links(Box::new(receive))
    }
}

impl Publisher {
    /// Whether the key has a subscriber. Without one, messages need not be encoded.
    pub fn is_heard(&self) -> bool {
        self.0.is_heard()
    }

    /// Sends a message as CDR, with its name and version in the encoding.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send<M: Message + Serialize>(&self, message: &M) -> Result<(), BusError> {
        self.send_encoded::<M>(codec::encode(message))
    }

    /// Sends a message that is already encoded as CDR.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send_encoded<M: Message>(&self, bytes: Vec<u8>) -> Result<(), BusError> {
        self.0.send(
            bytes,
            Encoding::Cdr {
                schema: M::SCHEMA,
                version: M::VERSION,
            },
        )
    }

    /// Sends JSON bytes.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send_json(&self, json: Vec<u8>) -> Result<(), BusError> {
        self.0.send(json, Encoding::Json)
    }

    /// Sends bytes without a stated encoding.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send_raw(&self, bytes: Vec<u8>) -> Result<(), BusError> {
        self.0.send(bytes, Encoding::Bytes)
    }
}
