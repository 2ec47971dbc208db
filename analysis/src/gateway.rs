//! Gateways: what went over their links, and what stopped their boats.

use crate::link_line::Lines;
use game::external::{FailsafeReport, GatewayStatus, LinkBytes};
use recording::{Bag, Recording, RecordingError};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// What a recording tells of a gateway.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gateway {
    /// The boat.
    pub boat: String,
    /// The supervisor's last known state.
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

/// The gateways of a game, in the order of their boats.
///
/// # Errors
/// [`RecordingError::Damaged`] names the first message that is not what it should be.
pub(crate) fn gateways(recording: &Recording) -> Result<Vec<Gateway>, RecordingError> {
    let topics = recording.bag().topics();
    let is_known = |name: &str| ["link", "status"].iter().any(|what| topics.contains_key(&*format!("{what}/{name}")));
    let boats = recording.scenario().vehicles.iter().map(|vehicle| vehicle.name.as_str());
    boats.filter(|name| is_known(name)).map(|name| gateway_of(recording.bag(), name)).collect()
}

/// What a recording tells of a boat's gateway: a game's, or the gateway's own.
///
/// # Errors
/// [`RecordingError::Damaged`] names the first message that is not what it should be.
pub fn gateway_of(bag: &Bag, boat: &str) -> Result<Gateway, RecordingError> {
    let mut gateway = Gateway { boat: boat.to_owned(), ..Gateway::default() };
    traffic(bag, &mut gateway)?;
    // Each status holds the failsafes so far, and a gateway that was started anew begins again: every one is taken once.
    for message in bag.on(&format!("status/{boat}")) {
        let Ok(status) = message.read_json::<GatewayStatus>() else { continue };
        for failsafe in status.failsafes {
            if !gateway.failsafes.contains(&failsafe) {
                gateway.failsafes.push(failsafe);
            }
        }
        gateway.state = Some(status.state);
    }
    // The gateway's own recording holds the changes of its state.
    for message in bag.on("event") {
        let event: Value = message.read_json()?;
        if let Some(state) = event["event"]["state"]["to"].as_str() {
            gateway.state = Some(state.to_owned());
        }
    }
    Ok(gateway)
}

fn traffic(bag: &Bag, gateway: &mut Gateway) -> Result<(), RecordingError> {
    let mut lines = Lines::default();
    let mut found = vec![];
    for message in bag.on(&format!("link/{}", gateway.boat)) {
        let bytes: LinkBytes = message.read()?;
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
