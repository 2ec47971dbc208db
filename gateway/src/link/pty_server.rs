//! Serves our own pseudo-terminal as a link, one connection at a time.

use super::connection::Connection;
use super::interface::LinkEvent;
use super::port::Port;
use super::pty::Pty;
use super::threads::Threads;
use std::sync::Arc;

/// Serves each process that opens the terminal, until the link is closed.
pub(super) fn run(threads: &Arc<Threads>, pty: &Arc<Pty>) {
    let retry_in = threads.settings.retry_first;
    loop {
        let port = Port::Pty(Arc::clone(pty));
        if let Err(e) =
            Connection::open(threads, port, pty.path().display().to_string()).map(Connection::serve)
        {
            threads.emit(LinkEvent::Failed {
                reason: e.to_string(),
                retry_in,
            });
        }
        // We hold both ends: failures are rare, and a longer wait has no benefit.
        if threads.stops_within(retry_in) {
            return;
        }
    }
}
