//! Finds a boat's game and joins it on a separate thread, so that the boat's link and its operators
//! do not have to wait.

use super::error::NodeError;
use super::game_terms::{declination_rad, external_vehicle, pace_factor};
use super::loop_input::{Call, LoopInput};
use super::settings::Settings;
use crate::bridge::Site;
use crate::geofence::{Coasting, GeofenceArea};
use bus::game_search::{self, GameSearch};
use bus::{Bus, NodeThread};
use messages::topic::GameName;
use messages::{GameInfo, Role};
use primitives::VehicleId;

/// A game that the boat has joined.
pub(super) struct FoundGame {
    pub(super) bus: Bus,
    pub(super) game: GameName,
    pub(super) info: GameInfo,
    pub(super) vehicle: VehicleId,
    /// Seconds of game time per second of real time.
    pub(super) factor: f64,
    pub(super) site: Site,
}

/// Starts the search. Its result goes to the gateway loop.
///
/// # Errors
/// If the system cannot start a thread.
pub(super) fn begin(settings: &Settings, input: LoopInput) -> std::io::Result<NodeThread> {
    let settings = settings.clone();
    NodeThread::start(move || {
        let mut tell = |reason: &str| input.calls.put(Call::Looking(reason.to_owned()));
        let found = find(&settings, &mut tell);
        input.found(found);
    })
}

fn find(settings: &Settings, tell: &mut dyn FnMut(&str)) -> Result<FoundGame, NodeError> {
    let Settings { place, plan, .. } = settings;
    let mut search = GameSearch::new(settings.wait, &settings.stop);
    let (bus, game, info) = search.game(tell, place, settings.game.as_ref())?;
    let vehicle = external_vehicle(&info, &plan.vehicle)?;
    let factor = pace_factor(&info.pace, settings.at_game_pace)?;
    let field = info.scenario.field.clone();
    let area = GeofenceArea::new(&field, &plan.gateway.geofence);
    let file = plan.gateway.name.clone();
    // Check before the boat joins: otherwise a geofence that excludes the start position would only
    // be noticed once the boat is on the water.
    area.check(&info.scenario, vehicle)
        .map_err(|source| NodeError::Geofence { file, source })?;
    let declination_rad = declination_rad(plan.gateway.declination_rad, field.plan.datum)?;
    let boat = info.scenario.boat_of(vehicle);
    let coasting = Some(Coasting::of(boat));
    let site = Site {
        length_m: boat.length_m,
        field,
        declination_rad,
        coasting,
    };
    // `Join` later repeats this request and gets the same boat.
    let names = [plan.vehicle.clone()];
    let all = (&game, &info.scenario);
    // Join once during the search, to report a wrong token or a boat already taken while the
    // operator is still watching.
    search.until(tell, || {
        game_search::join(&bus, place, all, Role::Gateway, &names)
    })?;
    Ok(FoundGame {
        bus,
        game,
        info,
        vehicle,
        factor,
        site,
    })
}
