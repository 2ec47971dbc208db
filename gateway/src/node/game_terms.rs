//! The conditions under which a boat takes part in a game: it must be external, the pace must suit
//! it, and the declination at the field must be known.

use super::error::NodeError;
use crate::declination::declination_deg;
use crate::nmea::date_and_time;
use messages::GameInfo;
use primitives::VehicleId;
use primitives::frame::LatLon;
use recording::utc;
use scenario::Source;

/// The vehicle with this name, which must be external in this game.
pub(super) fn external_vehicle(info: &GameInfo, name: &str) -> Result<VehicleId, NodeError> {
    let vehicle = info.scenario.vehicle_named(name)?;
    if info.scenario.vehicles[vehicle.index()].source == Source::External {
        return Ok(vehicle);
    }
    Err(NodeError::Refused(format!(
        "{name} is simulated in this game: a real boat needs source = \"external\""
    )))
}

/// Seconds of game time per second of real time.
pub(super) fn pace_factor(pace: &str, at_game_pace: bool) -> Result<f64, NodeError> {
    match (pace, at_game_pace) {
        ("realtime", _) => Ok(1.0),
        (pace, true) => pace
            .strip_suffix('x')
            .and_then(|factor| factor.parse().ok())
            .ok_or_else(|| {
                NodeError::Refused(format!(
                    "the game's pace is {pace}, expected realtime or a factor"
                ))
            }),
        (pace, false) => Err(NodeError::Refused(format!(
            "the game's pace is {pace}, expected realtime: a real boat runs in real time (--at-game-pace is for emulated ones)"
        ))),
    }
}

/// The configured declination, or else today's declination at the field; east positive, rad.
pub(super) fn declination_rad(set_rad: Option<f64>, at: LatLon) -> Result<f64, NodeError> {
    let today_rad = || Ok(declination_deg(at, date_and_time(utc::now_ns()).0)?.to_radians());
    set_rad.map_or_else(today_rad, Ok)
}
