//! Checks a gateway file.

use super::{BoatProtocol, Gateway};
use primitives::angle::wrap_pi;
use primitives::{Ned, math};
use rules::field::{distance_to_line, sides};
use scenario::{Document, check_corners, check_thrust_map};

/// Maximum distance of a geofence corner from the first, m. Corners farther away have latitude and
/// longitude swapped, or an extra digit.
const EXTENT_MAX_M: f64 = 50_000.0;
/// The radius of a sphere, which is accurate enough to detect crossing sides, m.
const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// Checks a gateway.
pub(super) fn gateway(document: &Document<Gateway>) -> Option<Gateway> {
    let raw = &document.raw;
    check_thrust_map(document, "loops.thrust_map", &raw.loops.thrust_map);
    check_geofence(document);
    if raw.protocol == BoatProtocol::Mavlink && !raw.startup_words.is_empty() {
        let message = "startup_words are for Surveyors, expected none with protocol = \"mavlink\"";
        document.note("startup_words", message);
    }
    document.is_faultless().then(|| raw.clone())
}

fn check_geofence(document: &Document<Gateway>) {
    let fence = &document.raw.geofence;
    let origin = fence
        .polygon
        .as_ref()
        .or(fence.keep_out.first())
        .and_then(|corners| corners.first());
    let Some(&origin) = origin else { return };
    let check = |path: &str, corners: &[[f64; 2]]| {
        document
            .is_sound(path)
            .then(|| polygon(document, path, corners, origin))
            .flatten()
    };
    let outline = fence
        .polygon
        .as_ref()
        .and_then(|corners| check("geofence.polygon", corners));
    let path = |i: usize| format!("geofence.keep_out.{i}");
    let keep_out: Vec<_> = fence
        .keep_out
        .iter()
        .enumerate()
        .map(|(i, corners)| check(&path(i), corners))
        .collect();
    for (i, keep_out) in keep_out.iter().enumerate() {
        let (Some(outline), Some(keep_out)) = (&outline, keep_out) else {
            continue;
        };
        if sides(keep_out).all(|side| distance_to_line(outline, side) > 0.0) {
            document.note(
                &path(i),
                "keep_out lies outside the polygon; move it inside",
            );
        }
    }
}

/// The corners of a polygon in metres from `origin`, if the polygon is valid.
fn polygon(
    document: &Document<Gateway>,
    path: &str,
    places: &[[f64; 2]],
    origin: [f64; 2],
) -> Option<Vec<Ned>> {
    let note = |corner: usize, message: String| {
        document.note(&format!("{path}.{corner}"), message);
    };
    let mut latitudes_deg = places.iter().map(|[lat_deg, _]| *lat_deg);
    if let Some(corner) = latitudes_deg.position(|lat_deg| lat_deg.abs() > 90.0) {
        let message = format!(
            "latitude is {}, expected -90 to 90: it comes before the longitude",
            places[corner][0]
        );
        note(corner, message);
        return None;
    }
    let corners = places.iter().map(|place| metres_from(origin, *place));
    let corners: Vec<Ned> = corners.collect();
    let mut lengths_m = corners.iter().map(|corner| corner.length());
    if let Some(corner) = lengths_m.position(|length_m| length_m > EXTENT_MAX_M) {
        let [km, max_km] = [corners[corner].length(), EXTENT_MAX_M].map(|m| m / 1000.0);
        let message = format!("corner is {km:.0} km from the first, expected at most {max_km} km");
        note(corner, message);
        return None;
    }
    let checked = check_corners(&corners);
    checked
        .map_err(|(corner, message)| note(corner, message))
        .ok()
        .map(|()| corners)
}

/// Projects a position on a sphere to a plane: accurate enough for the order of corners, not for
/// the lengths of sides.
fn metres_from([lat_deg, lon_deg]: [f64; 2], place: [f64; 2]) -> Ned {
    let (_, shrink) = math::sin_cos_deg(lat_deg);
    let [north, east] =
        [place[0] - lat_deg, place[1] - lon_deg].map(|angle_deg| wrap_pi(angle_deg.to_radians()));
    Ned {
        north,
        east: east * shrink,
    }
    .scaled(EARTH_RADIUS_M)
}
