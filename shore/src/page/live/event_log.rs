//! The event_log: what has happened so far, from frames as they come and from the sim where some were missed.

use game::outcome::EventOutcome;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// The most events that are kept; of more, the first are forgotten.
const EVENTS_MAX: usize = 20_000;
/// The sim is asked no more often than this.
const ASK_AGAIN: Duration = Duration::from_secs(1);

/// How far somebody has read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Bookmark {
    edition: u64,
    next: u64,
}

/// What has happened so far.
#[derive(Clone, Debug, Default)]
pub(super) struct EventLog {
    events: VecDeque<EventOutcome>,
    /// The number of the first of them.
    first: u64,
    /// Rises whenever what was written before is not what is written now.
    edition: u64,
    is_gappy: bool,
    asked: Option<Instant>,
}

impl EventLog {
    /// A event_log of which all that happened before is missing.
    pub(super) fn new() -> EventLog {
        EventLog { is_gappy: true, edition: 1, ..EventLog::default() }
    }

    /// An event from a frame. One that the sim has told already is not told twice.
    pub(super) fn add(&mut self, event: EventOutcome) {
        let mut recent = self.events.iter().rev().take_while(|known| known.tick >= event.tick);
        if !recent.any(|known| *known == event) {
            self.events.push_back(event);
            self.trim();
        }
    }

    /// A frame was missed, and what it told.
    pub(super) fn miss(&mut self) {
        self.is_gappy = true;
    }

    /// Whether to ask the sim for all events now; whoever is told to does so.
    pub(super) fn is_to_ask(&mut self, now: Instant) -> bool {
        let rested = self.asked.is_none_or(|asked| now.saturating_duration_since(asked) >= ASK_AGAIN);
        let asks = self.is_gappy && rested;
        if asks {
            (self.is_gappy, self.asked) = (false, Some(now));
        }
        asks
    }

    /// All events up to a moment, from the sim. Later ones from frames stay.
    pub(super) fn rewrite(&mut self, mut all: Vec<EventOutcome>) {
        let last = all.last().map_or(0, |event| event.tick);
        let later = |event: &&EventOutcome| event.tick > last || (event.tick == last && !all.contains(event));
        let rest: Vec<EventOutcome> = self.events.iter().filter(later).cloned().collect();
        all.extend(rest);
        let goes_on =
            self.first == 0 && all.len() >= self.events.len() && self.events.iter().eq(&all[..self.events.len()]);
        if !goes_on {
            self.edition += 1;
            self.first = 0;
        }
        self.events = all.into();
        self.trim();
    }

    /// What somebody has not read yet, whether that is all there is, and how far they have read with it. Nothing if they
    /// have read everything.
    pub(super) fn unread(&self, mark: Bookmark) -> Option<(bool, impl Iterator<Item = &EventOutcome>, Bookmark)> {
        let reset = mark.edition != self.edition;
        let from = if reset { self.first } else { mark.next.max(self.first) };
        let next = self.first + self.events.len() as u64;
        let unread = self.events.range((from - self.first) as usize..);
        (reset || from < next).then_some((reset, unread, Bookmark { edition: self.edition, next }))
    }

    fn trim(&mut self) {
        let surplus = self.events.len().saturating_sub(EVENTS_MAX);
        self.events.drain(..surplus);
        self.first += surplus as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::clock;

    fn event(tick: u64, word: &str) -> EventOutcome {
        EventOutcome { tick, at_s: 0.0, event: word.into(), vehicle: None, other: None, team: None }
    }

    /// What a reader is told, and that they are told it once.
    fn read(event_log: &EventLog, mark: &mut Bookmark) -> (bool, Vec<u64>) {
        let Some((reset, unread, next)) = event_log.unread(*mark) else { return (false, vec![]) };
        let told = (reset, unread.map(|event| event.tick).collect());
        *mark = next;
        assert!(event_log.unread(*mark).is_none());
        told
    }

    #[test]
    fn a_newcomer_gets_all_and_then_news() {
        let mut event_log = EventLog::new();
        let mut mark = Bookmark::default();
        assert_eq!(read(&event_log, &mut mark), (true, vec![]), "even if there is nothing");
        event_log.add(event(5, "a"));
        event_log.add(event(5, "b"));
        assert_eq!(read(&event_log, &mut mark), (false, vec![5, 5]));
        assert_eq!(read(&event_log, &mut Bookmark::default()), (true, vec![5, 5]));
    }

    #[test]
    fn what_was_missed_is_put_in_its_place() {
        let mut event_log = EventLog::new();
        let mut mark = Bookmark::default();
        event_log.add(event(5, "a"));
        read(&event_log, &mut mark);
        event_log.add(event(9, "c"));
        // The sim's answer is older than the last frame, and says more of the time before.
        event_log.rewrite(vec![event(5, "a"), event(7, "b")]);
        assert_eq!(read(&event_log, &mut mark), (true, vec![5, 7, 9]));
        // An answer that says nothing new changes nothing; a frame that comes after it is not told twice.
        event_log.rewrite(vec![event(5, "a"), event(7, "b"), event(9, "c"), event(9, "d")]);
        event_log.add(event(9, "d"));
        assert_eq!(read(&event_log, &mut mark), (false, vec![9]));
    }

    #[test]
    fn the_sim_is_asked_when_something_was_missed_and_not_too_often() {
        let start = clock::now();
        let mut event_log = EventLog::new();
        assert!(event_log.is_to_ask(start) && !event_log.is_to_ask(start));
        event_log.miss();
        assert!(!event_log.is_to_ask(start) && event_log.is_to_ask(start + ASK_AGAIN));
    }

    #[test]
    fn a_chronicle_without_end_forgets_its_beginning() {
        let mut event_log = EventLog::new();
        let mut mark = Bookmark::default();
        read(&event_log, &mut mark);
        (0..EVENTS_MAX as u64 + 3).for_each(|tick| event_log.add(event(tick, "x")));
        let (reset, told) = read(&event_log, &mut mark);
        assert_eq!((reset, told.len(), told[0]), (false, EVENTS_MAX, 3));
    }
}
