//! A zenoh session that is none of ours.

use crate::support::Sim;
use game::topic::{self, GameName};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use zenoh::bytes::ZBytes;
use zenoh::{Config, Session, Wait};

/// Who reaches the port, and knows every topic.
pub(crate) struct Intruder {
    pub(crate) session: Session,
    game: GameName,
}

/// What an intruder has heard: the keys.
pub(crate) struct Heard {
    keys: Arc<Mutex<Vec<String>>>,
    _subscriber: zenoh::pubsub::Subscriber<()>,
}

impl Intruder {
    pub(crate) fn at(sim: &Sim) -> Intruder {
        let mut config = Config::default();
        for (key, value) in [
            ("mode", "\"client\"".to_owned()),
            ("connect/endpoints", format!("[{:?}]", sim.endpoint)),
            ("scouting/multicast/enabled", "false".to_owned()),
        ] {
            config.insert_json5(key, &value).expect("a setting of zenoh");
        }
        Intruder { session: zenoh::open(config).wait().expect("the port is open"), game: sim.name() }
    }

    pub(crate) fn topic(&self, rest: &str) -> String {
        topic::matching(&self.game, rest)
    }

    /// Listens to a topic, with wildcards or not.
    pub(crate) fn listen(&self, rest: &str) -> Heard {
        self.listen_anywhere(&self.topic(rest))
    }

    pub(crate) fn listen_anywhere(&self, key: &str) -> Heard {
        let keys = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&keys);
        let subscriber = self.session.declare_subscriber(key.to_owned()).callback(move |sample| {
            heard.lock().expect("nobody panics with it").push(sample.key_expr().to_string());
        });
        Heard { keys, _subscriber: subscriber.wait().expect("the session is open") }
    }

    pub(crate) fn publish(&self, rest: &str, payload: impl Into<ZBytes>) {
        self.session.put(self.topic(rest), payload).wait().expect("the session is open");
    }

    /// The answers to a query.
    pub(crate) fn ask(&self, rest: &str, payload: impl Into<ZBytes>) -> Vec<Vec<u8>> {
        let replies = self.session.get(self.topic(rest)).payload(payload).timeout(Duration::from_secs(5)).wait();
        let replies = replies.expect("the session is open");
        let sound = std::iter::from_fn(|| replies.recv().ok()).filter_map(|reply| reply.into_result().ok());
        sound.map(|sample| sample.payload().to_bytes().into_owned()).collect()
    }
}

impl Heard {
    pub(crate) fn keys(&self) -> Vec<String> {
        self.keys.lock().expect("nobody panics with it").clone()
    }
}
