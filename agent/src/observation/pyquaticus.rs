//! The observation spaces of Pyquaticus (`state_to_obs` of its main branch, 2023 and 2025, and of
//! the 2026 competition): bearings relative to the heading in half turns clockwise, distances in
//! field diagonals, everything scaled to -1 to 1, booleans as -1 and 1.
//!
//! For the boat itself: the enemies' flag, its own flag, the walls to starboard, behind, to port
//! and ahead as the team faces the enemies' end, the scrimmage line, speed, carrying, own side,
//! time since its last tag, tagged, out of action (2026), both scores (not in 2023). Then for each
//! other boat, teammates first: bearing, distance, heading relative to the line to this boat,
//! speed, carrying, own side, time since its last tag, tagged, out of action (2026).
//!
//! Pyquaticus provides the true values; this space provides those that the boat knows. All values
//! of an unknown boat are 0. An enemy's last tag time is known if it tagged a boat of the team.

use super::numbers::Numbers;
use crate::situation::{OtherBoat, Situation};
use primitives::angle::wrap_pi;
use primitives::{Ned, SimTime};
use rules::tag_wait_s;
use scenario::observation::pyquaticus::Edition;
use scenario::strategy::{Fact, Mark, Place, Values};
use std::f64::consts::PI;

/// Writes all values.
pub(super) fn write(situation: &Situation, edition: Edition, out: &mut Numbers<'_>) {
    let model = &situation.model;
    let longest_m = longest_m(situation, edition);
    for mark in [Mark::EnemyFlag, Mark::OwnFlag] {
        let place = situation
            .locate(&Place::Mark(mark))
            .map_or(situation.at, |point| point.at);
        toward(situation, place, (edition, longest_m), out);
    }
    // Corner 0 is to starboard of the first team's end, and corners continue clockwise: the walls
    // are 3 to 0, 0 to 1, 1 to 2, 2 to 3.
    let corners = &model.field.corners;
    for i in [3, 0, 1, 2].map(|i| i + 2 * model.team.index()) {
        let wall = (corners[i % 4], corners[(i + 1) % 4]);
        toward(
            situation,
            nearest_of(wall, situation.at),
            (edition, longest_m),
            out,
        );
    }
    let [one, other] = model.field.scrimmage;
    let scrimmage_m = if edition == Edition::Of2023 {
        model.field.plan.width_m / 2.0
    } else {
        longest_m
    };
    let nearest = nearest_of((one, other), situation.at);
    toward(situation, nearest, (edition, scrimmage_m), out);
    let own = &situation.own;
    out.push(unit(edition, own.nav.speed_m_s(), fastest_m_s(situation)));
    truth(own.carried_flag().is_some(), out);
    truth(
        is_own_side(
            situation,
            (situation.at, situation.velocity),
            model.team.index(),
        ),
        out,
    );
    out.push(since_tag(situation, edition, own.tag_ready_ns));
    truth(own.tagged, out);
    if edition == Edition::Of2026 {
        truth(own.disabled, out);
    }
    if edition != Edition::Of2023 {
        for score in [Fact::Score, Fact::EnemyScore] {
            out.push(unit(edition, situation.fact(score), model.score_max));
        }
    }
    for vehicle in model.mates.iter().chain(&model.enemies) {
        match situation.others().find(|other| other.vehicle == *vehicle) {
            Some(other) => other_boat(situation, other, edition, out),
            None => out.skip(edition.other_names().count()),
        }
    }
}

fn other_boat(situation: &Situation, other: &OtherBoat, edition: Edition, out: &mut Numbers<'_>) {
    let model = &situation.model;
    toward(
        situation,
        other.at,
        (edition, longest_m(situation, edition)),
        out,
    );
    out.push(wrap_pi(other.psi_rad - other.at.bearing_rad(situation.at)) / PI);
    out.push(unit(
        edition,
        other.velocity().length(),
        fastest_m_s(situation),
    ));
    truth(other.carrying.is_some(), out);
    let team = if other.is_enemy {
        1 - model.team.index()
    } else {
        model.team.index()
    };
    truth(
        is_own_side(situation, (other.at, other.velocity()), team),
        out,
    );
    out.push(since_tag(situation, edition, other.tag_ready));
    truth(other.tagged, out);
    if edition == Edition::Of2026 {
        truth(other.disabled, out);
    }
}

/// The distance that is scaled to 1, m.
fn longest_m(situation: &Situation, edition: Edition) -> f64 {
    let plan = &situation.model.field.plan;
    let beyond_m = if edition == Edition::Of2023 {
        10.0
    } else {
        0.0
    };
    primitives::math::length(plan.width_m, plan.depth_m) + beyond_m
}

/// Bearing and distance to a place.
fn toward(
    situation: &Situation,
    place: Ned,
    (edition, longest_m): (Edition, f64),
    out: &mut Numbers<'_>,
) {
    out.push(wrap_pi(situation.at.bearing_rad(place) - situation.own.nav.psi_rad) / PI);
    out.push(unit(edition, situation.at.distance(place), longest_m));
}

/// Whether a boat was on a team's side of the scrimmage line a tick ago, on the field or not:
/// Pyquaticus tests this before a boat moves, and by a rule that differs from `Field::is_own_side`.
fn is_own_side(situation: &Situation, (at, velocity): (Ned, Ned), team: usize) -> bool {
    let field = &situation.model.field;
    let before = at - velocity.scaled(situation.model.tick_s);
    let beyond_m = (before - field.middle()).dot(field.along);
    // A boat on the line counts as on its own side for both teams.
    if team == 0 {
        beyond_m <= 0.0
    } else {
        beyond_m >= 0.0
    }
}

/// The point of a line segment that is nearest to a place.
fn nearest_of((a, b): (Ned, Ned), at: Ned) -> Ned {
    let line = b - a;
    a + line.scaled(((at - a).dot(line) / line.dot(line)).clamp(0.0, 1.0))
}

/// The time since the last tag, limited to the cooldown, s.
fn since_tag(situation: &Situation, edition: Edition, ready: SimTime) -> f64 {
    let cooldown_s = situation.model.rules.tag_cooldown.as_s();
    let wait_s = tag_wait_s(ready, situation.now).min(cooldown_s);
    unit(edition, cooldown_s - wait_s, cooldown_s)
}

/// The top speed of the game's fastest boat, m/s.
fn fastest_m_s(situation: &Situation) -> f64 {
    situation
        .model
        .boat_speeds_m_s
        .iter()
        .copied()
        .fold(0.0, f64::max)
}

/// Maps 0 to `most` onto -1 to 1; in 2023, larger values exceed this range.
fn unit(edition: Edition, number: f64, most: f64) -> f64 {
    let scaled = 2.0 * number / most - 1.0;
    match edition {
        _ if most <= 0.0 => 1.0,
        Edition::Of2023 => scaled,
        Edition::Of2025 | Edition::Of2026 => scaled.clamp(-1.0, 1.0),
    }
}

fn truth(is: bool, out: &mut Numbers<'_>) {
    out.push(if is { 1.0 } else { -1.0 });
}
