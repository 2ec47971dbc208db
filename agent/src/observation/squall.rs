//! The observation space `squall`: data from the boat's sensors and the radio, in a frame that is
//! the same for both teams.
//!
//! Places on the field are relative to its centre: ahead, as the team faces the enemies' end, and
//! to port. Other boats and goals are expressed in the boat's own axes. Lengths are in hundreds of
//! metres, each paired with a nearness, 10 m / (10 m + distance). Speeds are in units of 3 m/s;
//! booleans are 0 or 1.

use super::numbers::Numbers;
use crate::situation::{OtherBoat, Situation};
use primitives::frame::Rotation;
use primitives::{Ned, math};
use rules::Ability;
use scenario::observation::squall::OTHER;
use scenario::strategy::{Fact, Mark, Place, Values};

/// Unit of lengths, m.
const LENGTH_M: f64 = 100.0;
/// Maximum length in these units; longer ones are clamped.
const LENGTHS_MAX: f64 = 3.0;
/// Distance with a nearness of 0.5, m: the tag radius of the Aquaticus rules.
const NEAR_M: f64 = 10.0;
/// Unit of speeds, m/s: a Surveyor's top speed.
const SPEED_M_S: f64 = 3.0;
/// Unit of yaw rates, rad/s.
const YAW_RATE_RAD_S: f64 = 0.5;
/// Unit of ages, s.
const AGE_S: f64 = 10.0;
/// Distance beyond which edges and obstacles make no difference, m.
const FAR_M: f64 = 20.0;
const POINTS: f64 = 10.0;

/// Writes all values.
pub(super) fn write(
    situation: &Situation,
    (mates, enemies): (usize, usize),
    out: &mut Numbers<'_>,
) {
    own_boat(situation, out);
    edges(situation, out);
    goals(situation, out);
    game(situation, out);
    let distance = |other: &OtherBoat| situation.at.distance_squared(other.at);
    for (is_enemy, count) in [(false, mates), (true, enemies)] {
        let others = situation.others();
        let mut others: Vec<_> = others.filter(|other| other.is_enemy == is_enemy).collect();
        // Sort enemies by distance: the scenario's order means nothing to a policy, and if there
        // are too few slots, the nearest boats are kept. Teammates keep their slots if all fit.
        if is_enemy || others.len() > count {
            others.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        }
        slots(situation, others.into_iter(), count, out);
    }
}

/// Unit vectors in the team's forward and port directions.
fn team_axes(situation: &Situation) -> (Ned, Ned) {
    let field = &situation.model.field;
    let sign = if situation.model.team.index() == 0 {
        1.0
    } else {
        -1.0
    };
    (field.along.scaled(sign), field.across.scaled(sign))
}

/// 15 values: position, heading, motion and state.
fn own_boat(situation: &Situation, out: &mut Numbers<'_>) {
    let (forward, port) = team_axes(situation);
    let field = &situation.model.field;
    let from_middle = situation.at - field.middle();
    out.push(from_middle.dot(forward) / (0.5 * field.plan.width_m));
    out.push(from_middle.dot(port) / (0.5 * field.plan.depth_m));
    out.push(situation.ahead.dot(forward));
    out.push(situation.ahead.dot(port));
    out.extend(along_axes(situation, situation.velocity).map(|m_s| m_s / SPEED_M_S));
    out.push(situation.own.nav.yaw_rate_rad_s / YAW_RATE_RAD_S);
    out.extend(along_axes(situation, situation.motion.drift()).map(|m_s| m_s / SPEED_M_S));
    out.push(situation.motion.spread_m_s() / SPEED_M_S);
    out.flag(situation.own.tagged);
    out.flag(situation.own.carried_flag().is_some());
    out.flag(situation.own.outside);
    out.flag(situation.own.disabled);
    out.flag(Ability::from(&situation.own).may_tag(situation.now));
}

/// 6 values: nearness of the four edges and of the nearest obstacle, and speed.
fn edges(situation: &Situation, out: &mut Numbers<'_>) {
    let (forward, port) = team_axes(situation);
    let plan = &situation.model.field.plan;
    let from_middle = situation.at - situation.model.field.middle();
    for (axis, half_m) in [(forward, 0.5 * plan.width_m), (port, 0.5 * plan.depth_m)] {
        let along_m = from_middle.dot(axis);
        out.extend([half_m - along_m, half_m + along_m].map(|m| (1.0 - m / FAR_M).clamp(0.0, 2.0)));
    }
    let obstacles = plan
        .obstacles
        .iter()
        .map(|obstacle| obstacle.distance(situation.at));
    let nearest_m = obstacles.fold(f64::INFINITY, f64::min);
    out.push((1.0 - nearest_m / FAR_M).max(0.0));
    out.push((situation.own.nav.speed_m_s() / situation.model.speed_max_m_s.max(0.1)).min(2.0));
}

/// 16 values: the enemies' flag, the team's own flag, the place for capturing or untagging, and
/// whichever of these is the current goal.
fn goals(situation: &Situation, out: &mut Numbers<'_>) {
    let at = |mark| {
        situation
            .locate(&Place::Mark(mark))
            .map_or(situation.at, |point| point.at)
    };
    let enemy_flag = at(Mark::EnemyFlag);
    let own_flag = at(Mark::OwnFlag);
    let capture = at(Mark::CapturePlace);
    let untag = at(Mark::UntagPlace);
    let own = &situation.own;
    let goal = if own.tagged {
        untag
    } else if own.carried_flag().is_some() {
        capture
    } else {
        enemy_flag
    };
    for place in [enemy_flag, own_flag, untag, goal] {
        toward(situation, place, out);
    }
}

/// 7 values: flags, points, time, and the boat's index in its team.
fn game(situation: &Situation, out: &mut Numbers<'_>) {
    for fact in [
        Fact::OwnSide,
        Fact::FlagTaken,
        Fact::EnemyFlagTaken,
        Fact::MateHasFlag,
    ] {
        out.push(situation.fact(fact));
    }
    let ahead = situation.fact(Fact::Score) - situation.fact(Fact::EnemyScore);
    out.push((ahead / POINTS).clamp(-1.0, 1.0));
    let limit_s = situation.model.rules.time_limit.as_s().max(1.0);
    out.push((situation.fact(Fact::TimeLeftS) / limit_s).clamp(0.0, 1.0));
    out.push(situation.model.rank as f64 / (situation.model.mates.len() + 1) as f64);
}

/// One entry per slot; unused slots are zeros.
fn slots<'a>(
    situation: &Situation,
    others: impl Iterator<Item = &'a OtherBoat>,
    count: usize,
    out: &mut Numbers<'_>,
) {
    let mut empty = count;
    for other in others.take(count) {
        other_boat(situation, other, out);
        empty -= 1;
    }
    out.skip(empty * OTHER);
}

/// 16 values for one boat.
fn other_boat(situation: &Situation, other: &OtherBoat, out: &mut Numbers<'_>) {
    out.flag(true);
    toward(situation, other.at, out);
    out.extend(along_axes(situation, other.velocity()).map(|m_s| m_s / SPEED_M_S));
    let heading = Rotation::from_heading(other.psi_rad).ahead();
    out.extend(along_axes(situation, heading));
    out.flag(other.tagged);
    out.flag(other.carrying.is_some());
    out.flag(other.intrudes);
    out.flag(situation.model.is_own_side(other.at));
    out.push(
        situation
            .model
            .rules
            .tag_wait_share(other.tag_ready, situation.now),
    );
    out.push((other.age_s / AGE_S).min(1.0));
    let home = situation.model.own_flag_near(other.at, situation.now);
    out.push(NEAR_M / (NEAR_M + other.at.distance(home)));
}

/// 4 values: direction of a place in the boat's axes, distance and nearness.
fn toward(situation: &Situation, place: Ned, out: &mut Numbers<'_>) {
    let line = place - situation.at;
    let [ahead_m, starboard_m] = along_axes(situation, line);
    let distance_m = math::length(ahead_m, starboard_m);
    // Give the direction as two components: an angle would jump from half a turn to minus half a
    // turn astern.
    let per_m = if distance_m > 1e-6 {
        1.0 / distance_m
    } else {
        0.0
    };
    out.extend([ahead_m * per_m, starboard_m * per_m]);
    out.push((distance_m / LENGTH_M).min(LENGTHS_MAX));
    // The nearness complements the distance in hundreds of metres, in which the last ten metres,
    // where boats tag and touch, are only a tenth of a unit.
    out.push(NEAR_M / (NEAR_M + distance_m));
}

/// The forward and starboard components of a vector.
fn along_axes(situation: &Situation, vector: Ned) -> [f64; 2] {
    let ahead = situation.ahead;
    [
        vector.dot(ahead),
        vector.east * ahead.north - vector.north * ahead.east,
    ]
}
