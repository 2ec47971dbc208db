//! The bridge's nodes, topics and services in the ROS graph.

use crate::message::RosMessage;
use crate::name::{self, Kind, Node};
use bus::{BusError, Declaration, Parcel, PendingQuery, RosPublisher, RosSession, clock};
use primitives::codec;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::marker::PhantomData;

/// The nodes of this process.
pub(super) struct Graph {
    session: RosSession,
    domain: u32,
    /// The next number of a node or an endpoint.
    next: u32,
    declarations: Vec<Declaration>,
}

/// A topic that the bridge publishes.
pub(super) struct Topic<M> {
    publisher: RosPublisher,
    gid: [u8; 16],
    sent: i64,
    message: PhantomData<M>,
}

impl Graph {
    /// Connects to the router at this endpoint, or acts as the router if none is running there.
    pub(super) fn open(router: &str, domain: u32) -> Result<Graph, BusError> {
        Ok(Graph {
            session: RosSession::open(router)?,
            domain,
            next: 0,
            declarations: Vec::new(),
        })
    }

    /// Whether this process is the router.
    pub(super) fn is_router(&self) -> bool {
        self.session.is_router
    }

    /// Adds a node.
    pub(super) fn node(&mut self, name: &str) -> Result<Node, BusError> {
        let node = Node {
            domain: self.domain,
            session: self.session.id(),
            id: self.number(),
            name: name.to_owned(),
        };
        self.declarations
            .push(self.session.show_alive(node.token())?);
        Ok(node)
    }

    /// Adds a topic that `node` publishes.
    pub(super) fn publisher<M: RosMessage>(
        &mut self,
        node: &Node,
        topic: &str,
    ) -> Result<Topic<M>, BusError> {
        let publisher = self
            .session
            .publisher(name::key(self.domain, topic, M::TYPE))?;
        let gid = self.declare(node, Kind::Publisher, topic, M::TYPE)?;
        Ok(Topic {
            publisher,
            gid,
            sent: 0,
            message: PhantomData,
        })
    }

    /// Calls `receive` with every message on `topic`, or with `None` if it cannot be decoded.
    pub(super) fn subscribe<M: RosMessage + DeserializeOwned>(
        &mut self,
        node: &Node,
        topic: &str,
        receive: impl Fn(Option<M>) + Send + Sync + 'static,
    ) -> Result<(), BusError> {
        let take = move |bytes: &[u8]| receive(codec::decode_plain(bytes));
        self.declarations.push(self.session.subscribe(
            name::key(self.domain, topic, M::TYPE),
            false,
            Box::new(take),
        )?);
        self.declare(node, Kind::Subscription, topic, M::TYPE)
            .map(drop)
    }

    /// Calls `receive` with every request to a service.
    pub(super) fn serve(
        &mut self,
        node: &Node,
        (service, type_name): (&str, &str),
        receive: impl Fn(Parcel, Box<dyn PendingQuery>) + Send + Sync + 'static,
    ) -> Result<(), BusError> {
        self.declarations.push(
            self.session
                .serve(name::key(self.domain, service, type_name), receive)?,
        );
        self.declare(node, Kind::Service, service, type_name)
            .map(drop)
    }

    /// Publishes the token of an endpoint, and returns its global identifier.
    fn declare(
        &mut self,
        node: &Node,
        kind: Kind,
        topic: &str,
        type_name: &str,
    ) -> Result<[u8; 16], BusError> {
        let token = node.endpoint_token(self.number(), kind, topic, type_name);
        let gid = name::gid(&token);
        self.declarations.push(self.session.show_alive(token)?);
        Ok(gid)
    }

    fn number(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }
}

impl Drop for Graph {
    fn drop(&mut self) {
        self.session.close();
    }
}

impl<M: RosMessage + Serialize> Topic<M> {
    /// Sends the message that `make` returns, if there is a subscriber.
    pub(super) fn send(&mut self, make: impl FnOnce() -> M) -> Result<(), BusError> {
        if self.publisher.is_heard() {
            self.send_bytes(codec::encode_plain(&make()))
        } else {
            Ok(())
        }
    }

    /// Sends an encoded message.
    pub(super) fn send_bytes(&mut self, bytes: Vec<u8>) -> Result<(), BusError> {
        self.sent += 1;
        self.publisher.send(
            bytes,
            name::attachment(self.sent, clock::unix_ns(), self.gid),
        )
    }
}
