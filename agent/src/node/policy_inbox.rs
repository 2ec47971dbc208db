//! PolicyInbox: what policies outside propose for the boats minded here.

use super::NodeError;
use crate::MindRunner;
use bus::{Bus, Declaration, Watched};
use game::message::{PolicyProposal, Stamp};
use game::refusal::{Refusal, Refusals};
use game::strategy::Proposer;
use game::topic::{self, GameName};
use game::{Scenario, SimTime, VehicleId};
use std::sync::Arc;
use std::time::Duration;

/// What was proposed for one boat.
#[derive(Clone, Debug)]
struct Adviser {
    vehicle: VehicleId,
    /// NoRecorder waits for a person.
    is_awaited: bool,
    newest: Option<PolicyProposal>,
}

/// What was proposed for all of them.
#[derive(Clone, Debug, Default)]
struct Heap {
    advisers: Vec<Adviser>,
    refusals: Refusals,
}

/// The lines from policies to the boats whose program heeds one.
pub(super) struct PolicyInbox {
    heap: Arc<Watched<Heap>>,
    /// How long the proposal for a decision is waited for.
    patience: Duration,
    is_wanted: bool,
    _standing: Vec<Declaration>,
}

impl PolicyInbox {
    /// Listens to policies, where a program heeds them.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        runner: &MindRunner,
        patience: Duration,
    ) -> Result<PolicyInbox, NodeError> {
        let minds = runner.minds().filter_map(|(vehicle, mind)| Some((vehicle, mind.proposer()?)));
        let adviser =
            |(vehicle, proposer)| Adviser { vehicle, is_awaited: proposer == Proposer::Program, newest: None };
        let advisers: Vec<Adviser> = minds.map(adviser).collect();
        let heap = Arc::new(Watched::new(Heap { advisers: advisers.clone(), refusals: Refusals::default() }));
        let mut standing = Vec::new();
        for (i, adviser) in advisers.iter().enumerate() {
            let inbox = Arc::clone(&heap);
            let take = move |bytes: &[u8]| inbox.visit(|heap| heap.take(i, bytes));
            standing.push(bus.subscribe_remote(topic::policy(game, scenario, adviser.vehicle), take)?);
        }
        Ok(PolicyInbox { heap, patience, is_wanted: !advisers.is_empty(), _standing: standing })
    }

    /// Gives the newest proposals to the minds that decide on the picture with this stamp.
    pub(super) fn give(&mut self, runner: &mut MindRunner, stamp: Stamp) {
        if !self.is_wanted {
            return;
        }
        let advised = self.patience.is_zero() || self.heap.wait(self.patience, |heap| heap.is_for(stamp.seq));
        self.heap.visit(|heap| {
            heap.refusals.add(Refusal::ProposalMissing, u64::from(!advised));
            let proposals = heap.advisers.iter().filter_map(|adviser| adviser.newest.as_ref());
            proposals.for_each(|proposal| runner.propose(proposal, stamp));
        });
    }

    pub(super) fn refusals(&self) -> Refusals {
        self.heap.visit(|heap| heap.refusals)
    }
}

impl Heap {
    fn take(&mut self, i: usize, bytes: &[u8]) {
        let Some(proposal) = self.refusals.decode::<PolicyProposal>(bytes) else { return };
        if proposal.vehicle != self.advisers[i].vehicle {
            self.refusals.count(Refusal::NotYours);
        } else if !is_sound(&proposal) {
            self.refusals.count(Refusal::BadNumber);
        } else {
            self.advisers[i].newest = Some(proposal);
        }
    }

    /// Whether the proposals for decision `seq` are there that are waited for.
    fn is_for(&self, seq: u64) -> bool {
        let is_for = |proposal: &PolicyProposal| proposal.stamp.seq >= seq;
        self.advisers.iter().all(|adviser| !adviser.is_awaited || adviser.newest.as_ref().is_some_and(is_for))
    }
}

/// Whether its numbers are numbers, and it is of a time in the game.
fn is_sound(proposal: &PolicyProposal) -> bool {
    proposal.course_rad.is_finite() && proposal.speed_m_s.is_finite() && proposal.stamp.valid_ns >= SimTime::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::codec;
    use game::message::Message;

    fn proposal(vehicle: u16, seq: u64, speed_m_s: f64) -> PolicyProposal {
        let stamp = Stamp { seq, version: PolicyProposal::VERSION, ..Stamp::default() };
        PolicyProposal { stamp, vehicle: VehicleId(vehicle), course_rad: 0.5, speed_m_s }
    }

    #[test]
    fn the_newest_good_proposal_stands_and_others_are_counted() {
        let adviser = |v: u16| Adviser { vehicle: VehicleId(v), is_awaited: v < 2, newest: None };
        let mut heap = Heap { advisers: vec![adviser(0), adviser(1), adviser(2)], refusals: Refusals::default() };
        heap.take(0, &codec::encode(&proposal(0, 4, 1.0)));
        assert!(!heap.is_for(4), "the other is missing");
        heap.take(1, &codec::encode(&proposal(1, 4, 1.0)));
        assert!(heap.is_for(4) && !heap.is_for(5));
        heap.take(1, &codec::encode(&proposal(1, 5, 2.0)));
        heap.take(1, &codec::encode(&proposal(0, 6, 9.0)));
        heap.take(1, &codec::encode(&proposal(1, 6, f64::NAN)));
        let early = Stamp { valid_ns: SimTime(i64::MIN), ..proposal(1, 6, 9.0).stamp };
        heap.take(1, &codec::encode(&PolicyProposal { stamp: early, ..proposal(1, 6, 9.0) }));
        heap.take(1, b"ahoy");
        let mut other = proposal(1, 6, 9.0);
        other.stamp.version += 1;
        heap.take(1, &codec::encode(&other));
        assert_eq!(heap.advisers[1].newest, Some(proposal(1, 5, 2.0)));
        let want = [(Refusal::NotYours, 1), (Refusal::BadNumber, 2), (Refusal::Garbage, 1), (Refusal::Version, 1)];
        assert_eq!(heap.refusals, Refusals::from(want));
    }
}
