//! The open connections of a server with a limited number of slots. A new connection always gets
//! one; if none is free, another connection is evicted.

use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::Arc;

/// The open connections.
#[derive(Clone)]
pub struct Connections {
    open: Arc<Mutex<Open>>,
    most: usize,
}

#[derive(Default)]
struct Open {
    /// Logical clock of events; the lowest value is the oldest.
    count: u64,
    /// By slot number.
    connections: BTreeMap<u64, Entry>,
}

struct Entry {
    from: IpAddr,
    /// `count` at the last request over the connection.
    used: u64,
    close: Box<dyn FnOnce() + Send>,
}

/// A slot for one connection, freed on drop.
pub struct Slot {
    open: Arc<Mutex<Open>>,
    number: u64,
}

impl Connections {
    /// Slots for at most `most` connections.
    pub fn new(most: usize) -> Connections {
        Connections {
            open: Arc::default(),
            most,
        }
    }

    /// Takes a slot for a connection from this address. If no slot is free, evicts the least
    /// recently used connection of the address with the most connections. `close` ends the new
    /// connection, when it is itself evicted or all connections are closed.
    pub fn admit(&self, from: IpAddr, close: impl FnOnce() + Send + 'static) -> Slot {
        let mut open = self.open.lock();
        let mut surplus = Vec::new();
        while open.connections.len() >= self.most {
            let Some(entry) = open
                .most_idle()
                .and_then(|number| open.connections.remove(&number))
            else {
                break;
            };
            surplus.push(entry);
        }
        open.count += 1;
        let number = open.count;
        open.connections.insert(
            number,
            Entry {
                from,
                used: number,
                close: Box::new(close),
            },
        );
        drop(open);
        // Close outside the lock: closing calls the connection's owner, which may drop its slot and
        // so take the lock.
        surplus.into_iter().for_each(|entry| (entry.close)());
        Slot {
            open: Arc::clone(&self.open),
            number,
        }
    }

    /// Ends all connections.
    pub fn close(&self) {
        let all = std::mem::take(&mut self.open.lock().connections);
        all.into_values().for_each(|entry| (entry.close)());
    }
}

impl Open {
    fn most_idle(&self) -> Option<u64> {
        let mut by_address = BTreeMap::<IpAddr, usize>::new();
        self.connections
            .values()
            .for_each(|entry| *by_address.entry(entry.from).or_insert(0) += 1);
        let share = |entry: &Entry| by_address.get(&entry.from).copied().unwrap_or(0);
        let most_idle =
            // Prefer the address with the most connections: a host that opens thousands evicts its
            // own connections, while a host with a single connection keeps it, however long it is
            // idle.
            |(_, a): &(&u64, &Entry), (_, b): &(&u64, &Entry)| share(b).cmp(&share(a)).then(a.used.cmp(&b.used));
        self.connections
            .iter()
            .min_by(most_idle)
            .map(|(number, _)| *number)
    }
}

impl Slot {
    /// Records that a request used the connection.
    pub fn touch(&self) {
        let mut open = self.open.lock();
        open.count += 1;
        let count = open.count;
        if let Some(entry) = open.connections.get_mut(&self.number) {
            entry.used = count;
        }
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        self.open.lock().connections.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    const STRANGER: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 1));
    const OPERATOR: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 2));

    /// A connection, and whether it has been closed.
    fn admit(connections: &Connections, from: IpAddr) -> (Slot, Arc<AtomicBool>) {
        let closed = Arc::new(AtomicBool::new(false));
        let close = Arc::clone(&closed);
        (
            connections.admit(from, move || close.store(true, Ordering::Relaxed)),
            closed,
        )
    }

    fn closed<'a>(all: impl IntoIterator<Item = &'a (Slot, Arc<AtomicBool>)>) -> Vec<bool> {
        all.into_iter()
            .map(|(_, closed)| closed.load(Ordering::Relaxed))
            .collect()
    }

    #[test]
    fn a_newcomer_takes_the_place_of_whoever_idles_longest() {
        let connections = Connections::new(3);
        let mut all: Vec<_> = (0..3).map(|_| admit(&connections, STRANGER)).collect();
        all[0].0.touch();
        all.push(admit(&connections, STRANGER));
        assert_eq!(closed(&all), [false, true, false, false]);
        // A closed connection also frees its slot.
        all.remove(2);
        all.push(admit(&connections, STRANGER));
        assert_eq!(closed(&all), [false, true, false, false]);
        connections.close();
        assert_eq!(closed(&all), [true; 4]);
    }

    #[test]
    fn who_has_many_makes_room_for_who_has_few() {
        let connections = Connections::new(4);
        let operator = admit(&connections, OPERATOR);
        let crowd: Vec<_> = (0..300).map(|_| admit(&connections, STRANGER)).collect();
        assert_eq!(
            closed([&operator]),
            [false],
            "it has been idle longest, but is one of few"
        );
        assert_eq!(closed(&crowd).iter().filter(|closed| !**closed).count(), 3);
    }
}
