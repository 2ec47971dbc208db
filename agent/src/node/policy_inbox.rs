//! Policy proposals: courses and speeds that external programs and people propose for this
//! process's boats.

use super::error::NodeError;
use crate::MindRunner;
use bus::{Bus, Declaration, Watched};
use messages::refusal::{Refusal, Refusals};
use messages::topic::{self, GameName};
use messages::{PolicyProposal, Stamp};
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::strategy::Proposer;
use std::sync::Arc;
use std::time::Duration;

/// The proposals for one boat.
#[derive(Clone, Debug)]
struct Boat {
    vehicle: VehicleId,
    /// Whether decisions wait for this boat's proposal; never for a proposal from a person.
    is_awaited: bool,
    newest: Option<PolicyProposal>,
}

/// The proposals for all boats.
#[derive(Clone, Debug, Default)]
struct Proposals {
    boats: Vec<Boat>,
    refusals: Refusals,
}

/// The proposals for the boats whose strategy uses them.
pub(super) struct PolicyInbox {
    proposals: Arc<Watched<Proposals>>,
    /// Maximum wait for the proposal for a decision.
    patience: Duration,
    is_wanted: bool,
    _declarations: Vec<Declaration>,
}

impl PolicyInbox {
    /// Subscribes to proposals if a strategy uses them.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        runner: &MindRunner,
        patience: Duration,
    ) -> Result<PolicyInbox, NodeError> {
        let minds = runner
            .minds()
            .filter_map(|(vehicle, mind)| Some((vehicle, mind.proposer()?)));
        let boat = |(vehicle, proposer)| Boat {
            vehicle,
            is_awaited: proposer == Proposer::Program,
            newest: None,
        };
        let boats: Vec<Boat> = minds.map(boat).collect();
        let proposals = Arc::new(Watched::new(Proposals {
            boats: boats.clone(),
            refusals: Refusals::default(),
        }));
        let mut declarations = Vec::new();
        for (i, boat) in boats.iter().enumerate() {
            let inbox = Arc::clone(&proposals);
            let take = move |bytes: &[u8]| inbox.visit(|proposals| proposals.receive(i, bytes));
            declarations
                .push(bus.subscribe_remote(topic::policy(game, scenario, boat.vehicle), take)?);
        }
        Ok(PolicyInbox {
            proposals,
            patience,
            is_wanted: !boats.is_empty(),
            _declarations: declarations,
        })
    }

    /// Passes the newest proposals to the minds that decide on the picture with this stamp.
    pub(super) fn give(&mut self, runner: &mut MindRunner, stamp: Stamp) {
        if !self.is_wanted {
            return;
        }
        let is_complete =
            // Real-time games do not wait for policies. In lockstep, without waiting, the game
            // would depend on the speed of processes.
            self.patience.is_zero() || self.proposals.wait(self.patience, |proposals| proposals.is_for(stamp.seq));
        self.proposals.visit(|proposals| {
            proposals
                .refusals
                .add(Refusal::ProposalMissing, u64::from(!is_complete));
            let newest = proposals
                .boats
                .iter()
                .filter_map(|boat| boat.newest.as_ref());
            newest.for_each(|proposal| runner.propose(proposal, stamp));
        });
    }

    pub(super) fn refusals(&self) -> Refusals {
        self.proposals.visit(|proposals| proposals.refusals)
    }
}

impl Proposals {
    fn receive(&mut self, i: usize, bytes: &[u8]) {
        let Some(proposal) = self.refusals.decode::<PolicyProposal>(bytes) else {
            return;
        };
        // Access control works by key, so reject a message whose vehicle contradicts its key.
        if proposal.vehicle != self.boats[i].vehicle {
            self.refusals.count(Refusal::NotYours);
        } else if !is_sound(&proposal) {
            self.refusals.count(Refusal::BadNumber);
        } else {
            self.boats[i].newest = Some(proposal);
        }
    }

    /// Whether all awaited proposals for decision `seq` have arrived.
    fn is_for(&self, seq: u64) -> bool {
        let is_for = |proposal: &PolicyProposal| proposal.stamp.seq >= seq;
        self.boats
            .iter()
            .all(|boat| !boat.is_awaited || boat.newest.as_ref().is_some_and(is_for))
    }
}

/// Whether the values are finite and the time is within the game.
fn is_sound(proposal: &PolicyProposal) -> bool {
    proposal.course_rad.is_finite()
        && proposal.speed_m_s.is_finite()
        && proposal.stamp.valid_ns >= SimTime::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::Message;
    use primitives::codec;

    fn proposal(vehicle: u16, seq: u64, speed_m_s: f64) -> PolicyProposal {
        let stamp = Stamp {
            seq,
            version: PolicyProposal::VERSION,
            ..Stamp::default()
        };
        PolicyProposal {
            stamp,
            vehicle: VehicleId(vehicle),
            course_rad: 0.5,
            speed_m_s,
        }
    }

    #[test]
    fn the_newest_good_proposal_stands_and_others_are_counted() {
        let boat = |v: u16| Boat {
            vehicle: VehicleId(v),
            is_awaited: v < 2,
            newest: None,
        };
        let mut proposals = Proposals {
            boats: vec![boat(0), boat(1), boat(2)],
            refusals: Refusals::default(),
        };
        proposals.receive(0, &codec::encode(&proposal(0, 4, 1.0)));
        assert!(!proposals.is_for(4), "the other proposal is missing");
        proposals.receive(1, &codec::encode(&proposal(1, 4, 1.0)));
        assert!(proposals.is_for(4) && !proposals.is_for(5));
        proposals.receive(1, &codec::encode(&proposal(1, 5, 2.0)));
        proposals.receive(1, &codec::encode(&proposal(0, 6, 9.0)));
        proposals.receive(1, &codec::encode(&proposal(1, 6, f64::NAN)));
        let early = Stamp {
            valid_ns: SimTime(i64::MIN),
            ..proposal(1, 6, 9.0).stamp
        };
        proposals.receive(
            1,
            &codec::encode(&PolicyProposal {
                stamp: early,
                ..proposal(1, 6, 9.0)
            }),
        );
        proposals.receive(1, b"ahoy");
        let mut other = proposal(1, 6, 9.0);
        other.stamp.version += 1;
        proposals.receive(1, &codec::encode(&other));
        assert_eq!(proposals.boats[1].newest, Some(proposal(1, 5, 2.0)));
        let want = [
            (Refusal::NotYours, 1),
            (Refusal::BadNumber, 2),
            (Refusal::Garbage, 1),
            (Refusal::Version, 1),
        ];
        assert_eq!(proposals.refusals, Refusals::from(want));
    }
}
