//! Whose turn it is at a sonde: that of its clients, or, as long as there are none, of the gateway, which asks it by itself.

use bus::Watched;
use std::time::Duration;

/// How long a client waits for the gateway to let go of the sonde, which takes it no longer than an attempt to connect.
const LET_GO_MAX: Duration = Duration::from_secs(3);

/// The most clients at once, those among them that are being disconnected.
const CLIENTS_MAX: usize = 2 * super::limit::CLIENTS_MAX;

/// Whose turn it is.
#[derive(Default)]
pub(super) struct Turn(Watched<State>);

#[derive(Default)]
struct State {
    clients: usize,
    is_polling: bool,
    is_closing: bool,
}

/// A client has the turn, with other clients, until this is dropped.
pub(super) struct ClientTurn<'a>(&'a Turn);

/// The gateway has the turn, until this is dropped.
pub(super) struct PollTurn<'a>(&'a Turn);

impl Turn {
    /// A client takes the turn, and waits until the gateway has let go of it. None where there are too many.
    pub(super) fn client(&self) -> Option<ClientTurn<'_>> {
        let is_one_more = self.0.visit(|state| {
            let is_one_more = state.clients < CLIENTS_MAX;
            state.clients += usize::from(is_one_more);
            is_one_more
        });
        let turn = is_one_more.then(|| ClientTurn(self))?;
        // A sonde has one conversation at a time: our question and a client's would get each
        // other's answers.
        self.0.wait(LET_GO_MAX, |state| !state.is_polling);
        Some(turn)
    }

    /// The gateway takes the turn once there are no clients; none when all is over.
    pub(super) fn poll(&self) -> Option<PollTurn<'_>> {
        loop {
            self.0.wait(LET_GO_MAX, |state| state.clients == 0 || state.is_closing);
            let (is_polling, is_closing) = self.0.visit(|state| {
                state.is_polling = state.clients == 0 && !state.is_closing;
                (state.is_polling, state.is_closing)
            });
            if is_polling {
                return Some(PollTurn(self));
            }
            if is_closing {
                return None;
            }
        }
    }

    /// All is over.
    pub(super) fn close(&self) {
        self.0.visit(|state| state.is_closing = true);
    }
}

impl PollTurn<'_> {
    /// Waits, as long as nobody else wants the turn; whether somebody does.
    pub(super) fn is_wanted_within(&self, limit: Duration) -> bool {
        self.0.0.wait(limit, |state| state.clients > 0 || state.is_closing)
    }
}

impl Drop for ClientTurn<'_> {
    fn drop(&mut self) {
        self.0.0.visit(|state| state.clients -= 1);
    }
}

impl Drop for PollTurn<'_> {
    fn drop(&mut self) {
        self.0.0.visit(|state| state.is_polling = false);
    }
}
