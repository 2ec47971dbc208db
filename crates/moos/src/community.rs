//! A MOOS community from the bridge's point of view: the database in which the bridge publishes and
//! reads variables.

use crate::back_seat::HELM;
use crate::clock::MoosClock;
use crate::database::{BRIDGE, Database, Dropped};
use crate::remote::Remote;
use crate::server::Server;
use crate::wire::{Kind, Msg};
use messages::refusal::Refusals;
use std::collections::{BTreeMap, BTreeSet};
use std::net::{Ipv4Addr, SocketAddr};
use std::str::FromStr;

/// The location of a community's database.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// Served by the bridge at this address.
    Serve(SocketAddr),
    /// A running MOOSDB, `host:port`.
    Connect(String),
}

impl FromStr for Address {
    type Err = String;

    /// Parses `:9001`, `0.0.0.0:9001` or `tcp/HOST:9001`.
    fn from_str(text: &str) -> Result<Address, String> {
        let wrong = || {
            format!(
                "the address is {text:?}, expected :PORT or IP:PORT to serve a MOOSDB, or tcp/HOST:PORT to connect to one"
            )
        };
        if let Some(place) = text.strip_prefix("tcp/") {
            let port = place
                .rsplit_once(':')
                .filter(|(host, _)| !host.is_empty())
                .map(|(_, port)| port.parse::<u16>());
            return if let Some(Ok(1..)) = port {
                Ok(Address::Connect(place.to_owned()))
            } else {
                Err(wrong())
            };
        }
        let port = text.strip_prefix(':').map(str::parse::<u16>);
        match port {
            Some(port) => port
                .map(|port| Address::Serve((Ipv4Addr::LOCALHOST, port).into()))
                .map_err(|_| wrong()),
            None => text.parse().map(Address::Serve).map_err(|_| wrong()),
        }
    }
}

/// The database of a community.
enum Link {
    Served(Server),
    Remote(Remote),
}

/// A community, and the last values that the bridge has published there.
pub struct Community {
    /// The community's name.
    pub name: String,
    /// The location of the community's database, as text.
    pub place: String,
    link: Link,
    moos: MoosClock,
    published: BTreeMap<String, Value>,
    /// Notes for the person who runs the bridge.
    notes: Vec<String>,
    /// Drawings by the applications, waiting for the shoreside.
    pub(crate) drawings: Vec<Msg>,
    /// Number of malformed datagrams.
    pub(crate) malformed: u64,
    /// Counts of values from applications that the bridge could not use.
    pub refusals: Refusals,
}

/// A value to publish.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A string.
    Text(String),
}

impl Community {
    /// Opens the database, or the connection to it.
    ///
    /// # Errors
    /// If the address cannot be served, or a thread cannot be started.
    pub fn open(
        name: &str,
        address: &Address,
        reads: BTreeSet<String>,
        moos: MoosClock,
    ) -> Result<Community, String> {
        let failed =
            |e: std::io::Error| format!("cannot open the MOOSDB of {name} at {address}: {e}");
        let (link, place) = match address {
            Address::Serve(at) => {
                let server = Server::open(*at, Database::new(name, reads, moos.now_s()), moos)
                    .map_err(failed)?;
                let place = format!("MOOSDB at {}", server.address);
                (Link::Served(server), place)
            }
            Address::Connect(at) => (
                Link::Remote(Remote::open(at, reads, moos).map_err(failed)?),
                format!("client of the MOOSDB at {at}"),
            ),
        };
        let published = BTreeMap::new();
        Ok(Community {
            name: name.to_owned(),
            place,
            link,
            moos,
            published,
            notes: Vec::new(),
            drawings: Vec::new(),
            malformed: 0,
            refusals: Refusals::default(),
        })
    }

    /// Publishes a value now. Returns the message.
    pub fn publish(&mut self, key: &str, value: Value) -> Msg {
        self.publish_at(key, value, self.moos.now_s())
    }

    /// Publishes a value with this MOOS time. Returns the message.
    pub fn publish_at(&mut self, key: &str, value: Value, time_s: f64) -> Msg {
        let msg = match value {
            Value::Number(number) => Msg::number(Kind::NOTIFY, key, number, time_s),
            Value::Text(text) => Msg::text(Kind::NOTIFY, key, &text, time_s),
        };
        let msg = Msg {
            source: BRIDGE.to_owned(),
            community: self.name.clone(),
            ..msg
        };
        match &self.link {
            Link::Served(server) => {
                server.visit(|database, now_s| database.notify(msg.clone(), now_s))
            }
            Link::Remote(remote) => remote.publish(&msg),
        }
        msg
    }

    /// Publishes a value if it differs from the last value of the variable that this function
    /// published. Returns the message if it was published.
    pub fn publish_change(&mut self, key: &str, value: Value) -> Option<Msg> {
        if self.published.get(key) == Some(&value) {
            return None;
        }
        self.published.insert(key.to_owned(), value.clone());
        Some(self.publish_at(key, value, self.moos.now_s()))
    }

    /// Whether `text` differs from the last one passed for `key`, which need not be a variable.
    pub(crate) fn is_change(&mut self, key: &str, text: &str) -> bool {
        let value = Value::Text(text.to_owned());
        self.published.insert(key.to_owned(), value.clone()) != Some(value)
    }

    /// Publishes a person's command from the shoreside, so that both the applications and the
    /// bridge receive it.
    pub(crate) fn command(&mut self, msg: Msg) {
        let msg = Msg {
            kind: Kind::NOTIFY,
            source: "shoreside".to_owned(),
            ..msg
        };
        match &self.link {
            Link::Served(server) => {
                server.visit(|database, now_s| database.receive("shoreside", vec![msg], now_s));
            }
            Link::Remote(remote) => {
                remote.publish(&msg);
                remote.hear(msg);
            }
        }
    }

    /// Makes [`Community::publish_change`] publish this variable again.
    pub fn forget(&mut self, key: &str) {
        self.published.remove(key);
    }

    /// Makes [`Community::publish_change`] publish everything again.
    pub fn forget_all(&mut self) {
        self.published.clear();
    }

    /// Whether there is a helm or a controller, and whether there is an application.
    pub(crate) fn presence(&self) -> (bool, bool) {
        match &self.link {
            Link::Served(server) => server.visit(|database, _| database.presence(&HELM)),
            Link::Remote(remote) => remote.presence(&HELM),
        }
    }

    /// Whether values published now will arrive.
    pub(crate) fn is_reachable(&self) -> bool {
        matches!(self.link, Link::Served(_)) || self.presence().1
    }

    /// The newest values that applications have published since the last call.
    pub fn take_heard(&mut self) -> Vec<Msg> {
        let (heard, notes) = match &self.link {
            Link::Served(server) => server.visit(|database, _| database.take_heard()),
            Link::Remote(remote) => {
                let (heard, notes, is_connected) = remote.take_heard();
                if !is_connected {
                    // The database may have been restarted, so everything is sent again.
                    self.published.clear();
                }
                (heard, notes)
            }
        };
        self.notes.extend(notes);
        heard
    }

    /// Publishes the state of a served database once a second. Returns the notes since the last
    /// call for the person who runs the bridge.
    pub fn tend(&mut self) -> Vec<String> {
        if let Link::Served(server) = &self.link {
            self.notes.extend(server.visit(|database, now_s| {
                database.publish_status(now_s);
                database.take_notes()
            }));
        }
        std::mem::take(&mut self.notes)
    }

    /// The messages and connections dropped so far.
    pub fn dropped(&self) -> Dropped {
        let dropped = match &self.link {
            Link::Served(server) => server.visit(|database, _| database.dropped),
            Link::Remote(remote) => remote.dropped(),
        };
        Dropped {
            malformed: dropped.malformed + self.malformed,
            ..dropped
        }
    }
}

impl std::fmt::Display for Address {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Address::Serve(at) => write!(f, "{at}"),
            Address::Connect(at) => write!(f, "tcp/{at}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bus::clock;
    use std::time::Duration;

    #[test]
    fn a_persons_command_reaches_the_bridge_in_any_database() {
        let moos = MoosClock { warp: 1.0 };
        let open = |address: Address| {
            let reads = BTreeSet::from(["DEPLOY".to_owned()]);
            Community::open("blue_one", &address, reads, moos).unwrap()
        };
        let served = open(":0".parse().unwrap());
        let place = served.place.strip_prefix("MOOSDB at ").unwrap().to_owned();
        let mut communities = [open(Address::Connect(place)), served];
        let start = clock::now();
        while !communities[0].is_reachable() {
            assert!(clock::since(start) < Duration::from_secs(20));
            clock::rest(Duration::from_millis(10));
        }
        for community in &mut communities {
            community.command(Msg::text(Kind::NOTIFY, "DEPLOY", "true", 0.0));
            let heard = community.take_heard();
            assert_eq!(heard.len(), 1, "{}", community.place);
        }
    }

    #[test]
    fn an_address_says_whether_to_serve_or_to_connect() {
        let serve = |text: &str| Ok(Address::Serve(text.parse().unwrap()));
        for (text, want) in [
            (":9001", serve("127.0.0.1:9001")),
            ("0.0.0.0:9001", serve("0.0.0.0:9001")),
            ("[::1]:0", serve("[::1]:0")),
            (
                "tcp/boat.local:9000",
                Ok(Address::Connect("boat.local:9000".to_owned())),
            ),
        ] {
            assert_eq!(text.parse::<Address>(), want);
        }
        for text in [
            "",
            "9001",
            ":",
            ":70000",
            "boat:9001",
            "tcp/9001",
            "tcp/:9001",
            "tcp/boat:0",
            "udp/boat:1",
        ] {
            assert!(
                text.parse::<Address>()
                    .unwrap_err()
                    .contains("tcp/HOST:PORT"),
                "{text}"
            );
        }
    }
}
