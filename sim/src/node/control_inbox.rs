//! Operator commands to the game. They are handled before all other messages, and no stop is ever
//! lost.

use bus::Watched;
use messages::Control;
use messages::refusal::{Refusal, Refusals};
use std::collections::VecDeque;

/// Maximum number of waiting commands: more than people send between two reads by the sim.
const WAITING_MAX: usize = 64;

/// An operator command. `Q` is a query that needs a reply.
#[derive(Debug, PartialEq)]
pub(super) enum Command<Q> {
    /// A published stop, which needs no token.
    Stop(Control),
    /// A query to the sim.
    Ask(Q),
}

pub(super) struct ControlInbox<Q>(Watched<Waiting<Q>>);

struct Waiting<Q> {
    commands: VecDeque<Command<Q>>,
    refusals: Refusals,
}

impl<Q> Default for ControlInbox<Q> {
    fn default() -> ControlInbox<Q> {
        ControlInbox(Watched::new(Waiting {
            commands: VecDeque::new(),
            refusals: Refusals::default(),
        }))
    }
}

impl<Q> ControlInbox<Q> {
    /// Adds a published command. Returns whether the sim should read the inbox.
    pub(super) fn put_stop(&self, bytes: &[u8]) -> bool {
        let control = serde_json::from_slice::<Control>(bytes);
        self.0.visit(|waiting| match control {
            // Only stops can be published without the token; all other commands must be queries
            // with it.
            Ok(control) if control.stops() => {
                waiting.put_stop(control);
                true
            }
            Ok(_) => {
                waiting.refusals.count(Refusal::OutOfPlace);
                false
            }
            Err(_) => {
                waiting.refusals.count(Refusal::Garbage);
                false
            }
        })
    }

    /// Adds a query unless the inbox is full. Returns whether it was added.
    pub(super) fn put_query(&self, query: Q) -> bool {
        self.0.visit(|waiting| {
            let has_room = waiting.commands.len() < WAITING_MAX;
            if has_room {
                waiting.commands.push_back(Command::Ask(query));
            } else {
                waiting.refusals.count(Refusal::Flood);
            }
            has_room
        })
    }

    /// The oldest command.
    pub(super) fn pop_command(&self) -> Option<Command<Q>> {
        self.0.visit(|waiting| waiting.commands.pop_front())
    }

    /// The refusals so far.
    pub(super) fn refusals(&self) -> Refusals {
        self.0.visit(|waiting| waiting.refusals)
    }
}

impl<Q> Waiting<Q> {
    /// Adds a stop unless it repeats the last command. In a full inbox, the stop replaces all
    /// commands that are not stops.
    fn put_stop(&mut self, stop: Control) {
        let is_stop = |command: &Command<Q>, stop| matches!(command, Command::Stop(waiting) if *waiting == stop);
        // Senders repeat stops until they get a reply; duplicates would only fill the inbox.
        if self.commands.back().is_some_and(|last| is_stop(last, stop)) {
            return;
        }
        if self.commands.len() >= WAITING_MAX {
            let stops = [Control::EStop, Control::Halt];
            let waiting =
                stops.map(|stop| self.commands.iter().any(|command| is_stop(command, stop)));
            let before = self.commands.len();
            self.commands.clear();
            let kept = stops.into_iter().zip(waiting).filter(|(_, waits)| *waits);
            self.commands
                .extend(kept.map(|(stop, _)| Command::Stop(stop)));
            self.refusals
                .add(Refusal::Flood, (before - self.commands.len()) as u64);
        }
        self.commands.push_back(Command::Stop(stop));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn send(inbox: &ControlInbox<u32>, control: Control) -> bool {
        inbox.put_stop(&serde_json::to_vec(&control).expect("JSON"))
    }

    fn all(inbox: &ControlInbox<u32>) -> Vec<Command<u32>> {
        std::iter::from_fn(|| inbox.pop_command()).collect()
    }

    #[test]
    fn commands_are_taken_in_their_order_and_only_stops_are_taken_from_anybody() {
        let inbox = ControlInbox::default();
        assert!(send(&inbox, Control::EStop) && send(&inbox, Control::EStop) && inbox.put_query(1));
        assert!(send(&inbox, Control::EStop) && send(&inbox, Control::Halt) && inbox.put_query(1));
        assert!(
            !send(&inbox, Control::Release) && !send(&inbox, Control::Stop),
            "they must be queries"
        );
        assert!(!inbox.put_stop(b"ahoy") && !inbox.put_stop(b"\"e_stop"));
        let [e_stop, halt] = [Control::EStop, Control::Halt].map(Command::Stop);
        assert_eq!(
            all(&inbox),
            [
                Command::Stop(Control::EStop),
                Command::Ask(1),
                e_stop,
                halt,
                Command::Ask(1)
            ]
        );
        assert_eq!(
            inbox.refusals(),
            Refusals::from([(Refusal::Garbage, 2), (Refusal::OutOfPlace, 2)])
        );
    }

    #[test]
    fn no_flood_keeps_a_stop_out() {
        let inbox = ControlInbox::default();
        assert!(send(&inbox, Control::Halt));
        (1..1000).for_each(|i| assert_eq!(inbox.put_query(i), (i as usize) < WAITING_MAX));
        assert!(send(&inbox, Control::EStop));
        assert_eq!(
            all(&inbox),
            [Command::Stop(Control::Halt), Command::Stop(Control::EStop)]
        );
        assert_eq!(inbox.refusals(), Refusals::from([(Refusal::Flood, 999)]));
        // Nor do alternating stops and queries fill the inbox: both stops are kept, and the last
        // one remains last.
        for i in 0..1000 {
            send(
                &inbox,
                if i % 2 == 0 {
                    Control::EStop
                } else {
                    Control::Halt
                },
            );
            inbox.put_query(i);
        }
        let left = all(&inbox);
        assert!(left.len() <= WAITING_MAX && left.contains(&Command::Stop(Control::EStop)));
        assert_eq!(
            left.iter()
                .rev()
                .find(|command| matches!(command, Command::Stop(_))),
            Some(&Command::Stop(Control::Halt))
        );
    }
}
