//! The event log of a running game: events from frames, and from the sim after missed frames.

use scenario::outcome::EventOutcome;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Maximum number of events kept; the oldest are dropped first.
const EVENTS_MAX: usize = 20_000;
/// Minimum time between two queries to the sim.
const ASK_AGAIN: Duration = Duration::from_secs(1);

/// A reader's position in the log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct EventCursor {
    revision: u64,
    next: u64,
}

#[derive(Clone, Debug, Default)]
pub(super) struct EventLog {
    events: VecDeque<EventOutcome>,
    /// The number of the first event kept.
    first: u64,
    /// Increases whenever earlier entries change.
    revision: u64,
    has_gap: bool,
    asked: Option<Instant>,
}

impl EventLog {
    /// A log without any events yet.
    pub(super) fn new() -> EventLog {
        EventLog {
            has_gap: true,
            revision: 1,
            ..EventLog::default()
        }
    }

    /// Adds an event from a frame, unless the sim has already listed it.
    pub(super) fn add(&mut self, event: EventOutcome) {
        let mut recent = self
            .events
            .iter()
            .rev()
            .take_while(|known| known.tick >= event.tick);
        if !recent.any(|known| *known == event) {
            self.events.push_back(event);
            self.trim();
        }
    }

    /// Records that a frame and its events were missed.
    pub(super) fn note_gap(&mut self) {
        self.has_gap = true;
    }

    /// Whether to query the sim for all events now; a caller that gets `true` must do so.
    pub(super) fn should_query(&mut self, now: Instant) -> bool {
        let rested = self
            .asked
            .is_none_or(|asked| now.saturating_duration_since(asked) >= ASK_AGAIN);
        let asks = self.has_gap && rested;
        if asks {
            (self.has_gap, self.asked) = (false, Some(now));
        }
        asks
    }

    /// Replaces all events up to a moment with those from the sim. Later events from frames remain.
    pub(super) fn replace(&mut self, mut all: Vec<EventOutcome>) {
        let last = all.last().map_or(0, |event| event.tick);
        let later = |event: &&EventOutcome| {
            event.tick > last || (event.tick == last && !all.contains(event))
        };
        let rest: Vec<EventOutcome> = self.events.iter().filter(later).cloned().collect();
        all.extend(rest);
        let goes_on = self.first == 0
            && all.len() >= self.events.len()
            && self.events.iter().eq(&all[..self.events.len()]);
        if !goes_on {
            self.revision += 1;
            self.first = 0;
        }
        self.events = all.into();
        self.trim();
    }

    /// The unread events, whether they replace all earlier ones, and the reader's new position.
    /// `None` if there is nothing to read.
    pub(super) fn unread(
        &self,
        cursor: EventCursor,
    ) -> Option<(bool, impl Iterator<Item = &EventOutcome>, EventCursor)> {
        let reset = cursor.revision != self.revision;
        let from = if reset {
            self.first
        } else {
            cursor.next.max(self.first)
        };
        let next = self.first + self.events.len() as u64;
        let unread = self.events.range((from - self.first) as usize..);
        (reset || from < next).then_some((
            reset,
            unread,
            EventCursor {
                revision: self.revision,
                next,
            },
        ))
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
    use bus::clock;

    fn event(tick: u64, word: &str) -> EventOutcome {
        EventOutcome {
            tick,
            at_s: 0.0,
            event: word.into(),
            vehicle: None,
            other: None,
            team: None,
        }
    }

    /// The events that a reader receives.
    fn read(event_log: &EventLog, cursor: &mut EventCursor) -> (bool, Vec<u64>) {
        let Some((reset, unread, next)) = event_log.unread(*cursor) else {
            return (false, vec![]);
        };
        let sent = (reset, unread.map(|event| event.tick).collect());
        *cursor = next;
        assert!(event_log.unread(*cursor).is_none());
        sent
    }

    #[test]
    fn a_newcomer_gets_all_and_then_news() {
        let mut event_log = EventLog::new();
        let mut cursor = EventCursor::default();
        assert_eq!(
            read(&event_log, &mut cursor),
            (true, vec![]),
            "even if there is nothing"
        );
        event_log.add(event(5, "a"));
        event_log.add(event(5, "b"));
        assert_eq!(read(&event_log, &mut cursor), (false, vec![5, 5]));
        assert_eq!(
            read(&event_log, &mut EventCursor::default()),
            (true, vec![5, 5])
        );
    }

    #[test]
    fn what_was_missed_is_put_in_its_place() {
        let mut event_log = EventLog::new();
        let mut cursor = EventCursor::default();
        event_log.add(event(5, "a"));
        read(&event_log, &mut cursor);
        event_log.add(event(9, "c"));
        // The sim's reply is older than the last frame, and has more events before it.
        event_log.replace(vec![event(5, "a"), event(7, "b")]);
        assert_eq!(read(&event_log, &mut cursor), (true, vec![5, 7, 9]));
        // A reply without news changes nothing. An event of a later frame is not added twice.
        event_log.replace(vec![
            event(5, "a"),
            event(7, "b"),
            event(9, "c"),
            event(9, "d"),
        ]);
        event_log.add(event(9, "d"));
        assert_eq!(read(&event_log, &mut cursor), (false, vec![9]));
    }

    #[test]
    fn the_sim_is_asked_when_something_was_missed_and_not_too_often() {
        let start = clock::now();
        let mut event_log = EventLog::new();
        assert!(event_log.should_query(start) && !event_log.should_query(start));
        event_log.note_gap();
        assert!(!event_log.should_query(start) && event_log.should_query(start + ASK_AGAIN));
    }

    #[test]
    fn a_chronicle_without_end_forgets_its_beginning() {
        let mut event_log = EventLog::new();
        let mut cursor = EventCursor::default();
        read(&event_log, &mut cursor);
        (0..EVENTS_MAX as u64 + 3).for_each(|tick| event_log.add(event(tick, "x")));
        let (reset, sent) = read(&event_log, &mut cursor);
        assert_eq!((reset, sent.len(), sent[0]), (false, EVENTS_MAX, 3));
    }
}
