//! A session on the simulated network, behind [`bus::Bus`].

use crate::declared::{Declared, PendingQuery, RoutedQuery, What};
use crate::packet::{Asked, Kind, Packet};
use crate::scheduler::{World, current, is_in_callback, wait_until};
use crate::state::SessionState;
use bus::{
    BusError, Declaration, Delivery, Encoding, Net, OnBytes, OnLinkLost, OnQuery, OnToken, Parcel,
    Priority, Sender, Session, Watched, clock,
};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

/// Reciprocal of the fraction of messages that are delayed before sending.
const PAUSES: u64 = 8;
/// Prefix of the token keys of linked leaves, followed by the leaf's identifier.
const LINKS: &str = "link/";
/// Duration of an attempt to connect if no hub is listening.
const CONNECT: Duration = Duration::from_secs(1);

/// A session of a simulated node.
#[derive(Clone)]
pub(crate) struct SimulatedSession {
    world: Arc<World>,
    session: usize,
    id: String,
}

/// Sends messages on one key.
pub(crate) struct SimulatedSender {
    session: SimulatedSession,
    key: Arc<str>,
}

/// The answers to a query so far.
#[derive(Default)]
struct Answers {
    /// In order of arrival; removed by the querying session.
    waiting: VecDeque<Parcel>,
    is_complete: bool,
}

/// Withdraws a declaration on drop.
pub(crate) struct Undeclare {
    session: SimulatedSession,
    id: u64,
}

/// A query that is to be answered once.
pub(crate) struct SimulatedQuery {
    world: Arc<World>,
    routed: RoutedQuery,
}

impl SimulatedSession {
    /// Opens a hub inside a simulation. Fails if another one listens at its endpoint.
    pub(crate) fn hub(net: &Net) -> Result<SimulatedSession, String> {
        let session = SimulatedSession::new(&net.listen, true)?;
        let is_taken = session
            .world
            .visit(|state| state.hub_at(&net.listen) != Some(session.session));
        if is_taken {
            session.close();
            return Err("the address is in use".to_owned());
        }
        Ok(session)
    }

    /// Connects to a hub inside a simulation.
    pub(crate) fn leaf(net: &Net) -> Result<SimulatedSession, String> {
        let session = SimulatedSession::new(&net.connect, false)?;
        let delay = session.world.state.lock().conditions.delay;
        // A handshake is one round trip; zenoh needs more, but the effect is the same.
        wait_until(0, session.world.now().checked_add(2 * delay));
        session.insert(format!("{LINKS}{}", session.id), What::Token);
        let hub = session.world.visit(|state| {
            let hub = state.reachable_hub(session.session);
            hub.inspect(|hub| state.connect(session.session, *hub))
        });
        if hub.is_none() {
            session.close();
            wait_until(0, session.world.now().checked_add(CONNECT));
            return Err("nothing is listening there".to_owned());
        }
        Ok(session)
    }

    fn new(endpoints: &[String], is_hub: bool) -> Result<SimulatedSession, String> {
        let current = current().ok_or("not inside a simulation")?;
        let world = current.world;
        let mut state = world.state.lock();
        let id = format!("{:016x}", state.stream.bits());
        let session = state.sessions.len();
        let node = current.node;
        let endpoints = endpoints.to_vec();
        let declared = BTreeMap::new();
        state.sessions.push(SessionState {
            node,
            is_open: true,
            endpoints,
            link: None,
            is_hub,
            declared,
        });
        drop(state);
        Ok(SimulatedSession { world, session, id })
    }

    fn declare(&self, key: String, what: What) -> Declaration {
        Declaration::new(Undeclare {
            session: self.clone(),
            id: self.insert(key, what),
        })
    }

    /// Adds a declaration, which lasts until it is withdrawn or the session closes. Returns its
    /// number.
    fn insert(&self, key: String, what: What) -> u64 {
        // A closed session refuses a declaration. It is dropped here, after the lock is released,
        // because dropping it may use the network.
        let (id, _refused) = self.world.visit(|state| {
            state.number += 1;
            let id = state.number;
            let declared = Declared {
                key: key.clone(),
                what,
            };
            let packet = declared.packet(id);
            let own = &mut state.sessions[self.session];
            let is_hub = own.is_hub;
            let link = own.link;
            let refused = if own.is_open {
                own.declared.insert(id, declared)
            } else {
                Some(declared)
            };
            match packet {
                Packet::Declare {
                    kind: Kind::Watch, ..
                } if is_hub => state.begin_watch(self.session, id, &key),
                Packet::Declare {
                    kind: Kind::Token, ..
                } if is_hub => state.announce(self.session, &key, true, None),
                packet => link
                    .into_iter()
                    .for_each(|link| state.send(link, true, packet.clone())),
            }
            (id, refused)
        });
        id
    }

    fn query(
        &self,
        key: &str,
        asked: Asked,
        limit: Duration,
        accept: &mut dyn FnMut(&Parcel) -> bool,
    ) -> Option<Parcel> {
        let answers = Arc::new(Watched::new(Answers::default()));
        let taken = Arc::clone(&answers);
        let take = Arc::new(move |answer| {
            taken.visit(|answers| match answer {
                Some(answer) => answers.waiting.push_back(answer),
                None => answers.is_complete = true,
            });
        });
        let query = self.world.visit(|state| {
            let SessionState { is_hub, link, .. } = state.sessions[self.session];
            state.number += 1;
            let query = state.number;
            if is_hub || link.is_some() {
                state.queries.insert(
                    query,
                    PendingQuery {
                        asker: self.session,
                        open: 0,
                        take,
                    },
                );
            }
            match link {
                _ if is_hub => state.route(self.session, query, key, asked, None),
                link => state.send(
                    link?,
                    true,
                    Packet::Ask {
                        query,
                        key: key.to_owned(),
                        asked,
                    },
                ),
            }
            Some(query)
        })?;
        let start = clock::now();
        let accepted = loop {
            let left = limit.saturating_sub(clock::since(start));
            answers.wait(left, |answers| {
                !answers.waiting.is_empty() || answers.is_complete
            });
            match answers.visit(|answers| answers.waiting.pop_front()) {
                Some(answer) if accept(&answer) => break Some(answer),
                Some(_) => {}
                None => break None,
            }
        };
        drop(self.world.state.lock().queries.remove(&query));
        accepted
    }
}

impl Session for SimulatedSession {
    fn id(&self) -> String {
        self.id.clone()
    }

    fn publisher(
        &self,
        key: String,
        _: Priority,
        _: Delivery,
    ) -> Result<Box<dyn Sender>, BusError> {
        Ok(Box::new(SimulatedSender {
            session: self.clone(),
            key: key.into(),
        }))
    }

    fn subscribe(
        &self,
        key: String,
        hears_own: bool,
        receive: OnBytes,
    ) -> Result<Declaration, BusError> {
        Ok(self.declare(
            key,
            What::Subscriber {
                take: receive.into(),
                hears_own,
            },
        ))
    }

    fn answer(&self, key: String, receive: OnQuery) -> Result<Declaration, BusError> {
        let take = move |mut routed: RoutedQuery| {
            let world = current()
                .expect("events happen in threads of the simulation")
                .world;
            let question = std::mem::take(&mut routed.payload);
            receive(question, Box::new(SimulatedQuery { world, routed }));
        };
        Ok(self.declare(key, What::Queryable(Arc::new(take))))
    }

    fn ask(
        &self,
        _: Priority,
        key: &str,
        question: Parcel,
        limit: Duration,
        accept: &mut dyn FnMut(&Parcel) -> bool,
    ) -> Result<Option<Vec<u8>>, BusError> {
        Ok(self
            .query(key, Asked::Payload(question), limit, accept)
            .map(|answer| answer.bytes))
    }

    fn show_alive(&self, key: String) -> Result<Declaration, BusError> {
        Ok(self.declare(key, What::Token))
    }

    fn watch_alive(&self, key: String, receive: OnToken) -> Result<Declaration, BusError> {
        Ok(self.declare(key, What::Watch(receive.into(), BTreeSet::default())))
    }

    fn watch_links(&self, receive: OnLinkLost) -> Result<Declaration, BusError> {
        self.watch_alive(
            format!("{LINKS}*"),
            Box::new(move |key, is_there| {
                let gone = key.strip_prefix(LINKS).filter(|_| !is_there);
                gone.map(str::to_owned).into_iter().for_each(&receive);
            }),
        )
    }

    fn who_is_alive(&self, key: &str, limit: Duration) -> Result<Vec<String>, BusError> {
        let tokens = self.query(key, Asked::Tokens, limit, &mut |_| true);
        Ok(tokens
            .and_then(|json| serde_json::from_slice(&json.bytes).ok())
            .unwrap_or_default())
    }

    fn close(&self) {
        self.world.state.lock().close(self.session);
    }
}

impl Sender for SimulatedSender {
    fn is_heard(&self) -> bool {
        self.session
            .world
            .state
            .lock()
            .is_heard(self.session.session, &self.key)
    }

    fn send(&self, bytes: Vec<u8>, _: Encoding) -> Result<(), BusError> {
        self.pause_now_and_then();
        self.session
            .world
            .state
            .lock()
            .publish(self.session.session, &self.key, &bytes.into());
        Ok(())
    }
}

impl SimulatedSender {
    /// Pauses occasionally, as if computing.
    fn pause_now_and_then(&self) {
        if is_in_callback() {
            return;
        }
        let mut state = self.session.world.state.lock();
        let pause = state.conditions.pause;
        let is_held_up = !pause.is_zero() && state.stream.below(PAUSES) == 0;
        let time = if is_held_up {
            state.draw(pause)
        } else {
            Duration::ZERO
        };
        drop(state);
        if is_held_up {
            wait_until(0, self.session.world.now().checked_add(time));
        }
    }
}

impl Drop for Undeclare {
    fn drop(&mut self) {
        let Undeclare {
            session: SimulatedSession { world, session, .. },
            id,
        } = self;
        let removed = world.visit(|state| {
            let SessionState { is_hub, link, .. } = state.sessions[*session];
            let removed = state.sessions[*session].declared.remove(id);
            match (&removed, link) {
                (
                    Some(Declared {
                        key,
                        what: What::Token,
                    }),
                    _,
                ) if is_hub => state.announce(*session, key, false, None),
                (Some(_), Some(link)) => state.send(link, true, Packet::Undeclare { id: *id }),
                _ => {}
            }
            removed
        });
        // Dropping a subscriber's state may use the network.
        drop(removed);
    }
}

impl SimulatedQuery {
    fn send(&self, answer: Option<Parcel>) {
        let RoutedQuery { session, query, .. } = self.routed;
        self.world.visit(|state| {
            let SessionState {
                is_open,
                is_hub,
                link,
                ..
            } = state.sessions[session];
            match link {
                _ if !is_open => {}
                _ if is_hub => state.answer_at_hub(session, query, answer),
                Some(link) => state.send(link, true, Packet::Answer { query, answer }),
                None => {}
            }
        });
    }
}

impl bus::PendingQuery for SimulatedQuery {
    fn key(&self) -> &str {
        &self.routed.key
    }

    fn answer(self: Box<Self>, answer: Parcel) {
        self.send(Some(answer));
    }
}

impl Drop for SimulatedQuery {
    fn drop(&mut self) {
        self.send(None);
    }
}
