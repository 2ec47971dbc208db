//! Behaviours: each produces objective functions of course and speed, which the helm weighs against
//! each other.

mod arrival;
mod attractor;
mod avoid_collision;
mod avoid_obstacle;
mod clearance;
mod collision_halt;
mod constant;
mod cut_range;
mod intercept;
mod loiter;
mod max_speed;
mod memory_turn_limit;
mod nearest;
mod op_region;
mod outline;
mod output;
mod policy;
mod shield;
mod station_keep;
mod steering;
mod trail;
mod waypoint;

pub(crate) use loiter::corners_of;
pub(crate) use output::{BehaviourOutput, Functions, WeightedFunction};

use crate::policy::BoardPolicy;
use crate::situation::Situation;
use dyn_clone::DynClone;
use scenario::strategy::Task;

/// The logic of a behaviour; the helm decides when it runs.
pub(crate) trait BehaviourLogic: DynClone + Send {
    /// Observes the situation at a decision, whether or not the behaviour runs.
    fn observe(&mut self, _situation: &Situation) {}

    /// The variable that this behaviour sets, even when it does not run, and the index of its
    /// string value.
    fn option(&self) -> Option<(u16, usize)> {
        None
    }

    /// Resets the memory when the behaviour starts running.
    fn begin(&mut self, _situation: &Situation) {}

    /// Adds the objective functions of this decision.
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>);

    /// The trained policy of this behaviour, if any.
    fn policy(&self) -> Option<&BoardPolicy> {
        None
    }
}

dyn_clone::clone_trait_object!(BehaviourLogic);

pub(crate) fn logic_of(task: &Task) -> Box<dyn BehaviourLogic> {
    match task.clone() {
        Task::Waypoint(task) => Box::new(waypoint::WaypointBehaviour::new(task)),
        Task::Loiter(task) => Box::new(loiter::LoiterBehaviour::new(task)),
        Task::StationKeep(task) => Box::new(station_keep::StationKeepBehaviour::new(task)),
        Task::CutRange(task) => Box::new(task),
        Task::Trail(task) => Box::new(task),
        Task::Intercept(task) => Box::new(task),
        Task::AvoidCollision(task) => Box::new(collision_halt::HaltingAvoidance::new(task)),
        Task::AvoidObstacle(task) => Box::new(avoid_obstacle::AvoidObstacleBehaviour::new(task)),
        Task::OpRegion(task) => Box::new(op_region::OpRegionBehaviour::new(task)),
        Task::MaxSpeed(task) => Box::new(task),
        Task::ConstantHeading(task) => Box::new(task),
        Task::ConstantSpeed(task) => Box::new(task),
        Task::MemoryTurnLimit(task) => {
            Box::new(memory_turn_limit::MemoryTurnLimitBehaviour::new(task))
        }
        Task::Timer(task) => Box::new(task),
        Task::FullStop(task) => Box::new(task),
        Task::Shield(task) => Box::new(task),
        Task::Attractor(task) => Box::new(task),
        Task::Policy(task) => Box::new(policy::PolicyBehaviour::new(*task)),
    }
}
