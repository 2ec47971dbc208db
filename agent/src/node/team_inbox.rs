//! Messages from teammates in other processes, kept until the decision at which they are delivered.
//!
//! This module uses neither network nor clock. Messages that a teammate sends after decision `k`
//! are delivered at decision `k + 1`, not earlier. A faster teammate may already have sent its
//! messages of `k + 1`, so the last two are kept.

use messages::refusal::{Refusal, Refusals};
use messages::{Say, Word};
use primitives::{TeamId, VehicleId};
use scenario::strategy::SHARED_MAX;

/// The messages of one boat after one decision.
#[derive(Clone, Debug, PartialEq)]
struct Sent {
    seq: u64,
    words: Vec<Word>,
}

/// A boat that may send, and its pending messages.
#[derive(Clone, Debug)]
struct Sender {
    team: TeamId,
    /// Whether a different process runs the boat.
    is_mate: bool,
    /// Whether the boat's strategy sends messages at all.
    talks: bool,
    newest: Option<Sent>,
    before: Option<Sent>,
    /// The decision at which its next message is due, if any.
    awaited_at: Option<u64>,
}

/// Messages on their way to the next decisions.
#[derive(Clone, Debug)]
pub struct TeamInbox {
    /// By vehicle index.
    senders: Vec<Sender>,
    /// Whether a delivery has taken place, even an empty one.
    has_begun: bool,
    /// Counts of rejected messages.
    pub refusals: Refusals,
}

impl TeamInbox {
    /// An inbox for boats by vehicle index, each with its team and whether it sends messages. `own`
    /// lists the boats of this process.
    pub fn new(boats: impl Iterator<Item = (TeamId, bool)>, own: &[VehicleId]) -> TeamInbox {
        let sender = |(i, (team, talks))| {
            let is_mate = !own.contains(&VehicleId::at(i));
            Sender {
                team,
                is_mate,
                talks: talks && is_mate,
                newest: None,
                before: None,
                awaited_at: None,
            }
        };
        let senders = boats.enumerate().map(sender).collect();
        TeamInbox {
            senders,
            has_begun: false,
            refusals: Refusals::default(),
        }
    }

    /// Receives a message on a team's topic.
    pub fn receive(&mut self, team: TeamId, bytes: &[u8]) {
        let Some(say) = self.refusals.decode::<Say>(bytes) else {
            return;
        };
        for word in say.words {
            // Messages identify boats, not processes: a boat keeps its identifier when a different
            // process takes it over.
            let sender = self.senders.get_mut(word.vehicle.index());
            let Some(sender) = sender.filter(|sender| sender.is_mate && sender.team == team) else {
                self.refusals.count(Refusal::NotYours);
                continue;
            };
            if !word.value.is_finite() {
                self.refusals.count(Refusal::BadNumber);
                continue;
            }
            self.refusals.add(
                Refusal::Surplus,
                u64::from(!sender.note(say.stamp.seq, word)),
            );
        }
    }

    /// Whether all messages due at decision `seq` have arrived. Teammates that sent after the
    /// decision before last are expected to send after the last one, too; all that send messages
    /// are expected to send after the first.
    pub fn is_complete(&self, seq: u64) -> bool {
        !self
            .senders
            .iter()
            .any(|sender| sender.is_awaited(seq) && !sender.is_past(seq))
    }

    /// Adds the messages due at decision `seq`: each boat's newest from an earlier decision.
    /// Returns the number of boats whose expected message is missing.
    pub fn deliver(&mut self, seq: u64, words: &mut Vec<Word>) -> u64 {
        let mut missed = 0;
        for sender in &mut self.senders {
            let awaited = sender.is_awaited(seq);
            let sent = match sender.newest.take_if(|sent| sent.seq < seq) {
                Some(sent) => {
                    sender.before = None;
                    Some(sent)
                }
                None => sender.before.take_if(|sent| sent.seq < seq),
            };
            let on_time = sent.as_ref().is_some_and(|sent| sent.seq + 1 == seq);
            // Count the message as missing and keep the previous values: a boat continues with the
            // last values that it received.
            missed += u64::from(awaited && !on_time);
            if !self.has_begun && sender.talks {
                sender.awaited_at = Some(seq.saturating_add(1));
            }
            if let Some(sent) = sent {
                sender.awaited_at = Some(sent.seq.saturating_add(2));
                words.extend(sent.words);
            }
        }
        self.has_begun = true;
        missed
    }
}

impl Sender {
    /// Stores a word sent after decision `seq`, if there is space.
    fn note(&mut self, seq: u64, word: Word) -> bool {
        let Some(newest) = self.newest.as_mut().filter(|newest| newest.seq == seq) else {
            // Keep messages in order of arrival, not by stamp: a wrong stamp displaces at most one
            // message.
            self.before = self.newest.replace(Sent {
                seq,
                words: vec![word],
            });
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

    /// Whether a message from the boat is due at decision `seq`.
    fn is_awaited(&self, seq: u64) -> bool {
        self.awaited_at == Some(seq)
    }

    /// Whether the boat's message for decision `seq` has arrived or can no longer arrive.
    fn is_past(&self, seq: u64) -> bool {
        [&self.newest, &self.before]
            .into_iter()
            .flatten()
            .any(|sent| sent.seq >= seq.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::{Message, Stamp};
    use primitives::codec;

    const BLUE: TeamId = TeamId(0);

    /// Two teams of two boats, with or without messages; the first boat belongs to this process.
    fn team_inbox() -> TeamInbox {
        TeamInbox::new(
            [0, 0, 1, 1].into_iter().map(|team| (TeamId(team), false)),
            &[VehicleId(0)],
        )
    }

    fn say(seq: u64, words: &[(u16, f64)]) -> Say {
        let words = words.iter().map(|(vehicle, value)| Word {
            vehicle: VehicleId(*vehicle),
            key: 7,
            value: *value,
        });
        Say {
            stamp: Stamp {
                seq,
                version: Say::VERSION,
                ..Stamp::default()
            },
            words: words.collect(),
        }
    }

    fn receive(inbox: &mut TeamInbox, say: &Say) {
        inbox.receive(BLUE, &codec::encode(say));
    }

    fn delivered(inbox: &mut TeamInbox, seq: u64) -> Vec<f64> {
        let mut words = Vec::new();
        inbox.deliver(seq, &mut words);
        words.iter().map(|word| word.value).collect()
    }

    #[test]
    fn messages_are_delivered_one_decision_later_and_not_before_even_of_a_faster_mate() {
        let mut inbox = team_inbox();
        receive(&mut inbox, &say(0, &[(1, 10.0)]));
        assert_eq!(delivered(&mut inbox, 0), [0.0; 0]);
        receive(&mut inbox, &say(1, &[(1, 11.0)]));
        assert_eq!(delivered(&mut inbox, 1), [10.0]);
        assert_eq!(delivered(&mut inbox, 2), [11.0]);
        let mut words = Vec::new();
        assert_eq!(
            (inbox.deliver(3, &mut words), inbox.deliver(4, &mut words)),
            (1, 0),
            "missed once, it is not awaited again"
        );
        assert_eq!(words, []);
    }

    #[test]
    fn a_mate_that_sent_is_waited_for_and_a_silent_one_is_not() {
        let mut inbox = team_inbox();
        assert!(inbox.is_complete(0) && inbox.is_complete(1) && inbox.is_complete(9));
        receive(&mut inbox, &say(3, &[(1, 1.0)]));
        assert!(inbox.is_complete(4));
        delivered(&mut inbox, 4);
        assert!(!inbox.is_complete(5));
        receive(&mut inbox, &say(4, &[(1, 1.0)]));
        assert!(inbox.is_complete(5));
        delivered(&mut inbox, 5);
        // A later message proves that the awaited one can no longer arrive.
        receive(&mut inbox, &say(6, &[(1, 1.0)]));
        assert!(inbox.is_complete(6));
    }

    #[test]
    fn the_first_message_of_a_mate_that_talks_is_waited_for_once() {
        for first in [0, 7] {
            let mut inbox = TeamInbox::new(
                [0, 0].into_iter().map(|team| (TeamId(team), true)),
                &[VehicleId(0)],
            );
            let mut words = Vec::new();
            assert!(inbox.is_complete(first));
            assert_eq!(inbox.deliver(first, &mut words), 0);
            assert!(!inbox.is_complete(first + 1));
            let mut lost = inbox.clone();
            assert_eq!(
                lost.deliver(first + 1, &mut words),
                1,
                "the message was lost"
            );
            assert!(lost.is_complete(first + 2), "it may be silent");
            receive(&mut inbox, &say(first, &[(1, 10.0)]));
            assert!(inbox.is_complete(first + 1));
            assert_eq!(delivered(&mut inbox, first + 1), [10.0]);
        }
    }

    #[test]
    fn a_slow_receiver_gets_the_newest_that_is_due() {
        let mut inbox = team_inbox();
        (0..5).for_each(|seq| receive(&mut inbox, &say(seq, &[(1, seq as f64)])));
        assert_eq!(delivered(&mut inbox, 9), [4.0]);
        assert_eq!(delivered(&mut inbox, 10), [0.0; 0], "only once");
    }

    #[test]
    fn messages_sent_twice_count_once() {
        let mut inbox = team_inbox();
        receive(&mut inbox, &say(0, &[(1, 5.0)]));
        receive(&mut inbox, &say(0, &[(1, 5.0)]));
        assert_eq!(delivered(&mut inbox, 1), [5.0]);
        assert_eq!(inbox.refusals.total(), 0);
    }

    #[test]
    fn strangers_enemies_and_nonsense_are_counted_and_ignored() {
        let mut inbox = team_inbox();
        receive(
            &mut inbox,
            &say(
                0,
                &[
                    (9, 1.0),
                    (u16::MAX, 1.0),
                    (2, 1.0),
                    (0, 1.0),
                    (1, f64::NAN),
                    (1, f64::INFINITY),
                ],
            ),
        );
        inbox.receive(TeamId(1), &codec::encode(&say(0, &[(1, 1.0)])));
        assert_eq!(
            inbox.refusals,
            Refusals::from([(Refusal::NotYours, 5), (Refusal::BadNumber, 2)])
        );
        let mut other = say(0, &[(1, 1.0)]);
        other.stamp.version += 1;
        receive(&mut inbox, &other);
        inbox.receive(BLUE, b"ahoy");
        assert_eq!(
            [Refusal::Version, Refusal::Garbage].map(|refusal| inbox.refusals.of(refusal)),
            [1, 1]
        );
        let key = |key| Word {
            vehicle: VehicleId(1),
            key,
            value: 1.0,
        };
        receive(
            &mut inbox,
            &Say {
                words: (0..300).map(key).collect(),
                ..say(0, &[])
            },
        );
        assert_eq!(inbox.refusals.of(Refusal::Surplus), 300 - SHARED_MAX as u64);
        assert_eq!(delivered(&mut inbox, 1).len(), SHARED_MAX);
        // The number of a decision that never happened hides earlier messages, but not for long.
        receive(&mut inbox, &say(u64::MAX, &[(1, 1.0)]));
        assert!(inbox.is_complete(u64::MAX));
        assert!(inbox.is_complete(3), "it is beyond the awaited decision");
        receive(&mut inbox, &say(1, &[(1, 6.0)]));
        assert_eq!(delivered(&mut inbox, 2), [6.0]);
    }
}
