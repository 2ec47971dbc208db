//! The file descriptors of this process. zenoh does not expose its sockets, so they are found by
//! their addresses.

use socket2::{SockRef, Type};
use std::io;
use std::net::{Shutdown, SocketAddr};
use std::os::fd::{AsRawFd, BorrowedFd, RawFd};

/// Where the system lists the calling process's descriptors: Linux has both folders, macOS and the
/// BSDs only the second.
const FOLDERS: [&str; 2] = ["/proc/self/fd", "/dev/fd"];

/// The two ends of a connection: local and peer address.
pub(crate) type Ends = (SocketAddr, SocketAddr);

/// The kind of a descriptor.
pub(crate) enum Kind {
    Connection(Ends),
    /// A TCP socket listening on this port.
    Listener(u16),
    Other,
}

/// The numbers of all descriptors.
///
/// # Errors
/// If the system provides no list, or no descriptor is left to read it.
pub(crate) fn all() -> io::Result<Vec<RawFd>> {
    // If neither exists, links keep their linger time and the port keeps zenoh's limits.
    let folder = std::fs::read_dir(FOLDERS[0]).or_else(|_| std::fs::read_dir(FOLDERS[1]))?;
    Ok(folder
        .flatten()
        .filter_map(|entry| entry.file_name().to_str()?.parse().ok())
        .collect())
}

/// Borrows a descriptor as a socket, whatever its kind: the system checks the kind at each call.
#[expect(
    unsafe_code,
    reason = "zenoh does not expose its sockets: only their numbers can be found"
)]
fn borrow<'a>(descriptor: RawFd) -> BorrowedFd<'a> {
    // SAFETY: the number comes from the system, so it is not -1, and the descriptor is not closed
    // through this borrow. If another thread closes it meanwhile, calls fail. If its number is
    // reused, the addresses differ: callers that change the socket compare them first, on a
    // duplicate or while zenoh keeps the socket open.
    unsafe { BorrowedFd::borrow_raw(descriptor) }
}

pub(crate) fn kind(descriptor: RawFd) -> Kind {
    let borrowed = borrow(descriptor);
    let socket = SockRef::from(&borrowed);
    let Some(local) = socket
        .local_addr()
        .ok()
        .and_then(|address| address.as_socket())
    else {
        return Kind::Other;
    };
    match socket.peer_addr() {
        Ok(peer) => peer
            .as_socket()
            .map_or(Kind::Other, |peer| Kind::Connection((local, peer))),
        // Neither a listener nor a datagram socket has a peer; the socket type distinguishes them.
        Err(_) if socket.r#type().is_ok_and(|kind| kind == Type::STREAM) => {
            Kind::Listener(local.port())
        }
        Err(_) => Kind::Other,
    }
}

/// Calls `change` with the socket of a descriptor, whose owner must keep it open meanwhile.
pub(crate) fn with_socket<T>(descriptor: RawFd, change: impl FnOnce(&SockRef<'_>) -> T) -> T {
    let borrowed = borrow(descriptor);
    change(&SockRef::from(&borrowed))
}

/// Ends a connection if the descriptor still belongs to it. The owner notices this and closes the
/// descriptor.
pub(crate) fn end(descriptor: RawFd, ends: Ends) {
    // A duplicate keeps referring to the same socket, even if the owner closes the descriptor.
    let Ok(duplicate) = borrow(descriptor).try_clone_to_owned() else {
        return;
    };
    if matches!(kind(duplicate.as_raw_fd()), Kind::Connection(found) if found == ends) {
        // The connection may have ended already.
        drop(SockRef::from(&duplicate).shutdown(Shutdown::Both));
    }
}
