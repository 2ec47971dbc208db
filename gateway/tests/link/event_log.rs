//! A log of a link's events, for tests that wait for one of them.

use gateway::link::{Link, LinkAddress, LinkEvent, LinkSettings};
use std::io::Read;
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

/// Timeout of every wait.
pub(crate) const LIMIT: Duration = Duration::from_secs(10);

/// All events of a link so far.
#[derive(Default)]
pub(crate) struct EventLog {
    events: Mutex<Vec<(Instant, LinkEvent)>>,
    news: Condvar,
}

/// Settings for tests: short waits, no silence limit.
pub(crate) fn patient() -> LinkSettings {
    retrying(Duration::from_millis(20), Duration::from_millis(100))
}

/// Settings with these waits between attempts and no silence limit.
pub(crate) fn retrying(retry_first: Duration, retry_max: Duration) -> LinkSettings {
    LinkSettings {
        silence: None,
        retry_first,
        retry_max,
    }
}

pub(crate) fn connect(text: &str, settings: LinkSettings) -> (Link, Arc<EventLog>) {
    open(&LinkAddress::to_connect(text).unwrap(), settings)
}

pub(crate) fn listen(text: &str) -> (Link, Arc<EventLog>) {
    open(&LinkAddress::to_listen(text).unwrap(), patient())
}

pub(crate) fn open(address: &LinkAddress, settings: LinkSettings) -> (Link, Arc<EventLog>) {
    let log = Arc::new(EventLog::default());
    let events = Arc::clone(&log);
    let link = Link::open(address, settings, move |event| events.push(event)).unwrap();
    (link, log)
}

/// Drops a link, which must take less than 200 ms.
pub(crate) fn close(link: Link) {
    let start = Instant::now();
    drop(link);
    assert!(
        start.elapsed() < Duration::from_millis(200),
        "{:?}",
        start.elapsed()
    );
}

pub(crate) fn read(from: &mut impl Read, count: usize) -> Vec<u8> {
    let mut got = vec![0; count];
    from.read_exact(&mut got).unwrap();
    got
}

impl EventLog {
    pub(crate) fn push(&self, event: LinkEvent) {
        self.events.lock().unwrap().push((Instant::now(), event));
        self.news.notify_all();
    }

    /// All events so far, with their times.
    pub(crate) fn all(&self) -> Vec<(Instant, LinkEvent)> {
        self.events.lock().unwrap().clone()
    }

    /// Waits until `find` returns a result from all events.
    pub(crate) fn until<T>(
        &self,
        what: &str,
        mut find: impl FnMut(&[(Instant, LinkEvent)]) -> Option<T>,
    ) -> T {
        let start = Instant::now();
        let mut events = self.events.lock().unwrap();
        loop {
            if let Some(found) = find(&events) {
                return found;
            }
            let left = LIMIT.saturating_sub(start.elapsed());
            assert!(
                !left.is_zero(),
                "no {what} within {LIMIT:?}; the last of {}: {:?}",
                events.len(),
                tail(&events)
            );
            events = self.news.wait_timeout(events, left).unwrap().0;
        }
    }

    /// Waits for the `nth` peer (from 0) to connect; returns its number and the time.
    pub(crate) fn up(&self, nth: usize) -> (u32, Instant) {
        self.until("peer up", |events| events.iter().filter_map(up).nth(nth))
    }

    /// Waits for the `nth` peer (from 0) to disconnect; returns the reason and the time.
    pub(crate) fn down(&self, nth: usize) -> (String, Instant) {
        let down = |(at, event): &(Instant, LinkEvent)| match event {
            LinkEvent::Down { reason, .. } => Some((reason.clone(), *at)),
            _ => None,
        };
        self.until("peer down", |events| {
            events.iter().filter_map(down).nth(nth)
        })
    }

    /// Waits for a failed attempt; returns the wait after it.
    pub(crate) fn failure(&self) -> Duration {
        self.until("failure", |events| events.iter().find_map(wait))
    }

    /// Waits until the data with this tag has been written.
    pub(crate) fn written(&self, wanted: u64) {
        let is_it =
            |event: &LinkEvent| matches!(event, LinkEvent::Written { tag, .. } if *tag == wanted);
        self.until("tag written", |events| {
            events.iter().any(|(_, event)| is_it(event)).then_some(())
        });
    }

    /// Waits until the bytes from all peers together equal `wanted`.
    pub(crate) fn received(&self, wanted: &[u8]) {
        self.until("the bytes", |events| {
            let received: Vec<u8> = events.iter().flat_map(bytes).collect();
            assert!(
                wanted.starts_with(&received),
                "received {received:?}, not {wanted:?}"
            );
            (received.len() == wanted.len()).then_some(())
        });
    }
}

pub(crate) fn up((at, event): &(Instant, LinkEvent)) -> Option<(u32, Instant)> {
    if let LinkEvent::Up { peer, .. } = event {
        Some((*peer, *at))
    } else {
        None
    }
}

/// The wait after a failed attempt.
pub(crate) fn wait((_, event): &(Instant, LinkEvent)) -> Option<Duration> {
    if let LinkEvent::Failed { retry_in, .. } = event {
        Some(*retry_in)
    } else {
        None
    }
}

fn bytes((_, event): &(Instant, LinkEvent)) -> Vec<u8> {
    if let LinkEvent::Bytes { bytes, .. } = event {
        bytes.clone()
    } else {
        Vec::new()
    }
}

fn tail(events: &[(Instant, LinkEvent)]) -> Vec<&LinkEvent> {
    events
        .iter()
        .rev()
        .take(5)
        .rev()
        .map(|(_, event)| event)
        .collect()
}
