//! Takes the linger option off the sockets of zenoh's links, so that closing one never waits for its peer.
//!
//! zenoh gives every TCP and TLS socket a linger time of ten seconds. Linux then waits in `close` until the peer has taken
//! what was sent to it, even where the socket is non-blocking; zenoh closes sockets in the threads that serve all its other
//! links. So a peer that is cut off or stopped would hold up everybody for ten seconds. Without the option the system sends
//! what is left on its own.

use crate::descriptor::{self, Ends, Kind};
use std::os::fd::RawFd;
use zenoh::sample::SampleKind;
use zenoh::session::{Link, LinkEvent};
use zenoh::{Session, Wait};

/// Takes the option off the socket of every link of a session, of those there are and of those to come.
pub(crate) fn disable(session: &Session) -> zenoh::Result<()> {
    let take = |event: LinkEvent| {
        if event.kind() == SampleKind::Put {
            disable_for(event.link());
        }
    };
    // A new link is reported before it is read from, and while it is held open.
    session.info().link_events_listener().history(true).callback(take).background().wait()
}

/// The ends of a link. One that is no connection has none.
pub(crate) fn ends(link: &Link) -> Option<Ends> {
    let address = |locator: &zenoh::config::Locator| locator.address().as_str().parse().ok();
    Some((address(link.src())?, address(link.dst())?))
}

/// Takes the option off the socket of a link. A link that is no connection, such as one over UDP, has none.
fn disable_for(link: &Link) {
    if let Some(ends) = ends(link) {
        descriptor::all().into_iter().flatten().for_each(|descriptor| disable_if(descriptor, ends));
    }
}

/// Takes the option off a descriptor if it is the socket between these two addresses. That stays open: zenoh holds its link
/// while it reports it.
fn disable_if(descriptor: RawFd, ends: Ends) {
    if matches!(descriptor::kind(descriptor), Kind::Connection(found) if found == ends) {
        // A socket that is closed already needs it no more.
        // Off, not zero: with zero the system throws away what was sent last. Links that are
        // never finished are not reported here; for those `.cargo/config.toml` compiles zenoh's
        // linger time to nothing. `strace -f -T -e close` showed calls of 10.0 s before;
        // `tests/process/network.rs` guards it.
        drop(descriptor::with_socket(descriptor, |socket| socket.set_linger(None)));
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
        let linger = || sockets.each_ref().map(|socket| SockRef::from(socket).linger().expect("a TCP socket"));
        let time = Some(Duration::from_secs(10));
        sockets.iter().for_each(|socket| SockRef::from(socket).set_linger(time).expect("a TCP socket"));
        let local = sockets[1].local_addr().expect("an address");
        let all = descriptor::all().expect("the system lists them");
        all.into_iter().for_each(|descriptor| disable_if(descriptor, (local, address)));
        assert_eq!(linger(), [time, None]);
    }
}
