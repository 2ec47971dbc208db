//! The changing state of a contest, except its boats, and checks of its invariants.

use super::Contest;
use crate::external::Track;
use messages::picture::OwnBoat;
use messages::{Order, Picture};
use primitives::{Ned, SimTime, VehicleId};
use rules::Standing;
use rules::count::Tally;
use rules::event::{EventCursor, Logged};
use serde::{Deserialize, Serialize};

/// The state of a game: the referee's standing, orders to the boats, and knowledge on shore.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ContestState {
    /// The number of the open decision.
    pub(super) decision: u64,
    pub(super) standing: Standing,
    /// Orders in force, by vehicle index.
    pub(super) orders: Vec<OrderInForce>,
    /// Stations of station-keeping boats that hold, by vehicle index.
    pub(super) stations: Vec<Option<Ned>>,
    /// Whether each vehicle's agent is lost.
    pub(super) agent_lost: Vec<bool>,
    /// Whether an operator has set the E-stop.
    pub(super) e_stopped: bool,
    /// Whether an operator has ordered a halt.
    pub(super) halted: bool,
    /// Tracks of the real boats, by vehicle index.
    pub(super) tracks: Vec<Option<Track>>,
    /// Own boats as known on shore in the last pictures.
    pub(super) known: Vec<OwnBoat>,
    pub(super) events: Vec<Logged>,
    /// Position in the events when the pictures were last built.
    pub(super) pictured: EventCursor,
    /// The decision for which the pictures were last built.
    pub(super) pictured_for: Option<u64>,
    /// Pictures, by team index.
    pub(super) pictures: Vec<Picture>,
}

/// A vehicle's order in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct OrderInForce {
    pub(super) order: Order,
    /// Time of arrival.
    pub(super) arrived_at: SimTime,
    /// Time of the picture that the newest order answers, even if that order is still in transit.
    pub(super) given_at: SimTime,
}

impl Contest {
    /// Checks the invariants of world and game, once per decision.
    pub(super) fn assert_sound(&self) {
        let world = self.world.state();
        let standing = &self.state.standing;
        assert_eq!(
            world.now,
            self.scenario.tick * world.tick as i64,
            "time is the number of ticks"
        );
        // The world quarantines boats with a non-finite state. If one gets past that, we have a
        // bug, and the game's result would be worthless.
        assert!(
            world.boats.iter().all(|boat| boat.pose.at.is_finite()),
            "positions are finite"
        );
        for (i, boat) in standing.vehicles.iter().enumerate() {
            let Some(flag) = boat.carrying else { continue };
            // Three rules interact here, and each of them could break this invariant.
            assert!(
                boat.in_play && !boat.tagged && !boat.outside,
                "vehicle {i} carries a flag out of play"
            );
            assert_eq!(
                standing.flags[flag.index()].carrier,
                Some(VehicleId::at(i)),
                "the flag that vehicle {i} carries"
            );
        }
        let carried = standing
            .flags
            .iter()
            .filter(|flag| flag.carrier.is_some())
            .count();
        assert_eq!(
            carried,
            standing
                .vehicles
                .iter()
                .filter(|boat| boat.carrying.is_some())
                .count(),
            "each flag has one carrier"
        );
    }

    /// Checks that the score equals the sum over the events.
    pub(super) fn assert_score(&self) {
        // Count from the events, so that referee and log cannot diverge.
        let mut tally = Tally::new(self.scenario.vehicles.len());
        self.state
            .events
            .iter()
            .for_each(|logged| tally.add(logged.event));
        let mut score = vec![0_u32; self.score().len()];
        for (vehicle, counts) in self.scenario.vehicles.iter().zip(&tally.vehicles) {
            let team = &mut score[vehicle.team.index()];
            *team = team.saturating_add(self.scenario.rules.points.of(counts));
        }
        assert_eq!(score, self.score(), "the score is the sum over the events");
    }
}
