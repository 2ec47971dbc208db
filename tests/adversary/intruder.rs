//! A zenoh session from outside our own programs.

use crate::support::Sim;
use messages::topic::{self, GameName};
use serde_json::{Value, json};
use std::io::Write;
use std::net::TcpStream;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use zenoh::bytes::ZBytes;
use zenoh::{Config, Session, Wait};

/// A game that an intruder can reach.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    pub(crate) endpoint: String,
    pub(crate) game: GameName,
}

/// An intruder that reaches the port and knows every topic.
pub(crate) struct Intruder {
    pub(crate) session: Session,
    game: GameName,
}

/// The keys of the messages that an intruder received.
pub(crate) struct Heard {
    keys: Arc<Mutex<Vec<String>>>,
    _subscriber: zenoh::pubsub::Subscriber<()>,
}

/// A zenoh configuration with these settings, without scouting.
pub(crate) fn config(settings: &[(&str, &str)]) -> Config {
    let mut config = Config::default();
    for (key, value) in settings
        .iter()
        .chain(&[("scouting/multicast/enabled", "false")])
    {
        config.insert_json5(key, value).expect("a setting of zenoh");
    }
    config
}

impl Target {
    pub(crate) fn of(sim: &Sim) -> Target {
        Target {
            endpoint: sim.endpoint.clone(),
            game: sim.name(),
        }
    }

    /// The address, for connections that do not speak zenoh.
    pub(crate) fn address(&self) -> &str {
        self.endpoint.split_once('/').expect("an endpoint").1
    }

    /// Opens this many connections and sends these bytes on each; fewer if descriptors run out.
    pub(crate) fn connections(&self, words: &[u8], count: usize) -> Vec<TcpStream> {
        let connect = |_| {
            let mut stream = TcpStream::connect(self.address()).ok()?;
            // The server may close the connection at once.
            drop(stream.write_all(words));
            Some(stream)
        };
        (0..count).map_while(connect).collect()
    }

    pub(crate) fn topic(&self, rest: &str) -> String {
        topic::matching(&self.game, rest)
    }

    /// Opens a session in a zenoh mode; `None` if the hub refuses it.
    pub(crate) fn open(&self, mode: &str) -> Option<Intruder> {
        self.open_with(mode, &json!({}))
    }

    /// Opens a session in a zenoh mode with these TLS settings.
    pub(crate) fn open_with(&self, mode: &str, tls: &Value) -> Option<Intruder> {
        let config = config(&[
            ("mode", &format!("{mode:?}")),
            ("connect/endpoints", &format!("[{:?}]", self.endpoint)),
            ("connect/timeout_ms", "0"),
            ("connect/exit_on_failure", "true"),
            ("listen/endpoints", "[]"),
            ("transport/link/tls", &tls.to_string()),
        ]);
        let session = zenoh::open(config).wait().ok()?;
        Some(Intruder {
            session,
            game: self.game.clone(),
        })
    }
}

impl Intruder {
    pub(crate) fn at(sim: &Sim) -> Intruder {
        Intruder::of(&Target::of(sim))
    }

    pub(crate) fn of(target: &Target) -> Intruder {
        target.open("client").expect("the port is open")
    }

    pub(crate) fn topic(&self, rest: &str) -> String {
        topic::matching(&self.game, rest)
    }

    /// Subscribes to a topic, with or without wildcards.
    pub(crate) fn listen(&self, rest: &str) -> Heard {
        self.listen_anywhere(&self.topic(rest))
    }

    pub(crate) fn listen_anywhere(&self, key: &str) -> Heard {
        let keys = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&keys);
        let subscriber = self
            .session
            .declare_subscriber(key.to_owned())
            .callback(move |sample| {
                heard
                    .lock()
                    .expect("no thread panics while holding it")
                    .push(sample.key_expr().to_string());
            });
        Heard {
            keys,
            _subscriber: subscriber.wait().expect("the session is open"),
        }
    }

    pub(crate) fn publish(&self, rest: &str, payload: impl Into<ZBytes>) {
        self.session
            .put(self.topic(rest), payload)
            .wait()
            .expect("the session is open");
    }

    /// The answers to a query.
    pub(crate) fn ask(&self, rest: &str, payload: impl Into<ZBytes>) -> Vec<Vec<u8>> {
        self.ask_at(&self.topic(rest), payload)
    }

    pub(crate) fn ask_at(&self, key: &str, payload: impl Into<ZBytes>) -> Vec<Vec<u8>> {
        let replies = self
            .session
            .get(key)
            .payload(payload)
            .timeout(Duration::from_secs(5))
            .wait();
        let replies = replies.expect("the session is open");
        let sound =
            std::iter::from_fn(|| replies.recv().ok()).filter_map(|reply| reply.into_result().ok());
        sound
            .map(|sample| sample.payload().to_bytes().into_owned())
            .collect()
    }

    /// Sends a query without waiting for an answer.
    pub(crate) fn ask_in_vain(&self, rest: &str, payload: impl Into<ZBytes>) {
        drop(
            self.session
                .get(self.topic(rest))
                .payload(payload)
                .wait()
                .expect("the session is open"),
        );
    }

    /// Answers a topic with false data until dropped.
    pub(crate) fn answer(&self, rest: &str) -> zenoh::query::Queryable<()> {
        let queryable = self
            .session
            .declare_queryable(self.topic(rest))
            .callback(|query| {
                let key = query.key_expr().clone();
                drop(query.reply(key, "forged").wait());
            });
        queryable.wait().expect("the session is open")
    }
}

impl Heard {
    pub(crate) fn keys(&self) -> Vec<String> {
        self.keys
            .lock()
            .expect("no thread panics while holding it")
            .clone()
    }
}
