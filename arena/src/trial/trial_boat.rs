//! One boat afloat in open water, told what to do tick by tick.

use super::command::Command;
use super::sample::Sample;
use super::water::open_field;
use game::boat::{Boat, Drive};
use game::frame::{self, Body};
use game::sea::Sea;
use game::{Ned, Order, Pose, Rotation, SimTime, VehicleId};
use sim::hull::Planar;
use sim::kinematic::{Command as PointCommand, KinematicModel, KinematicState};
use sim::sea::SeaModel;
use sim::{VehiclePlan, World, WorldPlan};

/// How a boat begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Heading, rad clockwise from north.
    pub psi_rad: f64,
    /// Velocity over the ground along the boat's axes.
    pub nu: Planar,
    /// Thrust of a kinematic boat, per cent; `None` is what keeps its speed.
    pub thrust_pct: Option<f64>,
}

/// One boat in open water.
#[derive(Clone)]
pub struct TrialBoat {
    craft: Craft,
    tick: SimTime,
    /// Where it is counted from.
    origin: Ned,
}

#[derive(Clone)]
enum Craft {
    Thrusters(Box<World>),
    Kinematic(Box<Point>),
}

/// A kinematic boat: the law of `sim::kinematic` as the world applies it, but with thrust and rudder as they come. (An
/// order for two thrusters cannot say full thrust and half rudder.)
#[derive(Clone)]
struct Point {
    model: KinematicModel,
    state: KinematicState,
    sea: SeaModel,
    now: SimTime,
    at: Ned,
    nu: Planar,
}

impl TrialBoat {
    /// A boat at its start. `seed` chooses the randomness of the sea and of its sensors.
    #[must_use]
    pub fn new(boat: &Boat, sea: &Sea, tick: SimTime, seed: u64, start: &Start) -> TrialBoat {
        let (field, kinds) = (open_field(), std::slice::from_ref(boat));
        let craft = match &boat.drive {
            Drive::Thrusters { .. } => {
                let vehicle = VehiclePlan { name: "boat", kind: 0, start: Pose::default(), is_external: false };
                let mut world = World::new(&WorldPlan {
                    tick,
                    sea,
                    field: &field,
                    kinds,
                    vehicles: vec![vehicle],
                    sensor_period: tick,
                    pairs_within_m: 0.0,
                    seed,
                });
                let pose = Pose { at: Ned::default(), psi_rad: start.psi_rad };
                world.set_under_way(VehicleId(0), pose, start.nu);
                Craft::Thrusters(Box::new(world))
            }
            Drive::Kinematic(kinematic) => {
                let sea = SeaModel::new(sea, kinds, &field, tick, seed);
                Craft::Kinematic(Box::new(Point::new(KinematicModel::new(kinematic), sea, start)))
            }
        };
        TrialBoat { craft, tick, origin: Ned::default() }
    }

    /// The length of a tick.
    #[must_use]
    pub fn tick(&self) -> SimTime {
        self.tick
    }

    /// Simulated time since the start.
    #[must_use]
    pub fn now(&self) -> SimTime {
        match &self.craft {
            Craft::Thrusters(world) => world.state().now,
            Craft::Kinematic(point) => point.now,
        }
    }

    /// Counts positions from here on from where the boat is.
    pub fn set_origin(&mut self) {
        self.origin = self.pose().at;
    }

    pub(super) fn pose(&self) -> Pose {
        match &self.craft {
            Craft::Thrusters(world) => world.state().boats[0].pose,
            Craft::Kinematic(point) => Pose { at: point.at, psi_rad: point.state.psi_rad() },
        }
    }

    /// Moves a boat with thrusters to where it was measured, moving as it was measured; its thrusters stay as they are.
    pub fn relocate(&mut self, pose: Pose, nu: Planar) {
        if let Craft::Thrusters(world) = &mut self.craft {
            world.set_under_way(VehicleId(0), pose, nu);
        }
    }

    /// Moves it on by one tick.
    pub fn step(&mut self, command: Command) {
        match &mut self.craft {
            Craft::Thrusters(world) => {
                world.step(&[order(command)]);
                world.read_sensors();
            }
            Craft::Kinematic(point) => point.step(command, self.tick),
        }
    }

    /// Whether its numbers are still numbers.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        match &self.craft {
            Craft::Thrusters(world) => !world.state().boats[0].quarantined,
            Craft::Kinematic(point) => point.at.is_finite() && point.state.speed_m_s.is_finite(),
        }
    }

    /// What there is to write down now, at `t_s` of the trial, about to be told `command`.
    #[must_use]
    pub fn sample(&self, t_s: f64, command: Command) -> Sample {
        let Pose { at, psi_rad } = self.pose();
        let (nu, surge_through_water_m_s, thrusts_newton) = match &self.craft {
            Craft::Thrusters(world) => {
                let boat = world.state().boats[0];
                let current = in_body(psi_rad, world.sea().current_at(at));
                (boat.nu, boat.nu.surge - current.ahead, [boat.port.newton, boat.starboard.newton])
            }
            Craft::Kinematic(point) => (point.nu, point.state.speed_m_s, [f64::NAN; 2]),
        };
        Sample { t_s, at: at - self.origin, psi_rad, nu, surge_through_water_m_s, thrusts_newton, command }
    }

    /// The settings of its two thrusters, or thrust and rudder in per cent.
    #[must_use]
    pub fn settings(&self) -> [f64; 2] {
        match &self.craft {
            Craft::Thrusters(world) => {
                let boat = world.state().boats[0];
                [boat.port.command, boat.starboard.command]
            }
            Craft::Kinematic(point) => [point.state.thrust, point.state.rudder],
        }
    }
}

impl Point {
    fn new(model: KinematicModel, sea: SeaModel, start: &Start) -> Point {
        let carried = in_body(start.psi_rad, sea.at_time(SimTime::ZERO).current_at(Ned::default()));
        // Speed is through the water; drifting sideways is what a boat without mass cannot do.
        let speed_m_s = (start.nu.surge - carried.ahead).clamp(0.0, model.speed_max_m_s());
        let state = if start.nu == Planar::default() && start.thrust_pct.is_none() {
            KinematicState::at_rest(start.psi_rad)
        } else {
            let thrust = start.thrust_pct.unwrap_or_else(|| model.thrust_for_speed(speed_m_s));
            KinematicState::under_way(start.psi_rad, speed_m_s, thrust)
        };
        Point { model, state, sea, now: SimTime::ZERO, at: Ned::default(), nu: start.nu }
    }

    fn step(&mut self, command: Command, tick: SimTime) {
        let dt_s = tick.as_s();
        self.sea.prepare(self.now);
        let drift_m_s = self.sea.at_time(self.now).current_at(self.at);
        let motion = self.model.step(&mut self.state, point_command(command), drift_m_s, dt_s);
        self.at = self.at + motion.travel_m;
        self.now = self.now + tick;
        let carried = in_body(motion.psi_rad, drift_m_s);
        self.nu =
            Planar { surge: motion.speed_m_s + carried.ahead, sway: carried.starboard, yaw: motion.turn_rad / dt_s };
    }
}

fn in_body(psi_rad: f64, ned: Ned) -> Body {
    frame::body_from_ned(Rotation::from_heading(psi_rad), ned)
}

fn order(command: Command) -> Order {
    match command {
        Command::Thrust { port, starboard } => Order::Thrust { port, starboard },
        Command::Steer { heading_rad, speed_m_s } => Order::Steer { heading_rad, speed_m_s },
        Command::Hold | Command::Impose { .. } => Order::Hold,
    }
}

fn point_command(command: Command) -> PointCommand {
    match command {
        Command::Impose { thrust, rudder } => PointCommand::Impose { thrust, rudder },
        Command::Steer { heading_rad, speed_m_s } => PointCommand::Steer { heading_rad, speed_m_s },
        Command::Hold | Command::Thrust { .. } => PointCommand::Hold,
    }
}
