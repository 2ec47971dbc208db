//! A game being played: the world, the orders in force, and everything that has happened.
//!
//! One decision goes: [`Contest::pictures`] to the minds, [`Contest::order`] from them,
//! [`Contest::advance`]. The network node and the in-process arena do just that and nothing else, so a
//! game is the same bytes in both.

use crate::view;
use crate::world::{NoStart, World};
use game::event::Logged;
use game::message::Frame;
use game::outcome::{Outcome, Played};
use game::{Event, Order, Picture, Scenario, SimTime, VehicleId};
use xxhash_rust::xxh3::Xxh3;

/// A game being played.
pub struct Contest {
    scenario: Scenario,
    world: World,
    /// In force, by vehicle.
    orders: Vec<Order>,
    mind_lost: Vec<bool>,
    events: Vec<Logged>,
    /// Events that the last pictures and the last frame already told.
    pictured: usize,
    framed: usize,
    /// The decision that the pictures are of.
    pictured_for: Option<u64>,
    /// By team.
    pictures: Vec<Picture>,
    decision: u64,
}

impl Contest {
    /// The game of `scenario` that `seed` chooses, at its start.
    ///
    /// # Errors
    /// [`NoStart`] where the boats do not fit into their spawn area, or numbers drawn by lot do not go together.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Contest, NoStart> {
        let scenario = scenario.of_seed(seed)?;
        let world = World::new(&scenario, seed)?;
        let count = scenario.vehicles.len();
        let pictures = (0..scenario.teams.len()).map(|team| Picture { team: team as u8, ..Picture::default() });
        Ok(Contest {
            world,
            orders: vec![Order::Hold; count],
            mind_lost: vec![false; count],
            events: Vec::new(),
            pictured: 0,
            framed: 0,
            pictured_for: None,
            pictures: pictures.collect(),
            decision: 0,
            scenario,
        })
    }

    /// What is played, with the seed of this game.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The decision tick that is open.
    #[must_use]
    pub fn decision(&self) -> u64 {
        self.decision
    }

    /// Simulated time.
    #[must_use]
    pub fn now(&self) -> SimTime {
        self.world.state().now
    }

    /// Whether the game is over.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.world.state().standing.over
    }

    /// Points, by team.
    #[must_use]
    pub fn score(&self) -> &[u32] {
        &self.world.state().standing.score
    }

    /// Everything that has happened so far.
    #[must_use]
    pub fn events(&self) -> &[Logged] {
        &self.events
    }

    /// What each team knows at the open decision, by team: the same whenever it is asked. Each event is told in
    /// one decision's pictures.
    pub fn pictures(&mut self) -> &[Picture] {
        if self.pictured_for == Some(self.decision) {
            return &self.pictures;
        }
        self.pictured_for = Some(self.decision);
        let news = &self.events[self.pictured..];
        for picture in &mut self.pictures {
            view::picture(&self.scenario, self.world.state(), self.decision, news, picture);
        }
        self.pictured = self.events.len();
        &self.pictures
    }

    /// The picture of a vehicle's team, as [`Contest::pictures`] last made it.
    #[must_use]
    pub fn picture_of(&self, vehicle: VehicleId) -> &Picture {
        &self.pictures[self.scenario.vehicles[vehicle.index()].team.index()]
    }

    /// The truth, with the events since the last frame.
    pub fn frame(&mut self) -> Frame {
        let frame = view::frame(self.world.state(), self.decision, &self.events[self.framed..], &self.mind_lost);
        self.framed = self.events.len();
        frame
    }

    /// Puts an order in force until the next one for this vehicle.
    pub fn order(&mut self, vehicle: VehicleId, order: Order) {
        self.orders[vehicle.index()] = order;
    }

    /// Says that a vehicle's mind is lost: it holds, and an event says so. Does nothing if it is lost already.
    pub fn lose_mind(&mut self, vehicle: VehicleId) {
        if !std::mem::replace(&mut self.mind_lost[vehicle.index()], true) {
            self.orders[vehicle.index()] = Order::Hold;
            self.log(Event::MindLost { vehicle });
        }
    }

    /// Says that a vehicle's mind is there again. Does nothing if it was not lost.
    pub fn regain_mind(&mut self, vehicle: VehicleId) {
        if std::mem::replace(&mut self.mind_lost[vehicle.index()], false) {
            self.log(Event::MindBack { vehicle });
        }
    }

    /// Plays until the next decision, or the end of the game.
    pub fn advance(&mut self) {
        for _ in 0..self.scenario.ticks_per_decision {
            if self.is_over() {
                break;
            }
            self.world.step(&self.orders);
            let (tick, at) = (self.world.state().tick, self.world.state().now);
            self.events.extend(self.world.events().iter().map(|event| Logged { tick, at, event: *event }));
        }
        self.decision += 1;
    }

    /// 128 bits over the state and all events.
    #[must_use]
    pub fn digest(&self) -> u128 {
        let mut hash = Xxh3::new();
        hash.update(&self.world.digest().to_le_bytes());
        for logged in &self.events {
            let record = game::message::EventRecord::from(*logged);
            hash.update(&record.tick.to_le_bytes());
            hash.update(&[record.kind]);
            hash.update(&record.subject.to_le_bytes());
            hash.update(&record.object.to_le_bytes());
        }
        hash.digest128()
    }

    /// How the game stands or ended.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome::new(&Played {
            scenario: &self.scenario,
            digest: self.digest(),
            ticks: self.world.state().tick,
            score: self.score(),
            events: &self.events,
        })
    }

    fn log(&mut self, event: Event) {
        let state = self.world.state();
        self.events.push(Logged { tick: state.tick, at: state.now, event });
    }
}
