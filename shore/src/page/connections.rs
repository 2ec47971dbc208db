//! The connections that are no websockets (yet): a newcomer always gets in, and whoever idles longest makes room for it.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::oneshot;

/// The open connections.
#[derive(Clone)]
pub(super) struct Connections {
    open: Arc<Mutex<Open>>,
    most: usize,
}

#[derive(Default)]
struct Open {
    /// Counts what happened; the least is what happened longest ago.
    count: u64,
    /// By number.
    connections: BTreeMap<u64, Entry>,
}

struct Entry {
    from: IpAddr,
    /// When something was last requested over it, by `count`.
    used: u64,
    /// Ends it.
    close: oneshot::Sender<()>,
}

/// The place of a connection. Dropped, it is free again.
pub(super) struct Place {
    open: Arc<Mutex<Open>>,
    number: u64,
}

impl Connections {
    /// Of which there are at most so many.
    pub(super) fn new(most: usize) -> Connections {
        Connections { open: Arc::default(), most }
    }

    /// A place for a connection from this address, and the word to close it. Where there is none, it takes that of another:
    /// of the address that has the most, the connection that was used longest ago.
    pub(super) fn admit(&self, from: IpAddr) -> (Place, oneshot::Receiver<()>) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        while open.connections.len() >= self.most {
            let Some(number) = open.most_idle() else { break };
            if let Some(entry) = open.connections.remove(&number) {
                // It may have ended by itself.
                entry.close.send(()).unwrap_or_default();
            }
        }
        let (close, closed) = oneshot::channel();
        open.count += 1;
        let number = open.count;
        open.connections.insert(number, Entry { from, used: number, close });
        (Place { open: Arc::clone(&self.open), number }, closed)
    }
}

impl Open {
    fn most_idle(&self) -> Option<u64> {
        let mut by_address = BTreeMap::<IpAddr, usize>::new();
        self.connections.values().for_each(|entry| *by_address.entry(entry.from).or_insert(0) += 1);
        let share = |entry: &Entry| by_address.get(&entry.from).copied().unwrap_or(0);
        let most_idle =
            |(_, a): &(&u64, &Entry), (_, b): &(&u64, &Entry)| share(b).cmp(&share(a)).then(a.used.cmp(&b.used));
        self.connections.iter().min_by(most_idle).map(|(number, _)| *number)
    }
}

impl Place {
    /// Something is requested over it.
    pub(super) fn touch(&self) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.count += 1;
        let count = open.count;
        if let Some(entry) = open.connections.get_mut(&self.number) {
            entry.used = count;
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.open.lock().unwrap_or_else(PoisonError::into_inner).connections.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRANGER: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 1));
    const OPERATOR: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 2));

    fn is_closed(closed: &mut oneshot::Receiver<()>) -> bool {
        closed.try_recv() == Ok(())
    }

    #[test]
    fn a_newcomer_takes_the_place_of_whoever_idles_longest() {
        let connections = Connections::new(3);
        let mut all: Vec<_> = (0..3).map(|_| connections.admit(STRANGER)).collect();
        all[0].0.touch();
        let newcomer = connections.admit(STRANGER);
        assert_eq!(all.iter_mut().map(|(_, closed)| is_closed(closed)).collect::<Vec<_>>(), [false, true, false]);
        // Who has left makes room as well.
        all.remove(2);
        let another = connections.admit(STRANGER);
        assert!(!is_closed(&mut all[0].1), "there was room");
        drop((newcomer, another));
    }

    #[test]
    fn who_has_many_makes_room_for_who_has_few() {
        let connections = Connections::new(4);
        let (_place, mut operator) = connections.admit(OPERATOR);
        let mut crowd: Vec<_> = (0..300).map(|_| connections.admit(STRANGER)).collect();
        assert!(!is_closed(&mut operator), "it has idled longest, but is one of few");
        assert_eq!(crowd.iter_mut().filter_map(|(_, closed)| closed.try_recv().err()).count(), 3);
    }
}
