//! The world: boats in water and their contacts, tick by tick, independent of the game.

use crate::contact::Displacement;
use crate::external;
use crate::hull::Planar;
use crate::model::Model;
use crate::motion::{Forcing, Motion};
use crate::sea::SeaNow;
use crate::sensor::{Reading, Truth};
use crate::spawn::{self, NoStart};
use crate::state::{BoatState, State};
use messages::Order;
use primitives::frame::{self, Leg, Ned, Rotation};
use primitives::instructions::Instructions;
use primitives::near::{Near, Pair};
use primitives::reseed::Seeds;
use primitives::{Pose, SimTime, VehicleId, math};
use rules::{Contact, Field};
use scenario::fault::{FaultSpan, fault_spans};
use scenario::sea::Sea;
use scenario::{Boat, Scenario, Source};

/// Maximum speed over the ground, m/s; a faster boat has an invalid state.
// Far above the speed of any boat, and far below the overflow of squares.
const ABSURD_M_S: f64 = 1_000.0;

/// Distance beyond the radius to which Pyquaticus sets boats back, m.
const POINT_BOAT_SPARE_M: f64 = 0.1;

/// Boats in water.
#[derive(Clone)]
pub struct World {
    model: Model,
    state: State,
    work: Work,
}

/// The data from which a world is created.
#[derive(Clone, Debug)]
pub struct WorldPlan<'a> {
    /// The length of a tick.
    pub tick: SimTime,
    /// Wind, waves and current.
    pub sea: &'a Sea,
    /// Provides walls and obstacles, and the area of eddies.
    pub field: &'a Field,
    /// The kinds of boat.
    pub kinds: &'a [Boat],
    /// Vehicles, by index.
    pub vehicles: Vec<VehiclePlan<'a>>,
    /// The time between two readings of the sensors.
    pub sensor_period: SimTime,
    /// Whether boats collide with each other rather than only with walls and obstacles.
    pub boats_are_solid: bool,
    /// Distance (m) within which [`World::pairs`] lists every pair of boats; it may also list
    /// others.
    pub pairs_within_m: f64,
    /// Seeds of the randomness of sea and sensors.
    pub seeds: Seeds,
}

/// One vehicle of a [`WorldPlan`].
#[derive(Clone, Debug)]
pub struct VehiclePlan<'a> {
    /// The name that selects its sensors' random numbers.
    pub name: &'a str,
    /// Index of the vehicle's kind.
    pub kind: usize,
    /// Starting pose.
    pub start: Pose,
    /// Whether it is a real boat, which the simulation never moves.
    pub is_external: bool,
    /// The vehicle's faults and their times.
    pub faults: Vec<FaultSpan>,
}

/// Memory reused every tick; its contents follow from the state.
#[derive(Clone, Default)]
struct Work {
    near: Near,
    /// Rotations of the headings, by vehicle index.
    rotations: Vec<Rotation>,
    /// Forces on each boat, and its motion under these forces alone.
    forcings: Vec<Forcing>,
    currents_m_s: Vec<Ned>,
    motions: Vec<Motion>,
    /// Motion over the tick, by vehicle index.
    displacements: Vec<Displacement>,
    /// Velocity over the ground at the end of the tick without contact, by vehicle index.
    velocities: Vec<Planar>,
    pairs: Vec<Pair>,
    quarantined: Vec<VehicleId>,
}

impl World {
    /// The world of this plan at its start.
    pub fn new(plan: &WorldPlan<'_>) -> World {
        let model = Model::new(plan);
        let boats = plan.vehicles.iter().map(|vehicle| BoatState {
            pose: vehicle.start,
            ..BoatState::default()
        });
        let mut state = State {
            tick: 0,
            now: SimTime::ZERO,
            boats: boats.collect(),
            flaws: model.flaws_at_start(),
            points: vec![],
            senses: model.senses_at_start(),
        };
        state.points = model.points_at_start(&state.boats);
        let mut world = World {
            model,
            state,
            work: Work::default(),
        };
        world.refresh();
        // Minds decide before the first tick, based on sensor readings at rest.
        world.read_sensors();
        world
    }

    /// The world of a game with this seed, before its first tick.
    ///
    /// # Errors
    /// [`NoStart`] if the boats do not fit into their spawn area, or the randomised values are
    /// inconsistent.
    pub fn of_game(scenario: &Scenario, seed: u64) -> Result<World, NoStart> {
        // Apply the seed first: a file may randomise values, and everything below depends on the
        // drawn game.
        let scenario = scenario.of_seed(seed)?;
        let starts = spawn::start_positions(&scenario, seed)?;
        let seeds = scenario.seeds();
        let faults = |i: usize, name: &str| {
            fault_spans(
                &scenario.faults,
                (VehicleId::at(i), name),
                &seeds,
                scenario.rules.time_limit,
            )
        };
        let vehicles =
            scenario
                .vehicles
                .iter()
                .zip(starts)
                .enumerate()
                .map(|(i, (vehicle, start))| VehiclePlan {
                    faults: faults(i, &vehicle.name),
                    name: &vehicle.name,
                    kind: vehicle.boat,
                    start,
                    is_external: vehicle.source == Source::External,
                });
        Ok(World::new(&WorldPlan {
            tick: scenario.tick,
            sea: &scenario.sea,
            field: &scenario.field,
            kinds: &scenario.boats,
            vehicles: vehicles.collect(),
            sensor_period: scenario.decision(),
            boats_are_solid: scenario.rules.contact == Contact::Solid,
            pairs_within_m: scenario.rules.reach_m(),
            seeds,
        }))
    }

    /// Advances the world by one tick. `commands` are the boats' commands with valid numbers, by
    /// vehicle index. Returns the boats whose state became non-finite; these stay at rest from now
    /// on.
    ///
    /// # Panics
    /// If the number of commands differs from the number of vehicles.
    pub fn step(&mut self, commands: &[Order]) -> &[VehicleId] {
        assert_eq!(
            commands.len(),
            self.state.boats.len(),
            "one command per vehicle"
        );
        self.work.quarantined.clear();
        // Wind and current are processes in time, whose values for this tick are computed once for
        // all boats.
        self.model.sea.prepare(self.state.now);
        self.drive(commands);
        // First all boats move without contact, then touching boats are corrected, so that their
        // order in the list gives no advantage.
        self.model.contact.resolve(
            &self.model.hulls,
            &mut self.work.displacements,
            &self.work.pairs,
        );
        self.settle();
        self.state.tick += 1;
        self.state.now = self.state.now + self.model.tick;
        self.find_pairs();
        &self.work.quarantined
    }

    /// Reads the sensors for the next decision.
    pub fn read_sensors(&mut self) {
        let World { model, state, work } = self;
        if state.senses.is_empty() {
            return;
        }
        let sea = model.sea.at_time(state.now);
        for (i, boat) in state.boats.iter().enumerate() {
            let Some((place, sensors)) = &model.sensed[i] else {
                continue;
            };
            let truth = model.truth(i, boat, work.rotations[i], &sea);
            let (memory, reading) = &mut state.senses[*place];
            *reading = sensors.read(memory, &truth, state.now);
        }
    }

    /// Sets boats back to the edge of circles that they must stay out of. `circle` returns the
    /// circle (centre, radius in m), if any, for a vehicle at a position. A hull loses its inward
    /// velocity. A point boat behaves as in Pyquaticus: it returns to its point of entry and
    /// continues along the circle with the remaining velocity. A real boat is not moved.
    pub fn set_back(&mut self, circle: impl Fn(VehicleId, Ned) -> Option<(Ned, f64)>) {
        let World { model, state, work } = self;
        let mut moved = false;
        for (i, boat) in state
            .boats
            .iter_mut()
            .enumerate()
            .filter(|(i, _)| !model.is_external(*i))
        {
            let Some((centre, radius_m)) = circle(VehicleId::at(i), boat.pose.at) else {
                continue;
            };
            let from_centre = boat.pose.at - centre;
            let distance_m = from_centre.length();
            // At the exact centre there is no direction in which to set it back.
            if distance_m >= radius_m || distance_m == 0.0 {
                continue;
            }
            moved = true;
            if let Some((place, _)) = model.point(i) {
                let came_from = work
                    .displacements
                    .get(i)
                    .map_or(boat.pose.at, |displacement| displacement.from.at);
                // As in Pyquaticus, the boat returns to its point of entry and turns along the
                // circle, with the tangential part of its velocity.
                boat.pose.at = way_back(
                    (came_from, boat.pose.at),
                    centre,
                    radius_m + POINT_BOAT_SPARE_M,
                );
                let point = &mut state.points[place];
                let drift = boat.nu.in_ned(work.rotations[i])
                    - work.rotations[i].ahead().scaled(point.speed_m_s);
                point.slide_across(
                    (boat.pose.at - centre).scaled(1.0 / boat.pose.at.distance(centre)),
                );
                boat.pose.psi_rad = point.psi_rad();
                work.rotations[i] = boat.pose.rotation();
                let drift = frame::body_from_ned(work.rotations[i], drift);
                (boat.nu.surge, boat.nu.sway) = (point.speed_m_s + drift.ahead, drift.starboard);
                continue;
            }
            let out = from_centre.scaled(1.0 / distance_m);
            boat.pose.at = centre + out.scaled(radius_m);
            let out_in_body = frame::body_from_ned(work.rotations[i], out);
            let inward_m_s =
                (out_in_body.ahead * boat.nu.surge + out_in_body.starboard * boat.nu.sway).min(0.0);
            // A hull keeps its heading and loses its inward velocity, as at a soft wall.
            boat.nu.surge -= inward_m_s * out_in_body.ahead;
            boat.nu.sway -= inward_m_s * out_in_body.starboard;
        }
        if moved {
            self.find_pairs();
        }
    }

    /// The changing state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Replaces the changing state.
    ///
    /// # Panics
    /// If the number of boats differs.
    pub fn set_state(&mut self, state: State) {
        assert_eq!(
            state.boats.len(),
            self.state.boats.len(),
            "the state has a different number of boats"
        );
        self.state = state;
        self.refresh();
    }

    /// Places a boat with this velocity over the ground (body axes), for external control. Its
    /// thrusters keep their state.
    ///
    /// # Panics
    /// If the vehicle does not exist.
    pub fn set_under_way(&mut self, vehicle: VehicleId, pose: Pose, nu: Planar) {
        let boat = &mut self.state.boats[vehicle.index()];
        (boat.pose, boat.nu) = (pose, nu);
        self.refresh();
    }

    /// A vehicle's motion in the last tick.
    pub fn leg(&self, vehicle: VehicleId) -> Leg {
        let to = self.state.boats[vehicle.index()].pose.at;
        let from = self
            .work
            .displacements
            .get(vehicle.index())
            .map_or(to, |displacement| displacement.from.at);
        Leg { from, to }
    }

    /// Pairs of near boats, in the order of [`primitives::near::Near`]: all that may touch, and all
    /// within [`WorldPlan::pairs_within_m`].
    pub fn pairs(&self) -> &[Pair] {
        &self.work.pairs
    }

    /// The current sea.
    pub fn sea(&self) -> SeaNow<'_> {
        self.model.sea.at_time(self.state.now)
    }

    /// A vehicle's sensor readings; `None` if all its sensors are perfect.
    pub fn reading(&self, vehicle: VehicleId) -> Option<&Reading> {
        let place = self.model.sensed[vehicle.index()]
            .as_ref()
            .map(|(place, _)| *place)?;
        Some(&self.state.senses[place].1)
    }

    /// The true state of a vehicle, as far as sensors measure it.
    pub fn truth(&self, vehicle: VehicleId) -> Truth {
        let i = vehicle.index();
        self.model
            .truth(i, &self.state.boats[i], self.work.rotations[i], &self.sea())
    }

    /// Passes boats within `close_m` of any shape to rapier. This is slower but gives the same
    /// bytes.
    #[doc(hidden)]
    pub fn widen_contact(&mut self, close_m: f64) {
        self.model.contact.widen(close_m);
        self.find_pairs();
    }

    /// Computes sea and motion with these instructions instead of the machine's fastest. The
    /// results have the same bytes.
    #[doc(hidden)]
    pub fn set_instructions(&mut self, instructions: Instructions) {
        self.model.sea.set_instructions(instructions);
        self.model.fleet.set_instructions(instructions);
    }

    /// Updates everything derived from the state.
    fn refresh(&mut self) {
        self.work.rotations.clear();
        self.work
            .rotations
            .extend(self.state.boats.iter().map(|boat| boat.pose.rotation()));
        self.find_pairs();
    }

    fn find_pairs(&mut self) {
        // One search with the larger reach serves both: with many boats the search dominates the
        // cost.
        let reach_m = self.model.contact.reach_m().max(self.model.pairs_within_m);
        // Search at the end of a tick, for the next tick and for the referee: both need close pairs
        // at the same positions.
        let boats = &self.state.boats;
        let pairs = self
            .work
            .near
            .pairs(|i| boats[i].pose.at, boats.len(), reach_m);
        self.work.pairs.clear();
        self.work.pairs.extend_from_slice(pairs);
    }

    /// Computes every boat's motion over the tick without contact.
    fn drive(&mut self, commands: &[Order]) {
        let World { model, state, work } = self;
        let sea = model.sea.at_time(state.now);
        work.forcings.clear();
        work.currents_m_s.clear();
        for (i, boat) in state.boats.iter_mut().enumerate() {
            let heading = (work.rotations[i], model.heading_error_rad(i, &state.senses));
            let failing = model.failing(i, state.now);
            let (forcing, current_m_s) = model.forcing(
                (i, failing),
                boat,
                &mut state.flaws[i],
                heading,
                commands[i],
                &sea,
            );
            work.forcings.push(forcing);
            work.currents_m_s.push(current_m_s);
        }
        model.fleet.advance(
            &work.forcings,
            model.dt_s,
            model.sea.is_uniform(),
            &mut work.motions,
        );
        work.displacements.clear();
        work.velocities.clear();
        for (i, boat) in state.boats.iter().enumerate() {
            let from = boat.pose;
            let rotation = work.rotations[i];
            let (to, rotation_to, nu) = match model.point(i) {
                _ if model.is_external(i) => {
                    let to = external::dead_reckoned(from, boat.nu, model.dt_s);
                    (to, to.rotation(), boat.nu)
                }
                _ if boat.quarantined => (from, rotation, Planar::default()),
                Some((place, point)) => model.point_moved(
                    from,
                    (point, &mut state.points[place]),
                    commands[i],
                    sea.current_at(from.at),
                ),
                None => model.hull_moved(
                    from,
                    rotation,
                    &work.forcings[i],
                    &work.motions[i],
                    work.currents_m_s[i],
                ),
            };
            let kind = model.kinds[i];
            let role = model.role(i, boat);
            let velocity_change = Planar::default();
            work.displacements.push(Displacement {
                kind,
                from,
                to,
                rotation,
                rotation_to,
                role,
                velocity_change,
            });
            work.velocities.push(nu);
        }
    }

    /// Applies the motion and its changes by contact. Quarantines boats whose state is no longer
    /// finite.
    fn settle(&mut self) {
        let World { model, state, work } = self;
        let sea = model.sea.at_time(state.now);
        for (i, boat) in state.boats.iter_mut().enumerate() {
            let displacement = &work.displacements[i];
            let mut nu = work.velocities[i];
            nu = nu.plus(1.0, displacement.velocity_change);
            if is_sound(displacement.to, nu) {
                boat.nu_change = nu.plus(-1.0, boat.nu);
                (boat.pose, boat.nu, work.rotations[i]) =
                    (displacement.to, nu, displacement.rotation_to);
                if let (Some((place, _)), true) = (
                    model.point(i),
                    displacement.velocity_change != Planar::default(),
                ) {
                    // The boat's own speed is through the water.
                    let drift = frame::body_from_ned(
                        displacement.rotation_to,
                        sea.current_at(displacement.from.at),
                    );
                    state.points[place].divert(boat.pose.psi_rad, boat.nu.surge - drift.ahead);
                }
            } else if !boat.quarantined {
                // The boat stays at its last valid position, where others may hit it.
                *boat = BoatState {
                    pose: boat.pose,
                    quarantined: true,
                    ..BoatState::default()
                };
                work.quarantined.push(VehicleId::at(i));
            }
        }
    }
}

/// The point where a boat inside a circle entered it, by tracing back its straight path. For a boat
/// that has not moved, the point straight outward.
fn way_back((from, to): (Ned, Ned), centre: Ned, radius_m: f64) -> Ned {
    let back = if from == to { to - centre } else { from - to };
    let back = back.scaled(1.0 / back.length());
    let from_centre = to - centre;
    let beside = from_centre.dot(back);
    to + back.scaled(
        (beside * beside + radius_m * radius_m - from_centre.dot(from_centre))
            .max(0.0)
            .sqrt()
            - beside,
    )
}

#[inline]
fn is_sound(pose: Pose, nu: Planar) -> bool {
    // A NaN fails every comparison.
    pose.at.is_finite()
        && pose.psi_rad.is_finite()
        && nu.yaw.is_finite()
        && math::length(nu.surge, nu.sway) < ABSURD_M_S
}
