//! Keeps a hub's port open for new nodes, however many other connections there are.
//!
//! A connection is pending until zenoh has made it a link. The number of pending connections is
//! limited: a newcomer beyond the limit ends an older one, chosen as in [`Connections`]. zenoh's
//! TLS listener (1.10, `tls-listener` 0.11) needs more: once the process has run out of file
//! descriptors, the listener only tries to accept and closes none of its connections, so it would
//! never recover. When descriptors run short, the port is closed briefly and the reserved
//! descriptors are lent to connections already accepted. The listener then has nothing more to
//! accept, and closes the connections that have ended.

use crate::descriptor::{self, Ends, Kind};
use crate::open_files::OpenFiles;
use crate::{Connections, Slot, clock, linger, start_thread};
use parking_lot::Mutex;
use std::collections::{BTreeMap, BTreeSet};
use std::os::fd::RawFd;
use std::sync::Arc;
use std::time::Duration;
use zenoh::sample::SampleKind;
use zenoh::session::LinkEvent;
use zenoh::{Session, Wait};

/// Interval at which the port is checked, and the interval while many connections are pending.
const POLL: Duration = Duration::from_millis(100);
const LOOK_OFTEN: Duration = Duration::from_millis(10);

type Links = Mutex<BTreeSet<Ends>>;

/// The state of the port.
struct Port {
    numbers: Vec<u16>,
    /// The listening sockets, which zenoh keeps open until the session closes.
    listeners: Vec<RawFd>,
    files: OpenFiles,
    waiting_max: usize,
    waiting: Connections,
    /// One slot for each pending connection.
    slots: BTreeMap<Ends, Slot>,
    is_closed: bool,
}

/// Guards these ports while the session is open; at most `waiting_max` connections may be pending.
pub(crate) fn begin(
    session: &Session,
    numbers: Vec<u16>,
    files: OpenFiles,
    waiting_max: usize,
) -> zenoh::Result<()> {
    let links = Arc::new(Links::default());
    let watched = Arc::downgrade(&links);
    let note = move |event: LinkEvent| {
        let Some(ends) = linger::ends(event.link()) else {
            return;
        };
        match event.kind() {
            SampleKind::Put => links.lock().insert(ends),
            // Links are identified by both addresses, since descriptors are reused: the same number
            // may now be a different connection.
            SampleKind::Delete => links.lock().remove(&ends),
        };
    };
    session
        .info()
        .link_events_listener()
        .history(true)
        .callback(note)
        .background()
        .wait()?;
    let waiting = Connections::new(waiting_max);
    let listeners = listeners(&numbers);
    // Connections already accepted by the system must fit into the reserved descriptors, together
    // with those still on loan.
    let queue_max = i32::try_from(files.kept() / 4).unwrap_or(i32::MAX);
    for listener in &listeners {
        // `listen` on a listening socket only changes the length of its queue.
        descriptor::with_socket(*listener, |socket| socket.listen(queue_max))?;
    }
    let slots = BTreeMap::new();
    let mut port = Port {
        numbers,
        listeners,
        files,
        waiting_max,
        waiting,
        slots,
        is_closed: false,
    };
    // A session that closes drops its callback, which ends this loop.
    let look = move || {
        while let Some(links) = watched.upgrade() {
            let rest = port.look(&links);
            drop(links);
            clock::rest(rest);
        }
    };
    Ok(start_thread("admission", look)?)
}

impl Port {
    /// Finds pending connections, ends the surplus ones, and returns the time until the next check.
    fn look(&mut self, links: &Links) -> Duration {
        // Listing descriptors needs a descriptor itself. If that fails, the reserved ones are lent
        // first.
        let listed = descriptor::all().or_else(|_| {
            self.close(true);
            descriptor::all()
        });
        let Ok(descriptors) = listed else {
            return LOOK_OFTEN;
        };
        let OpenFiles { usual, .. } = self.files;
        let is_lent =
            |descriptor: RawFd| u64::try_from(descriptor).is_ok_and(|number| number >= usual);
        let free = usual
            - descriptors
                .iter()
                .filter(|descriptor| !is_lent(**descriptor))
                .count() as u64;
        let mut found = BTreeMap::new();
        for descriptor in descriptors {
            if let Kind::Connection(ends) = descriptor::kind(descriptor)
                && self.numbers.contains(&ends.0.port())
            {
                found.insert(ends, descriptor);
            }
        }
        // Read the links only now, so that connections that have since become links are known.
        let links = links.lock().clone();
        let lent: Vec<(Ends, RawFd)> = found
            .iter()
            .map(|(ends, it)| (*ends, *it))
            .filter(|it| is_lent(it.1))
            .collect();
        // Lent descriptors are taken back before the port opens, because the next flood needs them.
        // A node whose link holds one has to reconnect.
        let are_too_many = lent.len() as u64 > self.files.kept() / 4;
        self.close(free < self.files.kept() / 2 || are_too_many);
        let goes = |ends: &Ends| self.is_closed && (are_too_many || !links.contains(ends));
        lent.iter()
            .filter(|(ends, _)| goes(ends))
            .for_each(|(ends, it)| descriptor::end(*it, *ends));
        found.retain(|ends, _| !links.contains(ends));
        self.slots.retain(|ends, _| found.contains_key(ends));
        for (ends, descriptor) in found {
            // Mapped IPv4 addresses count as IPv4; otherwise one host would have two allowances on
            // this port.
            let admit = || {
                self.waiting.admit(ends.1.ip().to_canonical(), move || {
                    descriptor::end(descriptor, ends)
                })
            };
            self.slots.entry(ends).or_insert_with(admit);
        }
        let are_many = 2 * self.slots.len() > self.waiting_max;
        if self.is_closed || are_many {
            LOOK_OFTEN
        } else {
            POLL
        }
    }

    /// Blocks new connections and lends the reserved descriptors, or undoes both.
    fn close(&mut self, is_closed: bool) {
        if self.is_closed != is_closed {
            self.is_closed = is_closed;
            // The order matters: new connections would take the lent descriptors.
            self.listeners
                .iter()
                .for_each(|listener| filter(*listener, is_closed));
            self.files.lend(is_closed);
        }
    }
}

/// This process's sockets that listen on one of these ports.
fn listeners(ports: &[u16]) -> Vec<RawFd> {
    let is_one =
        |it: &RawFd| matches!(descriptor::kind(*it), Kind::Listener(port) if ports.contains(&port));
    descriptor::all()
        .unwrap_or_default()
        .into_iter()
        .filter(is_one)
        .collect()
}

/// Makes the system drop packets for a listener, or accept them again. A client's TCP retries after
/// a second.
#[cfg(target_os = "linux")]
fn filter(listener: RawFd, is_closed: bool) {
    /// `BPF_RET | BPF_K` of classic BPF (`linux/bpf_common.h`) with zero: accepts no bytes of the
    /// packet.
    const DROP: [socket2::SockFilter; 1] = [socket2::SockFilter::new(0x06, 0, 0, 0)];
    let change = |socket: &socket2::SockRef<'_>| {
        if is_closed {
            socket.attach_filter(&DROP)
        } else {
            socket.detach_filter()
        }
    };
    // If this fails, a flood takes longer to clear.
    drop(descriptor::with_socket(listener, change));
}

/// Other systems have no such filter, so a flood takes longer to clear.
#[cfg(not(target_os = "linux"))]
fn filter(_listener: RawFd, _is_closed: bool) {}
