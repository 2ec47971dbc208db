//! The state of a MOOSDB: variables, and clients with their subscriptions and mail. It has no
//! sockets and no clock.
//!
//! Like MOOSDB, it fixes a variable's type when the first value arrives, delivers the last value on
//! registration, and refuses a second client with the same name. Unlike MOOSDB, it limits
//! everything that clients can fill, and counts what it drops.

use crate::mail::Mail;
use crate::pattern::{matches, patterns};
use crate::wire::{self, Kind, Msg};
use bus::Watched;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Maximum number of clients.
pub const CLIENTS_MAX: usize = 64;
/// Maximum length of a client's name, bytes.
const NAME_MAX: usize = 128;
/// Maximum number of variables.
const VARIABLES_MAX: usize = 8192;
/// Maximum number of subscriptions to single variables per client. For patterns, the maximum is
/// 1/64 of this.
const SUBSCRIPTIONS_MAX: usize = 8192;
/// Maximum total length of all values, bytes.
const STORED_MAX: usize = 64 << 20;
/// The name under which the database and the bridge publish.
pub const BRIDGE: &str = "squall";
/// Interval at which the database publishes its own variables, s.
const STATUS_S: f64 = 1.0;
/// Clock difference (s) above which a client's clock is reported.
const SKEW_MAX_S: f64 = 60.0;

/// Counts of dropped messages and connections, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Values that do not have the variable's type.
    pub wrong_type: u64,
    /// Values, variables or subscriptions beyond a limit.
    pub over_limit: u64,
    /// Mail for clients that did not read it.
    pub unread: u64,
    /// Packets and datagrams that could not be decoded.
    pub malformed: u64,
    /// Connections without a name, with a name in use, or beyond the limit.
    pub refused: u64,
    /// Connections that were closed because the client was silent or did not read.
    pub stalled: u64,
}

impl std::fmt::Display for Dropped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let texts = [
            (self.wrong_type, "of the wrong type"),
            (self.over_limit, "over a limit"),
            (self.unread, "not read in time"),
            (self.malformed, "malformed"),
            (self.refused, "refused connections"),
            (self.stalled, "stalled connections"),
        ];
        let texts: Vec<String> = texts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, text)| format!("{count} x {text}"))
            .collect();
        f.write_str(&texts.join(", "))
    }
}

/// A subscription.
#[derive(Clone, Copy)]
struct Subscription {
    /// Minimum time between two messages, s.
    interval_s: f64,
    /// MOOS time of the last message, s.
    sent_s: f64,
}

impl Subscription {
    fn new(interval_s: f64) -> Subscription {
        Subscription {
            interval_s: if interval_s.is_finite() {
                interval_s
            } else {
                0.0
            },
            sent_s: f64::NEG_INFINITY,
        }
    }
}

/// A subscription by patterns: `*` matches any characters, `?` one.
struct Wildcard {
    sources: String,
    variables: String,
    subscription: Subscription,
}

/// A connected client.
struct Client {
    name: String,
    mail: Arc<Watched<Mail>>,
    subscriptions: BTreeMap<String, Subscription>,
    wildcards: Vec<Wildcard>,
    /// Subscriptions derived from the patterns, for the variables received so far.
    matched: BTreeMap<String, Subscription>,
}

/// A database.
pub struct Database {
    community: String,
    variables: BTreeMap<String, Msg>,
    stored: usize,
    clients: Vec<Client>,
    /// The newest value of each variable that the bridge reads, until the bridge has read it.
    heard: BTreeMap<String, Msg>,
    reads: BTreeSet<String>,
    /// Notes for the person who runs the bridge.
    notes: Vec<String>,
    /// Clients whose clocks were reported.
    skewed: BTreeSet<String>,
    opened_s: f64,
    status_s: f64,
    /// The messages and connections dropped so far.
    pub dropped: Dropped,
}

impl Database {
    /// An empty database, opened at this MOOS time. The bridge reads the variables `reads`.
    pub fn new(community: &str, reads: BTreeSet<String>, now_s: f64) -> Database {
        Database {
            community: community.to_owned(),
            variables: BTreeMap::new(),
            stored: 0,
            clients: Vec::new(),
            heard: BTreeMap::new(),
            reads,
            notes: Vec::new(),
            skewed: BTreeSet::new(),
            opened_s: now_s,
            status_s: f64::NEG_INFINITY,
            dropped: Dropped::default(),
        }
    }

    /// Admits a client with the handshake `hello`, and returns the welcome message and the client's
    /// mailbox.
    ///
    /// # Errors
    /// The reason for a refusal.
    pub fn admit(&mut self, hello: &Msg, now_s: f64) -> Result<(Msg, Arc<Watched<Mail>>), String> {
        let name = hello.as_text().unwrap_or_default().trim();
        let is_taken = name.eq_ignore_ascii_case(BRIDGE)
            || self.clients.iter().any(|client| client.name == name);
        let refusal = match name {
            _ if name.is_empty() || name.len() > NAME_MAX => {
                Some(format!("a name must have 1 to {NAME_MAX} bytes"))
            }
            _ if is_taken => Some(format!("the name {name} is in use")),
            _ if self.clients.len() >= CLIENTS_MAX => {
                Some(format!("there are already {CLIENTS_MAX} clients"))
            }
            _ => None,
        };
        if let Some(reason) = refusal {
            self.dropped.refused += 1;
            return Err(reason);
        }
        // This includes the packet's transit time.
        let skew_s = if hello.time_s.is_finite() {
            now_s - hello.time_s
        } else {
            0.0
        };
        let is_other = skew_s.abs() > SKEW_MAX_S;
        if is_other && self.skewed.len() < CLIENTS_MAX && self.skewed.insert(name.to_owned()) {
            let community = &self.community;
            self.notes.push(format!(
                "{community}: the MOOS time of {name:?} differs by {:.0} s from the game's; compare MOOSTimeWarp in its mission file",
                skew_s.abs()
            ));
        }
        let mail = Arc::<Watched<Mail>>::default();
        let client = Client {
            name: name.to_owned(),
            mail: Arc::clone(&mail),
            subscriptions: BTreeMap::new(),
            wildcards: Vec::new(),
            matched: BTreeMap::new(),
        };
        self.clients.push(client);
        self.publish_clients(now_s);
        let welcome = Msg::text(Kind::WELCOME, "", wire::ASYNCHRONOUS, now_s);
        let source_aux = "hostname=localhost".to_owned();
        Ok((
            Msg {
                number: skew_s,
                source_aux,
                community: self.community.clone(),
                ..welcome
            },
            mail,
        ))
    }

    /// Removes a client.
    pub fn remove(&mut self, name: &str, now_s: f64) {
        if let Some(at) = self.clients.iter().position(|client| client.name == name) {
            self.clients
                .swap_remove(at)
                .mail
                .visit(|mail| mail.is_closed = true);
            self.publish_clients(now_s);
        }
    }

    /// Processes a client's packet. Returns the answer to its clock comparison, if the packet
    /// contained one.
    pub fn receive(&mut self, name: &str, messages: Vec<Msg>, now_s: f64) -> Option<Msg> {
        let mut timing = None;
        for msg in messages {
            match msg.kind {
                Kind::NOTIFY => {
                    let msg = Msg {
                        source: name.to_owned(),
                        ..msg
                    };
                    if self.reads.contains(&msg.key) {
                        wire::keep(&mut self.heard, msg.clone());
                    }
                    self.notify(msg, now_s);
                }
                Kind::TIMING => {
                    timing = Some(Msg {
                        number: now_s,
                        ..msg
                    })
                }
                Kind::REGISTER => self.register(name, &msg, now_s),
                Kind::WILDCARD => self.register_wildcard(name, &msg),
                Kind::REQUEST => self.answer(name, &msg, now_s),
                Kind::UNREGISTER => self.change(name, |client| {
                    client.subscriptions.remove(&msg.key);
                }),
                Kind::WILDCARD_END => {
                    let [sources, variables, _] = patterns(&msg);
                    self.change(name, |client| {
                        client
                            .wildcards
                            .retain(|one| (&one.sources, &one.variables) != (&sources, &variables));
                        client.matched.clear();
                    });
                }
                _ => {}
            }
        }
        timing
    }

    /// Stores a value and delivers it.
    pub fn notify(&mut self, mut msg: Msg, now_s: f64) {
        if msg.time_s == -1.0 || !msg.time_s.is_finite() {
            msg.time_s = now_s;
        }
        if msg.community.is_empty() {
            msg.community.clone_from(&self.community);
        }
        let before = self.variables.get(&msg.key);
        if before.is_some_and(|before| before.data != msg.data) {
            self.dropped.wrong_type += 1;
            return;
        }
        let stored = self.stored + msg.bytes.len() - before.map_or(0, |before| before.bytes.len());
        if stored > STORED_MAX
            || (before.is_none() && self.variables.len() >= VARIABLES_MAX)
            || msg.key.is_empty()
        {
            self.dropped.over_limit += 1;
            return;
        }
        self.stored = stored;
        let mut encoded = Vec::new();
        wire::encode(&msg, &mut encoded);
        let encoded: Arc<[u8]> = encoded.into();
        for client in &mut self.clients {
            let due = |one: &mut Subscription| {
                let is_due = now_s - one.sent_s >= one.interval_s;
                one.sent_s = if is_due { now_s } else { one.sent_s };
                is_due
            };
            let is_registered = client.subscriptions.get_mut(&msg.key).map(due);
            let is_wanted = is_registered.unwrap_or_else(|| client.matching(&msg).is_some_and(due));
            if is_wanted {
                self.dropped.unread += client.mail.visit(|mail| mail.push(&encoded));
            }
        }
        self.variables.insert(msg.key.clone(), msg);
    }

    /// Publishes the state of the database, once a second.
    pub fn publish_status(&mut self, now_s: f64) {
        if now_s - self.status_s >= STATUS_S {
            self.status_s = now_s;
            for (key, value) in [("DB_TIME", now_s), ("DB_UPTIME", now_s - self.opened_s)] {
                self.notify(
                    Msg {
                        source: BRIDGE.to_owned(),
                        ..Msg::number(Kind::NOTIFY, key, value, now_s)
                    },
                    now_s,
                );
            }
        }
    }

    /// Whether one of these variables has a value, and whether there is a client.
    pub fn presence(&self, names: &[&str]) -> (bool, bool) {
        let has = |name: &&str| self.variables.contains_key(*name);
        (names.iter().any(has), !self.clients.is_empty())
    }

    /// The newest values for the bridge since the last call, and notes for the person who runs it.
    pub fn take_heard(&mut self) -> (Vec<Msg>, Vec<String>) {
        (
            std::mem::take(&mut self.heard).into_values().collect(),
            self.take_notes(),
        )
    }

    /// Notes for the person who runs the bridge since the last call.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    fn publish_clients(&mut self, now_s: f64) {
        let names: String = self
            .clients
            .iter()
            .map(|client| format!("{},", client.name))
            .collect();
        let text = Msg::text(
            Kind::NOTIFY,
            "DB_CLIENTS",
            &format!("{BRIDGE},{names}"),
            now_s,
        );
        self.notify(
            Msg {
                source: BRIDGE.to_owned(),
                ..text
            },
            now_s,
        );
    }

    fn change(&mut self, name: &str, change: impl FnOnce(&mut Client)) {
        if let Some(client) = self.clients.iter_mut().find(|client| client.name == name) {
            change(client);
        }
    }

    /// Delivers a message to one client.
    fn deliver(&mut self, name: &str, msg: &Msg) {
        let mut encoded = Vec::new();
        wire::encode(msg, &mut encoded);
        let mut displaced = 0;
        self.change(name, |client| {
            displaced = client.mail.visit(|mail| mail.push(&encoded.into()))
        });
        self.dropped.unread += displaced;
    }

    fn register(&mut self, name: &str, msg: &Msg, now_s: f64) {
        let mut is_full = false;
        self.change(name, |client| {
            is_full = client.subscriptions.len() >= SUBSCRIPTIONS_MAX;
            if !is_full {
                let subscription = Subscription {
                    sent_s: now_s,
                    ..Subscription::new(msg.number)
                };
                client.subscriptions.insert(msg.key.clone(), subscription);
            }
        });
        self.dropped.over_limit += u64::from(is_full);
        if let Some(value) = self.variables.get(&msg.key).cloned().filter(|_| !is_full) {
            self.deliver(name, &value);
        }
    }

    fn register_wildcard(&mut self, name: &str, msg: &Msg) {
        let [sources, variables, interval] = patterns(msg);
        let subscription = Subscription::new(interval.parse().unwrap_or(0.0));
        let mut is_full = false;
        self.change(name, |client| {
            is_full = client.wildcards.len() >= SUBSCRIPTIONS_MAX / 64;
            if !is_full {
                client.matched.clear();
                client.wildcards.push(Wildcard {
                    sources: sources.clone(),
                    variables: variables.clone(),
                    subscription,
                });
            }
        });
        self.dropped.over_limit += u64::from(is_full);
        let is_known =
            |value: &&Msg| matches(&sources, &value.source) && matches(&variables, &value.key);
        let known: Vec<Msg> = self
            .variables
            .values()
            .filter(is_known)
            .filter(|_| !is_full)
            .cloned()
            .collect();
        known.iter().for_each(|value| self.deliver(name, value));
    }

    /// Answers a request to the database: `ALL` for the values, `VAR_SUMMARY` for the names.
    fn answer(&mut self, name: &str, msg: &Msg, now_s: f64) {
        let names = || {
            self.variables
                .keys()
                .map(String::as_str)
                .collect::<Vec<_>>()
                .join(",")
        };
        let answers = match msg.key.as_str() {
            "ALL" => self
                .variables
                .values()
                .map(|value| Msg {
                    id: msg.id,
                    ..value.clone()
                })
                .collect(),
            "VAR_SUMMARY" => vec![Msg {
                id: msg.id,
                ..Msg::text(Kind::NOTIFY, &msg.key, &names(), now_s)
            }],
            _ => vec![Msg {
                id: msg.id,
                ..Msg::number(Kind::NULL, "", 0.0, now_s)
            }],
        };
        answers.iter().for_each(|answer| self.deliver(name, answer));
    }
}

impl Client {
    /// The subscription by pattern through which this client receives the variable of `msg`.
    fn matching(&mut self, msg: &Msg) -> Option<&mut Subscription> {
        if self.wildcards.is_empty() {
            return None;
        }
        let is_meant = |one: &&Wildcard| {
            matches(&one.sources, &msg.source) && matches(&one.variables, &msg.key)
        };
        let found = self.wildcards.iter().find(is_meant)?.subscription;
        Some(self.matched.entry(msg.key.clone()).or_insert(found))
    }
}

#[cfg(test)]
mod tests;
