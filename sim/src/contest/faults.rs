//! Faults of agents and links in the midst of a game: who is silent, and who holds.

use super::Contest;
use primitives::{SimTime, VehicleId};
use rules::Event;
use scenario::Scenario;
use scenario::fault::{FaultKind, FaultSpan, fault_spans};

/// The faults of a vehicle's agent and link in this game.
pub(super) fn of(scenario: &Scenario, vehicle: VehicleId) -> Vec<FaultSpan> {
    let name = &scenario.vehicles[vehicle.index()].name;
    let spans = fault_spans(&scenario.faults, (vehicle, name), &scenario.seeds(), scenario.rules.time_limit);
    // Those of sensors and thrusters are the world's. Spans follow from the seed before the
    // game, so a snapshot holds nothing of them and processes agree.
    spans.into_iter().filter(|span| matches!(span.kind, FaultKind::AgentLost | FaultKind::LinkLost)).collect()
}

/// Whether nothing passes between a vehicle and its people, or there are none.
pub(super) fn is_silent(faults: &[FaultSpan], now: SimTime) -> bool {
    faults.iter().any(|span| span.is_on(now))
}

impl Contest {
    /// Whether an order reaches a vehicle, as far as faults go.
    pub(super) fn is_cut_off(&self, vehicle: VehicleId) -> bool {
        is_silent(&self.faults[vehicle.index()], self.now())
    }

    /// Agents that die in this tick make their boats hold, and are back when that is over: an event each.
    pub(super) fn begin_and_end_faults(&mut self) {
        let (now, tick) = (self.now(), self.scenario.tick);
        for i in 0..self.faults.len() {
            if self.faults[i].is_empty() {
                continue;
            }
            let is_on =
                |at: SimTime| self.faults[i].iter().any(|span| span.kind == FaultKind::AgentLost && span.is_on(at));
            // Compared with the tick before and not remembered: a restored game must log the
            // same events.
            let (was, is) = (now.0 >= tick.0 && is_on(now - tick), is_on(now));
            if is {
                self.hold_now(i);
            }
            if was != is {
                let vehicle = VehicleId::at(i);
                self.log(if is { Event::AgentLost(vehicle) } else { Event::AgentBack(vehicle) });
            }
        }
    }
}
