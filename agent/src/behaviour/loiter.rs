//! Loiter: drives round and round a convex polygon.

use super::waypoint::Approach;
use super::{Conduct, drive};
use crate::helm::{Bid, Scene};
use game::field::{distance_to_outline, sides};
use game::strategy::{Ellipse, Loiter, Shape, Turn};
use game::{Ned, math};
use std::f64::consts::TAU;

pub(super) struct Conductor {
    task: Loiter,
    /// The corners, clockwise.
    corners: Vec<Ned>,
    /// The corner that is steered for; none until the first is chosen.
    target: Option<usize>,
    clockwise: bool,
    approach: Approach,
}

impl Conductor {
    pub(super) fn new(task: Loiter) -> Conductor {
        Conductor { task, corners: Vec::new(), target: None, clockwise: true, approach: Approach::new() }
    }

    /// The corner to steer for first, and which way round from there: the corners ahead in the chosen direction.
    fn choose(&mut self, scene: &Scene) {
        let centre = centre_of(&self.corners);
        let out = scene.at - centre;
        self.clockwise = match self.task.turn {
            Turn::Clockwise => true,
            Turn::Counterclockwise => false,
            // North-east-down: the cross product is positive where the course goes clockwise round the centre.
            Turn::Best => {
                let (east, north) = math::sin_cos(scene.own.nav.psi_rad);
                out.north * east - out.east * north >= 0.0
            }
        };
        let count = self.corners.len();
        let distance = |i: usize| scene.at.distance_squared(self.corners[i]);
        let nearest = (1..count).fold(0, |best, i| if distance(i) < distance(best) { i } else { best });
        self.target = Some(self.after(nearest));
        self.approach = Approach::new();
    }

    fn after(&self, corner: usize) -> usize {
        let count = self.corners.len();
        if self.clockwise { (corner + 1) % count } else { (corner + count - 1) % count }
    }
}

impl Conduct for Conductor {
    fn begin(&mut self, scene: &Scene) {
        self.target = None;
        corners_of(&self.task.shape, scene, &mut self.corners);
    }

    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        if self.corners.len() < 3 {
            // What it goes round was not known when it began.
            corners_of(&self.task.shape, scene, &mut self.corners);
        }
        if self.corners.len() < 3 {
            return;
        }
        let far = distance_to_outline(&self.corners, scene.at) > self.task.acquire_m.value(scene);
        if self.target.is_none() || far {
            self.choose(scene);
        }
        let Some(mut target) = self.target else { return };
        let (capture_m, slip_m) = (self.task.capture_radius_m.value(scene), self.task.slip_radius_m.value(scene));
        // On a short way round several corners may be behind the boat at once, but never all of them.
        for _ in 1..self.corners.len() {
            if !self.approach.reaches(scene.at.distance(self.corners[target]), capture_m, slip_m) {
                break;
            }
            (bid.reached, self.approach) = (true, Approach::new());
            target = self.after(target);
        }
        self.target = Some(target);
        bid.ask(&drive(scene, self.corners[target], self.task.speed_m_s.value(scene)));
    }
}

/// The corners of a shape, clockwise; none if a place of it is not known.
fn corners_of(shape: &Shape, scene: &Scene, corners: &mut Vec<Ned>) {
    corners.clear();
    match shape {
        Shape::Corners(places) => {
            let known = places.iter().filter_map(|place| scene.spot(place));
            corners.extend(known.map(|spot| spot.at));
            if corners.len() != places.len() {
                corners.clear();
            }
        }
        Shape::Ellipse(Ellipse { centre, along_m, across_m, corners: count }) => {
            let Some(centre) = scene.spot(centre) else { return };
            let field = &scene.chart.field;
            corners.extend((0..*count).map(|i| {
                let (sin, cos) = math::sin_cos(TAU * i as f64 / *count as f64);
                centre.at + field.along.scaled(0.5 * along_m * cos) + field.across.scaled(0.5 * across_m * sin)
            }));
        }
    }
    if turns_clockwise(corners) < 0.0 {
        corners.reverse();
    }
}

/// Twice the area that the corners go round clockwise, m²; negative if they go the other way.
fn turns_clockwise(corners: &[Ned]) -> f64 {
    sides(corners).map(|(a, b)| a.north * b.east - a.east * b.north).sum()
}

fn centre_of(corners: &[Ned]) -> Ned {
    let sum = corners.iter().fold(Ned::default(), |sum, corner| sum + *corner);
    sum.scaled(1.0 / corners.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_told_clockwise_from_the_other_way() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(north, east)| Ned { north, east });
        assert!((turns_clockwise(&square) - 200.0).abs() < 1e-9, "north, then east: clockwise");
        let mut other = square;
        other.reverse();
        assert!((turns_clockwise(&other) + 200.0).abs() < 1e-9);
    }
}
