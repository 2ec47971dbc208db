//! Takes the linger option off the sockets of zenoh's links, so that closing one never waits for its peer.
//!
//! zenoh gives every TCP and TLS socket a linger time of ten seconds. Linux then waits in `close` until the peer has taken
//! what was sent to it, even where the socket is non-blocking; zenoh closes sockets in the threads that serve all its other
//! links. So a peer that is cut off or stopped would hold up everybody for ten seconds. Without the option the system sends
//! what is left on its own. zenoh does not give its sockets away, so they are found among this process's descriptors.

use socket2::SockRef;
use std::net::SocketAddr;
use std::os::fd::{BorrowedFd, RawFd};
use zenoh::sample::SampleKind;
use zenoh::session::{Link, LinkEvent};
use zenoh::{Session, Wait};

/// Where the system lists the descriptors of the process that asks: Linux has both, macOS and the BSDs the second.
const DESCRIPTORS: [&str; 2] = ["/proc/self/fd", "/dev/fd"];

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

/// Takes the option off the socket of a link. A link that is no connection, such as one over UDP, has none.
fn disable_for(link: &Link) {
    let address = |locator: &zenoh::config::Locator| locator.address().as_str().parse::<SocketAddr>().ok();
    if let (Some(local), Some(peer)) = (address(link.src()), address(link.dst())) {
        descriptors().into_iter().for_each(|descriptor| disable_if(descriptor, local, peer));
    }
}

/// The descriptors of this process.
fn descriptors() -> Vec<RawFd> {
    let Some(folder) = DESCRIPTORS.iter().find_map(|folder| std::fs::read_dir(folder).ok()) else { return vec![] };
    folder.flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok()).collect()
}

/// Takes the option off a descriptor if it is the socket between these two addresses.
#[expect(unsafe_code, reason = "zenoh does not give its sockets away: only their numbers can be known")]
fn disable_if(descriptor: RawFd, local: SocketAddr, peer: SocketAddr) {
    // SAFETY: the number is not -1, the descriptor is not closed, and the system checks it at each call. If another thread
    // closes it meanwhile, the calls fail; if its number is used anew, it has other addresses and is left alone. The socket
    // with these addresses stays open, since zenoh holds its link while it reports it.
    let borrowed = unsafe { BorrowedFd::borrow_raw(descriptor) };
    let socket = SockRef::from(&borrowed);
    let is_at = |address: std::io::Result<socket2::SockAddr>, wanted| {
        address.ok().and_then(|address| address.as_socket()) == Some(wanted)
    };
    if is_at(socket.local_addr(), local) && is_at(socket.peer_addr(), peer) {
        // A socket that is closed already needs it no more.
        drop(socket.set_linger(None));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        descriptors().into_iter().for_each(|descriptor| disable_if(descriptor, local, address));
        assert_eq!(linger(), [time, None]);
    }
}
