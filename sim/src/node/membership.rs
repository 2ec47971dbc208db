//! Membership of a game: agents that decide for vehicles, and gateways that connect real boats,
//! with one list per role.
//!
//! A node that joins gets a ticket and sends it with every message. This module uses neither
//! network nor clock: the server passes in messages and acts on the results.

use messages::{JoinReply, JoinRequest, Role};
use primitives::{SimTime, VehicleId};
use scenario::{Scenario, Source};

/// The nodes that have joined in one role.
#[derive(Clone, Debug)]
pub struct Membership {
    role: Role,
    /// By vehicle index.
    places: Vec<Place>,
}

/// A vehicle that a node can join for.
#[derive(Clone, Debug)]
struct Place {
    name: String,
    /// Whether a node with this role may join for it: gateways connect only real boats.
    is_open: bool,
    holder: Option<Holder>,
}

/// The last node that joined for a vehicle.
#[derive(Clone, Debug)]
struct Holder {
    node: String,
    ticket: u64,
    /// Whether the node counts as present: neither dead nor silent.
    is_present: bool,
    /// The sequence number of the newest accepted message.
    newest: Option<u64>,
}

impl Place {
    fn present(&self) -> Option<&Holder> {
        self.holder.as_ref().filter(|holder| holder.is_present)
    }
}

impl Membership {
    /// The membership of a game before any join.
    pub fn new(scenario: &Scenario, role: Role) -> Membership {
        let places = scenario.vehicles.iter().map(|vehicle| Place {
            name: vehicle.name.clone(),
            is_open: role == Role::Agent || vehicle.source == Source::External,
            holder: None,
        });
        Membership {
            role,
            places: places.collect(),
        }
    }

    /// Handles a join request at this time of the game. `ticket` becomes the node's ticket if it
    /// joins. A node that requests its own vehicles again gets them with the new ticket, since the
    /// first reply may have been lost.
    pub fn join(&mut self, request: &JoinRequest, ticket: u64, now: SimTime) -> JoinReply {
        let role = self.role;
        let refused = |reason: String| JoinReply::Refused { reason };
        // The versions must be equal: two versions may agree on messages but differ in rounding,
        // and so in the game.
        if request.version != primitives::VERSION {
            let theirs = &request.version;
            let ours = primitives::VERSION;
            return refused(format!(
                "the {role} runs Squall {theirs}, the sim Squall {ours}: use the same version"
            ));
        }
        // A node must join for at least one vehicle: lockstep would wait for a node without any.
        if request.vehicles.is_empty() {
            return refused(format!("the {role} names no vehicle"));
        }
        let mut vehicles = Vec::new();
        for name in &request.vehicles {
            let Some(i) = self.places.iter().position(|place| place.name == *name) else {
                return refused(format!("no vehicle named {name:?}; {}", self.on_offer()));
            };
            let place = &self.places[i];
            if !place.is_open {
                return refused(format!(
                    "{name} is simulated in this game; {}",
                    self.on_offer()
                ));
            }
            if place
                .present()
                .is_some_and(|holder| holder.node != request.node)
            {
                return JoinReply::Busy {
                    vehicle: name.clone(),
                };
            }
            // A repeated name is a typing error and would make the number of boats wrong.
            if vehicles.contains(&VehicleId::at(i)) {
                return refused(format!("the {role} names {name:?} twice"));
            }
            vehicles.push(VehicleId::at(i));
        }
        for vehicle in &vehicles {
            // A new ticket voids the old one, so that an agent presumed dead cannot steer alongside
            // its successor.
            let holder = Holder {
                node: request.node.clone(),
                ticket,
                is_present: true,
                newest: None,
            };
            self.places[vehicle.index()].holder = Some(holder);
        }
        JoinReply::Granted {
            ticket,
            vehicles,
            now_ns: now,
        }
    }

    fn on_offer(&self) -> String {
        let names: Vec<&str> = self.open().map(|(_, place)| place.name.as_str()).collect();
        match (self.role, names.is_empty()) {
            (Role::Agent, _) => format!("the vehicles are: {}", names.join(", ")),
            (Role::Gateway, false) => format!("the external vehicles are: {}", names.join(", ")),
            (Role::Gateway, true) => {
                "this game has no external vehicles or is a rehearsal".to_owned()
            }
        }
    }

    fn open(&self) -> impl Iterator<Item = (VehicleId, &Place)> {
        self.places
            .iter()
            .enumerate()
            .filter(|(_, place)| place.is_open)
            .map(|(i, place)| (VehicleId::at(i), place))
    }

    fn holders(&mut self) -> impl Iterator<Item = (VehicleId, &mut Holder)> {
        let places = self.places.iter_mut().enumerate();
        places.filter_map(|(i, place)| Some((VehicleId::at(i), place.holder.as_mut()?)))
    }

    /// The vehicles of the node with this ticket. Empty if the ticket is unknown or void.
    pub(super) fn vehicles_of(&self, ticket: u64) -> impl Iterator<Item = VehicleId> {
        let holds = move |place: &Place| {
            place
                .holder
                .as_ref()
                .is_some_and(|holder| holder.ticket == ticket)
        };
        self.open()
            .filter(move |(_, place)| holds(place))
            .map(|(vehicle, _)| vehicle)
    }

    /// The tickets of all nodes that hold a vehicle or may return to it.
    pub(super) fn tickets(&self) -> impl Iterator<Item = u64> {
        self.places
            .iter()
            .filter_map(|place| Some(place.holder.as_ref()?.ticket))
    }

    /// Marks the node with this ticket as present. Returns its vehicles that were lost and are
    /// back.
    pub(super) fn welcome_back(&mut self, ticket: u64) -> Vec<VehicleId> {
        let back = self
            .holders()
            .filter(|(_, holder)| holder.ticket == ticket && !holder.is_present);
        let back = back.map(|(vehicle, holder)| {
            holder.is_present = true;
            vehicle
        });
        back.collect()
    }

    /// Whether a message with this or a later number was accepted for a vehicle.
    pub(super) fn has_taken(&self, vehicle: VehicleId, seq: u64) -> bool {
        let holder = self.places[vehicle.index()].holder.as_ref();
        holder
            .and_then(|holder| holder.newest)
            .is_some_and(|newest| newest >= seq)
    }

    /// Records that a message with this number was accepted for a vehicle.
    pub(super) fn note_taken(&mut self, vehicle: VehicleId, seq: u64) {
        if let Some(holder) = &mut self.places[vehicle.index()].holder {
            holder.newest = Some(seq);
        }
    }

    /// Marks a node as absent. Returns its abandoned vehicles, to which it may return unless a
    /// different node takes them.
    pub fn gone(&mut self, node: &str) -> Vec<VehicleId> {
        // The node is identified by the link that zenoh reports as lost, not by a liveliness token,
        // which anyone could present in another node's name.
        self.lose(|holder| holder.node == node)
    }

    /// Marks all nodes that have not replied to `tick` as absent. Returns their abandoned vehicles.
    pub fn give_up(&mut self, tick: u64) -> Vec<VehicleId> {
        self.lose(|holder| holder.newest.is_none_or(|newest| newest < tick))
    }

    /// Marks the node that holds this vehicle as absent. Returns all vehicles that the node
    /// abandoned.
    pub fn lose_holder_of(&mut self, vehicle: VehicleId) -> Vec<VehicleId> {
        let ticket = self.places[vehicle.index()]
            .present()
            .map(|holder| holder.ticket);
        self.lose(|holder| Some(holder.ticket) == ticket)
    }

    fn lose(&mut self, is_lost: impl Fn(&Holder) -> bool) -> Vec<VehicleId> {
        let lost = self
            .holders()
            .filter(|(_, holder)| holder.is_present && is_lost(holder));
        let lost = lost.map(|(vehicle, holder)| {
            holder.is_present = false;
            vehicle
        });
        lost.collect()
    }

    /// Whether all present nodes have replied to `tick`.
    pub fn all_answered(&self, tick: u64) -> bool {
        let answered = |holder: &Holder| holder.newest.is_some_and(|newest| newest >= tick);
        self.places.iter().filter_map(Place::present).all(answered)
    }

    /// The open vehicles without a present node.
    pub fn vacant(&self) -> impl Iterator<Item = VehicleId> {
        self.open()
            .filter(|(_, place)| place.present().is_none())
            .map(|(vehicle, _)| vehicle)
    }

    /// Whether no node is present.
    pub fn is_empty(&self) -> bool {
        self.places.iter().all(|place| place.present().is_none())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::path::Path;

    /// Game time at which all nodes join.
    pub(in super::super) const NOW: SimTime = SimTime(100);

    /// A game of blue one, blue two, red one and red two. With `is_mixed`, blue one and red one are
    /// real boats.
    pub(in super::super) fn membership(role: Role, is_mixed: bool) -> Membership {
        let name = if is_mixed {
            "mixed_2v2"
        } else {
            "pav01_vs_pav01"
        };
        let game =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/games/{name}.toml"));
        Membership::new(
            &scenario::load(&game).unwrap_or_else(|e| panic!("{e}")),
            role,
        )
    }

    pub(in super::super) fn request(role: Role, node: &str, vehicles: &[&str]) -> JoinRequest {
        let vehicles = vehicles.iter().map(|name| (*name).to_owned()).collect();
        JoinRequest {
            version: primitives::VERSION.to_owned(),
            role,
            node: node.to_owned(),
            vehicles,
        }
    }

    pub(in super::super) fn granted(ticket: u64, vehicles: &[u16]) -> JoinReply {
        JoinReply::Granted {
            ticket,
            vehicles: vehicles.iter().map(|v| VehicleId(*v)).collect(),
            now_ns: NOW,
        }
    }

    const ROLES: [Role; 2] = [Role::Agent, Role::Gateway];

    #[test]
    fn who_joins_gets_what_it_names_in_its_order() {
        for role in ROLES {
            let mut all = membership(role, true);
            assert_eq!(
                all.join(&request(role, "a", &["red_one", "blue_one"]), 7, NOW),
                granted(7, &[2, 0])
            );
            let vacant: Vec<VehicleId> = all.vacant().collect();
            assert_eq!(
                vacant,
                if role == Role::Agent {
                    vec![VehicleId(1), VehicleId(3)]
                } else {
                    vec![]
                }
            );
            assert!(
                all.vehicles_of(7).eq([VehicleId(0), VehicleId(2)])
                    && all.vehicles_of(8).next().is_none()
            );
        }
    }

    #[test]
    fn a_vehicle_is_free_again_when_its_node_is_gone_and_the_old_ticket_is_void() {
        for role in ROLES {
            let mut all = membership(role, true);
            all.join(&request(role, "a", &["blue_one"]), 1, NOW);
            let busy = JoinReply::Busy {
                vehicle: "blue_one".to_owned(),
            };
            assert_eq!(all.join(&request(role, "b", &["blue_one"]), 2, NOW), busy);
            assert!(!all.is_empty() && all.gone("b").is_empty());
            assert_eq!(all.gone("a"), [VehicleId(0)]);
            assert!(all.is_empty() && all.gone("a").is_empty(), "once");
            assert_eq!(
                all.join(&request(role, "b", &["blue_one"]), 2, NOW),
                granted(2, &[0])
            );
            assert!(all.vehicles_of(1).next().is_none() && all.welcome_back(1).is_empty());
        }
    }

    #[test]
    fn a_node_that_speaks_or_asks_again_has_its_vehicle_again() {
        for role in ROLES {
            let mut all = membership(role, true);
            all.join(&request(role, "a", &["blue_one"]), 1, NOW);
            all.gone("a");
            assert_eq!(
                all.welcome_back(1),
                [VehicleId(0)],
                "no other node has taken it"
            );
            let busy = JoinReply::Busy {
                vehicle: "blue_one".to_owned(),
            };
            assert_eq!(all.join(&request(role, "b", &["blue_one"]), 2, NOW), busy);
            all.note_taken(VehicleId(0), 5);
            assert!(all.has_taken(VehicleId(0), 5) && !all.has_taken(VehicleId(0), 6));
            assert_eq!(
                all.join(&request(role, "a", &["blue_one"]), 3, NOW),
                granted(3, &[0]),
                "the reply was lost"
            );
            assert!(
                all.vehicles_of(1).next().is_none(),
                "the newer ticket counts"
            );
            assert!(
                !all.has_taken(VehicleId(0), 0),
                "its messages are counted from zero"
            );
        }
    }

    #[test]
    fn who_is_silent_is_given_up_with_all_its_vehicles() {
        let mut all = membership(Role::Agent, false);
        all.join(&request(Role::Agent, "a", &["blue_one", "red_two"]), 1, NOW);
        all.join(&request(Role::Agent, "b", &["red_one"]), 2, NOW);
        assert!(!all.all_answered(0));
        all.note_taken(VehicleId(2), 0);
        assert_eq!(all.give_up(0), [VehicleId(0), VehicleId(3)]);
        assert!(
            all.all_answered(0) && !all.all_answered(1),
            "a lost node is not awaited"
        );
        all.welcome_back(1);
        assert_eq!(
            all.lose_holder_of(VehicleId(3)),
            [VehicleId(0), VehicleId(3)]
        );
        assert_eq!(
            (
                all.lose_holder_of(VehicleId(3)),
                all.lose_holder_of(VehicleId(1))
            ),
            (vec![], vec![])
        );
    }

    #[test]
    fn a_refusal_says_why() {
        for (role, is_mixed, vehicles, why) in [
            (Role::Agent, true, &[][..], "the agent names no vehicle"),
            (
                Role::Agent,
                true,
                &["green_one"],
                "the vehicles are: blue_one, blue_two, red_one, red_two",
            ),
            (Role::Agent, true, &["blue_one", "blue_one"], "twice"),
            (Role::Gateway, true, &[], "the gateway names no vehicle"),
            (
                Role::Gateway,
                true,
                &["green_one"],
                "no vehicle named \"green_one\"; the external vehicles are: blue_one, red_one",
            ),
            (
                Role::Gateway,
                true,
                &["blue_one", "blue_two"],
                "blue_two is simulated in this game; the external vehicles are: blue_one,",
            ),
            (Role::Gateway, true, &["blue_one", "blue_one"], "twice"),
            (Role::Gateway, false, &["blue_one"], "or is a rehearsal"),
        ] {
            let mut all = membership(role, is_mixed);
            let reply = all.join(&request(role, "a", vehicles), 1, NOW);
            let JoinReply::Refused { reason } = reply else {
                panic!("{role} {vehicles:?} may join")
            };
            assert!(reason.contains(why), "{reason}");
            let other = JoinRequest {
                version: "0.0.1".to_owned(),
                ..request(role, "a", &["blue_one"])
            };
            let reply = all.join(&other, 1, NOW);
            assert!(
                matches!(&reply, JoinReply::Refused { reason } if reason.contains("0.0.1")),
                "{reply:?}"
            );
            assert!(all.is_empty());
        }
    }
}
