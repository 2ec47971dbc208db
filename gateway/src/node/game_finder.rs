//! Finds a boat's game and joins it, on a thread of its own: the boat's link and its operators do
//! not wait for that.

use super::error::NodeError;
use super::found_game::FoundGame;
use super::game_terms::{declination_rad, external_vehicle, pace_factor};
use super::loop_input::{Call, LoopInput};
use super::settings::Settings;
use crate::bridge::Site;
use crate::config::Gateway;
use crate::geofence::{Coasting, GeofenceArea};
use bus::game_search::{self, GameSearch};
use bus::{NodeThread, Place};
use messages::Role;
use messages::topic::GameName;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// The search parameters.
struct Wanted {
    game: Option<GameName>,
    place: Place,
    vehicle: String,
    gateway: Gateway,
    at_game_pace: bool,
    wait: Duration,
    stop: Arc<AtomicBool>,
}

/// Starts the search. Its result goes to the loop.
///
/// # Errors
/// If the system cannot start a thread.
pub(super) fn begin(settings: &Settings, input: LoopInput) -> std::io::Result<NodeThread> {
    let Settings { game, place, vehicle, gateway, at_game_pace, wait, stop, .. } = settings;
    let wanted = Wanted {
        game: game.clone(),
        place: place.clone(),
        vehicle: vehicle.clone(),
        gateway: gateway.clone(),
        at_game_pace: *at_game_pace,
        wait: *wait,
        stop: Arc::clone(stop),
    };
    NodeThread::start(move || {
        let mut tell = |reason: &str| input.calls.put(Call::Looking(reason.to_owned()));
        let found = wanted.find(&mut tell);
        input.found(found);
    })
}

impl Wanted {
    fn find(&self, tell: &mut dyn FnMut(&str)) -> Result<FoundGame, NodeError> {
        let mut search = GameSearch::new(self.wait, &self.stop);
        let (bus, game, info) = search.game(tell, &self.place, self.game.as_ref())?;
        let vehicle = external_vehicle(&info, &self.vehicle)?;
        let factor = pace_factor(&info.pace, self.at_game_pace)?;
        let field = info.scenario.field.clone();
        let area = GeofenceArea::new(&field, &self.gateway.geofence);
        let file = self.gateway.name.clone();
        // Before the boat joins: otherwise a geofence that excludes the start would be noticed with
        // the boat on the water.
        area.check(&info.scenario, vehicle).map_err(|source| NodeError::Geofence { file, source })?;
        let declination_rad = declination_rad(self.gateway.declination_rad, field.plan.datum)?;
        let boat = info.scenario.boat_of(vehicle);
        let coasting = Some(Coasting::of(boat));
        let site = Site { length_m: boat.length_m, field, declination_rad, coasting };
        // The thread that keeps it joined asks again, and gets the same boat.
        let names = [self.vehicle.clone()];
        let all = (&game, &info.scenario);
        // Joining once here reports a wrong token or a taken boat while the operator is still
        // watching.
        search.until(tell, || game_search::join(&bus, &self.place, all, Role::Gateway, &names))?;
        Ok(FoundGame { bus, game, info, vehicle, factor, site })
    }
}
