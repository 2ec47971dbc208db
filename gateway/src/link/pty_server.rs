//! Serves a pseudo-terminal of our own as a link, one connection at a time.

use super::LinkEvent;
use super::connection::{Connection, Served};
use super::peer::End;
use super::port::Port;
use super::pty::Pty;
use super::threads::{Threads, Woken};
use std::sync::Arc;

/// Serves each process that opens it, until the link is closed.
pub(super) fn run(threads: &Arc<Threads>, pty: &Arc<Pty>) {
    let retry_in = threads.settings.retry_first;
    loop {
        let port = Port::Pty(Arc::clone(pty));
        match Connection::open(threads, port, pty.path().display().to_string()).map(Connection::serve) {
            // There is no connection to break: a reconnect asks for a clean start, without earlier bytes.
            Ok(Served { end: End::Asked, .. }) => drop(pty.flush()),
            Ok(_) => {}
            Err(e) => threads.emit(LinkEvent::Failed { reason: e.to_string(), retry_in }),
        }
        // We hold both ends: failures are rare, and a longer wait has no benefit.
        if threads.sleep(retry_in) == Woken::Stopped {
            return;
        }
    }
}
