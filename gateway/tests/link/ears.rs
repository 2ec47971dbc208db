//! Listens to a link for a test.

use gateway::link::{Link, LinkAddress, LinkEvent, LinkSettings};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

/// Anything takes less, unless it never comes.
pub(crate) const LIMIT: Duration = Duration::from_secs(10);

/// Everything that a link has told so far.
#[derive(Default)]
pub(crate) struct Ears {
    events: Mutex<Vec<(Instant, LinkEvent)>>,
    news: Condvar,
}

/// Patience for tests: quick to try again, never bored.
pub(crate) fn patient() -> LinkSettings {
    LinkSettings { silence: None, retry: (Duration::from_millis(20), Duration::from_millis(100)) }
}

pub(crate) fn connect(text: &str, settings: LinkSettings) -> (Link, Arc<Ears>) {
    open(&LinkAddress::to_connect(text).unwrap(), settings)
}

pub(crate) fn listen(text: &str) -> (Link, Arc<Ears>) {
    open(&LinkAddress::to_listen(text).unwrap(), patient())
}

pub(crate) fn open(address: &LinkAddress, settings: LinkSettings) -> (Link, Arc<Ears>) {
    let ears = Arc::new(Ears::default());
    let told = Arc::clone(&ears);
    let link = Link::open(address, settings, move |event| told.hear(event)).unwrap();
    (link, ears)
}

impl Ears {
    pub(crate) fn hear(&self, event: LinkEvent) {
        self.events.lock().unwrap().push((Instant::now(), event));
        self.news.notify_all();
    }

    /// All so far, with when they were told.
    pub(crate) fn all(&self) -> Vec<(Instant, LinkEvent)> {
        self.events.lock().unwrap().clone()
    }

    /// Waits until `find` finds what it looks for in all that was told.
    pub(crate) fn until<T>(&self, what: &str, mut find: impl FnMut(&[(Instant, LinkEvent)]) -> Option<T>) -> T {
        let start = Instant::now();
        let mut events = self.events.lock().unwrap();
        loop {
            if let Some(found) = find(&events) {
                return found;
            }
            let left = LIMIT.saturating_sub(start.elapsed());
            assert!(!left.is_zero(), "no {what} within {LIMIT:?}; the last of {}: {:?}", events.len(), tail(&events));
            events = self.news.wait_timeout(events, left).unwrap().0;
        }
    }

    /// Waits for the `nth` peer (from 0) to come up; gives its number and when.
    pub(crate) fn up(&self, nth: usize) -> (u32, Instant) {
        self.until("peer up", |events| events.iter().filter_map(up).nth(nth))
    }

    /// Waits for the `nth` peer (from 0) to go; gives why and when.
    pub(crate) fn down(&self, nth: usize) -> (String, Instant) {
        let down = |(at, event): &(Instant, LinkEvent)| match event {
            LinkEvent::Down { reason, .. } => Some((reason.clone(), *at)),
            _ => None,
        };
        self.until("peer down", |events| events.iter().filter_map(down).nth(nth))
    }

    /// Waits until a tag is written.
    pub(crate) fn written(&self, wanted: u64) {
        let is_it = |event: &LinkEvent| matches!(event, LinkEvent::Written { tag, .. } if *tag == wanted);
        self.until("tag written", |events| events.iter().any(|(_, event)| is_it(event)).then_some(()));
    }

    /// Waits until all bytes, of all peers, are these.
    pub(crate) fn heard(&self, wanted: &[u8]) {
        self.until("the bytes", |events| {
            let heard: Vec<u8> = events.iter().flat_map(bytes).collect();
            assert!(wanted.starts_with(&heard), "heard {heard:?}, not {wanted:?}");
            (heard.len() == wanted.len()).then_some(())
        });
    }
}

pub(crate) fn up((at, event): &(Instant, LinkEvent)) -> Option<(u32, Instant)> {
    if let LinkEvent::Up { peer, .. } = event { Some((*peer, *at)) } else { None }
}

/// The wait after an attempt that failed.
pub(crate) fn wait((_, event): &(Instant, LinkEvent)) -> Option<Duration> {
    if let LinkEvent::Failed { again, .. } = event { Some(*again) } else { None }
}

fn bytes((_, event): &(Instant, LinkEvent)) -> Vec<u8> {
    if let LinkEvent::Bytes { bytes, .. } = event { bytes.clone() } else { Vec::new() }
}

fn tail(events: &[(Instant, LinkEvent)]) -> Vec<&LinkEvent> {
    events.iter().rev().take(5).rev().map(|(_, event)| event).collect()
}
