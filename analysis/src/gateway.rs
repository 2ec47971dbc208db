//! The gateways of a game: what went over their links, and what stopped their boats.

use super::sentence::Lines;
use game::external::{FailsafeReport, GatewayStatus, LinkBytes};
use recording::{Recording, RecordingError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A gateway's game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gateway {
    /// The boat.
    pub boat: String,
    /// The supervisor's state, as it was told last.
    pub state: Option<String>,
    /// What made it stop, oldest first.
    pub failsafes: Vec<FailsafeReport>,
    /// What came from the boat.
    pub from_boat: Traffic,
    /// What went to the boat.
    pub to_boat: Traffic,
}

/// What went one way over a link.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Traffic {
    /// How many bytes.
    pub bytes: u64,
    /// How many lines of each kind of sentence.
    pub sentences: BTreeMap<String, u64>,
}

/// The gateways of a recording, by the boat's place among the vehicles.
///
/// # Errors
/// [`RecordingError::Damaged`] names the first message that is not what it should be.
pub(super) fn gateways(recording: &Recording) -> Result<Vec<Gateway>, RecordingError> {
    let topics = recording.topics();
    let mut gateways = vec![];
    for vehicle in &recording.header().notice.scenario.vehicles {
        let [link, status] = ["link", "status"].map(|what| format!("{what}/{}", vehicle.name));
        if topics.contains_key(link.as_str()) || topics.contains_key(status.as_str()) {
            let mut gateway = Gateway { boat: vehicle.name.clone(), ..Gateway::default() };
            traffic(recording, &link, &mut gateway)?;
            told(recording, &status, &mut gateway);
            gateways.push(gateway);
        }
    }
    Ok(gateways)
}

fn traffic(recording: &Recording, topic: &str, gateway: &mut Gateway) -> Result<(), RecordingError> {
    let mut lines = Lines::default();
    let mut found = vec![];
    for said in recording.on(topic) {
        let bytes: LinkBytes = said.read()?;
        let way = if bytes.outward { &mut gateway.to_boat } else { &mut gateway.from_boat };
        way.bytes += bytes.data.len() as u64;
        found.extend(lines.take(&bytes));
    }
    found.extend(lines.rest());
    for line in found {
        let way = if line.outward { &mut gateway.to_boat } else { &mut gateway.from_boat };
        *way.sentences.entry(line.kind().to_owned()).or_insert(0) += 1;
    }
    Ok(())
}

/// Each status tells the failsafes so far, and a gateway that was started anew begins again: every failsafe is taken once.
fn told(recording: &Recording, topic: &str, gateway: &mut Gateway) {
    for said in recording.on(topic) {
        let Ok(status) = serde_json::from_slice::<GatewayStatus>(said.bytes) else { continue };
        for failsafe in status.failsafes {
            if !gateway.failsafes.contains(&failsafe) {
                gateway.failsafes.push(failsafe);
            }
        }
        gateway.state = Some(status.state);
    }
}
