//! Messages from other nodes to the game. Each sender has its own space, which others cannot fill.

use bus::{Query, Watched};
use messages::external::{NavReport, Reported};
use messages::refusal::{Refusal, Refusals};
use messages::{Message, Orders};
use primitives::VehicleId;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

/// An incoming message.
pub(super) enum Incoming {
    Orders(Orders),
    /// A report, with its bytes for the recorder.
    Nav(NavReport, Vec<u8>),
    /// A gateway report to forward to other nodes: the gateway's ticket, the boat and the message.
    Report {
        ticket: u64,
        vehicle: VehicleId,
        what: Reported,
        message: Vec<u8>,
    },
    Join(Query),
    /// For the recorder only: the index of the topic in the list, and the message.
    RecordedMessage(usize, Vec<u8>),
    /// The link to this node is lost.
    Gone(String),
    /// Makes the sim read the inboxes for commands and questions.
    Look,
}

impl Incoming {
    fn sender(&self) -> Sender {
        match self {
            Incoming::Orders(orders) => Sender::Member(orders.ticket),
            Incoming::Nav(report, _) => Sender::Member(report.ticket),
            Incoming::Report { ticket, .. } => Sender::Reporting(*ticket),
            Incoming::Join(_) => Sender::Joining,
            Incoming::RecordedMessage(topic, _) => Sender::Recorded(*topic),
            Incoming::Gone(..) => Sender::Network,
            Incoming::Look => Sender::Inboxes,
        }
    }
}

/// The sender of a message. Each sender has its own share of the space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Sender {
    /// The node with this ticket.
    Member(u64),
    /// The gateway with this ticket, as the sender of reports for other nodes.
    Reporting(u64),
    /// Nodes that request to join.
    Joining,
    /// Any publisher on this topic, which is subscribed to only for the recorder.
    Recorded(usize),
    /// The network, which reports lost nodes.
    Network,
    /// Other inboxes with messages.
    Inboxes,
}

impl Sender {
    /// Maximum number of waiting messages: more than arrive between two reads by the sim.
    fn share(self) -> usize {
        match self {
            // Space per topic or link would not need tickets, but anyone can publish on any number
            // of topics over any number of links.
            Sender::Member(_) => 128,
            // Reports include every byte between a gateway and its boat.
            Sender::Reporting(_) => 2048,
            Sender::Joining => 64,
            Sender::Recorded(_) => 2048,
            Sender::Network => 1024,
            // A single notification makes the sim read all inboxes.
            Sender::Inboxes => 1,
        }
    }
}

/// The messages that wait for the game.
#[derive(Default)]
pub(super) struct MessageInbox {
    waiting: Watched<Waiting>,
    // Separate, so that refused messages do not wake the reader.
    gate: Watched<Gate>,
}

/// The waiting messages in order of arrival, and their number by sender.
#[derive(Default)]
struct Waiting {
    messages: VecDeque<(Sender, Incoming)>,
    counts: BTreeMap<Sender, usize>,
}

/// The valid tickets and the counts of refusals.
#[derive(Default)]
struct Gate {
    tickets: BTreeSet<u64>,
    refusals: Refusals,
}

impl MessageInbox {
    /// Replaces the set of valid tickets.
    pub(super) fn accept_tickets(&self, tickets: BTreeSet<u64>) {
        self.gate.visit(|gate| gate.tickets = tickets);
    }

    /// Decodes a message. Invalid messages are counted and take no space.
    pub(super) fn decode<M: Message + DeserializeOwned>(&self, bytes: &[u8]) -> Option<M> {
        self.gate.visit(|gate| gate.refusals.decode(bytes))
    }

    /// Adds a message if its sender may send it and has space left.
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
        // A notification that does not fit may be dropped, because one is already waiting.
        if !has_room && sender != Sender::Inboxes {
            self.refuse(Refusal::Flood);
        }
    }

    pub(super) fn refuse(&self, refusal: Refusal) {
        self.gate.visit(|gate| gate.refusals.count(refusal));
    }

    pub(super) fn next_within(&self, limit: Duration) -> Option<Incoming> {
        self.waiting
            .wait(limit, |waiting| !waiting.messages.is_empty());
        self.take_now()
    }

    /// The next message, if any.
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

    /// The refusals so far.
    pub(super) fn refusals(&self) -> Refusals {
        self.gate.visit(|gate| gate.refusals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inbox(tickets: &[u64]) -> MessageInbox {
        let inbox = MessageInbox::default();
        inbox.accept_tickets(tickets.iter().copied().collect());
        inbox
    }

    fn orders(ticket: u64) -> Incoming {
        Incoming::Orders(Orders {
            ticket,
            ..Orders::default()
        })
    }

    /// The senders of the waiting messages, in order.
    fn senders(inbox: &MessageInbox) -> Vec<Sender> {
        std::iter::from_fn(|| inbox.take_now())
            .map(|message| message.sender())
            .collect()
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
        assert_eq!(
            inbox.refusals(),
            Refusals::from([(Refusal::Flood, flood as u64)])
        );
        let got = senders(&inbox);
        assert_eq!(
            got.iter()
                .filter(|sender| **sender == Sender::Member(7))
                .count(),
            share
        );
        assert_eq!(
            got.iter()
                .filter(|sender| **sender == Sender::Inboxes)
                .count(),
            1
        );
        assert!(
            got.ends_with(&[Sender::Member(8), Sender::Recorded(1), Sender::Network]),
            "{got:?}"
        );
        // Reading frees space.
        inbox.push(orders(7));
        assert_eq!(senders(&inbox), [Sender::Member(7)]);
    }

    #[test]
    fn a_ticket_that_nobody_holds_takes_no_room_and_neither_does_garbage() {
        let inbox = inbox(&[7]);
        (0..100_000).for_each(|ticket| inbox.push(orders(ticket)));
        assert!(inbox.decode::<Orders>(b"ahoy").is_none());
        assert_eq!(senders(&inbox), [Sender::Member(7)]);
        assert_eq!(
            inbox.refusals(),
            Refusals::from([(Refusal::Ticket, 99_999), (Refusal::Garbage, 1)])
        );
        // A node that rejoins has a new ticket, and the old one is void.
        inbox.accept_tickets([9].into());
        [orders(7), orders(9)]
            .into_iter()
            .for_each(|message| inbox.push(message));
        assert_eq!(senders(&inbox), [Sender::Member(9)]);
    }
}
