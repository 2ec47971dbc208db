//! Faults of agents and links during a game: silent or held boats.

use super::Contest;
use primitives::{SimTime, VehicleId};
use rules::Event;
use scenario::Scenario;
use scenario::fault::{FaultKind, FaultSpan, fault_spans};

pub(super) fn of(scenario: &Scenario, vehicle: VehicleId) -> Vec<FaultSpan> {
    let name = &scenario.vehicles[vehicle.index()].name;
    let spans = fault_spans(
        &scenario.faults,
        (vehicle, name),
        &scenario.seeds(),
        scenario.rules.time_limit,
    );
    // Faults of sensors and thrusters belong to the world. The seed determines the fault spans
    // before the game, so snapshots need not contain them, and all processes agree.
    spans
        .into_iter()
        .filter(|span| matches!(span.kind, FaultKind::AgentLost | FaultKind::LinkLost))
        .collect()
}

/// Whether a fault silences a vehicle's agent or link at `now`.
pub(super) fn is_silent(faults: &[FaultSpan], now: SimTime) -> bool {
    faults.iter().any(|span| span.is_on(now))
}

impl Contest {
    /// Whether faults block orders to a vehicle.
    pub(super) fn is_cut_off(&self, vehicle: VehicleId) -> bool {
        is_silent(&self.faults[vehicle.index()], self.now())
    }

    /// Starts and ends the agent faults of this tick, each with an event. Boats whose agents are
    /// lost hold.
    pub(super) fn begin_and_end_faults(&mut self) {
        let now = self.now();
        let tick = self.scenario.tick;
        for i in 0..self.faults.len() {
            if self.faults[i].is_empty() {
                continue;
            }
            let is_on = |at: SimTime| {
                self.faults[i]
                    .iter()
                    .any(|span| span.kind == FaultKind::AgentLost && span.is_on(at))
            };
            // Derived from the previous tick, not stored: a restored game must log the same events.
            let was = now.0 >= tick.0 && is_on(now - tick);
            let is = is_on(now);
            if is {
                self.hold_now(i);
            }
            if was != is {
                let vehicle = VehicleId::at(i);
                self.log(if is {
                    Event::AgentLost(vehicle)
                } else {
                    Event::AgentBack(vehicle)
                });
            }
        }
    }
}
