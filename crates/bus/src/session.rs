//! A node's session on the network: publish, subscribe, queries, liveliness tokens.

use crate::error::reason;
use crate::keys::{self, Bundle};
use crate::net::{FILES_MAX, is_loopback, nodes_max};
use crate::open_files::OpenFiles;
use crate::simulated::{self, SimulatedPublisher, SimulatedSession};
use crate::{BusError, Net, Token, admission, linger};
use messages::Message;
use messages::topic::GameName;
use primitives::codec;
use scenario::Scenario;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use zenoh::bytes::Encoding;
use zenoh::qos::{self, CongestionControl};
use zenoh::sample::{Locality, SampleKind};
use zenoh::{Session, Wait};

/// Which messages go first. None waits for a link: what a congested link cannot take at once is dropped, and who needs to be
/// heard says it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// What stops boats: before everything else, and at once.
    Urgent,
    /// Everything that is sent at every decision.
    Normal,
}

/// Something declared that lasts as long as this is kept.
pub struct Declaration(#[expect(dead_code, reason = "kept for its drop")] pub(crate) Box<dyn Send + Sync>);

/// A node's session.
#[derive(Clone)]
pub struct Bus {
    pub(crate) network: Network,
    pub(crate) token: Option<Token>,
    pub(crate) keys: Option<Arc<Bundle>>,
    is_on_this_machine: bool,
}

/// The network that a session is on.
#[derive(Clone)]
pub(crate) enum Network {
    Zenoh(Session),
    Simulated(SimulatedSession),
}

/// Sends messages on one key.
pub struct Publisher(Sender);

enum Sender {
    Zenoh { publisher: zenoh::pubsub::Publisher<'static>, is_heard: Arc<AtomicBool> },
    Simulated(SimulatedPublisher),
}

pub(crate) fn failed(doing: &'static str, key: &str) -> impl FnOnce(zenoh::Error) -> BusError {
    move |e| BusError::Use { doing, key: key.to_owned(), reason: reason(&e) }
}

impl Bus {
    /// Opens the hub of a game.
    ///
    /// # Errors
    /// [`BusError`] if it cannot listen where it should.
    pub fn hub(net: &Net, game: &GameName, scenario: &Scenario) -> Result<Bus, BusError> {
        let what = format!("to listen on {}", net.endpoints(&net.listen).join(", "));
        if simulated::is_inside() {
            return simulated(SimulatedSession::hub(net), net, what);
        }
        let files = OpenFiles::reserve(FILES_MAX);
        let nodes = nodes_max(files);
        let bus = open(net.hub(game, scenario, nodes)?, net, what.clone())?;
        if let Network::Zenoh(session) = &bus.network {
            let begun = admission::begin(session, net.ports(), files, nodes);
            begun.map_err(|e| BusError::Open { what, reason: reason(&e) })?;
        }
        Ok(bus)
    }

    fn of(network: Network, net: &Net) -> Bus {
        let is_on_this_machine = !net.lan && net.connect.iter().all(|endpoint| is_loopback(endpoint));
        Bus { network, token: net.token.clone(), keys: net.keys.clone(), is_on_this_machine }
    }

    /// Connects to a hub.
    ///
    /// # Errors
    /// [`BusError`] if nobody listens there now.
    pub fn leaf(net: &Net) -> Result<Bus, BusError> {
        let endpoints = net.endpoints(&net.connect);
        let what = format!("to connect to {}", endpoints.join(", "));
        if simulated::is_inside() {
            return simulated(SimulatedSession::leaf(net), net, what);
        }
        open(net.leaf()?, net, what).map_err(|error| {
            // zenoh does not say why.
            let of_keys = endpoints.iter().find_map(|endpoint| match &net.keys {
                Some(keys) => keys::refusal(endpoint, keys),
                None => keys::is_tls(endpoint).then(|| BusError::NeedsKeys(endpoint.clone())),
            });
            of_keys.unwrap_or(error)
        })
    }

    /// The keys of this node, in a game with keys.
    #[must_use]
    pub fn keys(&self) -> Option<&Bundle> {
        self.keys.as_deref()
    }

    /// Whether the hub is reached by loopback.
    pub(crate) fn is_on_this_machine(&self) -> bool {
        self.is_on_this_machine
    }

    /// The game's token, where it is known.
    pub(crate) fn token(&self) -> Option<&Token> {
        self.token.as_ref()
    }

    /// The same session, for a node that knows this token.
    #[must_use]
    pub fn with_token(self, token: Option<Token>) -> Bus {
        Bus { token, ..self }
    }

    /// This session's own identifier, unique on the network.
    #[must_use]
    pub fn id(&self) -> String {
        match &self.network {
            Network::Zenoh(session) => session.zid().to_string(),
            Network::Simulated(session) => session.id(),
        }
    }

    /// Prepares to publish on `key`.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn publisher(&self, key: String, priority: Priority) -> Result<Publisher, BusError> {
        let session = match &self.network {
            Network::Zenoh(session) => session,
            Network::Simulated(session) => return Ok(Publisher(Sender::Simulated(session.publisher(&key)))),
        };
        // What must arrive is said again by whoever said it: in lockstep the sim repeats
        // pictures and agents repeat answers, and in real time a newer message follows. A
        // message that waits would hold up the thread that serves all links.
        let builder = session.declare_publisher(key.clone()).congestion_control(CongestionControl::Drop);
        let builder = match priority {
            Priority::Urgent => builder.priority(qos::Priority::RealTime).express(true),
            Priority::Normal => builder.priority(qos::Priority::Data),
        };
        let publisher = builder.wait().map_err(failed("publish on", &key))?;
        let is_heard = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&is_heard);
        let listener = publisher.matching_listener().callback(move |now| flag.store(now.matching(), Ordering::Relaxed));
        listener.background().wait().map_err(failed("publish on", &key))?;
        Ok(Publisher(Sender::Zenoh { publisher, is_heard }))
    }

    /// Calls `take` with the bytes of everything published on `key`.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn subscribe(
        &self,
        key: String,
        take: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        self.subscribe_from(Locality::Any, key, take)
    }

    /// As [`Bus::subscribe`], but not with what this session publishes itself.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn subscribe_remote(
        &self,
        key: String,
        take: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        self.subscribe_from(Locality::Remote, key, take)
    }

    fn subscribe_from(
        &self,
        origin: Locality,
        key: String,
        take: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        let session = match &self.network {
            Network::Zenoh(session) => session,
            Network::Simulated(session) => {
                return Ok(Declaration(Box::new(session.subscribe(key, take, origin == Locality::Any))));
            }
        };
        let callback = move |sample: zenoh::sample::Sample| take(&sample.payload().to_bytes());
        let builder = session.declare_subscriber(key.clone()).allowed_origin(origin);
        let subscriber = builder.callback(callback).wait();
        Ok(Declaration(Box::new(subscriber.map_err(failed("subscribe to", &key))?)))
    }

    /// Shows that this node is there, under `key`, until dropped or dead.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn show_alive(&self, key: String) -> Result<Declaration, BusError> {
        let session = match &self.network {
            Network::Zenoh(session) => session,
            Network::Simulated(session) => return Ok(Declaration(Box::new(session.show_alive(key)))),
        };
        let token = session.liveliness().declare_token(key.clone()).wait();
        Ok(Declaration(Box::new(token.map_err(failed("be alive as", &key))?)))
    }

    /// Calls `take` with the key of every node under `key` that comes (`true`) or goes, beginning with those that are there.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn watch_alive(
        &self,
        key: String,
        take: impl Fn(&str, bool) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        let session = match &self.network {
            Network::Zenoh(session) => session,
            Network::Simulated(session) => return Ok(Declaration(Box::new(session.watch_alive(key, take)))),
        };
        let callback = move |sample: zenoh::sample::Sample| {
            take(sample.key_expr().as_str(), sample.kind() == SampleKind::Put);
        };
        let watch = session.liveliness().declare_subscriber(key.clone()).history(true).callback(callback);
        Ok(Declaration(Box::new(watch.wait().map_err(failed("watch", &key))?)))
    }

    /// Calls `take` with the identifier of every node whose link to this hub is gone.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn watch_links(&self, take: impl Fn(String) + Send + Sync + 'static) -> Result<Declaration, BusError> {
        let session = match &self.network {
            Network::Zenoh(session) => session,
            Network::Simulated(session) => return Ok(Declaration(Box::new(session.watch_links(take)))),
        };
        // The link, not a liveliness token: anybody could show a token in the name of an agent,
        // and a link that ends is known at once where the process died.
        let callback = move |event: zenoh::session::TransportEvent| {
            if event.kind() == SampleKind::Delete {
                take(event.transport().zid().to_string());
            }
        };
        let listener = session.info().transport_events_listener().callback(callback).wait();
        Ok(Declaration(Box::new(listener.map_err(failed("watch", "the links"))?)))
    }

    /// The keys of all nodes under `key` that are there now.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn who_is_alive(&self, key: &str, limit: Duration) -> Result<Vec<String>, BusError> {
        let session = match &self.network {
            Network::Zenoh(session) => session,
            Network::Simulated(session) => return Ok(session.who_is_alive(key, limit)),
        };
        let replies = session.liveliness().get(key).timeout(limit).wait().map_err(failed("look for", key))?;
        let tokens = std::iter::from_fn(|| replies.recv().ok()).filter_map(|reply| reply.into_result().ok());
        let mut keys: Vec<String> = tokens.map(|sample| sample.key_expr().as_str().to_owned()).collect();
        keys.sort();
        keys.dedup();
        Ok(keys)
    }

    /// Closes the session, so that the others need not find out.
    pub fn close(&self) {
        match &self.network {
            // A session that cannot be closed is as gone as one that can.
            Network::Zenoh(session) => drop(session.close().wait()),
            Network::Simulated(session) => session.close(),
        }
    }
}

fn open(config: zenoh::Config, net: &Net, what: String) -> Result<Bus, BusError> {
    let session = zenoh::open(config).wait().and_then(|session| linger::disable(&session).map(|()| session));
    let bus = session.map(|session| Bus::of(Network::Zenoh(session), net));
    bus.map_err(|e| BusError::Open { what, reason: reason(&e) })
}

fn simulated(session: Result<SimulatedSession, String>, net: &Net, what: String) -> Result<Bus, BusError> {
    let session = session.map_err(|reason| BusError::Open { what, reason })?;
    Ok(Bus::of(Network::Simulated(session), net))
}

impl Publisher {
    /// Whether anybody listens; a message that nobody hears need not be made.
    #[must_use]
    pub fn is_heard(&self) -> bool {
        match &self.0 {
            Sender::Zenoh { is_heard, .. } => is_heard.load(Ordering::Relaxed),
            Sender::Simulated(publisher) => publisher.is_heard(),
        }
    }

    /// Sends a per-tick message as CDR, with its name and version in the encoding.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send<M: Message + Serialize>(&self, message: &M) -> Result<(), BusError> {
        self.send_encoded::<M>(codec::encode(message))
    }

    /// Sends a per-tick message that is CDR already.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send_encoded<M: Message>(&self, bytes: Vec<u8>) -> Result<(), BusError> {
        let encoding = Encoding::APPLICATION_CDR.with_schema(format!("{}@{}", M::SCHEMA, M::VERSION));
        self.put(bytes, encoding)
    }

    /// Sends bytes that are JSON.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send_json(&self, json: Vec<u8>) -> Result<(), BusError> {
        self.put(json, Encoding::APPLICATION_JSON)
    }

    /// Sends bytes as they are.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send_raw(&self, bytes: Vec<u8>) -> Result<(), BusError> {
        self.put(bytes, Encoding::ZENOH_BYTES)
    }

    fn put(&self, bytes: Vec<u8>, encoding: Encoding) -> Result<(), BusError> {
        match &self.0 {
            Sender::Zenoh { publisher, .. } => {
                let sent = publisher.put(bytes).encoding(encoding).wait();
                sent.map_err(failed("send on", publisher.key_expr().as_str()))
            }
            Sender::Simulated(publisher) => {
                publisher.put(bytes);
                Ok(())
            }
        }
    }
}
