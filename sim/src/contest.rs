//! A game being played: the world, the orders in force, and everything that has happened.
//!
//! One decision goes: [`Contest::pictures`] to the minds, [`Contest::order`] from them,
//! [`Contest::advance`]. The network node and the in-process arena do just that and nothing else, so a
//! game is the same bytes in both.

use crate::external::{self, BadReport, Track};
use crate::hull::Planar;
use crate::radio::Radio;
use crate::sighting::Sightings;
use crate::view;
use crate::world::{NoStart, World};
use game::boat::Drive;
use game::event::Logged;
use game::input::Input;
use game::message::Frame;
use game::outcome::{Outcome, Played};
use game::picture::{Nav, OwnBoat};
use game::scenario::Source;
use game::{Event, Order, Picture, Scenario, SimTime, VehicleId};
use xxhash_rust::xxh3::Xxh3;

/// A game being played.
pub struct Contest {
    scenario: Scenario,
    world: World,
    /// In force, by vehicle.
    orders: Vec<Order>,
    /// When each vehicle last received an order.
    ordered_at: Vec<SimTime>,
    /// After how long without one each vehicle's thrusters stop.
    watchdogs: Vec<Option<SimTime>>,
    agent_lost: Vec<bool>,
    /// Whether all boats hold, by somebody ashore: for good, or for now.
    stopped: bool,
    halted: bool,
    /// The real boats, in order.
    tracks: Vec<Track>,
    radio: Option<Radio>,
    sightings: Option<Sightings>,
    /// What is known ashore of every boat, as of the last pictures.
    known: Vec<OwnBoat>,
    events: Vec<Logged>,
    /// Events that the last pictures and the last frame already told.
    pictured: usize,
    framed: usize,
    /// The decision that the pictures are of.
    pictured_for: Option<u64>,
    /// By team.
    pictures: Vec<Picture>,
    decision: u64,
    /// What was given since somebody last asked, where somebody wants to know.
    given: Option<Vec<Input>>,
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
        let known: Vec<OwnBoat> = (0..count).map(|i| view::own_boat(&world, i)).collect();
        Ok(Contest {
            radio: Radio::new(&scenario),
            sightings: Sightings::new(&scenario),
            known,
            world,
            orders: vec![Order::Hold; count],
            ordered_at: vec![SimTime::ZERO; count],
            watchdogs: (0..count).map(|i| watchdog(&scenario, VehicleId::at(i))).collect(),
            agent_lost: vec![false; count],
            stopped: false,
            halted: false,
            tracks: scenario.externals().map(Track::new).collect(),
            events: Vec::new(),
            pictured: 0,
            framed: 0,
            pictured_for: None,
            pictures: pictures.collect(),
            decision: 0,
            given: None,
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

    /// Orders in force, by vehicle: those that have arrived.
    #[must_use]
    pub fn orders(&self) -> &[Order] {
        &self.orders
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
        self.note(Input::Pictured);
        self.gather();
        let news = (self.decision, &self.events[self.pictured..]);
        for picture in &mut self.pictures {
            let known = (self.known.as_slice(), self.sightings.as_ref());
            view::picture(&self.scenario, &self.world, news, known, picture);
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
        let frame = self.frame_since(self.framed);
        self.framed = self.events.len();
        frame
    }

    /// The truth, with all events but so many, the first.
    ///
    /// # Panics
    /// If there are fewer.
    #[must_use]
    pub fn frame_since(&self, events: usize) -> Frame {
        let mut frame = view::frame(&self.world, self.decision, &self.events[events..]);
        for (truth, agent_lost) in frame.vehicles.iter_mut().zip(&self.agent_lost) {
            truth.agent_lost = *agent_lost;
        }
        for track in &self.tracks {
            frame.vehicles[track.vehicle.index()].nav_lost = track.is_lost(self.now());
        }
        frame.stopped = self.stopped || self.halted;
        frame
    }

    /// The pictures as [`Contest::pictures`] last made them.
    #[must_use]
    pub fn last_pictures(&self) -> &[Picture] {
        &self.pictures
    }

    /// From now on, keeps what it is given, for [`Contest::take_inputs`].
    pub fn keep_inputs(&mut self) {
        self.given.get_or_insert_default();
    }

    /// Everything that was given since this was asked last, in order.
    pub fn take_inputs(&mut self) -> Vec<Input> {
        self.given.as_mut().map(std::mem::take).unwrap_or_default()
    }

    fn note(&mut self, input: Input) {
        if let Some(given) = &mut self.given {
            given.push(input);
        }
    }

    /// Gives what was once given, as it is recorded.
    pub fn give(&mut self, input: Input) {
        match input {
            Input::Pictured => drop(self.pictures()),
            Input::Ordered { vehicle, order } => self.order(vehicle, order),
            Input::Held { vehicle } => self.hold(vehicle),
            Input::AgentLost { vehicle } => self.lose_agent(vehicle),
            Input::AgentBack { vehicle } => self.regain_agent(vehicle),
            // What was taken in then is taken in again.
            Input::Reported { vehicle, nav, fix_at, valid } => drop(self.report(vehicle, nav, fix_at, valid)),
            Input::EStopped(stopped) => self.e_stop(stopped),
            Input::Halted(halted) => self.halt(halted),
            Input::Played => self.advance(),
        }
    }

    /// Sends an order to a vehicle: it is in force from when it arrives until the next one does. To a real boat it goes
    /// over a real link, and none of ours.
    pub fn order(&mut self, vehicle: VehicleId, order: Order) {
        self.note(Input::Ordered { vehicle, order });
        let (i, now) = (vehicle.index(), self.now());
        let is_external = self.track(vehicle).is_some();
        match &mut self.radio {
            Some(radio) if !is_external => radio.send_order(i, order, self.world.state().boats[i].pose.at, now),
            _ => (self.orders[i], self.ordered_at[i]) = (order, now),
        }
    }

    /// The order in force for a vehicle, after what the rules make of it: driven home it is a course at the speed that
    /// they allow, and a limit of speed also scales thrust. A real boat holds while it is lost, while its mind is, and
    /// when the game is over: whatever the rules want of it, somebody must be looking.
    #[must_use]
    pub fn obeyed(&self, vehicle: VehicleId) -> Order {
        let is_lost = |track: &Track| track.is_lost(self.now()) || self.agent_lost[vehicle.index()] || self.is_over();
        if self.track(vehicle).is_some_and(is_lost) {
            return Order::Hold;
        }
        let speed_max_m_s = self.scenario.boat_of(vehicle).speed_max_m_s();
        match self.world.obeyed(vehicle, self.orders[vehicle.index()]) {
            (Order::Steer { heading_rad, speed_m_s }, factor) => {
                Order::Steer { heading_rad, speed_m_s: speed_m_s.min(factor * speed_max_m_s) }
            }
            (Order::Thrust { port, starboard }, factor) => {
                Order::Thrust { port: factor * port, starboard: factor * starboard }
            }
            (Order::Hold, _) => Order::Hold,
        }
    }

    /// Takes in where a real boat was at `fix_at`: at most a decision ahead of the game, since reports come while one is
    /// open. What its gateway calls not `valid` changes nothing.
    ///
    /// # Errors
    /// [`BadReport`] for numbers that no boat has, and for a simulated boat; nothing changes then.
    pub fn report(&mut self, vehicle: VehicleId, nav: Nav, fix_at: SimTime, valid: bool) -> Result<(), BadReport> {
        let now = self.now();
        let track = self.tracks.iter_mut().find(|track| track.vehicle == vehicle).ok_or(BadReport::Simulated)?;
        let nav = external::sound(nav)?;
        if valid {
            track.take(nav, fix_at.min(now + self.scenario.decision()));
            self.carry(vehicle);
        }
        self.note(Input::Reported { vehicle, nav, fix_at, valid });
        Ok(())
    }

    /// Whether a real boat has ever been heard of; a simulated one always is.
    #[must_use]
    pub fn is_heard(&self, vehicle: VehicleId) -> bool {
        self.track(vehicle).is_none_or(Track::is_heard)
    }

    fn track(&self, vehicle: VehicleId) -> Option<&Track> {
        self.tracks.iter().find(|track| track.vehicle == vehicle)
    }

    /// Puts a real boat where it is taken to be now.
    fn carry(&mut self, vehicle: VehicleId) {
        if let Some((pose, nu)) = self.track(vehicle).and_then(|track| track.under_way(self.now())) {
            self.world.set_under_way(vehicle, pose, nu);
        }
    }

    /// Real boats that have not been heard of for long stop, and are lost.
    fn watch_real_boats(&mut self) {
        let now = self.now();
        for i in 0..self.tracks.len() {
            let vehicle = self.tracks[i].vehicle;
            let stops = self.tracks[i].under_way(now).is_some_and(|(_, nu)| nu == Planar::default());
            if stops && self.world.state().boats[vehicle.index()].nu != Planar::default() {
                self.carry(vehicle);
            }
            if let Some(event) = self.tracks[i].news(now) {
                self.log(event);
            }
        }
    }

    /// Makes a vehicle hold at once, whatever it was told: nothing of it goes over the air, and orders under way do not
    /// arrive any more.
    pub fn hold(&mut self, vehicle: VehicleId) {
        self.note(Input::Held { vehicle });
        self.hold_now(vehicle);
    }

    fn hold_now(&mut self, vehicle: VehicleId) {
        self.orders[vehicle.index()] = Order::Hold;
        self.forget_orders(vehicle);
    }

    /// Orders under way to a vehicle do not arrive any more.
    fn forget_orders(&mut self, vehicle: VehicleId) {
        if let Some(radio) = &mut self.radio {
            radio.forget_orders(vehicle.index());
        }
    }

    /// Boats look round and report.
    fn gather(&mut self) {
        let (world, state, decision) = (&self.world, self.world.state(), self.decision);
        if let Some(sightings) = &mut self.sightings {
            let oldest = self.radio.as_ref().map_or(decision, Radio::oldest_report);
            let vehicles = self.scenario.vehicles.iter().enumerate();
            sightings.look(decision, oldest, vehicles.map(|(i, vehicle)| view::contact(state, i, vehicle.team)));
        }
        for (i, known) in self.known.iter_mut().enumerate() {
            let mut report = view::own_boat(world, i);
            let track = self.tracks.iter().find(|track| track.vehicle.index() == i);
            track.into_iter().for_each(|track| track.tell(&mut report));
            let mut take = |sent: u64| {
                if let Some(sightings) = &mut self.sightings {
                    sightings.take(i, sent);
                }
            };
            let Some(radio) = self.radio.as_mut().filter(|_| track.is_none()) else {
                take(decision);
                *known = report;
                continue;
            };
            radio.send_report(i, report, state.boats[i].pose.at, state.now);
            if let Some(newest) = radio.report(i, state.now, take) {
                *known = newest;
            }
        }
    }

    /// Orders arrive; boats that have had none for too long hold.
    fn deliver(&mut self) {
        let now = self.now();
        for (i, order) in self.orders.iter_mut().enumerate() {
            if let Some(arrived) = self.radio.as_mut().and_then(|radio| radio.order(i, now))
                && !self.agent_lost[i]
            {
                (*order, self.ordered_at[i]) = (arrived, now);
            }
            if self.watchdogs[i].is_some_and(|limit| now > self.ordered_at[i] + limit) {
                *order = Order::Hold;
            }
        }
    }

    /// Says that a vehicle's mind is lost: it holds as by [`Contest::hold`], and an event says so. Does nothing if it is
    /// lost already.
    pub fn lose_agent(&mut self, vehicle: VehicleId) {
        if !std::mem::replace(&mut self.agent_lost[vehicle.index()], true) {
            self.note(Input::AgentLost { vehicle });
            self.hold_now(vehicle);
            self.log(Event::AgentLost { vehicle });
        }
    }

    /// Says that a vehicle's mind is there again: what was sent before does not arrive. Does nothing if it was not lost.
    pub fn regain_agent(&mut self, vehicle: VehicleId) {
        if std::mem::replace(&mut self.agent_lost[vehicle.index()], false) {
            self.note(Input::AgentBack { vehicle });
            self.forget_orders(vehicle);
            self.log(Event::AgentBack { vehicle });
        }
    }

    /// Makes all boats hold, or lets them go on. Says so, if that is news.
    pub fn e_stop(&mut self, stopped: bool) {
        if std::mem::replace(&mut self.stopped, stopped) != stopped {
            self.note(Input::EStopped(stopped));
            self.world.halt(self.stopped || self.halted);
            self.log(if stopped { Event::EStopped } else { Event::Released });
        }
    }

    /// Makes all boats hold for now, or lets them go on where nobody has stopped them. Says so, if that is news.
    pub fn halt(&mut self, halted: bool) {
        if std::mem::replace(&mut self.halted, halted) != halted {
            self.note(Input::Halted(halted));
            self.world.halt(self.stopped || self.halted);
            self.log(if halted { Event::Halted } else { Event::WentOn });
        }
    }

    /// Plays until the next decision, or the end of the game.
    pub fn advance(&mut self) {
        for _ in 0..self.scenario.ticks_per_decision {
            if self.is_over() {
                break;
            }
            self.deliver();
            self.watch_real_boats();
            self.world.step(&self.orders);
            let (tick, at) = (self.world.state().tick, self.world.state().now);
            self.events.extend(self.world.events().iter().map(|event| Logged { tick, at, event: *event }));
        }
        self.decision += 1;
        self.note(Input::Played);
        if let Some(radio) = &mut self.radio {
            radio.open_next();
        }
    }

    /// 128 bits over the state and all events. Where a game has radio links, limits of sharing or command watchdogs, also
    /// over what is in force, under way and known, and where it has real boats, over their fixes: that is in no snapshot
    /// of the world.
    ///
    /// # Panics
    /// Never: plain numbers always encode.
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
        if self.radio.is_some() || self.sightings.is_some() || self.watchdogs.iter().any(Option::is_some) {
            let between = (&self.orders, &self.ordered_at, &self.known, &self.radio, &self.sightings);
            hash.update(&postcard::to_stdvec(&between).expect("plain numbers always encode"));
        }
        if !self.tracks.is_empty() {
            hash.update(&postcard::to_stdvec(&self.tracks).expect("plain numbers always encode"));
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

/// After how long without a new order a vehicle's thrusters stop.
fn watchdog(scenario: &Scenario, vehicle: VehicleId) -> Option<SimTime> {
    match &scenario.boat_of(vehicle).drive {
        // A real boat has one of its own.
        _ if scenario.vehicles[vehicle.index()].source == Source::External => None,
        Drive::Thrusters { thruster, .. } => thruster.flaws.watchdog_s.map(SimTime::from_s),
        Drive::Kinematic(_) => None,
    }
}
