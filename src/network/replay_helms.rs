//! The helm reports of a replay: minds decide again, and their orders are compared with the
//! recorded orders.

use crate::minds::Minds;
use messages::Order;
use messages::input::{Input, Inputs};
use primitives::VehicleId;
use recording::{INPUTS, Recording};
use shore::page::HelmAnswer;
use shore::page::replay::Helms;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The minds of a recorded game, and their recorded orders.
pub(super) struct ReplayHelms {
    minds: Minds,
    recording: Arc<Recording>,
    /// Index of the recorded inputs for each decision.
    inputs: BTreeMap<u64, usize>,
}

impl ReplayHelms {
    pub(super) fn new(recording: Arc<Recording>) -> ReplayHelms {
        // Inputs are recorded with the resulting frame, one decision later.
        let decision = |place| {
            Some((
                recording
                    .bag()
                    .message(place)
                    .read::<Inputs>()
                    .ok()?
                    .stamp
                    .seq
                    .saturating_sub(1),
                place,
            ))
        };
        let inputs = recording
            .bag()
            .places(INPUTS)
            .filter_map(decision)
            .collect();
        ReplayHelms {
            minds: Minds::new(Arc::clone(&recording)),
            inputs,
            recording,
        }
    }

    /// The recorded order for the vehicle at this decision.
    fn recorded(&self, vehicle: VehicleId, decision: u64) -> Option<Order> {
        let inputs: Inputs = self
            .recording
            .bag()
            .message(*self.inputs.get(&decision)?)
            .read()
            .ok()?;
        inputs
            .inputs
            .iter()
            .rev()
            .find_map(|record| match record.input() {
                Some(Input::Ordered {
                    vehicle: of, order, ..
                }) if of == vehicle => Some(order),
                _ => None,
            })
    }
}

impl Helms for ReplayHelms {
    fn report(&mut self, vehicle: VehicleId, decision: u64, _functions: bool) -> HelmAnswer {
        // Decide again: recording all objective functions would take megabytes per second, and
        // strategies are deterministic. The comparison with the recorded order verifies this.
        let Some(order) = self.minds.decide(vehicle, decision, true) else {
            let reason = "no picture of this moment was recorded".to_owned();
            return HelmAnswer {
                reason: Some(reason),
                computed: true,
                ..HelmAnswer::default()
            };
        };
        HelmAnswer {
            report: self.minds.report(vehicle),
            reason: None,
            computed: true,
            agrees: self
                .recorded(vehicle, decision)
                .map(|recorded| recorded == order),
        }
    }

    fn modes(&mut self, decision: u64) -> Vec<Option<String>> {
        let vehicles = (0..self.recording.scenario().vehicles.len()).map(VehicleId::at);
        let mode = |vehicle: VehicleId| {
            // The first query about a team has already advanced all its minds.
            let (report, _) = self.minds.report_of(vehicle, decision)?;
            Some(report.mode).filter(|mode| !mode.is_empty())
        };
        vehicles.map(mode).collect()
    }
}
