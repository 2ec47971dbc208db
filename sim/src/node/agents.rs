//! Who minds which boat: the door, the tickets, and what is accepted from whom.
//!
//! No network and no clock in here: the node tells it what came, and asks what follows.

use game::message::{JoinReply, JoinRequest, Orders};
use game::order::BadOrder;
use game::{Order, Scenario, VehicleId};
use serde::{Deserialize, Serialize};

/// Why something an agent or a gateway sent was not heeded, and how often.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refused {
    /// Bytes that are no orders, or no report.
    pub garbage: u64,
    /// Orders or reports of another version of the message.
    pub version: u64,
    /// Orders or reports with a ticket that nobody holds (any more).
    pub ticket: u64,
    /// Orders for a tick that is over, or still to come; reports that came after a later one.
    pub wrong_tick: u64,
    /// An order for a vehicle that the agent does not mind, or a report of one that the gateway did not bring.
    pub not_yours: u64,
    /// An order with numbers that are not finite or out of range, or of an unknown kind: the boat holds. A report with
    /// numbers that no boat has.
    pub bad_number: u64,
    /// A vehicle of its own that an agent gave no order for. The boat holds.
    pub missing: u64,
    /// Wishes of people that the game cannot follow: another speed with real boats, a step of a game that goes on.
    #[serde(default)]
    pub out_of_place: u64,
    /// Messages that came faster than they could be looked at.
    pub flood: u64,
}

impl Refused {
    /// How many there were in all.
    #[must_use]
    pub fn total(&self) -> u64 {
        let Refused { garbage, version, ticket, wrong_tick, not_yours, bad_number, missing, out_of_place, flood } =
            self;
        garbage + version + ticket + wrong_tick + not_yours + bad_number + missing + out_of_place + flood
    }
}

impl std::ops::Add for Refused {
    type Output = Refused;
    fn add(self, other: Refused) -> Refused {
        Refused {
            garbage: self.garbage + other.garbage,
            version: self.version + other.version,
            ticket: self.ticket + other.ticket,
            wrong_tick: self.wrong_tick + other.wrong_tick,
            not_yours: self.not_yours + other.not_yours,
            bad_number: self.bad_number + other.bad_number,
            missing: self.missing + other.missing,
            out_of_place: self.out_of_place + other.out_of_place,
            flood: self.flood + other.flood,
        }
    }
}

/// An agent process that was let in.
#[derive(Clone, Debug)]
struct Minder {
    agent: String,
    ticket: u64,
    vehicles: Vec<VehicleId>,
    /// Whether we count on it: it has not died or fallen silent.
    present: bool,
    /// The newest tick it answered.
    answered: Option<u64>,
}

/// Which orders are in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timing {
    /// Those for the open tick.
    Lockstep,
    /// Those for the open tick or one before, as long as no newer one came.
    Realtime,
}

/// What an agent's orders come to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accepted {
    /// The orders to put in force.
    pub orders: Vec<(VehicleId, Order)>,
    /// Vehicles whose mind was lost and is there again.
    pub back: Vec<VehicleId>,
}

/// Who minds which boat.
pub struct Agents {
    names: Vec<String>,
    minders: Vec<Minder>,
    /// Index into `minders`, by vehicle.
    seats: Vec<Option<usize>>,
    timing: Timing,
    /// What was refused so far.
    pub refused: Refused,
}

impl Agents {
    /// The agents of a game that nobody has joined yet.
    #[must_use]
    pub fn new(scenario: &Scenario, timing: Timing) -> Agents {
        let names: Vec<String> = scenario.vehicles.iter().map(|vehicle| vehicle.name.clone()).collect();
        Agents { seats: vec![None; names.len()], names, minders: Vec::new(), timing, refused: Refused::default() }
    }

    /// Lets an agent in, or not. `ticket` is what it will have to show.
    pub fn join(&mut self, request: &JoinRequest, ticket: u64) -> JoinReply {
        let refused = |reason: String| JoinReply::Refused { reason };
        if request.version != game::VERSION {
            return refused(format!(
                "the agent is Squall {}, the sim is Squall {}: use the same version",
                request.version,
                game::VERSION
            ));
        }
        if request.vehicles.is_empty() {
            return refused("the agent names no vehicle".to_owned());
        }
        let mut vehicles = Vec::new();
        for name in &request.vehicles {
            let Some(i) = self.names.iter().position(|known| known == name) else {
                return refused(format!("there is no vehicle {name:?}; there are {}", self.names.join(", ")));
            };
            if self.minder_of(i).is_some_and(|minder| minder.present) {
                return JoinReply::Busy { vehicle: name.clone() };
            }
            if vehicles.contains(&VehicleId::at(i)) {
                return refused(format!("the agent names {name:?} twice"));
            }
            vehicles.push(VehicleId::at(i));
        }
        for vehicle in &vehicles {
            self.seats[vehicle.index()] = Some(self.minders.len());
        }
        let agent = request.agent.clone();
        self.minders.push(Minder { agent, ticket, vehicles: vehicles.clone(), present: true, answered: None });
        JoinReply::Granted { ticket, vehicles }
    }

    /// Takes an agent's orders while `tick` is open.
    pub fn take(&mut self, message: &Orders, tick: u64) -> Accepted {
        let mut accepted = Accepted::default();
        let Some(m) = self.minders.iter().position(|minder| minder.ticket == message.ticket) else {
            self.refused.ticket += 1;
            return accepted;
        };
        // A message with a good ticket shows that somebody is there, in time or not.
        if !std::mem::replace(&mut self.minders[m].present, true) {
            accepted.back = self.seated(m).collect();
        }
        let (seq, minder) = (message.stamp.seq, &mut self.minders[m]);
        let known = minder.answered.is_some_and(|answered| answered >= seq);
        let in_time = seq == tick || (self.timing == Timing::Realtime && seq < tick);
        if known {
            return accepted;
        }
        if !in_time {
            self.refused.wrong_tick += 1;
            return accepted;
        }
        minder.answered = Some(seq);
        self.read(m, message, &mut accepted.orders);
        accepted
    }

    /// One order for each of the minder's vehicles; the safe one where there is no good one.
    fn read(&mut self, m: usize, message: &Orders, orders: &mut Vec<(VehicleId, Order)>) {
        for item in &message.orders {
            let held = self.seats.get(item.vehicle.index()).copied().flatten();
            if held != Some(m) {
                self.refused.not_yours += 1;
                continue;
            }
            let order = item.order().ok_or(BadOrder::OutOfRange).and_then(Order::check);
            self.refused.bad_number += u64::from(order.is_err());
            orders.push((item.vehicle, order.unwrap_or_default()));
        }
        let given = |vehicle: &VehicleId| orders.iter().any(|(given, _)| given == vehicle);
        let missing: Vec<VehicleId> = self.seated(m).filter(|vehicle| !given(vehicle)).collect();
        self.refused.missing += missing.len() as u64;
        orders.extend(missing.into_iter().map(|vehicle| (vehicle, Order::Hold)));
    }

    /// The vehicles that a minder still minds: nobody has taken them on since.
    fn seated(&self, m: usize) -> impl Iterator<Item = VehicleId> {
        self.minders[m].vehicles.iter().copied().filter(move |vehicle| self.seats[vehicle.index()] == Some(m))
    }

    /// An agent process died: the vehicles it leaves behind.
    pub fn gone(&mut self, agent: &str) -> Vec<VehicleId> {
        let at_seat = |minder: &Minder| minder.agent == agent;
        let lost: Vec<usize> = (0..self.minders.len()).filter(|m| at_seat(&self.minders[*m])).collect();
        lost.into_iter().flat_map(|m| self.lose(m)).collect()
    }

    /// Gives up on everybody who has not answered `tick`: the vehicles they leave behind.
    pub fn give_up(&mut self, tick: u64) -> Vec<VehicleId> {
        let silent = |minder: &Minder| minder.present && minder.answered.is_none_or(|answered| answered < tick);
        let silent: Vec<usize> = (0..self.minders.len()).filter(|m| silent(&self.minders[*m])).collect();
        silent.into_iter().flat_map(|m| self.lose(m)).collect()
    }

    /// Gives up on the agent that minds this vehicle: all the vehicles it leaves behind.
    pub fn lose_agent_of(&mut self, vehicle: VehicleId) -> Vec<VehicleId> {
        let minder = self.seats[vehicle.index()].filter(|m| self.minders[*m].present);
        minder.map(|m| self.lose(m)).unwrap_or_default()
    }

    fn lose(&mut self, m: usize) -> Vec<VehicleId> {
        self.minders[m].present = false;
        self.seated(m).collect()
    }

    /// Whether everybody we count on has answered `tick`.
    #[must_use]
    pub fn all_answered(&self, tick: u64) -> bool {
        let seated = |m: usize| self.seats.contains(&Some(m));
        let owing = |minder: &Minder| minder.present && minder.answered.is_none_or(|answered| answered < tick);
        !self.minders.iter().enumerate().any(|(m, minder)| owing(minder) && seated(m))
    }

    /// The vehicles that nobody minds, by name.
    #[must_use]
    pub fn mindless(&self) -> Vec<VehicleId> {
        let empty = |i: &usize| !self.minder_of(*i).is_some_and(|minder| minder.present);
        (0..self.names.len()).filter(empty).map(VehicleId::at).collect()
    }

    /// How many agent processes are in the game.
    #[must_use]
    pub fn present(&self) -> usize {
        self.minders.iter().filter(|minder| minder.present).count()
    }

    fn minder_of(&self, vehicle: usize) -> Option<&Minder> {
        self.seats[vehicle].map(|m| &self.minders[m])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::message::{Message, Stamp, VehicleOrder};
    use std::path::Path;

    fn agents(timing: Timing) -> Agents {
        let game = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
        Agents::new(&game::scenario::load(&game).unwrap_or_else(|e| panic!("{e}")), timing)
    }

    fn ask(agent: &str, vehicles: &[&str]) -> JoinRequest {
        let vehicles = vehicles.iter().map(|name| (*name).to_owned()).collect();
        JoinRequest { version: game::VERSION.to_owned(), agent: agent.to_owned(), vehicles }
    }

    fn orders(ticket: u64, seq: u64, vehicles: &[u16]) -> Orders {
        let order = |v: &u16| VehicleOrder::new(VehicleId(*v), Order::Thrust { port: 1.0, starboard: 1.0 });
        let stamp = Stamp { seq, version: Orders::VERSION, ..Stamp::default() };
        Orders { stamp, ticket, orders: vehicles.iter().map(order).collect() }
    }

    fn is_granted(reply: &JoinReply) -> bool {
        matches!(reply, JoinReply::Granted { .. })
    }

    #[test]
    fn a_tick_is_complete_when_everybody_who_is_there_has_answered() {
        let mut agents = agents(Timing::Lockstep);
        assert!(is_granted(&agents.join(&ask("a", &["blue_one", "blue_two"]), 1)));
        assert!(is_granted(&agents.join(&ask("b", &["red_one"]), 2)));
        assert_eq!(agents.mindless(), [VehicleId(3)]);
        assert!(!agents.all_answered(0));
        assert_eq!(agents.take(&orders(1, 0, &[0, 1]), 0).orders.len(), 2);
        assert!(!agents.all_answered(0));
        agents.take(&orders(2, 0, &[2]), 0);
        assert!(agents.all_answered(0) && !agents.all_answered(1));
        assert_eq!(agents.refused.total(), 0);
    }

    #[test]
    fn an_answer_that_comes_twice_is_taken_once_and_not_refused() {
        let mut agents = agents(Timing::Lockstep);
        agents.join(&ask("a", &["blue_one"]), 1);
        assert_eq!(agents.take(&orders(1, 0, &[0]), 0).orders.len(), 1);
        assert_eq!(agents.take(&orders(1, 0, &[0]), 0), Accepted::default());
        assert_eq!(agents.refused.total(), 0);
    }

    #[test]
    fn old_orders_are_for_real_time_only_and_orders_to_come_for_nobody() {
        for (timing, seq, accepted, refused) in [
            (Timing::Lockstep, 4, 0, 1),
            (Timing::Realtime, 4, 1, 0),
            (Timing::Lockstep, 6, 0, 1),
            (Timing::Realtime, 6, 0, 1),
            (Timing::Lockstep, 5, 1, 0),
        ] {
            let mut agents = agents(timing);
            agents.join(&ask("a", &["blue_one"]), 1);
            assert_eq!(agents.take(&orders(1, seq, &[0]), 5).orders.len(), accepted, "{timing:?} {seq}");
            assert_eq!(agents.refused.wrong_tick, refused, "{timing:?} {seq}");
        }
    }

    #[test]
    fn a_seat_is_free_again_when_its_minder_is_lost_and_the_old_one_has_no_say() {
        let mut agents = agents(Timing::Lockstep);
        agents.join(&ask("a", &["blue_one"]), 1);
        assert_eq!(agents.join(&ask("b", &["blue_one"]), 2), JoinReply::Busy { vehicle: "blue_one".to_owned() });
        assert_eq!(agents.give_up(0), [VehicleId(0)]);
        assert!(agents.all_answered(0), "nobody is waited for");
        assert!(is_granted(&agents.join(&ask("b", &["blue_one"]), 2)));
        let late = agents.take(&orders(1, 0, &[0]), 0);
        assert_eq!(late, Accepted::default(), "the seat is b's");
        assert_eq!(agents.refused.not_yours, 1);
        assert!(!agents.all_answered(0), "b is waited for, a is not");
        agents.take(&orders(2, 0, &[0]), 0);
        assert!(agents.all_answered(0));
    }

    #[test]
    fn a_lost_minder_that_speaks_again_is_back() {
        let mut agents = agents(Timing::Lockstep);
        agents.join(&ask("a", &["blue_one"]), 1);
        assert_eq!(agents.gone("a"), [VehicleId(0)]);
        let late = agents.take(&orders(1, 0, &[0]), 9);
        assert_eq!((late.back, late.orders.len()), (vec![VehicleId(0)], 0));
        assert!(!agents.all_answered(9), "and waited for again");
    }

    #[test]
    fn the_door_says_why_it_stays_shut() {
        let mut agents = agents(Timing::Lockstep);
        let other = JoinRequest { version: "0.0.1".to_owned(), ..ask("a", &["blue_one"]) };
        for (request, why) in [
            (other, "0.0.1"),
            (ask("a", &[]), "names no vehicle"),
            (ask("a", &["green_one"]), "blue_one, blue_two, red_one, red_two"),
            (ask("a", &["blue_one", "blue_one"]), "twice"),
        ] {
            let JoinReply::Refused { reason } = agents.join(&request, 1) else { panic!("{request:?} is let in") };
            assert!(reason.contains(why), "{reason}");
        }
        assert_eq!(agents.present(), 0);
    }
}
