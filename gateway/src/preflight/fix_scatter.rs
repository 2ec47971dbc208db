//! The scatter of fixes of a boat at rest.

use crate::geodesy::LocalFrame;
use primitives::frame::{LatLon, Ned};

/// The scatter of fixes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FixScatter {
    /// The radius around the mean that contains 95 of 100 fixes, m.
    pub(super) radius_95_m: f64,
    /// The distance between the means of the first and second half, m.
    pub(super) drift_m: f64,
}

impl FixScatter {
    /// The scatter of these fixes, given in order of arrival; `None` for fewer than ten.
    pub(super) fn of(fixes: &[LatLon]) -> Option<FixScatter> {
        // With fewer fixes the 95th percentile is the worst fix.
        if fixes.len() < 10 {
            return None;
        }
        let frame = LocalFrame::new(fixes[0]);
        let places: Vec<Ned> = fixes.iter().map(|fix| frame.ned(*fix)).collect();
        let mean = |places: &[Ned]| {
            places
                .iter()
                .fold(Ned::default(), |sum, place| sum + *place)
                .scaled(1.0 / places.len() as f64)
        };
        let middle = mean(&places);
        let mut distances: Vec<f64> = places.iter().map(|place| place.distance(middle)).collect();
        distances.sort_by(f64::total_cmp);
        let (first, second) = places.split_at(places.len() / 2);
        let at = (0.95 * distances.len() as f64).ceil() as usize - 1;
        Some(FixScatter {
            radius_95_m: distances[at],
            drift_m: mean(first).distance(mean(second)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_radius_holds_nineteen_of_twenty_and_a_boat_that_drifts_is_seen() {
        let frame = LocalFrame::new(LatLon {
            lat_deg: 42.0,
            lon_deg: -71.0,
        });
        let fixes = |place: &dyn Fn(f64) -> Ned| -> Vec<LatLon> {
            (0..100)
                .map(|i| frame.lat_lon(place(f64::from(i))))
                .collect()
        };
        // Fixes evenly spaced on a circle with a radius of 2 m, except for four of a hundred, which
        // are far off.
        let round = fixes(&|i| {
            Ned::toward_deg(i * 90.0 + 3.6 * i).scaled(if i < 4.0 { 50.0 } else { 2.0 })
        });
        let scatter = FixScatter::of(&round).expect("enough");
        assert!((1.5..2.6).contains(&scatter.radius_95_m), "{scatter:?}");
        let drifting = FixScatter::of(&fixes(&|i| Ned {
            north: 0.1 * i,
            east: 0.0,
        }))
        .expect("enough");
        assert!((drifting.drift_m - 5.0).abs() < 1e-3, "{drifting:?}");
        assert_eq!(FixScatter::of(&round[..9]), None);
    }
}
