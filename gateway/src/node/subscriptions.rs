//! The subscriptions of a gateway in a game: orders, and everything that stops its boat.

use super::loop_input::{Call, LoopInput, Stop};
use crate::supervisor::Scope;
use bus::token::{Checked, Guard};
use bus::{Bus, BusError, Declaration};
use messages::external::{FleetCommand, GatewayCommand, OperatorCommand};
use messages::run_state::{Phase, RunState};
use messages::topic::{self, GameName};
use messages::{Control, GameInfo};
use primitives::{VehicleId, codec};

/// Subscribes to data from the sim and from operators.
pub(super) fn subscribe(
    bus: &Bus,
    game: &GameName,
    info: &GameInfo,
    vehicle: VehicleId,
    input: &LoopInput,
) -> Result<Vec<Declaration>, BusError> {
    let scenario = &info.scenario;
    let [orders, queries, stops, controls, releases, runs] = std::array::from_fn(|_| input.clone());
    let take_order = move |bytes: &[u8]| {
        let Ok(order) = codec::decode(bytes) else {
            return;
        };
        let mut latest_order = orders.latest_order.lock();
        // The pending call will pick up the latest order.
        if latest_order.replace((order, bus::clock::now())).is_none() {
            orders.calls.put(Call::Order);
        }
    };
    let name = &scenario.vehicles[vehicle.index()].name;
    Ok(vec![
        // Subscribe to the sim, not to agents: only the sim knows whose orders count (tickets),
        // what the referee allows, and when an agent is lost. A second implementation of these
        // rules would eventually diverge.
        bus.subscribe(topic::external_order(game, scenario, vehicle), take_order)?,
        bus.answer(topic::operate(game, name), move |query| {
            // The stop takes effect now; the query itself waits its turn in the queue to be
            // answered.
            let command =
                Guard::default().check(query.key(), query.payload(), OperatorCommand::needs_token);
            if let Checked::Granted(command) = command
                && let Some(stop) = Stop::of(&command)
            {
                queries.stop(stop);
            }
            queries.query(query);
        })?,
        bus.subscribe(topic::stop(game, name), move |bytes| {
            if let Some(stop) = stop_in(bytes) {
                stops.stop(stop);
            }
        })?,
        bus.subscribe(topic::control(game), move |bytes| {
            // All other commands reach the boat as orders, if at all.
            if let Ok(Control::EStop) = serde_json::from_slice(bytes) {
                controls.stop(Stop::EStop(Scope::Fleet));
            }
        })?,
        bus.subscribe(topic::released(game), move |_| {
            releases.calls.put(Call::Release)
        })?,
        bus.subscribe(topic::run(game), move |bytes| {
            if serde_json::from_slice(bytes).is_ok_and(|run: RunState| run.phase == Phase::Over) {
                runs.calls.put(Call::Over);
            }
        })?,
    ])
}

/// The stop in a message: an operator's command to this boat or to all boats.
fn stop_in(bytes: &[u8]) -> Option<Stop> {
    match serde_json::from_slice(bytes) {
        Ok(GatewayCommand::Fleet(FleetCommand::EStop)) => Some(Stop::EStop(Scope::Fleet)),
        _ => Stop::of(&serde_json::from_slice(bytes).ok()?),
    }
}
