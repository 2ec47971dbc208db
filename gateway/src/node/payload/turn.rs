//! Turns at a sonde: its clients have it, or, while there are none, the gateway, which polls it.

use bus::Watched;
use std::time::Duration;

/// How long a client waits for the gateway to release the sonde, which takes no longer than an
/// attempt to connect.
const LET_GO_MAX: Duration = Duration::from_secs(3);

/// Maximum number of clients, including those that are being disconnected.
const CLIENTS_MAX: usize = 2 * super::CLIENTS_MAX;

/// The state of the turns.
#[derive(Default)]
pub(super) struct Turn(Watched<State>);

#[derive(Default)]
struct State {
    clients: usize,
    is_polling: bool,
    is_closing: bool,
}

/// A client has the turn, together with other clients, until this is dropped.
pub(super) struct ClientTurn<'a>(&'a Turn);

/// The gateway has the turn, until this is dropped.
pub(super) struct PollTurn<'a>(&'a Turn);

impl Turn {
    /// Takes the turn for a client, and waits until the gateway has released it. `None` if there
    /// are too many clients.
    pub(super) fn client(&self) -> Option<ClientTurn<'_>> {
        let is_one_more = self.0.visit(|state| {
            let is_one_more = state.clients < CLIENTS_MAX;
            state.clients += usize::from(is_one_more);
            is_one_more
        });
        let turn = is_one_more.then(|| ClientTurn(self))?;
        // A sonde handles one conversation at a time: our query and a client's would get each
        // other's answers.
        self.0.wait(LET_GO_MAX, |state| !state.is_polling);
        Some(turn)
    }

    /// Takes the turn for the gateway once there are no clients; `None` when everything ends.
    pub(super) fn poll(&self) -> Option<PollTurn<'_>> {
        loop {
            self.0
                .wait(LET_GO_MAX, |state| state.clients == 0 || state.is_closing);
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

    /// Ends all turns.
    pub(super) fn close(&self) {
        self.0.visit(|state| state.is_closing = true);
    }
}

impl PollTurn<'_> {
    /// Waits while nobody else wants the turn; returns whether somebody does.
    pub(super) fn is_wanted_within(&self, limit: Duration) -> bool {
        self.0
            .0
            .wait(limit, |state| state.clients > 0 || state.is_closing)
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
