//! Queries and answers over a session.

use crate::parcel::Parcel;
use crate::session::{Declaration, PendingQuery};
use crate::{Bus, BusError, Priority, Token, access, token};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::time::Duration;

/// A query from another node, to be answered once.
pub struct Query {
    asker: Box<dyn PendingQuery>,
    question: Parcel,
    /// The token of the node that received the query.
    token: Option<Token>,
}

impl Bus {
    /// Calls `receive` with every query at `key`.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn answer(
        &self,
        key: String,
        receive: impl Fn(Query) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        let token = self.token.clone();
        let receive = move |question, asker| {
            receive(Query {
                asker,
                question,
                token: token.clone(),
            })
        };
        self.session.answer(key, Box::new(receive))
    }

    /// Queries `key`, where only the sim may answer; returns its answer if it arrives within
    /// `limit`. Query and answer have a lower priority than all published messages, and a congested
    /// link drops them.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn ask(
        &self,
        key: &str,
        payload: Vec<u8>,
        limit: Duration,
    ) -> Result<Option<Vec<u8>>, BusError> {
        self.session.ask(
            Priority::Normal,
            key,
            Parcel::new(payload),
            limit,
            &mut |_| true,
        )
    }

    /// Like [`Bus::ask`], for a key at which other nodes answer. In a game without keys any node
    /// may answer: if this node knows the token, only answers that prove knowledge of it count.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed, or if only nodes without the token have answered.
    pub fn ask_node(
        &self,
        key: &str,
        payload: Vec<u8>,
        limit: Duration,
    ) -> Result<Option<Vec<u8>>, BusError> {
        self.ask_node_at(Priority::Normal, key, payload, limit)
    }

    fn ask_node_at(
        &self,
        priority: Priority,
        key: &str,
        payload: Vec<u8>,
        limit: Duration,
    ) -> Result<Option<Vec<u8>>, BusError> {
        // With keys, access control lets no other node answer.
        let Some(token) = self.token.as_ref().filter(|_| self.keys.is_none()) else {
            return self
                .session
                .ask(priority, key, Parcel::new(payload), limit, &mut |_| true);
        };
        // Any node may declare that it answers for a boat's gateway, and zenoh routes a query to
        // the first that claims completeness: an intruder could intercept an E-stop and reply
        // "disarmed". Therefore all are queried, and only a sealed answer counts. A relay in the
        // sim would make each command depend on the sim's loop.
        let question = Parcel::question(payload);
        let mut refused = false;
        let answer = self
            .session
            .ask(priority, key, question.clone(), limit, &mut |answer| {
                let is_sealed = question.is_answered_by(key, answer, token);
                refused |= !is_sealed;
                is_sealed
            })?;
        if answer.is_none() && refused {
            Err(BusError::Unsealed {
                key: key.to_owned(),
            })
        } else {
            Ok(answer)
        }
    }

    /// Sends a request to the sim at `key` that may need the game's token, and proves knowledge of
    /// it if challenged. Returns the first answer; `limit` applies to each query. Requests have the
    /// highest priority, since some command boats.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed, if a required token is missing or wrong, if this
    /// node's keys do not allow the request, or if the answer cannot be read.
    pub fn request<B: Serialize, T: DeserializeOwned>(
        &self,
        key: &str,
        body: &B,
        limit: Duration,
    ) -> Result<Option<T>, BusError> {
        self.check_may_ask(key)?;
        let ask = |payload| {
            self.session.ask(
                Priority::Urgent,
                key,
                Parcel::new(payload),
                limit,
                &mut |_| true,
            )
        };
        token::request(self.token.as_ref(), key, body, ask)
    }

    /// Like [`Bus::request`], but to a node other than the sim. In a game without keys, the node
    /// must know the token.
    ///
    /// # Errors
    /// As for [`Bus::request`], and if this node has neither token nor keys: it could not verify
    /// who answers.
    pub fn request_node<B: Serialize, T: DeserializeOwned>(
        &self,
        key: &str,
        body: &B,
        limit: Duration,
    ) -> Result<Option<T>, BusError> {
        self.check_may_ask(key)?;
        if self.token.is_none() && self.keys.is_none() {
            return Err(BusError::NeedsToken);
        }
        let ask = |payload| self.ask_node_at(Priority::Urgent, key, payload, limit);
        token::request(self.token.as_ref(), key, body, ask)
    }

    fn check_may_ask(&self, key: &str) -> Result<(), BusError> {
        match self.keys.as_ref().map(|keys| &keys.identity) {
            Some(identity) if !access::may_ask(identity, key) => Err(BusError::NotAllowed {
                identity: identity.clone(),
            }),
            _ => Ok(()),
        }
    }
}

impl Query {
    /// The key of the query.
    pub fn key(&self) -> &str {
        self.asker.key()
    }

    /// The content of the query.
    pub fn payload(&self) -> &[u8] {
        &self.question.bytes
    }

    /// Answers with JSON bytes, sealed with the token of the session's node.
    pub fn answer(self, json: Vec<u8>) {
        let token = self.token.clone();
        self.answer_as(json, token.as_ref());
    }

    /// Answers with JSON bytes, sealed with this token.
    pub fn answer_as(self, json: Vec<u8>, token: Option<&Token>) {
        let answer = self.question.answer(self.key(), json, token);
        self.asker.answer(answer);
    }
}
