//! Disables the linger option on the sockets of zenoh's links, so that closing a socket never waits
//! for its peer.
//!
//! zenoh gives every TCP and TLS socket a linger time of ten seconds. Linux then blocks in `close`
//! until the peer has received all data, even on a non-blocking socket, and zenoh closes sockets in
//! the threads that serve all its other links. An unreachable or stopped peer would therefore block
//! all others for ten seconds. Without the option the system sends the remaining data in the
//! background.

use crate::descriptor::{self, Ends, Kind};
use std::os::fd::RawFd;
use zenoh::sample::SampleKind;
use zenoh::session::{Link, LinkEvent};
use zenoh::{Session, Wait};

/// Disables the option on the sockets of all links of a session, existing and future.
pub(crate) fn disable(session: &Session) -> zenoh::Result<()> {
    let take = |event: LinkEvent| {
        if event.kind() == SampleKind::Put {
            disable_for(event.link());
        }
    };
    // A new link is reported before it is read from, and stays open during the callback.
    session
        .info()
        .link_events_listener()
        .history(true)
        .callback(take)
        .background()
        .wait()
}

/// The addresses of a link's two ends; `None` if the link has no connection.
pub(crate) fn ends(link: &Link) -> Option<Ends> {
    let address = |locator: &zenoh::config::Locator| locator.address().as_str().parse().ok();
    Some((address(link.src())?, address(link.dst())?))
}

/// Disables the option on a link's socket. Connectionless links, such as UDP, have no linger
/// option.
fn disable_for(link: &Link) {
    if let Some(ends) = ends(link) {
        descriptor::all()
            .into_iter()
            .flatten()
            .for_each(|descriptor| disable_if(descriptor, ends));
    }
}

/// Disables the option on a descriptor if it is the socket between these two addresses. The socket
/// stays open, because zenoh holds its link during the callback.
fn disable_if(descriptor: RawFd, ends: Ends) {
    if matches!(descriptor::kind(descriptor), Kind::Connection(found) if found == ends) {
        // Errors are ignored: a closed socket has no linger time. The option is disabled rather
        // than set to zero: with a linger time of zero, the system discards unsent data. Incomplete
        // links are not reported here; for these, the build settings in `.cargo/config.toml` remove
        // zenoh's linger time. Without this, `strace -f -T -e close` showed `close` taking 10.0 s;
        // `tests/process/network.rs` guards against it.
        drop(descriptor::with_socket(descriptor, |socket| {
            socket.set_linger(None)
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socket2::SockRef;
    use std::net::{TcpListener, TcpStream};
    use std::time::Duration;

    #[test]
    fn the_socket_between_two_addresses_loses_its_linger_time_and_no_other_does() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("an address");
        let sockets = [0, 1].map(|_| TcpStream::connect(address).expect("it listens"));
        let linger = || {
            sockets
                .each_ref()
                .map(|socket| SockRef::from(socket).linger().expect("a TCP socket"))
        };
        let time = Some(Duration::from_secs(10));
        sockets.iter().for_each(|socket| {
            SockRef::from(socket)
                .set_linger(time)
                .expect("a TCP socket")
        });
        let local = sockets[1].local_addr().expect("an address");
        let all = descriptor::all().expect("the system lists them");
        all.into_iter()
            .for_each(|descriptor| disable_if(descriptor, (local, address)));
        assert_eq!(linger(), [time, None]);
    }
}
