//! The water where a boat may be: a polygon without the keep-outs.

use crate::config::Geofence;
use crate::geodesy::LocalFrame;
use primitives::frame::{LatLon, Ned};
use primitives::{VehicleId, math};
use rules::field::{Field, distance_to_outline, do_meet, is_within, sides};
use scenario::{Scenario, StartPosition};
use thiserror::Error;

/// Angle step for drawing a rounded corner, degrees. This cuts off less than half a per cent of the
/// margin.
const ROUND_STEP_DEG: f64 = 90.0 / 8.0;

/// Why a geofence does not suit a game.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GeofenceError {
    /// A keep-out is outside the geofence.
    #[error("keep_out {0} (the first is 0) lies outside the geofence; move it inside")]
    KeepOutOutside(usize),
    /// The boat would start outside the permitted water.
    #[error("{0} must start inside the geofence and outside keep-outs")]
    StartOutside(String),
}

/// The water where a boat may be, excluding its edges.
#[derive(Clone, Debug, PartialEq)]
pub struct GeofenceArea {
    /// The corners of the outline, in order.
    pub outline: Vec<Ned>,
    /// The corners of the keep-outs.
    pub keep_out: Vec<Vec<Ned>>,
}

impl GeofenceArea {
    /// The geofence on this field.
    pub fn new(field: &Field, rules: &Geofence) -> GeofenceArea {
        let frame = LocalFrame::new(field.plan.datum);
        let laid_out = |corners: &Vec<[f64; 2]>| -> Vec<Ned> {
            corners
                .iter()
                .map(|&[lat_deg, lon_deg]| frame.ned(LatLon { lat_deg, lon_deg }))
                .collect()
        };
        let outline = rules
            .polygon
            .as_ref()
            .map_or_else(|| with_margin(&field.corners, rules.margin_m), laid_out);
        GeofenceArea {
            outline,
            keep_out: rules.keep_out.iter().map(laid_out).collect(),
        }
    }

    /// Checks that the area suits the game: the keep-outs must overlap it, and the boat's start
    /// position must be inside.
    ///
    /// # Errors
    /// [`GeofenceError`] names the part outside.
    pub fn check(&self, scenario: &Scenario, vehicle: VehicleId) -> Result<(), GeofenceError> {
        // A keep-out that does not touch the area has a mistyped coordinate, and leaves its shoal
        // unprotected.
        let is_apart = |keep_out: &Vec<Ned>| {
            sides(keep_out)
                .all(|(a, b)| !is_within(&self.outline, a) && met(&self.outline, a, b) == 0)
        };
        if let Some(number) = self.keep_out.iter().position(is_apart) {
            return Err(GeofenceError::KeepOutOutside(number));
        }
        let boat = &scenario.vehicles[vehicle.index()];
        let starts = match &boat.start_position {
            StartPosition::At(pose) => vec![pose.at],
            // A random position may be in any corner, so all corners must be inside.
            StartPosition::Somewhere {
                along_m, across_m, ..
            } => {
                let ends = [along_m.0, along_m.1].into_iter();
                let corners =
                    ends.flat_map(|along| [across_m.0, across_m.1].map(|across| (along, across)));
                corners
                    .map(|(along, across)| scenario.field.seen_from(boat.team, along, across))
                    .collect()
            }
        };
        let is_inside = starts.iter().all(|start| self.contains(*start));
        is_inside
            .then_some(())
            .ok_or_else(|| GeofenceError::StartOutside(boat.name.clone()))
    }

    /// Whether a boat may be at a point.
    pub(crate) fn contains(&self, at: Ned) -> bool {
        is_within(&self.outline, at)
            && !self.keep_out.iter().any(|keep_out| is_within(keep_out, at))
    }

    /// Whether the whole straight line between two points lies in permitted water. The ends alone
    /// are not enough: the outline may be concave, and a keep-out may lie between them.
    pub(crate) fn contains_way(&self, from: Ned, to: Ned) -> bool {
        self.contains(from) && self.leads_in(from, to)
    }

    /// Whether the straight line ends inside, and never leaves the permitted water once it has
    /// entered it. A boat outside, or in a keep-out, can return along such a line.
    pub(crate) fn leads_in(&self, from: Ned, to: Ned) -> bool {
        // From outside, exactly one crossing leads in; a second one would lead out again.
        let crosses_once =
            |polygon: &[Ned], wrong: bool| met(polygon, from, to) == usize::from(wrong);
        self.contains(to)
            && crosses_once(&self.outline, !is_within(&self.outline, from))
            && self
                .keep_out
                .iter()
                .all(|keep_out| crosses_once(keep_out, is_within(keep_out, from)))
    }

    /// The distance to the nearest edge (m), negative outside the permitted water.
    pub(crate) fn clearance_m(&self, at: Ned) -> f64 {
        let outlines = std::iter::once(&self.outline).chain(&self.keep_out);
        let distance_m = outlines
            .map(|outline| distance_to_outline(outline, at))
            .fold(f64::INFINITY, f64::min);
        if self.contains(at) {
            distance_m
        } else {
            -distance_m
        }
    }
}

/// The number of polygon sides that touch the straight line.
fn met(polygon: &[Ned], from: Ned, to: Ned) -> usize {
    sides(polygon)
        .filter(|side| do_meet(*side, (from, to)))
        .count()
}

/// The outline of all points within this distance of a rectangle, clockwise on the chart: a
/// rectangle with rounded corners.
fn with_margin(corners: &[Ned; 4], margin_m: f64) -> Vec<Ned> {
    if margin_m <= 0.0 {
        return corners.to_vec();
    }
    // The corners are rounded because a margin is a distance: at square corners it would be 1.4
    // times as large.
    let round = |[before, corner, after]: [Ned; 3]| {
        // The arc runs from the normal of the side that ends at the corner to that of the next
        // side, a quarter turn clockwise.
        let [first, second] = [(before, corner), (corner, after)].map(|(a, b)| {
            let side = b - a;
            let length_m = a.distance(b);
            Ned {
                north: side.east,
                east: -side.north,
            }
            .scaled(margin_m / length_m)
        });
        (0..=8).map(move |step| {
            let (sin, cos) = math::sin_cos_deg(f64::from(step) * ROUND_STEP_DEG);
            corner + first.scaled(cos) + second.scaled(sin)
        })
    };
    let [a, b, c, d] = *corners;
    [[d, a, b], [a, b, c], [b, c, d], [c, d, a]]
        .into_iter()
        .flat_map(round)
        .collect()
}
