//! Team messages over the network: what the minds here publish to their mates elsewhere, and receive from them.

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
    /// Sent last, to be sent again when orders are sent again.
    last: Option<Say>,
}

/// The team messages of the teams whose minds here talk.
pub(super) struct Talk {
    outgoing: Vec<Outgoing>,
    team_inbox: Arc<Watched<TeamInbox>>,
    teams: Vec<TeamId>,
    /// How long messages that should be there may take.
    patience: Duration,
    words: Vec<Word>,
    _declarations: Vec<Declaration>,
}

impl Talk {
    /// Prepares to publish to each team of which a mind here talks, and subscribes to what its mates publish.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        runner: &MindRunner,
        patience: Duration,
    ) -> Result<Talk, NodeError> {
        let teams: Vec<TeamId> = (0..scenario.vehicles.len()).map(|i| scenario.team_of(VehicleId::at(i))).collect();
        let mut talking: Vec<TeamId> =
            runner.minds().filter(|(_, mind)| mind.shares()).map(|(vehicle, _)| scenario.team_of(vehicle)).collect();
        talking.sort_unstable();
        talking.dedup();
        let own: Vec<VehicleId> = runner.minds().map(|(vehicle, _)| vehicle).collect();
        // By the scenario's strategies: a mate that was given another one with `--strategy` may
        // be waited for once, and then no more.
        let talks = |vehicle| roles::role_of(scenario, vehicle).variables.iter().any(|variable| variable.shared);
        let boats =
            teams.iter().enumerate().map(|(i, team)| (*team, talking.contains(team) && talks(VehicleId::at(i))));
        let team_inbox = Arc::new(Watched::new(TeamInbox::new(boats, &own)));
        let (mut outgoing, mut declarations) = (Vec::new(), Vec::new());
        for team in talking {
            let inbox = Arc::clone(&team_inbox);
            let take = move |bytes: &[u8]| inbox.visit(|team_inbox| team_inbox.receive(team, bytes));
            // From agent to agent, past the sim's loop: it neither needs nor checks them, as
            // part of orders they would make lockstep slower for everybody, and on the water
            // there is no sim to pass them on.
            declarations.push(bus.subscribe_remote(topic::say(game, scenario, team), take)?);
            let publisher = bus.publisher(topic::say(game, scenario, team), Priority::Normal)?;
            outgoing.push(Outgoing { team, publisher, last: None });
        }
        Ok(Talk { outgoing, team_inbox, teams, patience, words: Vec::new(), _declarations: declarations })
    }

    /// Gives the minds what mates elsewhere sent after the decision before.
    pub(super) fn hear(&mut self, runner: &mut MindRunner, seq: u64) {
        if self.outgoing.is_empty() {
            return;
        }
        // In real time nobody waits, and nobody counts either: mates decide when they do.
        let waits = !self.patience.is_zero();
        if waits {
            self.team_inbox.wait(self.patience, |team_inbox| team_inbox.is_complete(seq));
        }
        self.words.clear();
        self.team_inbox.visit(|team_inbox| {
            let missed = team_inbox.deliver(seq, &mut self.words);
            team_inbox.refusals.add(Refusal::TeamMessageMissing, if waits { missed } else { 0 });
        });
        runner.receive(&self.words);
    }

    /// Takes what the minds here tell their teams after deciding, to be sent to mates elsewhere.
    pub(super) fn publish_words(&mut self, said: &[Word], stamp: Stamp) {
        for to in &mut self.outgoing {
            let ours = |word: &&Word| self.teams.get(word.vehicle.index()) == Some(&to.team);
            let words: Vec<Word> = said.iter().filter(ours).copied().collect();
            // Kept, since a repeated picture is answered with the same messages: whatever was
            // lost is said again.
            to.last = (!words.is_empty()).then_some(Say { stamp: Stamp { version: Say::VERSION, ..stamp }, words });
        }
    }

    /// Sends it, or sends it again: it may have been lost with the orders that are asked for again. It must be sent before
    /// the orders are: then it is on its way before the next picture.
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
