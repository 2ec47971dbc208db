//! Team messages over the network: to and from teammates in other processes.

use super::error::NodeError;
use super::team_inbox::TeamInbox;
use crate::{MindRunner, roles};
use bus::{Bus, Declaration, Priority, Publisher, Watched};
use messages::refusal::{Refusal, Refusals};
use messages::topic::{self, GameName};
use messages::{Message, Say, Stamp, Word};
use primitives::{TeamId, VehicleId};
use scenario::Scenario;
use std::sync::Arc;
use std::time::Duration;

/// Messages to one team.
struct Outgoing {
    team: TeamId,
    publisher: Publisher,
    /// The last message, kept to be repeated with repeated orders.
    last: Option<Say>,
}

/// The messages of the teams for which a mind in this process sends messages.
pub(super) struct Talk {
    outgoing: Vec<Outgoing>,
    team_inbox: Arc<Watched<TeamInbox>>,
    teams: Vec<TeamId>,
    /// Maximum wait for expected messages.
    patience: Duration,
    words: Vec<Word>,
    _declarations: Vec<Declaration>,
}

impl Talk {
    /// Prepares a publisher for each team with a mind that sends messages, and subscribes to
    /// teammates.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        runner: &MindRunner,
        patience: Duration,
    ) -> Result<Talk, NodeError> {
        let teams: Vec<TeamId> = (0..scenario.vehicles.len())
            .map(|i| scenario.team_of(VehicleId::at(i)))
            .collect();
        let mut talking: Vec<TeamId> = runner
            .minds()
            .filter(|(_, mind)| mind.shares())
            .map(|(vehicle, _)| scenario.team_of(vehicle))
            .collect();
        talking.sort_unstable();
        talking.dedup();
        let own: Vec<VehicleId> = runner.minds().map(|(vehicle, _)| vehicle).collect();
        // The scenario's strategies determine which boats send messages. If a teammate runs a
        // different strategy (`--strategy`), the agent waits at most once for messages that never
        // come.
        let talks = |vehicle| {
            roles::role_of(scenario, vehicle)
                .variables
                .iter()
                .any(|variable| variable.shared)
        };
        let boats = teams
            .iter()
            .enumerate()
            .map(|(i, team)| (*team, talking.contains(team) && talks(VehicleId::at(i))));
        let team_inbox = Arc::new(Watched::new(TeamInbox::new(boats, &own)));
        let mut outgoing = Vec::new();
        let mut declarations = Vec::new();
        for team in talking {
            let inbox = Arc::clone(&team_inbox);
            let take =
                move |bytes: &[u8]| inbox.visit(|team_inbox| team_inbox.receive(team, bytes));
            // These messages go from agent to agent and bypass the sim's loop, because the sim
            // neither needs nor checks them. As part of orders they would slow down lockstep for
            // everyone, and on the water no sim can relay them.
            declarations.push(bus.subscribe_remote(topic::say(game, scenario, team), take)?);
            let publisher = bus.publisher(topic::say(game, scenario, team), Priority::Normal)?;
            outgoing.push(Outgoing {
                team,
                publisher,
                last: None,
            });
        }
        Ok(Talk {
            outgoing,
            team_inbox,
            teams,
            patience,
            words: Vec::new(),
            _declarations: declarations,
        })
    }

    /// Passes on to the minds the messages that teammates in other processes sent after the
    /// previous decision.
    pub(super) fn hear(&mut self, runner: &mut MindRunner, seq: u64) {
        if self.outgoing.is_empty() {
            return;
        }
        // In real time, the agent neither waits for messages nor counts missing ones: each teammate
        // decides at its own time.
        let waits = !self.patience.is_zero();
        if waits {
            self.team_inbox
                .wait(self.patience, |team_inbox| team_inbox.is_complete(seq));
        }
        self.words.clear();
        self.team_inbox.visit(|team_inbox| {
            let missed = team_inbox.deliver(seq, &mut self.words);
            team_inbox
                .refusals
                .add(Refusal::TeamMessageMissing, if waits { missed } else { 0 });
        });
        runner.receive(&self.words);
    }

    /// Collects the minds' messages after a decision, to send to teammates in other processes.
    pub(super) fn publish_words(&mut self, said: &[Word], stamp: Stamp) {
        for to in &mut self.outgoing {
            let ours = |word: &&Word| self.teams.get(word.vehicle.index()) == Some(&to.team);
            let words: Vec<Word> = said.iter().filter(ours).copied().collect();
            // Keep the messages: the answer to a repeated picture repeats them, in case they were
            // lost.
            to.last = (!words.is_empty()).then_some(Say {
                stamp: Stamp {
                    version: Say::VERSION,
                    ..stamp
                },
                words,
            });
        }
    }

    /// Sends or repeats the messages, which may have been lost along with the orders. Must precede
    /// the orders, so that the messages are in transit before the next picture.
    pub(super) fn send(&self) -> Result<(), NodeError> {
        for to in &self.outgoing {
            if let Some(last) = &to.last {
                to.publisher.send(last)?;
            }
        }
        Ok(())
    }

    pub(super) fn refusals(&self) -> Refusals {
        self.team_inbox.visit(|team_inbox| team_inbox.refusals)
    }
}
