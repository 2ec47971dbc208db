//! Loiter: circles a convex polygon.

use super::arrival::Arrival;
use super::steering::toward;
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::Situation;
use primitives::{Ned, math};
use rules::field::{distance_to_outline, sides};
use scenario::strategy::{Ellipse, Loiter, Shape, Turn};
use std::f64::consts::TAU;

#[derive(Clone)]
pub(super) struct LoiterBehaviour {
    task: Loiter,
    /// The corners, clockwise.
    corners: Vec<Ned>,
    /// The corner to steer for; `None` until the first is chosen.
    target: Option<usize>,
    clockwise: bool,
    arrival: Arrival,
}

impl LoiterBehaviour {
    pub(super) fn new(task: Loiter) -> LoiterBehaviour {
        LoiterBehaviour {
            task,
            corners: Vec::new(),
            target: None,
            clockwise: true,
            arrival: Arrival::new(),
        }
    }

    /// Chooses the direction of travel and the first corner to steer for.
    fn choose(&mut self, situation: &Situation) {
        let centre = centre_of(&self.corners);
        let out = situation.at - centre;
        self.clockwise = match self.task.turn {
            Turn::Clockwise => true,
            Turn::Counterclockwise => false,
            // In north-east-down, the cross product is positive for a clockwise course around the
            // centre.
            Turn::Best => {
                let (east, north) = math::sin_cos(situation.own.nav.psi_rad);
                out.north * east - out.east * north >= 0.0
            }
        };
        let count = self.corners.len();
        let distance = |i: usize| situation.at.distance_squared(self.corners[i]);
        let nearest = (1..count).fold(0, |best, i| {
            if distance(i) < distance(best) {
                i
            } else {
                best
            }
        });
        // Steer for the corner after the nearest one, because the nearest may be behind the boat.
        self.target = Some(self.after(nearest));
        self.arrival = self.arrival.next();
    }

    fn after(&self, corner: usize) -> usize {
        let count = self.corners.len();
        if self.clockwise {
            (corner + 1) % count
        } else {
            (corner + count - 1) % count
        }
    }
}

impl BehaviourLogic for LoiterBehaviour {
    fn begin(&mut self, situation: &Situation) {
        (self.target, self.arrival) = (None, Arrival::new());
        corners_of(&self.task.shape, situation, &mut self.corners);
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        if self.corners.len() < 3 {
            // The place to circle was unknown at the start.
            corners_of(&self.task.shape, situation, &mut self.corners);
        }
        if self.corners.len() < 3 {
            return;
        }
        // A boat forced away by an evasion or a tag rejoins the nearest part of the polygon, not
        // its previous target corner.
        let far =
            distance_to_outline(&self.corners, situation.at) > self.task.acquire_m.value(situation);
        if self.target.is_none() || far {
            self.choose(situation);
        }
        let Some(mut target) = self.target else {
            return;
        };
        let capture_m = self.task.capture_radius_m.value(situation);
        let slip_m = self.task.slip_radius_m.value(situation);
        // On a small polygon several corners may be behind the boat at once, but never all of them.
        for _ in 1..self.corners.len() {
            if !self
                .arrival
                .reaches(self.corners[target] - situation.at, capture_m, slip_m)
            {
                break;
            }
            (output.reached, self.arrival) = (true, self.arrival.next());
            target = self.after(target);
        }
        self.target = Some(target);
        output.add(&toward(
            situation,
            self.corners[target],
            self.task.speed_m_s.value(situation),
        ));
    }
}

/// Replaces `corners` with the corners of a shape, clockwise, or with none if a place in it is
/// unknown.
pub(crate) fn corners_of(shape: &Shape, situation: &Situation, corners: &mut Vec<Ned>) {
    corners.clear();
    match shape {
        Shape::Corners(places) => {
            let known = places.iter().filter_map(|place| situation.locate(place));
            corners.extend(known.map(|point| point.at));
            if corners.len() != places.len() {
                corners.clear();
            }
        }
        Shape::Ellipse(Ellipse {
            centre,
            along_m,
            across_m,
            corners: count,
        }) => {
            let Some(centre) = situation.locate(centre) else {
                return;
            };
            let field = &situation.model.field;
            corners.extend((0..*count).map(|i| {
                let (sin, cos) = math::sin_cos(TAU * i as f64 / *count as f64);
                centre.at
                    + field.along.scaled(0.5 * along_m * cos)
                    + field.across.scaled(0.5 * across_m * sin)
            }));
        }
    }
    // Files may list corners in either direction; `turn` sets the direction of travel.
    if turns_clockwise(corners) < 0.0 {
        corners.reverse();
    }
}

/// Twice the signed area of the polygon, m²; positive if its corners are in clockwise order.
fn turns_clockwise(corners: &[Ned]) -> f64 {
    sides(corners)
        .map(|(a, b)| a.north * b.east - a.east * b.north)
        .sum()
}

fn centre_of(corners: &[Ned]) -> Ned {
    let sum = corners
        .iter()
        .fold(Ned::default(), |sum, corner| sum + *corner);
    sum.scaled(1.0 / corners.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_told_clockwise_from_the_other_way() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .map(|(north, east)| Ned { north, east });
        assert!(
            (turns_clockwise(&square) - 200.0).abs() < 1e-9,
            "north, then east: clockwise"
        );
        let mut other = square;
        other.reverse();
        assert!((turns_clockwise(&other) + 200.0).abs() < 1e-9);
    }
}
