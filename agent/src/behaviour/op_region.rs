//! Operation region: keeps the boat on the field, and brings it back slowly if it got out.

use super::Conduct;
use crate::helm::{Bid, Scene};
use crate::ivp::{Edge, Objective, Peak, Peaks, Stay};
use game::strategy::OpRegion;
use game::{Ned, SimTime};
use std::f64::consts::PI;

/// A course that leads out sooner than this share of the look-ahead is worth nothing.
const SOON: f64 = 0.4;
/// How far inside of the edge a boat steers for that comes back, m.
const WELL_IN_M: f64 = 5.0;
/// Half width of the peak at the recovery speed, m/s: none, it is as slow as said.
const RECOVERY_BASE_M_S: f64 = 0.5;

/// Where the boat counts as being.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    In,
    Out,
}

pub(super) struct Conductor {
    task: OpRegion,
    side: Side,
    /// Since when the boat has been on the other side of the edge than it counts.
    crossed: Option<SimTime>,
}

impl Conductor {
    pub(super) fn new(task: OpRegion) -> Conductor {
        Conductor { task, side: Side::In, crossed: None }
    }

    /// A boat counts as out, or in again, when it has been so for a while.
    fn debounce(&mut self, scene: &Scene, inside_m: f64) {
        let (is_other, wait_s) = match self.side {
            Side::In => (inside_m < 0.0, self.task.exit_s.value(scene)),
            Side::Out => (inside_m > 0.0, self.task.entry_s.value(scene)),
        };
        if !is_other {
            self.crossed = None;
            return;
        }
        let since = *self.crossed.get_or_insert(scene.now);
        if (scene.now - since).as_s() + 1e-9 >= wait_s {
            self.side = if self.side == Side::In { Side::Out } else { Side::In };
            self.crossed = None;
        }
    }
}

impl Conduct for Conductor {
    fn begin(&mut self, _scene: &Scene) {
        (self.side, self.crossed) = (Side::In, None);
    }

    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let region = Region::new(scene, self.task.margin_m.value(scene));
        let inside_m = region.inside_m();
        self.debounce(scene, inside_m);
        if self.side == Side::Out {
            if -inside_m > self.task.halt_m.value(scene) {
                bid.stop();
                return;
            }
            let speed_m_s = self.task.recovery_speed_m_s.value(scene).min(scene.chart.speed_max_m_s);
            bid.ask(&Objective::Coupled {
                course: Peaks::one(Peak::tent(scene.at.bearing_rad(region.nearest_inside(scene)), PI)),
                speed: Peaks::one(Peak::tent(speed_m_s, RECOVERY_BASE_M_S)),
                course_share: 0.5,
            });
            return;
        }
        let (lookahead_s, save_m) = (self.task.lookahead_s.value(scene), self.task.save_m.value(scene));
        let reach_m = save_m + lookahead_s * (scene.chart.speed_max_m_s + region.drift.length());
        if inside_m > reach_m {
            return;
        }
        // Within `save_m` of the edge the boat counts as outside of a smaller region, and is turned back into it.
        let mut stay = Stay::new(SOON * lookahead_s, lookahead_s).drifting(region.drift.north, region.drift.east);
        for (normal, edge_m) in region.edges {
            let inside_m = edge_m - save_m;
            stay = stay.and(Edge { normal_north: normal.north, normal_east: normal.east, inside_m });
        }
        bid.ask(&Objective::Stay(stay));
    }
}

/// The region about the boat.
struct Region {
    /// By edge: outward normal, and how far inside of it the boat is, m.
    edges: [(Ned, f64); 4],
    /// What wind and current add to the boat's way, m/s: what it moves sideways.
    drift: Ned,
    /// How far the region is inside of the field, m.
    margin_m: f64,
}

impl Region {
    fn new(scene: &Scene, margin_m: f64) -> Region {
        let field = &scene.chart.field;
        let (x, y) = field.along_across(scene.at);
        let (width_m, depth_m) = (field.plan.width_m, field.plan.depth_m);
        let minus = |v: Ned| v.scaled(-1.0);
        let (sin, cos) = game::math::sin_cos(scene.own.nav.psi_rad);
        let starboard = Ned { north: -sin, east: cos };
        Region {
            edges: [
                (minus(field.along), x - margin_m),
                (field.along, width_m - margin_m - x),
                (minus(field.across), y - margin_m),
                (field.across, depth_m - margin_m - y),
            ],
            drift: starboard.scaled(scene.own.nav.sway_m_s),
            margin_m,
        }
    }

    /// How far inside the boat is, m; negative outside.
    fn inside_m(&self) -> f64 {
        self.edges.iter().map(|(_, inside_m)| *inside_m).fold(f64::INFINITY, f64::min)
    }

    /// The nearest point well inside.
    fn nearest_inside(&self, scene: &Scene) -> Ned {
        let field = &scene.chart.field;
        let (x, y) = field.along_across(scene.at);
        let within = |v: f64, extent_m: f64| {
            let in_m = (self.margin_m + WELL_IN_M).min(0.5 * extent_m);
            v.clamp(in_m, extent_m - in_m)
        };
        field.at(within(x, field.plan.width_m), within(y, field.plan.depth_m))
    }
}
