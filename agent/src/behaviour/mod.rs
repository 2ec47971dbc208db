//! Behaviours: each wants something of course and speed, and the helm weighs them against each other.

mod attractor;
mod avoid_collision;
mod avoid_obstacle;
mod constant;
mod cut_range;
mod intercept;
mod loiter;
mod max_speed;
mod memory_turn_limit;
mod op_region;
mod policy;
mod shield;
mod station_keep;
mod still;
mod trail;
mod waypoint;

use crate::helm::{Bid, Other, Scene};
use crate::ivp::{Lag, Objective, Peak, Peaks};
use game::strategy::{Contacts, NEAREST_MAX, Task};
use game::{Ned, angle, math};
use std::f64::consts::PI;

/// What a behaviour does at its turn.
pub(crate) trait Conduct: Send {
    /// It begins to run: forget what was.
    fn begin(&mut self, _scene: &Scene) {}

    /// Says what it wants now.
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>);
}

/// What does this task.
pub(crate) fn conduct_of(task: &Task) -> Box<dyn Conduct> {
    match task.clone() {
        Task::Waypoint(task) => Box::new(waypoint::Conductor::new(task)),
        Task::Loiter(task) => Box::new(loiter::Conductor::new(task)),
        Task::StationKeep(task) => Box::new(station_keep::Conductor::new(task)),
        Task::CutRange(task) => Box::new(cut_range::Conductor(task)),
        Task::Trail(task) => Box::new(trail::Conductor(task)),
        Task::Intercept(task) => Box::new(intercept::Conductor(task)),
        Task::AvoidCollision(task) => Box::new(avoid_collision::Conductor(task)),
        Task::AvoidObstacle(task) => Box::new(avoid_obstacle::Conductor::new(task)),
        Task::OpRegion(task) => Box::new(op_region::Conductor::new(task)),
        Task::MaxSpeed(task) => Box::new(max_speed::Conductor(task)),
        Task::ConstantHeading(task) => Box::new(constant::Heading(task)),
        Task::ConstantSpeed(task) => Box::new(constant::Speed(task)),
        Task::MemoryTurnLimit(task) => Box::new(memory_turn_limit::Conductor::new(task)),
        Task::Timer(_) => Box::new(still::Waits),
        Task::FullStop(_) => Box::new(still::Stops),
        Task::Shield(task) => Box::new(shield::Conductor(task)),
        Task::Attractor(task) => Box::new(attractor::Conductor(task)),
        Task::Policy(task) => Box::new(policy::Conductor(task)),
    }
}

/// From the peak of a speed down to nothing, m/s: MOOS-IvP's for waypoints.
const SPEED_BASE_M_S: f64 = 1.6;
/// How much less the edge of a peak of speed is worth than its summit: so that the desired speed itself is best.
const SPEED_SUMMIT_DELTA: f64 = 20.0;

/// What a closest point of approach at the least distance is worth; below that it falls to nothing, so that a boat which is
/// too near comes no nearer.
const CPA_MIN_UTILITY: f64 = 50.0;

/// How fast a boat is thought to turn, rad/s. A Surveyor under way does 25 degrees a second.
const TURN_RAD_S: f64 = 0.35;
/// How long it takes until a decision shows, s.
const REACTION_S: f64 = 0.7;
/// How slow the boat is to follow.
fn lag(scene: &Scene) -> Lag {
    let (heading_east, heading_north) = math::sin_cos(scene.own.nav.psi_rad);
    Lag {
        velocity_north_m_s: scene.velocity.north,
        velocity_east_m_s: scene.velocity.east,
        heading_north,
        heading_east,
        reaction_s: REACTION_S,
        turn_rad_s: TURN_RAD_S,
    }
}

/// Straight for a place at a speed, both alike: the function of MOOS-IvP's waypoints.
fn drive(scene: &Scene, to: Ned, speed_m_s: f64) -> Objective<'static> {
    head(scene, scene.at.bearing_rad(to), speed_m_s, 0.5)
}

/// A course, rad, and a speed, with the course's share of the utility.
fn head(scene: &Scene, course_rad: f64, speed_m_s: f64, course_share: f64) -> Objective<'static> {
    Objective::Coupled {
        course: Peaks::one(Peak::tent(angle::wrap_pi(course_rad), PI)),
        speed: Peaks::one(speed_peak(scene, speed_m_s)),
        course_share,
    }
}

/// A speed; more than the boat can is the most that it can.
fn speed_peak(scene: &Scene, speed_m_s: f64) -> Peak {
    let summit = speed_m_s.min(scene.chart.speed_max_m_s);
    Peak {
        summit,
        peak_width: 0.5 * summit,
        base_width: SPEED_BASE_M_S,
        summit_delta: SPEED_SUMMIT_DELTA,
        height: 100.0,
    }
}

/// How much of a weight is left at a distance: all of it up to `inner_m`, nothing from `outer_m` on.
fn nearness(distance_m: f64, inner_m: f64, outer_m: f64) -> f64 {
    if distance_m <= inner_m {
        1.0
    } else if distance_m >= outer_m {
        0.0
    } else {
        (outer_m - distance_m) / (outer_m - inner_m)
    }
}

/// The nearest of a few, without a list on the heap: no behaviour heeds more.
struct Nearest {
    /// Distance, m, and index; the nearest first, of equally near ones the first.
    entries: [(f64, usize); NEAREST_MAX],
    count: usize,
}

impl Nearest {
    fn of(those: impl Iterator<Item = (f64, usize)>) -> Nearest {
        let mut nearest = Nearest { entries: [(f64::INFINITY, 0); NEAREST_MAX], count: 0 };
        for entry in those {
            let place = nearest.entries[..nearest.count].partition_point(|known| known.0 <= entry.0);
            if place < NEAREST_MAX {
                nearest.count = (nearest.count + 1).min(NEAREST_MAX);
                nearest.entries[place..nearest.count].rotate_right(1);
                nearest.entries[place] = entry;
            }
        }
        nearest
    }

    fn iter(&self) -> impl Iterator<Item = (f64, usize)> {
        self.entries[..self.count].iter().copied()
    }
}

/// Whether a boat is one of those meant.
fn is_meant(contacts: Contacts, scene: &Scene, other: &Other) -> bool {
    match contacts {
        Contacts::All => true,
        Contacts::Enemies => other.is_enemy,
        Contacts::Mates => !other.is_enemy,
        Contacts::Taggers => {
            // It tags on its own side only; where the own boat is about to be there it counts already.
            let soon = scene.at + scene.velocity.scaled(TAG_FORESIGHT_S);
            let exposed = !scene.chart.is_own_side(scene.at) || !scene.chart.is_own_side(soon);
            other.is_enemy && !other.tagged && !other.on_own_side && exposed && !scene.own.tagged
        }
    }
}

/// How far ahead a boat looks whether it comes to the side on which it can be tagged, s.
const TAG_FORESIGHT_S: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::{NEAREST_MAX, Nearest, nearness};

    #[test]
    fn the_nearest_of_many_are_heeded_in_order() {
        let many: Vec<(f64, usize)> = (0..100).map(|i| (f64::from((i * 37) % 50), i as usize)).collect();
        let mut sorted = many.clone();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        sorted.truncate(NEAREST_MAX);
        assert!(Nearest::of(many.into_iter()).iter().eq(sorted));
        assert_eq!(Nearest::of([(2.0, 0), (1.0, 1)].into_iter()).iter().collect::<Vec<_>>(), [(1.0, 1), (2.0, 0)]);
    }

    #[test]
    fn a_weight_falls_from_inner_to_outer_and_never_exceeds_itself() {
        for (distance_m, want) in [(0.0, 1.0), (10.0, 1.0), (15.0, 0.5), (20.0, 0.0), (90.0, 0.0)] {
            assert!((nearness(distance_m, 10.0, 20.0) - want).abs() < 1e-12, "{distance_m} m");
        }
        assert!(nearness(5.0, 5.0, 5.0) == 1.0 && nearness(5.1, 5.0, 5.0) == 0.0, "a step");
    }
}
