//! Warnings about points of a strategy inside a boat's turning circle, which the boat cannot reach.

use crate::behaviour::corners_of;
use crate::roles::role_of;
use crate::situation::Situation;
use primitives::{Ned, VehicleId};
use scenario::Scenario;
use scenario::strategy::{Behaviour, Mark, Parameter, Place, Shape, Task};
use std::collections::BTreeSet;

/// Warnings about a valid game: points in the boats' roles that the boats cannot reach.
///
/// A boat that has reached a point of a `waypoint` or a corner of a `loiter` turns at once towards
/// the next one. If that point lies inside the turning circle by more than the capture radius, the
/// boat circles it or misses it. Only points that are constant throughout the game are checked.
pub fn warnings(scenario: &Scenario) -> Vec<String> {
    let boats = (0..scenario.vehicles.len()).map(VehicleId::at);
    // Boats with the same role have the same warning, listed once and in a fixed order.
    let warnings: BTreeSet<String> = boats
        .flat_map(|vehicle| of_boat(scenario, vehicle))
        .collect();
    warnings.into_iter().collect()
}

/// The warnings for one boat.
fn of_boat(scenario: &Scenario, vehicle: VehicleId) -> Vec<String> {
    let program = role_of(scenario, vehicle);
    let boat = scenario.boat_of(vehicle);
    let situation = Situation::new(scenario, vehicle, program, program.helm.compensates_drift);
    let turn_rad_s = situation.motion.handling().turn_rad_s;
    let most_m_s = situation.model.speed_max_m_s;
    let warning = |behaviour: &Behaviour| {
        let (points, again, speed_m_s, capture_m) = way(&behaviour.task, &situation)?;
        let speed_m_s = speed_m_s.constant().unwrap_or(most_m_s).min(most_m_s);
        let circle_m = speed_m_s / turn_rad_s;
        let missed = beyond_reach(&points, again, circle_m, capture_m.constant()?);
        let first = missed.first()?;
        Some(format!(
            "{}: behaviour {:?}: {} of {} points lie within the turning circle of a {} coming from the previous point \
             ({circle_m:.1} m at {speed_m_s:.1} m/s), first point {}: the boat will miss them; use a larger \
             `capture_radius_m`, a lower `speed_m_s` or points farther apart",
            program.name,
            behaviour.name,
            missed.len(),
            points.len(),
            boat.name,
            first + 1
        ))
    };
    program.behaviours.iter().filter_map(warning).collect()
}

/// The points of a path if they are constant, whether it repeats, its speed and its capture radius.
fn way<'a>(
    task: &'a Task,
    situation: &Situation,
) -> Option<(Vec<Ned>, bool, &'a Parameter, &'a Parameter)> {
    match task {
        Task::Waypoint(task) => {
            let points: Option<Vec<Ned>> = task
                .points
                .iter()
                .map(|place| fixed(place, situation))
                .collect();
            let mut points = points?;
            if task.reverse {
                points.reverse();
            }
            Some((
                points,
                task.repeat.constant() != Some(0.0),
                &task.speed_m_s,
                &task.capture_radius_m,
            ))
        }
        Task::Loiter(task) => {
            let places = match &task.shape {
                Shape::Corners(places) => &places[..],
                Shape::Ellipse(ellipse) => std::slice::from_ref(&ellipse.centre),
            };
            places
                .iter()
                .all(|place| fixed(place, situation).is_some())
                .then_some(())?;
            let mut corners = Vec::new();
            corners_of(&task.shape, situation, &mut corners);
            Some((corners, true, &task.speed_m_s, &task.capture_radius_m))
        }
        _ => None,
    }
}

/// The position of a place, if it is constant throughout the game.
fn fixed(place: &Place, situation: &Situation) -> Option<Ned> {
    let stays = matches!(
        place,
        Place::At(_) | Place::Point(_) | Place::Mark(Mark::OwnFlag)
    );
    stays
        .then(|| situation.locate(place))?
        .map(|point| point.at)
}

/// Indices of the points inside the turning circle of a boat that reaches the previous point
/// straight from the one before.
fn beyond_reach(points: &[Ned], again: bool, circle_m: f64, capture_m: f64) -> Vec<usize> {
    let count = points.len();
    let is_missed = |i: &usize| {
        let [from, at, to] = [count + i - 2, count + i - 1, *i].map(|i| points[i % count]);
        let came = at - from;
        let goes = to - at;
        let came_m = came.length();
        let goes_m = goes.length();
        if came_m < 1e-6 || goes_m < 1e-6 {
            return false;
        }
        // The circle is tangent to the path at `at`, on the side of `to`.
        let ahead_m = came.dot(goes) / came_m;
        let aside_m = (came.north * goes.east - came.east * goes.north).abs() / came_m;
        let to_centre_m = primitives::math::length(ahead_m, circle_m - aside_m);
        circle_m - to_centre_m > capture_m
    };
    if count < 3 {
        Vec::new()
    } else {
        (if again { 0 } else { 2 }..count)
            .filter(is_missed)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::beyond_reach;
    use primitives::Ned;

    #[test]
    fn a_point_within_the_circle_is_beyond_reach() {
        // North for 20 m, then to a point 8 m abeam: the centre of a circle of radius 8 m.
        let to = |north: f64, east: f64| {
            [
                Ned {
                    north: -20.0,
                    east: 0.0,
                },
                Ned::default(),
                Ned { north, east },
            ]
        };
        for (what, points, circle_m, capture_m, want) in [
            ("at its centre", to(0.0, 8.0), 8.0, 3.0, vec![2]),
            ("at its centre, to port", to(0.0, -8.0), 8.0, 3.0, vec![2]),
            ("a smaller circle", to(0.0, 8.0), 5.0, 3.0, vec![]),
            ("a wide capture", to(0.0, 8.0), 8.0, 8.1, vec![]),
            ("on the circle", to(8.0, 8.0), 8.0, 0.1, vec![]),
            ("straight on", to(20.0, 0.0), 8.0, 0.1, vec![]),
            ("straight back", to(-20.0, 0.0), 8.0, 0.1, vec![]),
        ] {
            assert_eq!(
                beyond_reach(&points, false, circle_m, capture_m),
                want,
                "{what}"
            );
        }
        // On a small repeated square, every corner is out of reach.
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
            .map(|(north, east)| Ned { north, east });
        assert_eq!(beyond_reach(&square, true, 10.0, 1.0), [0, 1, 2, 3]);
        assert_eq!(beyond_reach(&square, false, 10.0, 1.0), [2, 3]);
        assert_eq!(beyond_reach(&square[..2], true, 10.0, 1.0), [0_usize; 0]);
    }
}
