//! A session on zenoh.

use crate::error::reason;
use crate::keys;
use crate::net::{FILES_MAX, nodes_max};
use crate::open_files::OpenFiles;
use crate::parcel::Parcel;
use crate::session::{
    Declaration, Encoding, OnBytes, OnLinkLost, OnQuery, OnToken, PendingQuery, Sender, Session,
};
use crate::{BusError, Delivery, Net, Priority, admission, linger};
use messages::topic::GameName;
use scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use zenoh::Wait;
use zenoh::qos::{self, CongestionControl};
use zenoh::query::{ConsolidationMode, QueryTarget};
use zenoh::sample::{Locality, SampleKind};

pub(crate) struct ZenohSession(pub(crate) zenoh::Session);

/// Sends on one zenoh key.
pub(crate) struct ZenohSender {
    publisher: zenoh::pubsub::Publisher<'static>,
    is_heard: Arc<AtomicBool>,
}

pub(crate) fn failed(doing: &'static str, key: &str) -> impl FnOnce(zenoh::Error) -> BusError {
    move |e| BusError::Use {
        doing,
        key: key.to_owned(),
        reason: reason(&e),
    }
}

impl ZenohSession {
    /// Opens the hub of a game.
    pub(crate) fn hub(
        net: &Net,
        game: &GameName,
        scenario: &Scenario,
    ) -> Result<ZenohSession, BusError> {
        let files = OpenFiles::reserve(FILES_MAX);
        let nodes = nodes_max(files);
        let what = format!("listen on {}", net.listen.join(", "));
        let session = open(net.hub(game, scenario, nodes)?, what.clone())?;
        let begun = admission::begin(&session.0, net.ports(), files, nodes);
        begun.map_err(|e| BusError::Open {
            what,
            reason: reason(&e),
        })?;
        Ok(session)
    }

    /// Connects to a hub.
    pub(crate) fn leaf(net: &Net) -> Result<ZenohSession, BusError> {
        let endpoints = net.endpoints(&net.connect);
        open(
            net.leaf()?,
            format!("connect to {}", net.connect.join(", ")),
        )
        .map_err(|error| {
            // zenoh does not report the cause.
            let of_keys = endpoints.iter().find_map(|endpoint| match &net.keys {
                Some(keys) => keys::refusal(endpoint, keys),
                None => keys::is_tls(endpoint).then(|| BusError::NeedsKeys(endpoint.clone())),
            });
            of_keys.unwrap_or(error)
        })
    }

    /// Prepares to publish on `key`.
    pub(crate) fn sender(
        &self,
        key: String,
        priority: Priority,
        delivery: Delivery,
    ) -> Result<ZenohSender, BusError> {
        // Senders repeat messages that must arrive: in lockstep the sim repeats pictures and agents
        // repeat answers, and in real time a newer message follows. A waiting message would block
        // the thread that serves all links.
        let builder = self
            .0
            .declare_publisher(key.clone())
            .congestion_control(CongestionControl::Drop);
        let builder = match priority {
            Priority::Urgent => builder.priority(qos::Priority::RealTime).express(true),
            Priority::Normal => builder.priority(qos::Priority::Data),
        };
        let builder = builder.reliability(match delivery {
            Delivery::Reliable => qos::Reliability::Reliable,
            Delivery::Newest => qos::Reliability::BestEffort,
        });
        let publisher = builder.wait().map_err(failed("publish on", &key))?;
        let is_heard = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&is_heard);
        let listener = publisher
            .matching_listener()
            .callback(move |now| flag.store(now.matching(), Ordering::Relaxed));
        listener
            .background()
            .wait()
            .map_err(failed("publish on", &key))?;
        Ok(ZenohSender {
            publisher,
            is_heard,
        })
    }
}

pub(crate) fn open(config: zenoh::Config, what: String) -> Result<ZenohSession, BusError> {
    let session = zenoh::open(config)
        .wait()
        .and_then(|session| linger::disable(&session).map(|()| session));
    session.map(ZenohSession).map_err(|e| BusError::Open {
        what,
        reason: reason(&e),
    })
}

impl Session for ZenohSession {
    fn id(&self) -> String {
        self.0.zid().to_string()
    }

    fn publisher(
        &self,
        key: String,
        priority: Priority,
        delivery: Delivery,
    ) -> Result<Box<dyn Sender>, BusError> {
        Ok(Box::new(self.sender(key, priority, delivery)?))
    }

    fn subscribe(
        &self,
        key: String,
        hears_own: bool,
        receive: OnBytes,
    ) -> Result<Declaration, BusError> {
        let origin = if hears_own {
            Locality::Any
        } else {
            Locality::Remote
        };
        let callback = move |sample: zenoh::sample::Sample| receive(&sample.payload().to_bytes());
        let builder = self
            .0
            .declare_subscriber(key.clone())
            .allowed_origin(origin);
        builder
            .callback(callback)
            .wait()
            .map(Declaration::new)
            .map_err(failed("subscribe to", &key))
    }

    fn answer(&self, key: String, receive: OnQuery) -> Result<Declaration, BusError> {
        let callback = move |query: zenoh::query::Query| {
            receive(
                Parcel::of(query.payload(), query.attachment()),
                Box::new(query),
            );
        };
        let queryable = self
            .0
            .declare_queryable(key.clone())
            .callback(callback)
            .wait();
        queryable
            .map(Declaration::new)
            .map_err(failed("answer queries at", &key))
    }

    fn ask(
        &self,
        priority: Priority,
        key: &str,
        question: Parcel,
        limit: Duration,
        accept: &mut dyn FnMut(&Parcel) -> bool,
    ) -> Result<Option<Vec<u8>>, BusError> {
        let priority = match priority {
            Priority::Urgent => qos::Priority::RealTime,
            Priority::Normal => qos::Priority::DataLow,
        };
        let query = self.0.get(key).payload(question.bytes).timeout(limit);
        // All queryables are queried, and each answer is passed on as it arrives, so a silent
        // queryable does not delay the others.
        let query = query
            .target(QueryTarget::All)
            .consolidation(ConsolidationMode::None);
        let query =
            query.attachment((!question.attachment.is_empty()).then_some(question.attachment));
        // `express`: do not hold the query back to fill a batch. The query is small, and its sender
        // waits for the answer.
        let query = query
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .express(true);
        let replies = query.wait().map_err(failed("query", key))?;
        let answers =
            std::iter::from_fn(|| replies.recv().ok()).filter_map(|reply| reply.into_result().ok());
        let mut parcels =
            answers.map(|sample| Parcel::of(Some(sample.payload()), sample.attachment()));
        Ok(parcels.find(accept).map(|answer| answer.bytes))
    }

    fn show_alive(&self, key: String) -> Result<Declaration, BusError> {
        let token = self.0.liveliness().declare_token(key.clone()).wait();
        token
            .map(Declaration::new)
            .map_err(failed("declare the liveliness token", &key))
    }

    fn watch_alive(&self, key: String, receive: OnToken) -> Result<Declaration, BusError> {
        let callback = move |sample: zenoh::sample::Sample| {
            receive(sample.key_expr().as_str(), sample.kind() == SampleKind::Put);
        };
        let watch = self
            .0
            .liveliness()
            .declare_subscriber(key.clone())
            .history(true)
            .callback(callback);
        watch
            .wait()
            .map(Declaration::new)
            .map_err(failed("watch", &key))
    }

    fn watch_links(&self, receive: OnLinkLost) -> Result<Declaration, BusError> {
        // Watch the link, not a liveliness token: any node could declare a token in the name of an
        // agent, and the link of a dead process ends immediately.
        let callback = move |event: zenoh::session::TransportEvent| {
            if event.kind() == SampleKind::Delete {
                receive(event.transport().zid().to_string());
            }
        };
        let listener = self
            .0
            .info()
            .transport_events_listener()
            .callback(callback)
            .wait();
        listener
            .map(Declaration::new)
            .map_err(failed("watch", "the links"))
    }

    fn who_is_alive(&self, key: &str, limit: Duration) -> Result<Vec<String>, BusError> {
        let replies = self
            .0
            .liveliness()
            .get(key)
            .timeout(limit)
            .wait()
            .map_err(failed("search for", key))?;
        let tokens =
            std::iter::from_fn(|| replies.recv().ok()).filter_map(|reply| reply.into_result().ok());
        let mut keys: Vec<String> = tokens
            .map(|sample| sample.key_expr().as_str().to_owned())
            .collect();
        keys.sort();
        keys.dedup();
        Ok(keys)
    }

    fn close(&self) {
        // A session that fails to close is no more usable than a closed one.
        drop(self.0.close().wait());
    }
}

impl Sender for ZenohSender {
    fn is_heard(&self) -> bool {
        self.is_heard.load(Ordering::Relaxed)
    }

    fn send(&self, bytes: Vec<u8>, encoding: Encoding) -> Result<(), BusError> {
        self.put(bytes, encoding, None)
    }
}

impl ZenohSender {
    /// Sends bytes, with an attachment if given.
    pub(crate) fn put(
        &self,
        bytes: Vec<u8>,
        encoding: Encoding,
        attachment: Option<Vec<u8>>,
    ) -> Result<(), BusError> {
        use zenoh::bytes::Encoding as Name;
        let encoding = match encoding {
            Encoding::Cdr { schema, version } => {
                Name::APPLICATION_CDR.with_schema(format!("{schema}@{version}"))
            }
            Encoding::Json => Name::APPLICATION_JSON,
            Encoding::Bytes => Name::ZENOH_BYTES,
        };
        let sent = self
            .publisher
            .put(bytes)
            .encoding(encoding)
            .attachment(attachment)
            .wait();
        sent.map_err(failed("send on", self.publisher.key_expr().as_str()))
    }
}

impl PendingQuery for zenoh::query::Query {
    fn key(&self) -> &str {
        self.key_expr().as_str()
    }

    fn answer(self: Box<Self>, answer: Parcel) {
        // Unlike published messages, answers are JSON: they are rare, and people read them.
        let reply = self
            .reply(self.key_expr().clone(), answer.bytes)
            .encoding(zenoh::bytes::Encoding::APPLICATION_JSON);
        let reply = reply.attachment((!answer.attachment.is_empty()).then_some(answer.attachment));
        drop(reply.wait());
    }
}
