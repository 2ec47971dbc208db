//! Who has joined a game: agents that decide for vehicles, gateways that connect real boats. One list for each role.
//!
//! A node that joins gets a ticket, and shows it with every message. No network and no clock in here: the server passes
//! in what came, and does what follows.

use messages::{JoinReply, JoinRequest, Role};
use primitives::{SimTime, VehicleId};
use scenario::{Scenario, Source};

/// The nodes that have joined in one role.
#[derive(Clone, Debug)]
pub struct Membership {
    role: Role,
    /// By vehicle.
    places: Vec<Place>,
}

/// A vehicle that nodes can join with.
#[derive(Clone, Debug)]
struct Place {
    name: String,
    /// Whether nodes of this role may have it: gateways connect real boats only.
    is_open: bool,
    holder: Option<Holder>,
}

/// The node that joined with a vehicle last.
#[derive(Clone, Debug)]
struct Holder {
    node: String,
    ticket: u64,
    /// Whether we count on it: it has not died or fallen silent.
    is_present: bool,
    /// The number of the newest message that was taken from it.
    newest: Option<u64>,
}

impl Place {
    fn present(&self) -> Option<&Holder> {
        self.holder.as_ref().filter(|holder| holder.is_present)
    }
}

impl Membership {
    /// That of a game that nobody has joined yet.
    #[must_use]
    pub fn new(scenario: &Scenario, role: Role) -> Membership {
        let places = scenario.vehicles.iter().map(|vehicle| Place {
            name: vehicle.name.clone(),
            is_open: role == Role::Agent || vehicle.source == Source::External,
            holder: None,
        });
        Membership { role, places: places.collect() }
    }

    /// Lets a node join at this time of the game, or not. `ticket` is what it will have to show.
    ///
    /// A node that asks again for what it has gets it again, with the new ticket: the answer was lost on the way.
    pub fn join(&mut self, request: &JoinRequest, ticket: u64, now: SimTime) -> JoinReply {
        let role = self.role;
        let refused = |reason: String| JoinReply::Refused { reason };
        // Exactly the same: two versions may agree on messages and differ in a rounding, and
        // then in the game.
        if request.version != primitives::VERSION {
            let (theirs, ours) = (&request.version, primitives::VERSION);
            return refused(format!("the {role} is Squall {theirs}, the sim is Squall {ours}: use the same version"));
        }
        // Nobody can have joined with nothing: lockstep would wait for a node that has nothing
        // to answer.
        if request.vehicles.is_empty() {
            return refused(format!("the {role} names no vehicle"));
        }
        let mut vehicles = Vec::new();
        for name in &request.vehicles {
            let Some(i) = self.places.iter().position(|place| place.name == *name) else {
                return refused(format!("there is no vehicle {name:?}; {}", self.on_offer()));
            };
            let place = &self.places[i];
            if !place.is_open {
                return refused(format!("{name} is simulated in this game; {}", self.on_offer()));
            }
            if place.present().is_some_and(|holder| holder.node != request.node) {
                return JoinReply::Busy { vehicle: name.clone() };
            }
            // A name given twice is a slip of the command line, and the count of boats would be
            // wrong.
            if vehicles.contains(&VehicleId::at(i)) {
                return refused(format!("the {role} names {name:?} twice"));
            }
            vehicles.push(VehicleId::at(i));
        }
        for vehicle in &vehicles {
            // A new ticket voids the old one, so that an agent that was taken for dead cannot
            // steer beside its successor.
            let holder = Holder { node: request.node.clone(), ticket, is_present: true, newest: None };
            self.places[vehicle.index()].holder = Some(holder);
        }
        JoinReply::Granted { ticket, vehicles, now_ns: now }
    }

    /// Which vehicles nodes can join with, in words.
    fn on_offer(&self) -> String {
        let names: Vec<&str> = self.open().map(|(_, place)| place.name.as_str()).collect();
        match (self.role, names.is_empty()) {
            (Role::Agent, _) => format!("there are {}", names.join(", ")),
            (Role::Gateway, false) => format!("external is {}", names.join(", ")),
            (Role::Gateway, true) => "no vehicle is external: the game has none, or is a rehearsal".to_owned(),
        }
    }

    fn open(&self) -> impl Iterator<Item = (VehicleId, &Place)> {
        self.places.iter().enumerate().filter(|(_, place)| place.is_open).map(|(i, place)| (VehicleId::at(i), place))
    }

    fn holders(&mut self) -> impl Iterator<Item = (VehicleId, &mut Holder)> {
        let places = self.places.iter_mut().enumerate();
        places.filter_map(|(i, place)| Some((VehicleId::at(i), place.holder.as_mut()?)))
    }

    /// The vehicles of whoever shows this ticket; none if nobody holds it (any more).
    pub(super) fn vehicles_of(&self, ticket: u64) -> impl Iterator<Item = VehicleId> {
        let holds = move |place: &Place| place.holder.as_ref().is_some_and(|holder| holder.ticket == ticket);
        self.open().filter(move |(_, place)| holds(place)).map(|(vehicle, _)| vehicle)
    }

    /// The tickets of whoever has a vehicle, or may come back to it.
    pub(super) fn tickets(&self) -> impl Iterator<Item = u64> {
        self.places.iter().filter_map(|place| Some(place.holder.as_ref()?.ticket))
    }

    /// A message with a ticket shows that somebody is there: the vehicles whose node was lost and is there again.
    pub(super) fn welcome_back(&mut self, ticket: u64) -> Vec<VehicleId> {
        let back = self.holders().filter(|(_, holder)| holder.ticket == ticket && !holder.is_present);
        let back = back.map(|(vehicle, holder)| {
            holder.is_present = true;
            vehicle
        });
        back.collect()
    }

    /// Whether a message of this number, or a newer one, was taken for a vehicle.
    pub(super) fn has_taken(&self, vehicle: VehicleId, seq: u64) -> bool {
        let holder = self.places[vehicle.index()].holder.as_ref();
        holder.and_then(|holder| holder.newest).is_some_and(|newest| newest >= seq)
    }

    /// A message of this number was taken for a vehicle.
    pub(super) fn note_taken(&mut self, vehicle: VehicleId, seq: u64) {
        if let Some(holder) = &mut self.places[vehicle.index()].holder {
            holder.newest = Some(seq);
        }
    }

    /// A node is gone: the vehicles it leaves behind. It may come back to those that nobody else takes.
    pub fn gone(&mut self, node: &str) -> Vec<VehicleId> {
        // By the link that zenoh says is gone, not by a liveliness token: anybody could show
        // one in another's name.
        self.lose(|holder| holder.node == node)
    }

    /// Gives up on everybody who has not answered `tick`: the vehicles they leave behind.
    pub fn give_up(&mut self, tick: u64) -> Vec<VehicleId> {
        self.lose(|holder| holder.newest.is_none_or(|newest| newest < tick))
    }

    /// Gives up on the node that has this vehicle: all the vehicles it leaves behind.
    pub fn lose_holder_of(&mut self, vehicle: VehicleId) -> Vec<VehicleId> {
        let ticket = self.places[vehicle.index()].present().map(|holder| holder.ticket);
        self.lose(|holder| Some(holder.ticket) == ticket)
    }

    fn lose(&mut self, is_lost: impl Fn(&Holder) -> bool) -> Vec<VehicleId> {
        let lost = self.holders().filter(|(_, holder)| holder.is_present && is_lost(holder));
        let lost = lost.map(|(vehicle, holder)| {
            holder.is_present = false;
            vehicle
        });
        lost.collect()
    }

    /// Whether everybody we count on has answered `tick`.
    #[must_use]
    pub fn all_answered(&self, tick: u64) -> bool {
        let answered = |holder: &Holder| holder.newest.is_some_and(|newest| newest >= tick);
        self.places.iter().filter_map(Place::present).all(answered)
    }

    /// The vehicles that nodes may have, and no present one has.
    pub fn vacant(&self) -> impl Iterator<Item = VehicleId> {
        self.open().filter(|(_, place)| place.present().is_none()).map(|(vehicle, _)| vehicle)
    }

    /// Whether nobody is there.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.iter().all(|place| place.present().is_none())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::path::Path;

    /// Time of the game at which everybody joins.
    pub(in super::super) const NOW: SimTime = SimTime(100);

    /// A game of blue one, blue two, red one and red two, of which blue one and red one are real boats; or none is.
    pub(in super::super) fn membership(role: Role, is_mixed: bool) -> Membership {
        let name = if is_mixed { "mixed_2v2" } else { "pav01_vs_pav01" };
        let game = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/games/{name}.toml"));
        Membership::new(&scenario::load(&game).unwrap_or_else(|e| panic!("{e}")), role)
    }

    pub(in super::super) fn request(role: Role, node: &str, vehicles: &[&str]) -> JoinRequest {
        let vehicles = vehicles.iter().map(|name| (*name).to_owned()).collect();
        JoinRequest { version: primitives::VERSION.to_owned(), role, node: node.to_owned(), vehicles }
    }

    pub(in super::super) fn granted(ticket: u64, vehicles: &[u16]) -> JoinReply {
        JoinReply::Granted { ticket, vehicles: vehicles.iter().map(|v| VehicleId(*v)).collect(), now_ns: NOW }
    }

    const ROLES: [Role; 2] = [Role::Agent, Role::Gateway];

    #[test]
    fn who_joins_gets_what_it_names_in_its_order() {
        for role in ROLES {
            let mut all = membership(role, true);
            assert_eq!(all.join(&request(role, "a", &["red_one", "blue_one"]), 7, NOW), granted(7, &[2, 0]));
            let vacant: Vec<VehicleId> = all.vacant().collect();
            assert_eq!(vacant, if role == Role::Agent { vec![VehicleId(1), VehicleId(3)] } else { vec![] });
            assert!(all.vehicles_of(7).eq([VehicleId(0), VehicleId(2)]) && all.vehicles_of(8).next().is_none());
        }
    }

    #[test]
    fn a_vehicle_is_free_again_when_its_node_is_gone_and_the_old_ticket_is_void() {
        for role in ROLES {
            let mut all = membership(role, true);
            all.join(&request(role, "a", &["blue_one"]), 1, NOW);
            let busy = JoinReply::Busy { vehicle: "blue_one".to_owned() };
            assert_eq!(all.join(&request(role, "b", &["blue_one"]), 2, NOW), busy);
            assert!(!all.is_empty() && all.gone("b").is_empty());
            assert_eq!(all.gone("a"), [VehicleId(0)]);
            assert!(all.is_empty() && all.gone("a").is_empty(), "once");
            assert_eq!(all.join(&request(role, "b", &["blue_one"]), 2, NOW), granted(2, &[0]));
            assert!(all.vehicles_of(1).next().is_none() && all.welcome_back(1).is_empty());
        }
    }

    #[test]
    fn a_node_that_speaks_or_asks_again_has_its_vehicle_again() {
        for role in ROLES {
            let mut all = membership(role, true);
            all.join(&request(role, "a", &["blue_one"]), 1, NOW);
            all.gone("a");
            assert_eq!(all.welcome_back(1), [VehicleId(0)], "nobody has taken it");
            let busy = JoinReply::Busy { vehicle: "blue_one".to_owned() };
            assert_eq!(all.join(&request(role, "b", &["blue_one"]), 2, NOW), busy);
            all.note_taken(VehicleId(0), 5);
            assert!(all.has_taken(VehicleId(0), 5) && !all.has_taken(VehicleId(0), 6));
            assert_eq!(all.join(&request(role, "a", &["blue_one"]), 3, NOW), granted(3, &[0]), "the answer was lost");
            assert!(all.vehicles_of(1).next().is_none(), "the newer ticket counts");
            assert!(!all.has_taken(VehicleId(0), 0), "and its messages count anew");
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
        assert!(all.all_answered(0) && !all.all_answered(1), "who is lost is not waited for");
        all.welcome_back(1);
        assert_eq!(all.lose_holder_of(VehicleId(3)), [VehicleId(0), VehicleId(3)]);
        assert_eq!((all.lose_holder_of(VehicleId(3)), all.lose_holder_of(VehicleId(1))), (vec![], vec![]));
    }

    #[test]
    fn a_refusal_says_why() {
        for (role, is_mixed, vehicles, why) in [
            (Role::Agent, true, &[][..], "the agent names no vehicle"),
            (Role::Agent, true, &["green_one"], "there are blue_one, blue_two, red_one, red_two"),
            (Role::Agent, true, &["blue_one", "blue_one"], "twice"),
            (Role::Gateway, true, &[], "the gateway names no vehicle"),
            (Role::Gateway, true, &["green_one"], "no vehicle \"green_one\"; external is blue_one, red_one"),
            (
                Role::Gateway,
                true,
                &["blue_one", "blue_two"],
                "blue_two is simulated in this game; external is blue_one,",
            ),
            (Role::Gateway, true, &["blue_one", "blue_one"], "twice"),
            (Role::Gateway, false, &["blue_one"], "or is a rehearsal"),
        ] {
            let mut all = membership(role, is_mixed);
            let reply = all.join(&request(role, "a", vehicles), 1, NOW);
            let JoinReply::Refused { reason } = reply else { panic!("{role} {vehicles:?} may join") };
            assert!(reason.contains(why), "{reason}");
            let other = JoinRequest { version: "0.0.1".to_owned(), ..request(role, "a", &["blue_one"]) };
            let reply = all.join(&other, 1, NOW);
            assert!(matches!(&reply, JoinReply::Refused { reason } if reason.contains("0.0.1")), "{reply:?}");
            assert!(all.is_empty());
        }
    }
}
