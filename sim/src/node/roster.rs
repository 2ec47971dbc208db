//! Who minds which boat: the door, the tickets, and what is accepted from whom.
//!
//! No network and no clock in here: the node tells it what came, and asks what follows.

use game::message::{JoinReply, JoinRequest, Orders};
use game::order::BadOrder;
use game::{Order, Scenario, VehicleId};
use serde::{Deserialize, Serialize};

/// Why something an agent sent was not obeyed, and how often.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refused {
    /// Bytes that are no orders.
    pub garbage: u64,
    /// Orders of another version of the message.
    pub version: u64,
    /// Orders with a ticket that nobody holds (any more).
    pub ticket: u64,
    /// Orders for a tick that is over, or still to come.
    pub wrong_tick: u64,
    /// An order for a vehicle that the agent does not mind.
    pub not_yours: u64,
    /// An order with numbers that are not finite or out of range, or of an unknown kind. The boat holds.
    pub bad_number: u64,
    /// A vehicle of its own that an agent gave no order for. The boat holds.
    pub missing: u64,
    /// Messages that came faster than they could be looked at.
    pub flood: u64,
}

impl Refused {
    /// How many there were in all.
    #[must_use]
    pub fn total(&self) -> u64 {
        let Refused { garbage, version, ticket, wrong_tick, not_yours, bad_number, missing, flood } = self;
        garbage + version + ticket + wrong_tick + not_yours + bad_number + missing + flood
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
pub struct Roster {
    names: Vec<String>,
    minders: Vec<Minder>,
    /// Index into `minders`, by vehicle.
    seats: Vec<Option<usize>>,
    timing: Timing,
    /// What was refused so far.
    pub refused: Refused,
}

impl Roster {
    /// The roster of a game that nobody has joined yet.
    #[must_use]
    pub fn new(scenario: &Scenario, timing: Timing) -> Roster {
        let names: Vec<String> = scenario.vehicles.iter().map(|vehicle| vehicle.name.clone()).collect();
        Roster { seats: vec![None; names.len()], names, minders: Vec::new(), timing, refused: Refused::default() }
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
        let (seq, minder) = (message.stamp.seq, &mut self.minders[m]);
        // A message with a good ticket shows that somebody is there, in time or not.
        if !std::mem::replace(&mut minder.present, true) {
            accepted.back.clone_from(&minder.vehicles);
        }
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
        for vehicle in &self.minders[m].vehicles {
            let mine = self.seats[vehicle.index()] == Some(m);
            if mine && !orders.iter().any(|(given, _)| given == vehicle) {
                self.refused.missing += 1;
                orders.push((*vehicle, Order::Hold));
            }
        }
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
    pub fn lose_minder_of(&mut self, vehicle: VehicleId) -> Vec<VehicleId> {
        let minder = self.seats[vehicle.index()].filter(|m| self.minders[*m].present);
        minder.map(|m| self.lose(m)).unwrap_or_default()
    }

    fn lose(&mut self, m: usize) -> Vec<VehicleId> {
        self.minders[m].present = false;
        let vehicles = self.minders[m].vehicles.iter().copied();
        vehicles.filter(|vehicle| self.seats[vehicle.index()] == Some(m)).collect()
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
