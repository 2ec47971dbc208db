//! Messages of other nodes on their way into the game. Every sender has a share of the room: none can take that of another.

use super::subscriptions::Incoming;
use bus::Watched;
use messages::Message;
use messages::refusal::{Refusal, Refusals};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

/// From whom a message is, as far as the room goes that it may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Sender {
    /// The node with this ticket.
    Member(u64),
    /// The gateway with this ticket, of what it reports for others.
    Reporting(u64),
    /// Nodes that want to join.
    Joining,
    /// Whoever publishes on this topic, which is subscribed to only for the recorder.
    Recorded(usize),
    /// The network, which says who is gone.
    Network,
    /// Other inboxes, which say that there is something in them.
    Inboxes,
}

impl Sender {
    /// How many messages may wait to be read: more than come between two looks of the sim.
    fn share(self) -> usize {
        match self {
            // Shares by topic or by link would need no tickets, but anybody can publish on as
            // many topics, over as many links, as they like.
            Sender::Member(_) => 128,
            // Every byte between a gateway and its boat is among it.
            Sender::Reporting(_) => 2048,
            Sender::Joining => 64,
            Sender::Recorded(_) => 2048,
            Sender::Network => 1024,
            // All of them are in one look.
            Sender::Inboxes => 1,
        }
    }
}

/// The messages that wait for the game.
#[derive(Default)]
pub(super) struct MessageInbox {
    waiting: Watched<Waiting>,
    // Apart: what is refused must not wake whoever waits for messages.
    gate: Watched<Gate>,
}

/// In the order in which they came.
#[derive(Default)]
struct Waiting {
    messages: VecDeque<(Sender, Incoming)>,
    counts: BTreeMap<Sender, usize>,
}

/// Who is let in, and what was not.
#[derive(Default)]
struct Gate {
    tickets: BTreeSet<u64>,
    refusals: Refusals,
}

impl MessageInbox {
    /// From now on these tickets are good.
    pub(super) fn accept_tickets(&self, tickets: BTreeSet<u64>) {
        self.gate.visit(|gate| gate.tickets = tickets);
    }

    /// The message in `bytes`. What is not understood is counted, and takes no room.
    pub(super) fn decode<M: Message + DeserializeOwned>(&self, bytes: &[u8]) -> Option<M> {
        self.gate.visit(|gate| gate.refusals.decode(bytes))
    }

    /// Takes in a message, if its sender has joined where it must, and has room left.
    pub(super) fn push(&self, message: Incoming) {
        let sender = message.sender();
        if let Sender::Member(ticket) | Sender::Reporting(ticket) = sender
            && !self.gate.visit(|gate| gate.tickets.contains(&ticket))
        {
            return self.refuse(Refusal::Ticket);
        }
        let has_room = self.waiting.visit(|waiting| {
            let count = waiting.counts.entry(sender).or_default();
            let has_room = *count < sender.share();
            if has_room {
                *count += 1;
                waiting.messages.push_back((sender, message));
            }
            has_room
        });
        // A look that finds no room is no loss: one is waiting.
        if !has_room && sender != Sender::Inboxes {
            self.refuse(Refusal::Flood);
        }
    }

    /// Counts a message that is not taken in.
    pub(super) fn refuse(&self, refusal: Refusal) {
        self.gate.visit(|gate| gate.refusals.count(refusal));
    }

    /// The next message, if one comes within `limit`.
    pub(super) fn next_within(&self, limit: Duration) -> Option<Incoming> {
        self.waiting.wait(limit, |waiting| !waiting.messages.is_empty());
        self.take_now()
    }

    /// The next message, if one is there.
    pub(super) fn take_now(&self) -> Option<Incoming> {
        self.waiting.visit(|waiting| {
            let (sender, message) = waiting.messages.pop_front()?;
            if let Some(count) = waiting.counts.get_mut(&sender) {
                *count -= 1;
                if *count == 0 {
                    waiting.counts.remove(&sender);
                }
            }
            Some(message)
        })
    }

    /// What was refused so far.
    pub(super) fn refusals(&self) -> Refusals {
        self.gate.visit(|gate| gate.refusals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::Orders;

    fn inbox(tickets: &[u64]) -> MessageInbox {
        let inbox = MessageInbox::default();
        inbox.accept_tickets(tickets.iter().copied().collect());
        inbox
    }

    fn orders(ticket: u64) -> Incoming {
        Incoming::Orders(Orders { ticket, ..Orders::default() })
    }

    /// The senders of what waits, in order.
    fn senders(inbox: &MessageInbox) -> Vec<Sender> {
        std::iter::from_fn(|| inbox.take_now()).map(|message| message.sender()).collect()
    }

    #[test]
    fn a_flood_of_one_sender_takes_the_room_of_no_other() {
        let inbox = inbox(&[7, 8]);
        for _ in 0..100_000 {
            inbox.push(orders(7));
            inbox.push(Incoming::Look);
            inbox.push(Incoming::RecordedMessage(0, vec![]));
        }
        inbox.push(orders(8));
        inbox.push(Incoming::RecordedMessage(1, vec![]));
        inbox.push(Incoming::Gone("a".to_owned()));
        let share = Sender::Member(7).share();
        let flood = 200_000 - share - Sender::Recorded(0).share();
        assert_eq!(inbox.refusals(), Refusals::from([(Refusal::Flood, flood as u64)]));
        let got = senders(&inbox);
        assert_eq!(got.iter().filter(|sender| **sender == Sender::Member(7)).count(), share);
        assert_eq!(got.iter().filter(|sender| **sender == Sender::Inboxes).count(), 1);
        assert!(got.ends_with(&[Sender::Member(8), Sender::Recorded(1), Sender::Network]), "{got:?}");
        // What was read makes room.
        inbox.push(orders(7));
        assert_eq!(senders(&inbox), [Sender::Member(7)]);
    }

    #[test]
    fn a_ticket_that_nobody_holds_takes_no_room_and_neither_does_garbage() {
        let inbox = inbox(&[7]);
        (0..100_000).for_each(|ticket| inbox.push(orders(ticket)));
        assert!(inbox.decode::<Orders>(b"ahoy").is_none());
        assert_eq!(senders(&inbox), [Sender::Member(7)]);
        assert_eq!(inbox.refusals(), Refusals::from([(Refusal::Ticket, 99_999), (Refusal::Garbage, 1)]));
        // Whoever joins anew has another ticket, and the old one is good no more.
        inbox.accept_tickets([9].into());
        [orders(7), orders(9)].into_iter().for_each(|message| inbox.push(message));
        assert_eq!(senders(&inbox), [Sender::Member(9)]);
    }
}
