//! Words of mates in other processes, kept until the decision at which they are heard.
//!
//! No network and no clock in here. What a mate says after decision `k` is heard at decision `k + 1`, not earlier: a
//! faster mate may have said its words of `k + 1` already, so the two that came last are kept.

use game::message::{Say, Word};
use game::refusal::{Refusal, Refusals};
use game::strategy::SHARED_MAX;
use game::{TeamId, VehicleId};

/// What one boat said after one decision.
#[derive(Clone, Debug, PartialEq)]
struct Said {
    seq: u64,
    words: Vec<Word>,
}

/// A boat that another process minds.
#[derive(Clone, Debug)]
struct Speaker {
    team: TeamId,
    /// Whether a mate of it is minded here, and it is not itself.
    is_mate: bool,
    newest: Option<Said>,
    before: Option<Said>,
    /// After which decision it said what was heard last.
    heard: Option<u64>,
}

/// The words that are under way to a decision.
#[derive(Clone, Debug)]
pub(super) struct TeamInbox {
    /// By vehicle.
    speakers: Vec<Speaker>,
    pub(super) refusals: Refusals,
}

impl TeamInbox {
    /// For boats of these teams, by vehicle; `minded` are those minded here.
    pub(super) fn new(teams: impl Iterator<Item = TeamId>, minded: &[VehicleId]) -> TeamInbox {
        let speaker = |(i, team)| {
            let is_mate = !minded.contains(&VehicleId::at(i));
            Speaker { team, is_mate, newest: None, before: None, heard: None }
        };
        TeamInbox { speakers: teams.enumerate().map(speaker).collect(), refusals: Refusals::default() }
    }

    /// Takes in what came on a team's line.
    pub(super) fn take(&mut self, team: TeamId, bytes: &[u8]) {
        let Some(say) = self.refusals.decode::<Say>(bytes) else { return };
        for word in say.words {
            let speaker = self.speakers.get_mut(word.vehicle.index());
            let Some(speaker) = speaker.filter(|speaker| speaker.is_mate && speaker.team == team) else {
                self.refusals.count(Refusal::NotYours);
                continue;
            };
            if !word.value.is_finite() {
                self.refusals.count(Refusal::BadNumber);
                continue;
            }
            self.refusals.add(Refusal::Surplus, u64::from(!speaker.note(say.stamp.seq, word)));
        }
    }

    /// Whether everything is there that is to be heard at decision `seq`: who talked after the decision before the last
    /// one is expected to have talked after the last one too.
    pub(super) fn is_complete(&self, seq: u64) -> bool {
        !self.speakers.iter().any(|speaker| speaker.is_awaited(seq) && !speaker.is_past(seq))
    }

    /// Adds what is to be heard at decision `seq`: the newest words of each boat that were said after an earlier one. Says
    /// of how many boats that talked before there is nothing.
    pub(super) fn hear(&mut self, seq: u64, words: &mut Vec<Word>) -> u64 {
        let mut missed = 0;
        for speaker in &mut self.speakers {
            let awaited = speaker.is_awaited(seq);
            let said = match speaker.newest.take_if(|said| said.seq < seq) {
                Some(said) => {
                    speaker.before = None;
                    Some(said)
                }
                None => speaker.before.take_if(|said| said.seq < seq),
            };
            let on_time = said.as_ref().is_some_and(|said| said.seq + 1 == seq);
            missed += u64::from(awaited && !on_time);
            if let Some(said) = said {
                speaker.heard = Some(said.seq);
                words.extend(said.words);
            }
        }
        missed
    }
}

impl Speaker {
    /// Keeps a word said after decision `seq`, if there is room for it.
    fn note(&mut self, seq: u64, word: Word) -> bool {
        let Some(newest) = self.newest.as_mut().filter(|newest| newest.seq == seq) else {
            self.before = self.newest.replace(Said { seq, words: vec![word] });
            return true;
        };
        let known = newest.words.iter().position(|known| known.key == word.key);
        match known {
            Some(known) => newest.words[known] = word,
            None if newest.words.len() < SHARED_MAX => newest.words.push(word),
            None => return false,
        }
        true
    }

    /// Whether it talked after the decision before the last one: it will have talked after the last one as well.
    fn is_awaited(&self, seq: u64) -> bool {
        self.heard.is_some_and(|heard| heard + 2 == seq)
    }

    /// Whether what it said after the decision before `seq` is there, or can no longer come.
    fn is_past(&self, seq: u64) -> bool {
        [&self.newest, &self.before].into_iter().flatten().any(|said| said.seq >= seq.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::codec;
    use game::message::{Message, Stamp};

    const BLUE: TeamId = TeamId(0);

    /// Two teams of two; the first boat is minded here.
    fn bag() -> TeamInbox {
        TeamInbox::new([0, 0, 1, 1].into_iter().map(TeamId), &[VehicleId(0)])
    }

    fn say(seq: u64, words: &[(u16, f64)]) -> Say {
        let words = words.iter().map(|(vehicle, value)| Word { vehicle: VehicleId(*vehicle), key: 7, value: *value });
        Say { stamp: Stamp { seq, version: Say::VERSION, ..Stamp::default() }, words: words.collect() }
    }

    fn take(bag: &mut TeamInbox, say: &Say) {
        bag.take(BLUE, &codec::encode(say));
    }

    fn heard(bag: &mut TeamInbox, seq: u64) -> Vec<f64> {
        let mut words = Vec::new();
        bag.hear(seq, &mut words);
        words.iter().map(|word| word.value).collect()
    }

    #[test]
    fn words_are_heard_one_decision_later_and_not_before_even_of_a_faster_mate() {
        let mut bag = bag();
        take(&mut bag, &say(0, &[(1, 10.0)]));
        assert_eq!(heard(&mut bag, 0), [0.0; 0]);
        take(&mut bag, &say(1, &[(1, 11.0)]));
        assert_eq!(heard(&mut bag, 1), [10.0]);
        assert_eq!(heard(&mut bag, 2), [11.0]);
        let mut words = Vec::new();
        assert_eq!(
            (bag.hear(3, &mut words), bag.hear(4, &mut words)),
            (1, 0),
            "missed once, it is not waited for again"
        );
        assert_eq!(words, []);
    }

    #[test]
    fn a_mate_that_talked_is_waited_for_and_a_silent_one_is_not() {
        let mut bag = bag();
        assert!(bag.is_complete(0) && bag.is_complete(1) && bag.is_complete(9));
        take(&mut bag, &say(3, &[(1, 1.0)]));
        assert!(bag.is_complete(4));
        heard(&mut bag, 4);
        assert!(!bag.is_complete(5));
        take(&mut bag, &say(4, &[(1, 1.0)]));
        assert!(bag.is_complete(5));
        heard(&mut bag, 5);
        // What comes after it shows that it can no longer come itself.
        take(&mut bag, &say(6, &[(1, 1.0)]));
        assert!(bag.is_complete(6));
    }

    #[test]
    fn a_slow_listener_hears_the_newest_that_is_due() {
        let mut bag = bag();
        (0..5).for_each(|seq| take(&mut bag, &say(seq, &[(1, seq as f64)])));
        assert_eq!(heard(&mut bag, 9), [4.0]);
        assert_eq!(heard(&mut bag, 10), [0.0; 0], "and once only");
    }

    #[test]
    fn words_said_twice_count_once() {
        let mut bag = bag();
        take(&mut bag, &say(0, &[(1, 5.0)]));
        take(&mut bag, &say(0, &[(1, 5.0)]));
        assert_eq!(heard(&mut bag, 1), [5.0]);
        assert_eq!(bag.refusals.total(), 0);
    }

    #[test]
    fn strangers_enemies_and_nonsense_are_counted_and_ignored() {
        let mut bag = bag();
        take(&mut bag, &say(0, &[(9, 1.0), (u16::MAX, 1.0), (2, 1.0), (0, 1.0), (1, f64::NAN), (1, f64::INFINITY)]));
        bag.take(TeamId(1), &codec::encode(&say(0, &[(1, 1.0)])));
        assert_eq!(bag.refusals, Refusals::from([(Refusal::NotYours, 5), (Refusal::BadNumber, 2)]));
        let mut other = say(0, &[(1, 1.0)]);
        other.stamp.version += 1;
        take(&mut bag, &other);
        bag.take(BLUE, b"ahoy");
        assert_eq!([Refusal::Version, Refusal::Garbage].map(|refusal| bag.refusals.of(refusal)), [1, 1]);
        let key = |key| Word { vehicle: VehicleId(1), key, value: 1.0 };
        take(&mut bag, &Say { words: (0..300).map(key).collect(), ..say(0, &[]) });
        assert_eq!(bag.refusals.of(Refusal::Surplus), 300 - SHARED_MAX as u64);
        assert_eq!(heard(&mut bag, 1).len(), SHARED_MAX);
        // A number of a decision that never comes hides what was said once, and not for long.
        take(&mut bag, &say(u64::MAX, &[(1, 1.0)]));
        assert!(bag.is_complete(u64::MAX));
        assert!(bag.is_complete(3), "it is past what is waited for");
        take(&mut bag, &say(1, &[(1, 6.0)]));
        assert_eq!(heard(&mut bag, 2), [6.0]);
    }
}
