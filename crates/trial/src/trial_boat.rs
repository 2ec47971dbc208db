//! One boat afloat in open water, commanded tick by tick.

use super::command::Command;
use super::sample::Sample;
use super::water::open_field;
use messages::Order;
use messages::picture::Nav;
use primitives::frame::{self, Body};
use primitives::{Ned, Pose, Rotation, SimTime, VehicleId};
use scenario::boat::{Boat, Drive, Kinematic};
use scenario::sea::Sea;
use sim::hull::Planar;
use sim::kinematic::{KinematicModel, KinematicState};
use sim::{VehiclePlan, World, WorldPlan};

/// A boat's initial state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Heading, rad clockwise from north.
    pub psi_rad: f64,
    /// Velocity over the ground along the boat's axes.
    pub nu: Planar,
    /// Thrust of a kinematic boat, per cent; `None`: the thrust that keeps its speed.
    pub thrust_pct: Option<f64>,
}

/// One boat in open water.
#[derive(Clone)]
pub struct TrialBoat {
    world: Box<World>,
    tick: SimTime,
    /// The origin of its positions.
    origin: Ned,
}

impl TrialBoat {
    /// A boat at its start. `seed` determines the randomness of the sea and of its sensors.
    pub fn new(boat: &Boat, sea: &Sea, tick: SimTime, seed: u64, start: &Start) -> TrialBoat {
        let vehicle = VehiclePlan {
            name: "boat",
            kind: 0,
            start: Pose::default(),
            is_external: false,
            faults: vec![],
        };
        let mut world = World::new(&WorldPlan {
            boats_are_solid: true,
            tick,
            sea,
            field: &open_field(),
            kinds: std::slice::from_ref(boat),
            vehicles: vec![vehicle],
            sensor_period: tick,
            pairs_within_m: 0.0,
            seeds: seed.into(),
        });
        let mut psi_rad = start.psi_rad;
        if let Drive::Kinematic(kinematic) = &boat.drive {
            // An order for two thrusters cannot express full thrust and half rudder, so in a trial
            // the loops of a kinematic boat are set directly. A test compares this with the world's
            // result.
            let mut state = world.state().clone();
            state.points[0] =
                point_at_start(kinematic, start, world.sea().current_at(Ned::default()));
            psi_rad = state.points[0].psi_rad();
            world.set_state(state);
        }
        let pose = Pose {
            at: Ned::default(),
            psi_rad,
        };
        world.set_under_way(VehicleId(0), pose, start.nu);
        TrialBoat {
            world: Box::new(world),
            tick,
            origin: Ned::default(),
        }
    }

    /// The length of a tick.
    pub fn tick(&self) -> SimTime {
        self.tick
    }

    /// Simulated time since the start.
    pub fn now(&self) -> SimTime {
        self.world.state().now
    }

    /// Makes the boat's current position the origin of positions from now on.
    pub fn set_origin(&mut self) {
        self.origin = self.pose().at;
    }

    pub(super) fn pose(&self) -> Pose {
        self.world.state().boats[0].pose
    }

    /// Sets a boat with thrusters to a measured position and motion; its thrusters are unchanged.
    pub fn relocate(&mut self, pose: Pose, nu: Planar) {
        self.world.set_under_way(VehicleId(0), pose, nu);
    }

    /// Advances the boat by one tick.
    pub fn step(&mut self, command: Command) {
        self.world.step(&[order(command)]);
        self.world.read_sensors();
    }

    /// Whether its state is finite.
    pub fn is_sound(&self) -> bool {
        !self.world.state().boats[0].quarantined
    }

    /// The sample at `t_s` of the trial, before `command`.
    pub fn sample(&self, t_s: f64, command: Command) -> Sample {
        let state = self.world.state();
        let boat = state.boats[0];
        let Pose { at, psi_rad } = boat.pose;
        let (surge_through_water_m_s, thrusts_newton) = match state.points.first() {
            None => {
                let current = in_body(psi_rad, self.world.sea().current_at(at));
                (
                    boat.nu.surge - current.ahead,
                    [boat.port.newton, boat.starboard.newton],
                )
            }
            Some(point) => (point.speed_m_s, [f64::NAN; 2]),
        };
        Sample {
            t_s,
            at: at - self.origin,
            psi_rad,
            nu: boat.nu,
            surge_through_water_m_s,
            thrusts_newton,
            command,
        }
    }

    /// What the boat's sensors measured last; `None` if it has none.
    pub fn reading(&self) -> Option<Nav> {
        let reading = self.world.reading(VehicleId(0))?;
        Some(reading.nav)
    }

    /// The settings of the boat's two thrusters, or thrust and rudder in per cent.
    pub fn settings(&self) -> [f64; 2] {
        let state = self.world.state();
        match state.points.first() {
            None => [
                state.boats[0].port.command,
                state.boats[0].starboard.command,
            ],
            Some(point) => [point.thrust, point.rudder],
        }
    }
}

/// The loops of a kinematic boat at its start, in this current.
fn point_at_start(kinematic: &Kinematic, start: &Start, current_m_s: Ned) -> KinematicState {
    if start.nu == Planar::default() && start.thrust_pct.is_none() {
        return KinematicState::at_rest(start.psi_rad);
    }
    // Speed is through the water; a massless boat cannot drift sideways.
    let ahead_m_s = start.nu.surge - in_body(start.psi_rad, current_m_s).ahead;
    let speed_m_s = ahead_m_s.clamp(0.0, kinematic.speed_max_m_s);
    let thrust = start
        .thrust_pct
        .unwrap_or_else(|| KinematicModel::new(kinematic).thrust_for_speed(speed_m_s));
    KinematicState::under_way(start.psi_rad, speed_m_s, thrust)
}

fn in_body(psi_rad: f64, ned: Ned) -> Body {
    frame::body_from_ned(Rotation::from_heading(psi_rad), ned)
}

/// A kinematic boat uses half the sum of two fractions as thrust and half their difference as
/// rudder. Full thrust with half rudder would need a fraction greater than 1.
fn order(command: Command) -> Order {
    match command {
        Command::Thrust { port, starboard } => Order::Thrust { port, starboard },
        Command::Steer {
            heading_rad,
            speed_m_s,
        } => Order::Steer {
            heading_rad,
            speed_m_s,
        },
        Command::Impose { thrust, rudder } => Order::Thrust {
            port: (thrust + rudder) / 100.0,
            starboard: (thrust - rudder) / 100.0,
        },
        Command::Hold => Order::Hold,
    }
}
