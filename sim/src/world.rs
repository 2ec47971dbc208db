//! The world: boats, water, contact and the referee, one tick at a time.

use crate::contact::Displacement;
use crate::hull::Planar;
use crate::model::Model;
use crate::motion::{Forcing, Motion};
use crate::sea::{Attitude, SeaNow};
use crate::sensor::{Reading, Truth};
use crate::spawn::{self, SpawnError};
use crate::state::{BoatState, RestoreError, State};
use game::frame::{self, Ned, Rotation};
use game::near::{Near, Pair};
use game::rules::{Notes, Referee};
use game::scenario::{Problems, RealBoats};
use game::stream::Stream;
use game::{Event, Order, Pose, Scenario, SimTime, VehicleId, math};
use thiserror::Error;

/// No boat is faster than this over the ground, m/s; one that is has bad numbers.
const ABSURD_M_S: f64 = 1_000.0;

/// A game's world.
#[derive(Clone)]
pub struct World {
    model: Model,
    state: State,
    work: Work,
    /// Whether all boats hold, whatever they are told: an E-stop, which is no part of the game.
    halted: bool,
}

/// Why a game cannot start.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoStart {
    /// The boats do not fit into their spawn area.
    #[error(transparent)]
    SpawnError(#[from] SpawnError),
    /// The numbers drawn for this seed are each allowed, but not together.
    #[error("what was drawn for this seed does not go together\n{0}")]
    Draw(#[from] Problems),
    /// The game has real boats, and is to be played without a clock.
    #[error(transparent)]
    RealBoats(#[from] RealBoats),
}

/// Memory that is used again every tick; all of it follows from the state.
#[derive(Clone, Default)]
struct Work {
    near: Near,
    /// By vehicle: the rotation of its heading.
    rotations: Vec<Rotation>,
    /// What moves each boat, and how it moves by that alone.
    forcings: Vec<Forcing>,
    currents_m_s: Vec<Ned>,
    motions: Vec<Motion>,
    /// Motion over the tick, by vehicle.
    displacements: Vec<Displacement>,
    /// Velocity over the ground at the end of the tick without contact, by vehicle.
    velocities: Vec<Planar>,
    pairs: Vec<Pair>,
    notes: Notes,
    events: Vec<Event>,
}

impl World {
    /// The world of this scenario at the start of the game that `seed` chooses.
    ///
    /// # Errors
    /// [`NoStart`] where the boats do not fit into their spawn area, or numbers drawn by lot do not go together.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<World, NoStart> {
        let scenario = scenario.of_seed(seed)?;
        let model = Model::new(&scenario, seed);
        let boats =
            spawn::start_positions(&scenario, seed)?.into_iter().map(|pose| BoatState { pose, ..BoatState::default() });
        let mut state = State {
            tick: 0,
            now: SimTime::ZERO,
            boats: boats.collect(),
            flaws: model.flaws_at_start(),
            points: vec![],
            senses: vec![],
            standing: model.referee.start(&mut Stream::new(seed, "power_play")),
        };
        state.points = model.points_at_start(&state.boats);
        state.senses = model.senses_at_start();
        let mut world = World { model, state, work: Work::default(), halted: false };
        world.refresh();
        world.sense();
        Ok(world)
    }

    /// Moves the world on by one tick. `orders` are by vehicle; what happened comes back.
    ///
    /// # Panics
    /// If there is not one order for each vehicle.
    pub fn step(&mut self, orders: &[Order]) -> &[Event] {
        assert_eq!(orders.len(), self.state.boats.len(), "one order a vehicle");
        self.work.events.clear();
        self.model.sea.prepare(self.state.now);
        self.drive(orders);
        self.model.contact.resolve(&self.model.hulls, &mut self.work.displacements, &self.work.pairs);
        self.settle();
        self.state.tick += 1;
        self.state.now = self.state.now + self.model.tick;
        self.find_pairs();
        self.judge();
        self.keep_out();
        self.sense();
        &self.work.events
    }

    /// What the last step brought.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.work.events
    }

    /// What changes, for reading.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The referee.
    #[must_use]
    pub fn referee(&self) -> &Referee {
        &self.model.referee
    }

    /// The state as bytes; [`World::restore`] takes them back. They hold the world alone: no orders in force, no messages
    /// under way, no sightings, no events of the last step.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        self.state.snapshot(self.model.scenario_mark)
    }

    /// Goes back (or on) to the state in a snapshot of the same scenario.
    ///
    /// # Errors
    /// [`RestoreError`] says what is wrong with the bytes; the world stays as it was.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), RestoreError> {
        self.state = State::from_snapshot(snapshot, self.model.scenario_mark)?;
        self.refresh();
        Ok(())
    }

    /// Puts a boat there, moving over the ground like this (body axes), its thrusters as they are: somebody outside says so.
    ///
    /// # Panics
    /// If there is no such vehicle.
    pub fn set_under_way(&mut self, vehicle: VehicleId, pose: Pose, nu: Planar) {
        let boat = &mut self.state.boats[vehicle.index()];
        (boat.pose, boat.nu) = (pose, nu);
        self.refresh();
    }

    /// Makes all boats hold, driven home or not, until they no longer must.
    pub fn halt(&mut self, halted: bool) {
        self.halted = halted;
    }

    /// 128 bits that differ when any bit of the state differs: of what [`World::snapshot`] holds.
    #[must_use]
    pub fn digest(&self) -> u128 {
        self.state.digest()
    }

    /// What a vehicle is to do by the rules, given an order, and the share of its top speed that it may use; being
    /// driven home is a course at any speed.
    #[must_use]
    pub fn obeyed(&self, vehicle: VehicleId, order: Order) -> (Order, f64) {
        let i = vehicle.index();
        if self.halted {
            return (Order::Hold, 1.0);
        }
        self.model.obeyed(&self.state.standing, i, self.state.boats[i].pose.at, order)
    }

    /// The sea now.
    #[must_use]
    pub fn sea(&self) -> SeaNow<'_> {
        self.model.sea.at_time(self.state.now)
    }

    /// What a vehicle's sensors tell it; `None` is all of the truth.
    #[must_use]
    pub fn reading(&self, vehicle: VehicleId) -> Option<&Reading> {
        let place = self.model.sensed[vehicle.index()].as_ref().map(|(place, _)| *place)?;
        Some(&self.state.senses[place].1)
    }

    /// What is true of a vehicle, as far as sensors feel it.
    #[must_use]
    pub fn truth(&self, vehicle: VehicleId) -> Truth {
        let i = vehicle.index();
        self.model.truth(i, &self.state.boats[i], self.work.rotations[i], &self.sea())
    }

    /// How a vehicle lies in the waves.
    #[must_use]
    pub fn attitude(&self, vehicle: VehicleId) -> Attitude {
        let i = vehicle.index();
        self.model.attitude(i, &self.state.boats[i], self.work.rotations[i], &self.sea())
    }

    /// Hands boats to rapier that are as far as `close_m` from anything. Slower, and the same bytes.
    #[doc(hidden)]
    pub fn widen_contact(&mut self, close_m: f64) {
        self.model.contact.widen(close_m);
        self.find_pairs();
    }

    /// Makes what follows from the state follow from it.
    fn refresh(&mut self) {
        self.work.rotations.clear();
        self.work.rotations.extend(self.state.boats.iter().map(|boat| boat.pose.rotation()));
        self.find_pairs();
    }

    fn find_pairs(&mut self) {
        let reach_m = self.model.contact.reach_m().max(self.model.referee.reach_m());
        let boats = &self.state.boats;
        let pairs = self.work.near.pairs(|i| boats[i].pose.at, boats.len(), reach_m);
        self.work.pairs.clear();
        self.work.pairs.extend_from_slice(pairs);
    }

    /// Every boat's motion over the tick as if it were alone.
    fn drive(&mut self, orders: &[Order]) {
        let World { model, state, work, halted } = self;
        let obeyed = |standing: &_, i: usize, at, order| {
            if *halted { (Order::Hold, 1.0) } else { model.obeyed(standing, i, at, order) }
        };
        let sea = model.sea.at_time(state.now);
        work.forcings.clear();
        work.currents_m_s.clear();
        for (i, boat) in state.boats.iter_mut().enumerate() {
            let order = obeyed(&state.standing, i, boat.pose.at, orders[i]);
            let heading = (work.rotations[i], model.heading_error_rad(i, &state.senses));
            let (forcing, current_m_s) = model.forcing(i, boat, &mut state.flaws[i], heading, order, &sea);
            work.forcings.push(forcing);
            work.currents_m_s.push(current_m_s);
        }
        model.fleet.advance(&work.forcings, model.dt_s, model.sea.is_uniform(), &mut work.motions);
        work.displacements.clear();
        work.velocities.clear();
        for (i, boat) in state.boats.iter().enumerate() {
            let (displacement, nu) = match model.point(i) {
                _ if model.is_external(i) => model.carried_displacement(i, boat, work.rotations[i]),
                Some((place, point)) if !boat.quarantined => {
                    let order = obeyed(&state.standing, i, boat.pose.at, orders[i]);
                    let drift_m_s = sea.current_at(boat.pose.at);
                    model.point_displacement(i, boat, (point, &mut state.points[place]), order, drift_m_s)
                }
                _ => model.displacement(
                    i,
                    boat,
                    work.rotations[i],
                    &work.forcings[i],
                    &work.motions[i],
                    work.currents_m_s[i],
                ),
            };
            work.displacements.push(displacement);
            work.velocities.push(nu);
        }
    }

    /// The boats take up the motion, with what contact changed in it. Bad numbers are contained here.
    fn settle(&mut self) {
        let World { model, state, work, .. } = self;
        let sea = model.sea.at_time(state.now);
        for (i, boat) in state.boats.iter_mut().enumerate() {
            let (displacement, mut nu) = (&work.displacements[i], work.velocities[i]);
            nu = nu.plus(1.0, displacement.velocity_change);
            if is_sound(displacement.to, nu) {
                boat.nu_change = nu.plus(-1.0, boat.nu);
                (boat.pose, boat.nu, work.rotations[i]) = (displacement.to, nu, displacement.rotation_to);
                if let (Some((place, _)), true) = (model.point(i), displacement.velocity_change != Planar::default()) {
                    // Its own speed is through the water.
                    let drift = frame::body_from_ned(displacement.rotation_to, sea.current_at(displacement.from.at));
                    state.points[place].divert(boat.pose.psi_rad, boat.nu.surge - drift.ahead);
                }
            } else if !boat.quarantined {
                *boat = BoatState { pose: boat.pose, quarantined: true, ..BoatState::default() };
                work.events.push(Event::Quarantined { vehicle: VehicleId::at(i) });
                model.referee.retire(&mut state.standing, VehicleId::at(i), &mut work.events);
            }
        }
    }

    /// Boats that came too near their own flag, as the referee has seen, are set back onto the circle and lose their
    /// way inward.
    fn keep_out(&mut self) {
        if self.model.referee.rules().flag_keepout_m <= 0.0 {
            return;
        }
        let World { model, state, work, .. } = self;
        let mut moved = false;
        for i in 0..state.boats.len() {
            let keepout = model.referee.keepout(&state.standing, VehicleId::at(i), state.boats[i].pose.at);
            // A real boat is where it is.
            let Some((centre, radius_m)) = keepout.filter(|_| !model.is_external(i)) else { continue };
            let boat = &mut state.boats[i];
            let from_centre = boat.pose.at - centre;
            let distance_m = from_centre.length();
            if distance_m >= radius_m || distance_m == 0.0 {
                continue;
            }
            let out = from_centre.scaled(1.0 / distance_m);
            boat.pose.at = centre + out.scaled(radius_m);
            let out_in_body = frame::body_from_ned(work.rotations[i], out);
            let inward_m_s = (out_in_body.ahead * boat.nu.surge + out_in_body.starboard * boat.nu.sway).min(0.0);
            boat.nu.surge -= inward_m_s * out_in_body.ahead;
            boat.nu.sway -= inward_m_s * out_in_body.starboard;
            moved = true;
        }
        if moved {
            self.find_pairs();
        }
    }

    /// Sensors read, if minds decide now.
    fn sense(&mut self) {
        let World { model, state, work, .. } = self;
        if state.senses.is_empty() || !state.tick.is_multiple_of(model.ticks_per_decision) {
            return;
        }
        let sea = model.sea.at_time(state.now);
        for (i, boat) in state.boats.iter().enumerate() {
            let Some((place, sensors)) = &model.sensed[i] else { continue };
            let truth = model.truth(i, boat, work.rotations[i], &sea);
            let (memory, reading) = &mut state.senses[*place];
            *reading = sensors.read(memory, &truth, state.now);
        }
    }

    fn judge(&mut self) {
        let World { model, state, work, .. } = self;
        let boats = &state.boats;
        let at = |i: usize| boats[i].pose.at;
        model.referee.advance(&mut state.standing, &mut work.notes, &at, &work.pairs, state.now, &mut work.events);
    }
}

#[inline]
fn is_sound(pose: Pose, nu: Planar) -> bool {
    // A NaN fails every comparison.
    pose.at.is_finite()
        && pose.psi_rad.is_finite()
        && nu.yaw.is_finite()
        && math::length(nu.surge, nu.sway) < ABSURD_M_S
}
