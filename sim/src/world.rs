//! The world: boats, water, contact and the referee, one tick at a time.

use crate::autopilot::AutopilotModel;
use crate::contact::{ContactModel, Passage};
use crate::hull::{HullModel, Planar};
use crate::motion::{Effort, Fleet, Motion};
use crate::sea::SeaModel;
use crate::spawn::{self, NoBerth};
use crate::state::{BoatState, RestoreError, State};
use crate::thruster::ThrusterModel;
use game::angle::wrap_pi;
use game::boat::Drive;
use game::frame::{self, Ned};
use game::near::{Near, Pair};
use game::rules::{Directive, Notes, Referee};
use game::stream::Stream;
use game::{Event, Order, Pose, Scenario, SimTime, VehicleId, math};
use xxhash_rust::xxh3;

/// No boat is faster than this over the ground, m/s; one that is has bad numbers.
const ABSURD_M_S: f64 = 1_000.0;

/// A game's world.
#[derive(Clone)]
pub struct World {
    model: Model,
    state: State,
    work: Work,
}

/// What is constant while a game is played.
#[derive(Clone)]
struct Model {
    tick: SimTime,
    dt_s: f64,
    /// By kind of boat.
    hulls: Vec<HullModel>,
    thrusters: Vec<ThrusterModel>,
    autopilots: Vec<AutopilotModel>,
    /// Kind of each vehicle.
    kinds: Vec<usize>,
    /// The hulls again, by vehicle.
    fleet: Fleet,
    sea: SeaModel,
    contact: ContactModel,
    referee: Referee,
    /// Marks snapshots.
    scenario_mark: u64,
}

/// Memory that is used again every tick; all of it follows from the state.
#[derive(Clone, Default)]
struct Work {
    near: Near,
    /// Sine and cosine of each heading.
    turns: Vec<(f64, f64)>,
    /// What moves each boat, and how it moves by that alone.
    efforts: Vec<Effort>,
    motions: Vec<Motion>,
    /// Motion over the tick, by vehicle.
    passages: Vec<Passage>,
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
    /// [`NoBerth`] where the boats do not fit into their spawn area.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<World, NoBerth> {
        let model = Model::new(scenario);
        let boats = spawn::berths(scenario, seed)?.into_iter().map(|pose| BoatState { pose, ..BoatState::default() });
        let standing = model.referee.start(&mut Stream::new(seed, "power_play"));
        let state = State { tick: 0, now: SimTime::ZERO, boats: boats.collect(), standing };
        let mut world = World { model, state, work: Work::default() };
        world.refresh();
        Ok(world)
    }

    /// Moves the world on by one tick. `orders` are by vehicle; what happened comes back.
    ///
    /// # Panics
    /// If there is not one order for each vehicle.
    pub fn step(&mut self, orders: &[Order]) -> &[Event] {
        assert_eq!(orders.len(), self.state.boats.len(), "one order a vehicle");
        self.work.events.clear();
        self.drive(orders);
        self.model.contact.resolve(&self.model.hulls, &mut self.work.passages, &self.work.pairs);
        self.settle();
        self.state.tick += 1;
        self.state.now = self.state.now + self.model.tick;
        self.find_pairs();
        self.judge();
        self.keep_out();
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

    /// The state as bytes; [`World::restore`] takes them back.
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

    /// 128 bits that differ when any bit of the state differs.
    #[must_use]
    pub fn digest(&self) -> u128 {
        self.state.digest()
    }

    /// Hands boats to rapier that are as far as `close_m` from anything. Slower, and the same bytes.
    #[doc(hidden)]
    pub fn widen_contact(&mut self, close_m: f64) {
        self.model.contact.widen(close_m);
        self.find_pairs();
    }

    /// Makes what follows from the state follow from it.
    fn refresh(&mut self) {
        self.work.turns.clear();
        self.work.turns.extend(self.state.boats.iter().map(|boat| math::sin_cos(boat.pose.psi_rad)));
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
        let World { model, state, work } = self;
        work.efforts.clear();
        for (i, boat) in state.boats.iter_mut().enumerate() {
            let directive = model.referee.directive(&state.standing, VehicleId::at(i), boat.pose.at);
            work.efforts.push(model.effort(boat, model.kinds[i], work.turns[i], orders[i], directive));
        }
        model.fleet.advance(&work.efforts, model.dt_s, &mut work.motions);
        work.passages.clear();
        work.velocities.clear();
        for (i, boat) in state.boats.iter().enumerate() {
            let (passage, nu) = model.passage(boat, model.kinds[i], work.turns[i], &work.efforts[i], &work.motions[i]);
            work.passages.push(passage);
            work.velocities.push(nu);
        }
    }

    /// The boats take up the motion, with what contact changed in it. Bad numbers are contained here.
    fn settle(&mut self) {
        let World { model, state, work } = self;
        for (i, boat) in state.boats.iter_mut().enumerate() {
            let (passage, mut nu) = (&work.passages[i], work.velocities[i]);
            nu = nu.plus(1.0, passage.kick);
            if is_sound(passage.to, nu) {
                (boat.pose, boat.nu, work.turns[i]) = (passage.to, nu, passage.turn_to);
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
        let World { model, state, work } = self;
        let mut moved = false;
        for i in 0..state.boats.len() {
            let Some((centre, radius_m)) =
                model.referee.keepout(&state.standing, VehicleId::at(i), state.boats[i].pose.at)
            else {
                continue;
            };
            let boat = &mut state.boats[i];
            let from_centre = boat.pose.at - centre;
            let distance_m = from_centre.length();
            if distance_m >= radius_m || distance_m == 0.0 {
                continue;
            }
            let out = from_centre.scaled(1.0 / distance_m);
            boat.pose.at = centre + out.scaled(radius_m);
            let out_in_body = frame::body_from_ned(work.turns[i], out);
            let inward_m_s = (out_in_body.ahead * boat.nu.surge + out_in_body.starboard * boat.nu.sway).min(0.0);
            boat.nu.surge -= inward_m_s * out_in_body.ahead;
            boat.nu.sway -= inward_m_s * out_in_body.starboard;
            moved = true;
        }
        if moved {
            self.find_pairs();
        }
    }

    fn judge(&mut self) {
        let World { model, state, work } = self;
        let boats = &state.boats;
        let at = |i: usize| boats[i].pose.at;
        model.referee.advance(&mut state.standing, &mut work.notes, &at, &work.pairs, state.now, &mut work.events);
    }
}

impl Model {
    fn new(scenario: &Scenario) -> Model {
        let dt_s = scenario.tick.as_s();
        let density = scenario.sea.water_density_kg_m3;
        let hulls: Vec<HullModel> = scenario.boats.iter().map(|boat| HullModel::new(&boat.hull, density)).collect();
        let shapes = scenario.boats.iter().map(|boat| (boat.length_m, boat.beam_m));
        let drives: Vec<_> = scenario
            .boats
            .iter()
            .map(|boat| match &boat.drive {
                Drive::Thrusters { thruster, autopilot } => (thruster, autopilot),
                Drive::Kinematic(_) => panic!("no kinematic boats yet"),
            })
            .collect();
        let autopilots =
            drives.iter().zip(&hulls).map(|((_, autopilot), hull)| AutopilotModel::new(autopilot, hull, dt_s));
        let encoded = postcard::to_stdvec(scenario).expect("a checked scenario always encodes");
        Model {
            tick: scenario.tick,
            dt_s,
            thrusters: drives.iter().map(|(thruster, _)| ThrusterModel::new(thruster, dt_s)).collect(),
            autopilots: autopilots.collect(),
            fleet: Fleet::new(scenario.vehicles.iter().map(|vehicle| &hulls[vehicle.boat])),
            kinds: scenario.vehicles.iter().map(|vehicle| vehicle.boat).collect(),
            sea: SeaModel::new(&scenario.sea),
            contact: ContactModel::new(shapes, &scenario.field, dt_s),
            referee: Referee::new(
                scenario.rules.clone(),
                scenario.field.clone(),
                scenario.vehicles.iter().map(|vehicle| vehicle.team).collect(),
            ),
            hulls,
            scenario_mark: xxh3::xxh3_64(&encoded),
        }
    }

    /// What moves a boat in this tick: its thrusters take up its order, as far as the rules let it.
    #[inline]
    fn effort(
        &self,
        boat: &mut BoatState,
        kind: usize,
        turn: (f64, f64),
        order: Order,
        directive: Directive,
    ) -> Effort {
        if boat.quarantined {
            return Effort::default();
        }
        let tau = self.thrust(boat, kind, obeyed(order, directive, boat.pose.at));
        let current_m_s = self.sea.at(boat.pose.at).current_m_s;
        Effort { nu_r: through_water(boat.nu, turn, current_m_s, -1.0), tau }
    }

    /// A boat's passage over a tick as if it were alone, and its velocity over the ground after it.
    #[inline]
    fn passage(
        &self,
        boat: &BoatState,
        kind: usize,
        turn: (f64, f64),
        effort: &Effort,
        motion: &Motion,
    ) -> (Passage, Planar) {
        let from = boat.pose;
        let still =
            Passage { kind, from, to: from, turn, turn_to: turn, fixed: boat.quarantined, kick: Planar::default() };
        if boat.quarantined {
            return (still, Planar::default());
        }
        let current_m_s = self.sea.at(from.at).current_m_s;
        let psi_rad = wrap_pi(from.psi_rad + motion.turn_rad);
        let half_turn = math::sin_cos(from.psi_rad + motion.turn_half_rad);
        let end_turn = math::sin_cos(psi_rad);
        let start = over_ground(turn, effort.nu_r);
        let middle = over_ground(half_turn, motion.nu_r_half);
        let end = over_ground(end_turn, motion.nu_r);
        let mean_m_s = (start + middle.scaled(4.0) + end).scaled(1.0 / 6.0) + current_m_s;
        let to = Pose { at: from.at + mean_m_s.scaled(self.dt_s), psi_rad };
        (Passage { to, turn_to: end_turn, ..still }, through_water(motion.nu_r, end_turn, current_m_s, 1.0))
    }

    /// The thrusters' force on the hull at the beginning, half-way and at the end of the tick.
    #[inline]
    fn thrust(&self, boat: &mut BoatState, kind: usize, order: (Order, f64)) -> [Planar; 3] {
        let (hull, thruster, autopilot) = (&self.hulls[kind], &self.thrusters[kind], &self.autopilots[kind]);
        let settings = match order {
            (Order::Steer { heading_rad, speed_m_s }, factor) => {
                let speed_m_s = speed_m_s.min(factor * autopilot.speed_max_m_s);
                let at = (boat.pose.psi_rad, boat.nu);
                autopilot.steer((hull, thruster), at, (heading_rad, speed_m_s), &mut boat.speed_integral_newton)
            }
            (Order::Thrust { port, starboard }, factor) => {
                [thruster.setting_of_share(factor * port), thruster.setting_of_share(factor * starboard)]
            }
            (Order::Hold, _) => [0.0, 0.0],
        };
        let port = thruster.respond(&mut boat.port, settings[0]);
        let starboard = thruster.respond(&mut boat.starboard, settings[1]);
        [0, 1, 2].map(|i| Planar {
            surge: port[i] + starboard[i],
            sway: 0.0,
            yaw: thruster.arm_m * (port[i] - starboard[i]),
        })
    }
}

/// What a boat does: its order as far as the rules let it, and the share of its top speed it may use.
#[inline]
fn obeyed(order: Order, directive: Directive, at: Ned) -> (Order, f64) {
    match directive {
        Directive::Free { speed_factor } => (order.check().unwrap_or_default(), speed_factor),
        Directive::DrivenHome { to: home, speed_factor } => {
            (Order::Steer { heading_rad: at.bearing_rad(home), speed_m_s: f64::INFINITY }, speed_factor)
        }
        Directive::Hold => (Order::Hold, 1.0),
    }
}

/// `nu` with the current, seen from the boat, added `sign` times: −1 takes a velocity over the ground to one
/// through the water, 1 takes it back.
#[inline]
fn through_water(nu: Planar, turn: (f64, f64), current_m_s: Ned, sign: f64) -> Planar {
    let current = frame::body_from_ned(turn, current_m_s);
    nu.plus(sign, Planar { surge: current.ahead, sway: current.starboard, yaw: 0.0 })
}

#[inline]
fn over_ground(turn: (f64, f64), nu: Planar) -> Ned {
    frame::ned_from_body(turn, game::Body { ahead: nu.surge, starboard: nu.sway })
}

#[inline]
fn is_sound(pose: Pose, nu: Planar) -> bool {
    // A NaN fails every comparison.
    pose.at.is_finite()
        && pose.psi_rad.is_finite()
        && nu.yaw.is_finite()
        && math::length(nu.surge, nu.sway) < ABSURD_M_S
}
