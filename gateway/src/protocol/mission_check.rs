//! Checks a mission before it is uploaded.

use messages::external::Mission;

/// Maximum number of waypoints of a mission.
// At one line a second such an upload takes minutes; the limit of a boat is not published.
const WAYPOINTS_MAX: usize = 200;
/// Maximum throttle sent by other drivers of a Surveyor, per cent.
const THROTTLE_MAX_PCT: f64 = 70.0;

/// Checks whether a mission can be sent to a boat.
///
/// # Errors
/// The fault of the mission.
pub(super) fn check(mission: &Mission) -> Result<(), String> {
    if !(0.0..=THROTTLE_MAX_PCT).contains(&mission.throttle_pct) {
        return Err(format!(
            "throttle_pct is {}, expected 0 to {THROTTLE_MAX_PCT}",
            mission.throttle_pct
        ));
    }
    if !(1..=WAYPOINTS_MAX).contains(&mission.waypoints.len()) {
        return Err(format!(
            "the mission has {} waypoints, expected 1 to {WAYPOINTS_MAX}",
            mission.waypoints.len()
        ));
    }
    for (index, [lat_deg, lon_deg]) in std::iter::once(&mission.erp)
        .chain(&mission.waypoints)
        .enumerate()
    {
        if !((-90.0..=90.0).contains(lat_deg) && (-180.0..=180.0).contains(lon_deg)) {
            return Err(format!(
                "waypoint {index} is [{lat_deg}, {lon_deg}], expected latitude -90 to 90 and longitude -180 to 180"
            ));
        }
    }
    Ok(())
}
