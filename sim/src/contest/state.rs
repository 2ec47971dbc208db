//! What changes in a contest beside its boats, and what must always hold of it.

use super::Contest;
use crate::external::Track;
use messages::picture::OwnBoat;
use messages::{Order, Picture};
use primitives::{Ned, SimTime, VehicleId};
use rules::Standing;
use rules::count::Tally;
use rules::event::{EventCursor, Logged};
use serde::{Deserialize, Serialize};

/// How a game stands: the referee's memory, what the boats were ordered, and what their people know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ContestState {
    /// The decision that is open.
    pub(super) decision: u64,
    pub(super) standing: Standing,
    /// By vehicle.
    pub(super) orders: Vec<OrderInForce>,
    /// By vehicle: where it began to hold, if it keeps its station there.
    pub(super) stations: Vec<Option<Ned>>,
    /// Whether each vehicle's agent is lost.
    pub(super) agent_lost: Vec<bool>,
    /// Whether people ashore have stopped all boats for good, or for now.
    pub(super) e_stopped: bool,
    pub(super) halted: bool,
    /// By vehicle: what is known of the real ones.
    pub(super) tracks: Vec<Option<Track>>,
    /// What is known ashore of every boat, as of the last pictures.
    pub(super) known: Vec<OwnBoat>,
    pub(super) events: Vec<Logged>,
    /// How far the last pictures go in the events.
    pub(super) pictured: EventCursor,
    /// The decision that the pictures are of.
    pub(super) pictured_for: Option<u64>,
    /// By team.
    pub(super) pictures: Vec<Picture>,
}

/// What a vehicle does by its agent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct OrderInForce {
    pub(super) order: Order,
    /// When it arrived.
    pub(super) arrived_at: SimTime,
    /// The time of the picture that the newest order answers, arrived or under way.
    pub(super) given_at: SimTime,
}

impl Contest {
    /// Invariants of world and game, looked at once a decision.
    pub(super) fn assert_sound(&self) {
        let (world, standing) = (self.world.state(), &self.state.standing);
        assert_eq!(world.now, self.scenario.tick * world.tick as i64, "time is ticks");
        // The world sets a boat aside whose numbers went bad; one that gets past that is a
        // mistake of ours, and the game's result would be worth nothing.
        assert!(world.boats.iter().all(|boat| boat.pose.at.is_finite()), "boats are somewhere");
        for (i, boat) in standing.vehicles.iter().enumerate() {
            let Some(flag) = boat.carrying else { continue };
            // Three rules meet here, and each could break it.
            assert!(boat.in_play && !boat.tagged && !boat.outside, "vehicle {i} carries a flag");
            assert_eq!(
                standing.flags[flag.index()].carrier,
                Some(VehicleId::at(i)),
                "the flag that vehicle {i} carries"
            );
        }
        let carried = standing.flags.iter().filter(|flag| flag.carrier.is_some()).count();
        assert_eq!(carried, standing.vehicles.iter().filter(|boat| boat.carrying.is_some()).count(), "flags carried");
    }

    /// That the score is what the events add up to.
    pub(super) fn assert_score(&self) {
        // Counted a second time, from the events: what referee and log say must not drift
        // apart.
        let mut tally = Tally::new(self.scenario.vehicles.len());
        self.state.events.iter().for_each(|logged| tally.add(logged.event));
        let mut score = vec![0_u32; self.score().len()];
        for (vehicle, counts) in self.scenario.vehicles.iter().zip(&tally.vehicles) {
            let team = &mut score[vehicle.team.index()];
            *team = team.saturating_add(self.scenario.rules.points.of(counts));
        }
        assert_eq!(score, self.score(), "the score is what the events add up to");
    }
}
