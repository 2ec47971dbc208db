//! Routing at the hub.

use crate::declared::{Call, Declared, RoutedQuery, TakeQuery, What};
use crate::event::Event;
use crate::packet::{Asked, Kind, Local, Packet};
use crate::state::State;
use crate::verdict::Published;
use bus::{Parcel, keys_meet};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

impl State {
    /// The hub's links, except `but`, whose other end has a matching declaration of this kind, with
    /// the number of each declaration.
    fn declared_beyond(
        &self,
        hub: usize,
        kind: Kind,
        key: &str,
        but: Option<usize>,
    ) -> Vec<(usize, u64)> {
        let mut found = Vec::new();
        for (i, link) in self.links.iter().enumerate() {
            if link.hub != hub || !link.hub_open || Some(i) == but {
                continue;
            }
            let known = link
                .known
                .iter()
                .filter(|(_, (of, at))| *of == kind && keys_meet(at, key));
            found.extend(known.map(|(id, _)| (i, *id)));
        }
        found
    }

    /// Calls this session's subscribers.
    fn call_subscribers(&mut self, session: usize, key: &str, bytes: &Arc<[u8]>, is_own: bool) {
        for declared in self.sessions[session].declared.values() {
            if let What::Subscriber { take, hears_own } = &declared.what
                && (!is_own || *hears_own)
                && keys_meet(&declared.key, key)
            {
                let take = Arc::clone(take);
                let bytes = Arc::clone(bytes);
                self.calls.push(Box::new(move || take(&bytes)));
            }
        }
    }

    /// Publishes a message from a session.
    pub(crate) fn publish(&mut self, session: usize, key: &Arc<str>, bytes: &Arc<[u8]>) {
        let hears_own = |what: &What| {
            matches!(
                what,
                What::Subscriber {
                    hears_own: true,
                    ..
                }
            )
        };
        let own = &self.sessions[session].declared;
        if own
            .values()
            .any(|declared| hears_own(&declared.what) && keys_meet(&declared.key, key))
        {
            let local = Local::Publish {
                key: Arc::clone(key),
                bytes: Arc::clone(bytes),
            };
            self.at(self.now_ns, Event::Local { session, local });
        }
        if self.sessions[session].is_hub {
            self.report_published(session, key, bytes);
            self.forward(session, key, bytes, None);
        } else if let Some(link) = self.sessions[session].link {
            self.send(
                link,
                true,
                Packet::Publish {
                    key: Arc::clone(key),
                    bytes: Arc::clone(bytes),
                },
            );
        }
    }

    /// Forwards a message to all leaves that have subscribed.
    fn forward(&mut self, hub: usize, key: &Arc<str>, bytes: &Arc<[u8]>, from: Option<usize>) {
        // Never forward over the incoming link, and forward once per link, however many subscribers
        // are behind it, as in zenoh.
        let mut to = self.declared_beyond(hub, Kind::Subscriber, key, from);
        to.dedup_by_key(|(link, _)| *link);
        for (link, _) in to {
            self.send(
                link,
                false,
                Packet::Publish {
                    key: Arc::clone(key),
                    bytes: Arc::clone(bytes),
                },
            );
        }
    }

    fn report_published(&mut self, session: usize, key: &str, bytes: &[u8]) {
        let node = self.sessions[session].node;
        self.note("publishes", node, key, bytes);
        if let Some(on_publish) = &mut self.on_publish {
            let at = Duration::from_nanos(self.now_ns);
            on_publish(Published {
                at,
                node: &self.nodes[node].name,
                key,
                bytes,
            });
        }
    }

    /// Whether a key has a subscriber.
    pub(crate) fn is_heard(&self, session: usize, key: &str) -> bool {
        // A leaf cannot know, so it assumes that there is one.
        !self.sessions[session].is_hub
            || self.on_publish.is_some()
            || !self
                .declared_beyond(session, Kind::Subscriber, key, None)
                .is_empty()
    }

    /// Handles a packet at the hub.
    pub(crate) fn take_at_hub(&mut self, link: usize, packet: Packet) {
        if !self.links[link].hub_open {
            return;
        }
        let leaf = self.links[link].leaf;
        let hub = self.links[link].hub;
        match packet {
            Packet::Publish { key, bytes } => {
                self.report_published(leaf, &key, &bytes);
                self.forward(hub, &key, &bytes, Some(link));
                self.call_subscribers(hub, &key, &bytes, false);
            }
            Packet::Declare { id, kind, key } => {
                self.links[link].known.insert(id, (kind, key.clone()));
                match kind {
                    Kind::Token => self.announce(hub, &key, true, Some(link)),
                    Kind::Watch => {
                        let there = self.tokens(hub, &key, Some(link));
                        there.into_iter().for_each(|key| {
                            self.send(
                                link,
                                false,
                                Packet::Token {
                                    key,
                                    is_there: true,
                                },
                            )
                        });
                    }
                    Kind::Subscriber | Kind::Queryable => {}
                }
            }
            Packet::Undeclare { id } => {
                if let Some((Kind::Token, key)) = self.links[link].known.remove(&id) {
                    self.announce(hub, &key, false, Some(link));
                }
            }
            Packet::Ask { query, key, asked } => self.route(hub, query, &key, asked, Some(link)),
            Packet::Answer { query, answer } => self.answer_at_hub(hub, query, answer),
            Packet::Close => self.close_end(link, true),
            Packet::Query { .. } | Packet::Token { .. } => {}
        }
    }

    /// Handles a packet at a leaf.
    pub(crate) fn take_at_leaf(&mut self, link: usize, packet: Packet) {
        if !self.links[link].leaf_open {
            return;
        }
        let leaf = self.links[link].leaf;
        match packet {
            Packet::Publish { key, bytes } => {
                let node = self.sessions[leaf].node;
                self.note("takes", node, &key, &bytes);
                if let Some(on_take) = &mut self.on_take {
                    let at = Duration::from_nanos(self.now_ns);
                    on_take(Published {
                        at,
                        node: &self.nodes[node].name,
                        key: &key,
                        bytes: &bytes,
                    });
                }
                self.call_subscribers(leaf, &key, &bytes, false);
            }
            Packet::Query {
                query,
                id,
                key,
                payload,
            } => match self.sessions[leaf].declared.get(&id) {
                Some(Declared {
                    what: What::Queryable(take),
                    ..
                }) => {
                    self.calls.push(asking(take, leaf, query, key, payload));
                }
                _ => self.send(
                    link,
                    true,
                    Packet::Answer {
                        query,
                        answer: None,
                    },
                ),
            },
            Packet::Answer { query, answer } => self.answered(query, answer),
            Packet::Token { key, is_there } => self.take_token(leaf, &key, is_there),
            Packet::Close => self.close_end(link, false),
            Packet::Declare { .. } | Packet::Undeclare { .. } | Packet::Ask { .. } => {}
        }
    }

    /// The tokens known to a hub that match a key.
    fn tokens(&self, hub: usize, key: &str, but: Option<usize>) -> Vec<String> {
        let own = self.sessions[hub]
            .declared
            .values()
            .filter(|declared| matches!(declared.what, What::Token));
        let mut keys: Vec<String> = own
            .map(|declared| declared.key.clone())
            .filter(|at| keys_meet(at, key))
            .collect();
        let beyond = self.declared_beyond(hub, Kind::Token, key, but);
        keys.extend(
            beyond
                .iter()
                .map(|(link, id)| self.links[*link].known[id].1.clone()),
        );
        keys
    }

    /// Notifies all watchers that a token has appeared at the hub or disappeared.
    pub(crate) fn announce(&mut self, hub: usize, key: &str, is_there: bool, from: Option<usize>) {
        // The hub may still know a returning leaf by its old link.
        if !is_there && self.tokens(hub, key, None).iter().any(|there| there == key) {
            return;
        }
        let mut to = self.declared_beyond(hub, Kind::Watch, key, from);
        to.dedup_by_key(|(link, _)| *link);
        for (link, _) in to {
            self.send(
                link,
                false,
                Packet::Token {
                    key: key.to_owned(),
                    is_there,
                },
            );
        }
        if from.is_some() {
            self.take_token(hub, key, is_there);
        }
    }

    /// Notifies a session of a token.
    fn take_token(&mut self, session: usize, key: &str, is_there: bool) {
        let node = self.sessions[session].node;
        self.note(if is_there { "sees" } else { "misses" }, node, key, &[]);
        for declared in self.sessions[session].declared.values_mut() {
            if let What::Watch(take, known) = &mut declared.what
                && keys_meet(&declared.key, key)
                && (if is_there {
                    known.insert(key.to_owned())
                } else {
                    known.remove(key)
                })
            {
                let take = Arc::clone(take);
                let key = key.to_owned();
                self.calls.push(Box::new(move || take(&key, is_there)));
            }
        }
    }

    /// Discards all tokens known to a leaf that has lost its link.
    pub(crate) fn forget_tokens(&mut self, leaf: usize) {
        let watches = self.sessions[leaf]
            .declared
            .values()
            .filter_map(|declared| match &declared.what {
                What::Watch(_, known) => Some(known),
                _ => None,
            });
        let known: BTreeSet<String> = watches.flatten().cloned().collect();
        known
            .iter()
            .for_each(|key| self.take_token(leaf, key, false));
    }

    /// Discards everything that the hub learned over a link.
    pub(crate) fn forget(&mut self, link: usize) {
        let hub = self.links[link].hub;
        let known = std::mem::take(&mut self.links[link].known);
        let tokens = known.into_values().filter(|(kind, _)| *kind == Kind::Token);
        tokens.for_each(|(_, key)| self.announce(hub, &key, false, Some(link)));
    }

    pub(crate) fn take_local(&mut self, session: usize, local: &Local) {
        match local {
            Local::Publish { key, bytes } => self.call_subscribers(session, key, bytes, true),
            Local::Token { watch, key } => {
                let declared = self.sessions[session].declared.get_mut(watch);
                if let Some(Declared {
                    what: What::Watch(take, known),
                    ..
                }) = declared
                    && known.insert(key.clone())
                {
                    let take = Arc::clone(take);
                    let key = key.clone();
                    self.calls.push(Box::new(move || take(&key, true)));
                }
            }
        }
    }

    /// Starts a watch at a hub with the tokens that are present.
    pub(crate) fn begin_watch(&mut self, session: usize, watch: u64, key: &str) {
        for key in self.tokens(session, key, None) {
            self.at(
                self.now_ns,
                Event::Local {
                    session,
                    local: Local::Token { watch, key },
                },
            );
        }
    }

    /// Forwards a query from a hub to all matching queryables.
    pub(crate) fn route(
        &mut self,
        hub: usize,
        query: u64,
        key: &str,
        asked: Asked,
        from: Option<usize>,
    ) {
        let payload = match asked {
            Asked::Payload(payload) => payload,
            Asked::Tokens => {
                let tokens = serde_json::to_vec(&self.tokens(hub, key, None))
                    .expect("a list of strings is JSON");
                return self.answer_back(hub, query, Some(Parcel::new(tokens)));
            }
        };
        let beyond = self.declared_beyond(hub, Kind::Queryable, key, from);
        let mut open = beyond.len();
        for declared in self.sessions[hub].declared.values() {
            if let What::Queryable(take) = &declared.what
                && keys_meet(&declared.key, key)
            {
                self.calls
                    .push(asking(take, hub, query, key.to_owned(), payload.clone()));
                open += 1;
            }
        }
        if let Some(pending) = self.queries.get_mut(&query) {
            pending.open = open;
        }
        if open == 0 {
            return self.answer_back(hub, query, None);
        }
        for (link, id) in beyond {
            self.send(
                link,
                false,
                Packet::Query {
                    query,
                    id,
                    key: key.to_owned(),
                    payload: payload.clone(),
                },
            );
        }
    }

    /// Handles an answer at the hub, or the end of a session's answers.
    pub(crate) fn answer_at_hub(&mut self, hub: usize, query: u64, answer: Option<Parcel>) {
        let Some(pending) = self.queries.get_mut(&query) else {
            return;
        };
        if answer.is_none() {
            pending.open = pending.open.saturating_sub(1);
            if pending.open > 0 {
                return;
            }
        }
        self.answer_back(hub, query, answer);
    }

    fn answer_back(&mut self, hub: usize, query: u64, answer: Option<Parcel>) {
        let Some(asker) = self.queries.get(&query).map(|pending| pending.asker) else {
            return;
        };
        if asker == hub {
            return self.answered(query, answer);
        }
        if let Some(link) = self
            .links
            .iter()
            .rposition(|link| link.leaf == asker && link.hub == hub && link.hub_open)
        {
            self.send(link, false, Packet::Answer { query, answer });
        }
    }

    /// Passes an answer to the querying session.
    fn answered(&mut self, query: u64, answer: Option<Parcel>) {
        if let Some(pending) = self.queries.get(&query) {
            let take = Arc::clone(&pending.take);
            self.calls.push(Box::new(move || take(answer)));
        }
    }
}

/// The call to a queryable.
fn asking(take: &TakeQuery, session: usize, query: u64, key: String, payload: Parcel) -> Call {
    let take = Arc::clone(take);
    Box::new(move || {
        take(RoutedQuery {
            session,
            query,
            key,
            payload,
        })
    })
}
