//! A running game: the world, the referee, the orders in force and all events.
//!
//! In each decision, agents receive [`Contest::pictures`] and reply with [`Contest::order`]; then
//! [`Contest::advance`] plays the ticks. The network node and the in-process arena do nothing else,
//! so a game is bit-identical in both. The world is physics alone; [`Contest::effective_command`]
//! decides what a boat does in a tick.

mod ask;
mod faults;
mod order;
mod snapshot;
mod state;

pub use snapshot::RestoreError;

use crate::external::{self, BadReport, Track};
use crate::hull::Planar;
use crate::radio::Radio;
use crate::sighting::Sightings;
use crate::spawn::NoStart;
use crate::view::Scene;
use crate::world::World;
use ask::asks_of;
use messages::input::Input;
use messages::picture::Nav;
use messages::{Frame, Order, Picture};
use primitives::stream::Stream;
use primitives::{Leg, SimTime, VehicleId};
use rules::event::{EventCursor, Logged};
use rules::{Acting, Asks, Event, Look, Notes, Referee};
use scenario::boat::Drive;
use scenario::fault::FaultSpan;
use scenario::outcome::Outcome;
use scenario::{Scenario, Source};
use state::{ContestState, OrderInForce};
use std::sync::Arc;

/// A running game. A clone continues independently.
#[derive(Clone)]
pub struct Contest {
    scenario: Arc<Scenario>,
    referee: Referee,
    /// By vehicle index: time without an order after which the thrusters stop.
    watchdogs: Vec<Option<SimTime>>,
    world: World,
    radio: Option<Radio>,
    /// By vehicle index: fault spans of agent and link.
    faults: Vec<Vec<FaultSpan>>,
    sightings: Option<Sightings>,
    state: ContestState,
    work: Work,
    /// Identifies the game in snapshots.
    scenario_mark: u64,
    /// Inputs since the last [`Contest::take_inputs`], if they are kept.
    given: Option<Vec<Input>>,
}

/// Memory reused every tick, with no state between ticks.
#[derive(Clone, Default)]
struct Work {
    commands: Vec<Order>,
    legs: Vec<Leg>,
    asks: Vec<Asks>,
    notes: Notes,
    events: Vec<Event>,
}

impl Contest {
    /// The game of `scenario` with this seed, before its first tick.
    ///
    /// # Errors
    /// [`NoStart`] if the boats do not fit into their spawn area, or the randomised values are
    /// inconsistent.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Contest, NoStart> {
        let scenario = scenario.of_seed(seed)?;
        let world = World::of_game(&scenario, seed)?;
        let team_of = scenario
            .vehicles
            .iter()
            .map(|vehicle| vehicle.team)
            .collect();
        let referee = Referee {
            rules: scenario.rules.clone(),
            field: scenario.field.clone(),
            team_of,
            joins: scenario.vehicles.iter().map(|boat| boat.joins).collect(),
            tag_noise: scenario.seeds().noise("tags"),
        };
        let standing = referee.start(&mut Stream::new(seed, "power_play"));
        let count = scenario.vehicles.len();
        let scene = Scene {
            scenario: &scenario,
            world: &world,
            standing: &standing,
            decision: 0,
        };
        let known = (0..count).map(|i| scene.own_boat(i)).collect();
        let pictures = (0..scenario.teams.len()).map(|team| Picture {
            team: team as u8,
            ..Picture::default()
        });
        let is_external = |source| source == Source::External;
        let state = ContestState {
            decision: 0,
            standing,
            orders: vec![OrderInForce::default(); count],
            stations: vec![None; count],
            agent_lost: vec![false; count],
            e_stopped: false,
            halted: false,
            tracks: scenario
                .vehicles
                .iter()
                .map(|v| is_external(v.source).then(Track::default))
                .collect(),
            known,
            events: Vec::new(),
            pictured: EventCursor::default(),
            pictured_for: None,
            pictures: pictures.collect(),
        };
        Ok(Contest {
            radio: Radio::new(&scenario),
            faults: (0..count)
                .map(|i| faults::of(&scenario, VehicleId::at(i)))
                .collect(),
            sightings: Sightings::new(&scenario),
            watchdogs: (0..count)
                .map(|i| watchdog(&scenario, VehicleId::at(i)))
                .collect(),
            referee,
            world,
            state,
            work: Work::default(),
            scenario_mark: snapshot::mark(&scenario),
            given: None,
            scenario: Arc::new(scenario),
        })
    }

    /// The scenario, with the seed of this game.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// A new game of `scenario` with this seed. An E-stop or halt of the current game stays in
    /// force.
    ///
    /// # Errors
    /// As for [`Contest::new`].
    pub fn restarted(&self, scenario: &Scenario, seed: u64) -> Result<Contest, NoStart> {
        let mut next = Contest::new(scenario, seed)?;
        next.e_stop(self.state.e_stopped);
        next.halt(self.state.halted);
        Ok(next)
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The number of the open decision.
    pub fn decision(&self) -> u64 {
        self.state.decision
    }

    /// Simulated time.
    pub fn now(&self) -> SimTime {
        self.world.state().now
    }

    /// Whether the game is over.
    pub fn is_over(&self) -> bool {
        self.state.standing.over
    }

    /// Points, by team index.
    pub fn score(&self) -> &[u32] {
        &self.state.standing.score
    }

    /// All events so far.
    pub fn events(&self) -> &[Logged] {
        &self.state.events
    }

    /// Each team's picture for the open decision, by team index. Repeated calls return the same
    /// pictures. Each event is in the pictures of exactly one decision.
    pub fn pictures(&mut self) -> &[Picture] {
        if self.state.pictured_for != Some(self.state.decision) {
            // Built once per decision, because building draws noise and reads events: an agent that
            // receives a picture twice must get the same bytes.
            self.state.pictured_for = Some(self.state.decision);
            self.note(Input::Pictured);
            self.gather();
            let Contest {
                scenario,
                world,
                sightings,
                state,
                ..
            } = self;
            let ContestState {
                standing,
                decision,
                known,
                events,
                pictured,
                pictures,
                ..
            } = state;
            let scene = Scene {
                scenario,
                world,
                standing,
                decision: *decision,
            };
            let new = pictured.read(events);
            for picture in pictures {
                scene.picture(known, sightings.as_ref(), new, picture);
            }
        }
        &self.state.pictures
    }

    /// The pictures last built by [`Contest::pictures`].
    pub fn last_pictures(&self) -> &[Picture] {
        &self.state.pictures
    }

    /// The picture of a vehicle's team last built by [`Contest::pictures`].
    pub fn picture_of(&self, vehicle: VehicleId) -> &Picture {
        &self.state.pictures[self.scenario.team_of(vehicle).index()]
    }

    /// The true state, with the events since `cursor`.
    pub fn frame(&self, cursor: &mut EventCursor) -> Frame {
        let ContestState {
            standing,
            decision,
            events,
            ..
        } = &self.state;
        let scene = Scene {
            scenario: &self.scenario,
            world: &self.world,
            standing,
            decision: *decision,
        };
        let mut frame = scene.frame(cursor.read(events));
        for (i, truth) in frame.vehicles.iter_mut().enumerate() {
            truth.agent_lost = self.state.agent_lost[i];
            truth.nav_lost = self.state.tracks[i]
                .as_ref()
                .is_some_and(|track| track.is_lost(self.now()));
        }
        frame.stopped = self.state.e_stopped || self.state.halted;
        frame
    }

    /// Keeps inputs from now on, for [`Contest::take_inputs`].
    pub fn keep_inputs(&mut self) {
        self.given.get_or_insert_default();
    }

    /// All inputs since the last call, in order.
    pub fn take_inputs(&mut self) -> Vec<Input> {
        self.given.as_mut().map(std::mem::take).unwrap_or_default()
    }

    fn note(&mut self, input: Input) {
        if let Some(given) = &mut self.given {
            given.push(input);
        }
    }

    /// Applies a recorded input. An input that was refused when it was recorded is refused again.
    pub fn give(&mut self, input: Input) {
        match input {
            Input::Pictured => drop(self.pictures()),
            Input::Ordered {
                vehicle,
                order,
                given_at,
            } => drop(self.order(vehicle, order, given_at)),
            Input::Held(vehicle) => self.hold(vehicle),
            Input::AgentLost(vehicle) => self.lose_agent(vehicle),
            Input::AgentBack(vehicle) => self.regain_agent(vehicle),
            Input::Reported {
                vehicle,
                nav,
                fix_at,
                valid,
            } => drop(self.report(vehicle, nav, fix_at, valid)),
            Input::EStopped(stopped) => self.e_stop(stopped),
            Input::Halted(halted) => self.halt(halted),
            // Advancing is an input like any other: in a replay, the order of inputs and ticks must
            // not depend on clocks.
            Input::Played => self.advance(),
        }
    }

    /// Updates a real boat's navigation from a fix at `fix_at`. Reports arrive while a decision is
    /// open, so the fix may be up to one decision ahead; a later time is reduced to that. A report
    /// that is not `valid` changes no position.
    ///
    /// # Errors
    /// [`BadReport`] for implausible numbers and simulated boats; nothing changes then.
    pub fn report(
        &mut self,
        vehicle: VehicleId,
        nav: Nav,
        fix_at: SimTime,
        valid: bool,
    ) -> Result<(), BadReport> {
        let now = self.now();
        let track = self.state.tracks[vehicle.index()]
            .as_mut()
            .ok_or(BadReport::Simulated)?;
        let nav = external::sound(nav)?;
        // Record an invalid report, too: it shows that the gateway is present.
        if valid {
            track.update(nav, fix_at.min(now + self.scenario.decision()));
            let estimate = track.estimate(now);
            estimate
                .into_iter()
                .for_each(|(pose, nu)| self.world.set_under_way(vehicle, pose, nu));
        }
        self.note(Input::Reported {
            vehicle,
            nav,
            fix_at,
            valid,
        });
        Ok(())
    }

    /// Whether a boat's position has ever been known: always for a simulated boat, from its first
    /// report for a real one.
    pub fn has_position(&self, vehicle: VehicleId) -> bool {
        self.state.tracks[vehicle.index()]
            .as_ref()
            .is_none_or(Track::has_fix)
    }

    /// Marks real boats without a recent fix as lost; they stay at rest.
    fn watch_real_boats(&mut self) {
        let now = self.now();
        for i in 0..self.state.tracks.len() {
            let (vehicle, Some(track)) = (VehicleId::at(i), &mut self.state.tracks[i]) else {
                continue;
            };
            let estimate = track.estimate(now);
            let event = track.event(vehicle, now);
            if let Some((pose, nu)) = estimate.filter(|(_, nu)| *nu == Planar::default())
                && self.world.state().boats[i].nu != nu
            {
                self.world.set_under_way(vehicle, pose, nu);
            }
            event.into_iter().for_each(|event| self.log(event));
        }
    }

    /// Updates the knowledge on shore from the boats' reports and sightings.
    fn gather(&mut self) {
        let Contest {
            scenario,
            world,
            radio,
            sightings,
            state,
            faults,
            ..
        } = self;
        let ContestState {
            standing,
            decision,
            known,
            tracks,
            ..
        } = state;
        let decision = *decision;
        let now = world.state().now;
        let scene = Scene {
            scenario,
            world,
            standing,
            decision,
        };
        if let Some(sightings) = sightings {
            let oldest = radio.as_ref().map_or(decision, Radio::oldest_report);
            sightings.record_truth(
                decision,
                oldest,
                (0..tracks.len()).map(|i| scene.contact(i)),
            );
        }
        for (i, (known, track)) in known.iter_mut().zip(tracks).enumerate() {
            // While its agent or link is silent, a boat sends no data.
            if faults::is_silent(&faults[i], now) {
                continue;
            }
            let mut report = scene.own_boat(i);
            let mut take = |sent: u64| {
                if let Some(sightings) = sightings {
                    sightings.show_sightings(i, sent);
                }
            };
            match (radio.as_mut(), track) {
                // A real boat has a real radio.
                (Some(radio), None) => {
                    radio.send_report(i, report, world.state().boats[i].pose.at, now);
                    if let Some(newest) = radio.report(i, now, take) {
                        *known = newest;
                    }
                }
                (_, track) => {
                    if let Some(track) = track {
                        track.put_fix(&mut report);
                    }
                    take(decision);
                    *known = report;
                }
            }
        }
    }

    /// Marks a vehicle's agent as lost, with an event; the vehicle holds, as with
    /// [`Contest::hold`]. No effect if it is already lost.
    pub fn lose_agent(&mut self, vehicle: VehicleId) {
        if !std::mem::replace(&mut self.state.agent_lost[vehicle.index()], true) {
            self.note(Input::AgentLost(vehicle));
            self.hold_now(vehicle.index());
            self.log(Event::AgentLost(vehicle));
        }
    }

    /// Marks a lost agent as back and cancels orders in transit. No effect if it was not lost.
    pub fn regain_agent(&mut self, vehicle: VehicleId) {
        if std::mem::replace(&mut self.state.agent_lost[vehicle.index()], false) {
            self.note(Input::AgentBack(vehicle));
            self.recall_orders(vehicle.index());
            self.log(Event::AgentBack(vehicle));
        }
    }

    /// Sets or releases the E-stop for all boats, with an event if the state changes.
    pub fn e_stop(&mut self, stopped: bool) {
        if std::mem::replace(&mut self.state.e_stopped, stopped) != stopped {
            self.note(Input::EStopped(stopped));
            self.log(if stopped {
                Event::EStopped
            } else {
                Event::Released
            });
        }
    }

    /// Orders all boats to hold, or ends the hold (but not an E-stop), with an event if the state
    /// changes.
    pub fn halt(&mut self, halted: bool) {
        if std::mem::replace(&mut self.state.halted, halted) != halted {
            self.note(Input::Halted(halted));
            self.log(if halted { Event::Halted } else { Event::WentOn });
        }
    }

    /// Advances to the next decision or the end of the game.
    pub fn advance(&mut self) {
        // Expire orders once per decision, before any tick: if they expired within a decision, the
        // game would depend on the time of this check.
        self.expire_orders();
        self.hear_requests();
        for _ in 0..self.scenario.ticks_per_decision {
            if self.is_over() {
                break;
            }
            // The order matters: a fault silences an agent before its orders arrive, and real boats
            // take their reported positions before anything moves.
            self.begin_and_end_faults();
            self.deliver_orders();
            self.watch_real_boats();
            self.step();
        }
        self.state.decision += 1;
        self.note(Input::Played);
        if let Some(radio) = &mut self.radio {
            radio.open_next();
        }
        // Checked once per decision, so that a broken invariant stops the game close to its cause.
        self.assert_sound();
    }

    /// Collects the boats' requests to the referee for this decision, based on their teams' last
    /// pictures.
    fn hear_requests(&mut self) {
        let Contest {
            scenario,
            state,
            work: Work { asks, .. },
            ..
        } = self;
        if scenario.rules.tags_and_grabs == Acting::Automatic {
            return;
        }
        asks.clear();
        asks.resize(scenario.vehicles.len(), Asks::default());
        for picture in &state.pictures {
            asks_of(&scenario.rules, &scenario.field, picture)
                .for_each(|(vehicle, ask)| asks[vehicle.index()] = ask);
        }
    }

    /// Plays one tick: boats move, the referee acts, and boats in a keep-out circle are set back.
    fn step(&mut self) {
        self.update_stations();
        let mut commands = std::mem::take(&mut self.work.commands);
        commands.clear();
        commands
            .extend((0..self.state.orders.len()).map(|i| self.effective_command(VehicleId::at(i))));
        let Contest {
            scenario,
            referee,
            world,
            state,
            work:
                Work {
                    notes,
                    events,
                    legs,
                    asks,
                    ..
                },
            ..
        } = self;
        let standing = &mut state.standing;
        events.clear();
        // A boat with a non-finite state is taken out of play here, in the tick of the failure; all
        // others continue.
        for vehicle in world.step(&commands) {
            events.push(Event::Quarantined(*vehicle));
            referee.retire(standing, *vehicle, events);
        }
        let now = world.state().now;
        legs.clear();
        legs.extend((0..commands.len()).map(|i| world.leg(VehicleId::at(i))));
        referee.advance(
            standing,
            notes,
            &Look {
                legs,
                asks,
                near: world.pairs(),
                now,
            },
            events,
        );
        // Set boats back after the referee, which would otherwise never see a boat enter a keep-out
        // circle.
        world.set_back(|vehicle, at| referee.keepout(standing, vehicle, at));
        let tick = world.state().tick;
        // Read the sensors only before decisions, because no one uses them in between.
        if tick.is_multiple_of(u64::from(scenario.ticks_per_decision)) {
            world.read_sensors();
        }
        state.events.extend(events.iter().map(|event| Logged {
            tick,
            at: now,
            event: *event,
        }));
        self.work.commands = commands;
    }

    /// The outcome so far.
    ///
    /// # Panics
    /// If the score differs from the sum over the events.
    pub fn outcome(&self) -> Outcome {
        self.assert_score();
        Outcome::new(
            &self.scenario,
            self.digest(),
            self.world.state().tick,
            self.score(),
            &self.state.events,
        )
    }

    fn log(&mut self, event: Event) {
        let state = self.world.state();
        self.state.events.push(Logged {
            tick: state.tick,
            at: state.now,
            event,
        });
    }
}

/// Time without a new order after which a vehicle's thrusters stop.
fn watchdog(scenario: &Scenario, vehicle: VehicleId) -> Option<SimTime> {
    match &scenario.boat_of(vehicle).drive {
        // A real boat has its own watchdog.
        _ if scenario.vehicles[vehicle.index()].source == Source::External => None,
        Drive::Thrusters { thruster, .. } => thruster.flaws.watchdog_s.map(SimTime::from_s),
        Drive::Kinematic(_) => None,
    }
}
