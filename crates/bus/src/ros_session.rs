//! A session on the zenoh network of ROS 2 nodes (`rmw_zenoh`), separate from any game's network.
//!
//! No function waits for a ROS 2 node: a link that cannot accept a message at once loses it.

use crate::net::set;
use crate::parcel::Parcel;
use crate::session::{Declaration, Encoding, PendingQuery, Sender, Session};
use crate::zenoh_session::{ZenohSender, ZenohSession, failed, open};
use crate::{BusError, Delivery, Net, Priority, is_loopback};
use messages::topic;
use std::ops::Deref;
use std::time::Duration;
use zenoh::Wait;

/// How long to wait for the tokens of games at a router; they arrive with its first answer.
const POLL: Duration = Duration::from_secs(1);

/// A session on a ROS 2 network.
pub struct RosSession {
    session: ZenohSession,
    /// Whether this process is the router, because no other router was running.
    pub is_router: bool,
}

/// Publishes one ROS 2 topic.
pub struct RosPublisher(ZenohSender);

impl RosSession {
    /// Connects to the router at `endpoint` as a client. If the endpoint is on this machine and no
    /// router responds there, acts as the router.
    ///
    /// # Errors
    /// [`BusError`] if the router is elsewhere and does not respond, if its port belongs to a
    /// different program, or if it is a Squall game.
    pub fn open(endpoint: &str) -> Result<RosSession, BusError> {
        let what = format!("join the ROS 2 network at {endpoint}");
        let net = Net {
            connect: vec![endpoint.to_owned()],
            ..Net::default()
        };
        let open = |mut config: zenoh::Config| {
            // A decision's messages follow each other closely. While one is being written, zenoh's
            // sender waits up to two milliseconds for it; with this setting, less than one. The
            // median latency from the sim to a subscriber of all topics is 0.5 ms instead of 0.7
            // ms. (Sending the messages as `express` was tried, but it overflowed the queue of
            // batches, and most were lost.)
            set(
                &mut config,
                "transport/link/tx/queue/batching/time_limit",
                "0",
            )?;
            open(config, what.clone())
        };
        match open(net.leaf()?) {
            Ok(session) => {
                if session
                    .who_is_alive(&topic::everyone_alive(), POLL)?
                    .is_empty()
                {
                    return Ok(RosSession {
                        session,
                        is_router: false,
                    });
                }
                session.close();
                let reason = "a Squall game is listening there: start the game with another --listen, or pass --router";
                Err(BusError::Open {
                    what,
                    reason: reason.to_owned(),
                })
            }
            // The ROS 2 nodes of a mesh need one known router to find each other.
            Err(_) if is_loopback(endpoint) => Ok(RosSession {
                session: open(net.ros_router(endpoint)?)?,
                is_router: true,
            }),
            Err(error) => Err(error),
        }
    }

    /// Prepares to publish on `key`.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn publisher(&self, key: String) -> Result<RosPublisher, BusError> {
        self.session
            .sender(key, Priority::Normal, Delivery::Reliable)
            .map(RosPublisher)
    }

    /// Calls `receive` with every request to the service at `key`, and a handle to answer it.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn serve(
        &self,
        key: String,
        receive: impl Fn(Parcel, Box<dyn PendingQuery>) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        let callback = move |query: zenoh::query::Query| {
            receive(
                Parcel::of(query.payload(), query.attachment()),
                Box::new(query),
            );
        };
        // ROS 2 clients query only queryables that are complete.
        let queryable = self
            .session
            .0
            .declare_queryable(key.clone())
            .complete(true)
            .callback(callback)
            .wait();
        queryable
            .map(Declaration::new)
            .map_err(failed("answer queries at", &key))
    }
}

/// Tokens and subscriptions work as in any session.
impl Deref for RosSession {
    type Target = dyn Session;

    fn deref(&self) -> &Self::Target {
        &self.session
    }
}

impl RosPublisher {
    /// Whether the topic has a subscriber. Without one, messages need not be encoded.
    pub fn is_heard(&self) -> bool {
        self.0.is_heard()
    }

    /// Sends a message with its attachment.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn send(&self, bytes: Vec<u8>, attachment: Vec<u8>) -> Result<(), BusError> {
        self.0.put(bytes, Encoding::Bytes, Some(attachment))
    }
}

impl Net {
    /// The zenoh configuration of a router for ROS 2 nodes.
    fn ros_router(&self, endpoint: &str) -> Result<zenoh::Config, BusError> {
        let mut config = self.base()?;
        for (key, value) in [
            ("mode", "\"router\"".to_owned()),
            ("listen/endpoints", format!("[{endpoint:?}]")),
            // Through gossip, nodes learn each other's addresses from the router.
            ("scouting/gossip/enabled", "true".to_owned()),
        ] {
            set(&mut config, key, &value)?;
        }
        Ok(config)
    }
}
