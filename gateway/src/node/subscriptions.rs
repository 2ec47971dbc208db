//! The subscriptions of a gateway in a game: orders, and all that stops its boat.

use super::loop_input::{Call, LoopInput, Stop};
use crate::supervisor::Scope;
use bus::token::{Checked, Guard};
use bus::{Bus, BusError, Declaration};
use messages::external::{FleetCommand, GatewayCommand, OperatorCommand};
use messages::topic::{self, GameName};
use messages::{Control, GameInfo};
use primitives::{VehicleId, codec};

/// Subscribes to what comes from the sim and from operators.
pub(super) fn subscribe(
    bus: &Bus,
    game: &GameName,
    info: &GameInfo,
    vehicle: VehicleId,
    input: &LoopInput,
) -> Result<Vec<Declaration>, BusError> {
    let scenario = &info.scenario;
    let [orders, queries, stops, controls, releases, frames] = std::array::from_fn(|_| input.clone());
    let take_order = move |bytes: &[u8]| {
        let Ok(order) = codec::decode(bytes) else { return };
        let mut latest_order = orders.latest_order.lock();
        // A call that still waits will find the newest.
        if latest_order.replace((order, bus::clock::now())).is_none() {
            orders.calls.put(Call::Order);
        }
    };
    let name = &scenario.vehicles[vehicle.index()].name;
    let mut subscriptions = vec![
        // From the sim, not from agents: whose order counts (tickets), what the referee lets a
        // boat do, and when an agent is lost are known there alone. A second implementation of
        // that on the way to the boat would be wrong one day.
        bus.subscribe(topic::external_order(game, scenario, vehicle), take_order)?,
        bus.answer(topic::operate(game, name), move |query| {
            // It is read again, to be answered, behind others.
            let command = Guard::default().check(query.key(), query.payload(), OperatorCommand::needs_token);
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
            // Everything else reaches the boat as an order, if at all.
            if let Ok(Control::EStop) = serde_json::from_slice(bytes) {
                controls.stop(Stop::EStop(Scope::Fleet));
            }
        })?,
        bus.subscribe(topic::released(game), move |_| releases.calls.put(Call::Release))?,
    ];
    // Frames are published only where somebody subscribes.
    if scenario.externals().nth(1).is_some() {
        let take_frame = move |bytes: &[u8]| frames.calls.put(Call::Frame(bytes.to_vec()));
        subscriptions.push(bus.subscribe(topic::frame(game), take_frame)?);
    }
    Ok(subscriptions)
}

/// What is published to stop the boat: an operator's command, or one for all boats.
fn stop_in(bytes: &[u8]) -> Option<Stop> {
    match serde_json::from_slice(bytes) {
        Ok(GatewayCommand::Fleet(FleetCommand::EStop)) => Some(Stop::EStop(Scope::Fleet)),
        _ => Stop::of(&serde_json::from_slice(bytes).ok()?),
    }
}
