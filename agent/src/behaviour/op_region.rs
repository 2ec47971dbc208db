//! Operation region: keeps the boat on the field, and brings it back slowly from outside.

use super::clearance::Clearance;
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak, Table};
use crate::own_motion::Handling;
use crate::situation::Situation;
use primitives::instructions::Instructions;
use primitives::{Ned, SimTime};
use scenario::strategy::{BeyondHalt, OpRegion};
use std::f64::consts::PI;

/// How far inside the edge the target of a returning boat lies, m.
const WELL_IN_M: f64 = 5.0;
/// Additional distance from the edges per m/s of the drift's standard deviation, s, because waves
/// and gusts displace a boat and delay its turns. In a gale over a lake that deviation is 0.3 to
/// 0.5 m/s. The metres farthest from the edge count little; otherwise a few centimetres would
/// outweigh the boat's task, which has a twentieth of the weight.
const GUST_S: f64 = 36.0;
/// Width over which utility falls from the recovery speed to zero, m/s: the boat returns as slowly
/// as configured.
const RECOVERY_BASE_M_S: f64 = 0.5;

/// The side of the edge that the boat counts as being on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    In,
    Out,
}

#[derive(Clone)]
pub(super) struct OpRegionBehaviour {
    task: OpRegion,
    side: Side,
    /// When the boat crossed to the side that it does not yet count as being on.
    crossed: Option<SimTime>,
    table: Table,
    instructions: Instructions,
}

impl OpRegionBehaviour {
    pub(super) fn new(task: OpRegion) -> OpRegionBehaviour {
        let table = Table::default();
        let instructions = Instructions::best();
        OpRegionBehaviour {
            task,
            side: Side::In,
            crossed: None,
            table,
            instructions,
        }
    }

    /// A boat counts as outside, or inside again, only once it has been there for a while.
    fn debounce(&mut self, situation: &Situation, inside_m: f64) {
        let (is_other, wait_s) = match self.side {
            Side::In => (inside_m < 0.0, self.task.exit_s.value(situation)),
            Side::Out => (inside_m > 0.0, self.task.entry_s.value(situation)),
        };
        if !is_other {
            self.crossed = None;
            return;
        }
        let since = *self.crossed.get_or_insert(situation.now);
        // Seconds are rounded, nanoseconds are not: without this tolerance, a wait may last one
        // decision too long.
        if (situation.now - since).as_s() + 1e-9 >= wait_s {
            self.side = if self.side == Side::In {
                Side::Out
            } else {
                Side::In
            };
            self.crossed = None;
        }
    }
}

impl BehaviourLogic for OpRegionBehaviour {
    fn begin(&mut self, _situation: &Situation) {
        (self.side, self.crossed) = (Side::In, None);
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let region = Region::new(situation, self.task.margin_m.value(situation));
        let inside_m = region.inside_m();
        self.debounce(situation, inside_m);
        if self.side == Side::Out {
            if self.task.beyond_halt == BeyondHalt::Stops
                && -inside_m > self.task.halt_m.value(situation)
            {
                output.stop();
                return;
            }
            // Steer over the ground, so that the boat returns whatever the drift.
            let (heading_rad, speed_m_s) = situation.motion.steer(
                situation.at.bearing_rad(region.nearest_inside(situation)),
                self.task.recovery_speed_m_s.value(situation),
            );
            output.add(&Objective::Coupled {
                course: Peak::tent(heading_rad, PI),
                speed: Peak::tent(speed_m_s, RECOVERY_BASE_M_S),
                course_share: 0.5,
            });
            return;
        }
        let lookahead_s = self.task.lookahead_s.value(situation);
        let save_m = self.task.save_m.value(situation);
        // With this additional distance, boats left the field a quarter to a half less often in
        // wind and waves.
        let gust_m = GUST_S * situation.motion.spread_m_s();
        let save_m = (save_m + gust_m).max(0.1);
        // Beyond this distance no course leads out within the look-ahead, so skip the table.
        let reach_m = region.reach_m(situation, lookahead_s, save_m);
        if inside_m > reach_m {
            return;
        }
        self.table.clear(output.grid());
        let nav = &situation.own.nav;
        // With straight lines from the boat's position, turning around at full speed appears to
        // clear the edge, but a Surveyor at 2 m/s needs 7 s and 9 m to turn. Modelling the arc
        // reduced departures from 6.2 to 0.2 per boat-hour (200 games of 120 s, calm water,
        // `crates/arena/examples/safety.rs`).
        self.instructions.run(Clearance {
            table: &mut self.table,
            grid: output.grid(),
            edges: &region.edges,
            reach_m,
            heading_rad: nav.psi_rad,
            surge_m_s: (nav.surge_m_s - region.drift.dot(situation.ahead)).max(0.0),
            drift: region.drift,
            handling: region.handling,
            lookahead_s,
            save_m,
            bend: (gust_m / save_m).min(1.0),
        });
        output.add(&Objective::Table(&self.table));
    }
}

/// The region around the boat.
#[derive(Clone)]
struct Region {
    /// For each edge: its outward unit normal, and how far inside it the boat is, m.
    edges: [(Ned, f64); 4],
    /// Velocity that wind and current add to the boat's, m/s.
    drift: Ned,
    handling: Handling,
    /// How far the region's edges lie inside those of the field, m.
    margin_m: f64,
}

impl Region {
    fn new(situation: &Situation, margin_m: f64) -> Region {
        let field = &situation.model.field;
        let (x, y) = field.along_across(situation.at);
        let width_m = field.plan.width_m;
        let depth_m = field.plan.depth_m;
        let minus = |v: Ned| v.scaled(-1.0);
        Region {
            edges: [
                (minus(field.along), x - margin_m),
                (field.along, width_m - margin_m - x),
                (minus(field.across), y - margin_m),
                (field.across, depth_m - margin_m - y),
            ],
            // If drift is not estimated, use the boat's present sway: drift across the edge must
            // always count.
            drift: situation.motion.drift_now(&situation.own.nav),
            handling: situation.motion.handling(),
            margin_m,
        }
    }

    /// How far the boat is inside the region, m; negative outside.
    fn inside_m(&self) -> f64 {
        self.edges
            .iter()
            .map(|(_, inside_m)| *inside_m)
            .fold(f64::INFINITY, f64::min)
    }

    /// How far inside the region the boat must be so that no candidate comes near an edge, m.
    fn reach_m(&self, situation: &Situation, lookahead_s: f64, save_m: f64) -> f64 {
        let fastest_m_s = situation
            .model
            .speed_max_m_s
            .max(situation.own.nav.surge_m_s);
        // The widest turn leads outward by twice its radius.
        let turn_s = 2.0 / self.handling.mean_turn_rad_s(PI);
        save_m
            + (lookahead_s.max(turn_s) + self.handling.reaction_s)
                * (fastest_m_s + self.drift.length())
    }

    /// The nearest point that is well inside.
    fn nearest_inside(&self, situation: &Situation) -> Ned {
        let field = &situation.model.field;
        let (x, y) = field.along_across(situation.at);
        // Use at most half of the field's extent: in a field narrower than twice the margin, the
        // target is then the centre. `clamp` would panic if its limits crossed.
        let within = |v: f64, extent_m: f64| {
            let in_m = (self.margin_m + WELL_IN_M).min(0.5 * extent_m);
            v.clamp(in_m, extent_m - in_m)
        };
        field.at(within(x, field.plan.width_m), within(y, field.plan.depth_m))
    }
}
