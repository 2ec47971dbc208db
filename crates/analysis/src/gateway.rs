//! Gateways: the traffic on their links and their failsafes.

use crate::link_line::{Line, Lines};
use messages::external::{FailsafeReport, GatewayStatus, LinkBytes};
use recording::{Bag, Damaged, Kind, Recording};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The part of a recording that concerns one gateway.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Gateway {
    /// The boat.
    pub boat: String,
    /// The supervisor's last known state.
    pub state: Option<String>,
    /// Its failsafes, oldest first.
    pub failsafes: Vec<FailsafeReport>,
    /// Traffic from the boat.
    pub from_boat: Traffic,
    /// Traffic to the boat.
    pub to_boat: Traffic,
    /// Damaged messages about it.
    pub damaged: Damaged,
}

/// Traffic in one direction of a link.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Traffic {
    /// Number of bytes.
    pub bytes: u64,
    /// Number of lines, by kind of sentence.
    pub sentences: BTreeMap<String, u64>,
}

/// The gateways of a game, by boat.
pub(crate) fn gateways(recording: &Recording) -> Vec<Gateway> {
    let topics = recording.bag().topics();
    let is_known = |name: &str| {
        ["link", "status"]
            .iter()
            .any(|what| topics.contains_key(&*format!("{what}/{name}")))
    };
    let boats = recording
        .scenario()
        .vehicles
        .iter()
        .map(|vehicle| vehicle.name.as_str());
    boats
        .filter(|name| is_known(name))
        .map(|name| gateway_of(recording.bag(), name))
        .collect()
}

/// The gateway of a boat, from the recording of a game or of the gateway itself.
pub fn gateway_of(bag: &Bag, boat: &str) -> Gateway {
    // A gateway's recording begins when the gateway starts, and it starts disarmed.
    let state = (bag.kind == Kind::Gateway).then(|| "disarmed".to_owned());
    let mut gateway = Gateway {
        boat: boat.to_owned(),
        state,
        ..Gateway::default()
    };
    traffic(bag, &mut gateway);
    // Each status lists all failsafes so far, and a restarted gateway starts a new list: count each
    // failsafe once.
    for message in bag.on(&format!("status/{boat}")) {
        let Some(status) = gateway.damaged.sound(message.read_json::<GatewayStatus>()) else {
            continue;
        };
        for failsafe in status.failsafes {
            if !gateway.failsafes.contains(&failsafe) {
                gateway.failsafes.push(failsafe);
            }
        }
        gateway.state = Some(status.state);
    }
    // The gateway's own recording contains its changes of state.
    for message in bag.on("event") {
        let Some(event) = gateway.damaged.sound(message.read_json::<Value>()) else {
            continue;
        };
        if let Some(state) = event["event"]["state"]["to"].as_str() {
            gateway.state = Some(state.to_owned());
            // The recording has no status that lists its failsafes.
            if let Some(cause) = state
                .strip_prefix("failsafe: ")
                .filter(|_| bag.kind == Kind::Gateway)
            {
                gateway.failsafes.push(FailsafeReport {
                    at_s: message.at.as_s(),
                    cause: cause.to_owned(),
                });
            }
        }
    }
    gateway
}

fn traffic(bag: &Bag, gateway: &mut Gateway) {
    let mut lines = Lines::default();
    for message in bag.on(&format!("link/{}", gateway.boat)) {
        let Some(bytes) = gateway.damaged.sound(message.read::<LinkBytes>()) else {
            continue;
        };
        gateway.way(bytes.outward).bytes += bytes.data.len() as u64;
        lines
            .take(bytes.outward, &bytes.data)
            .iter()
            .for_each(|line| gateway.count(line));
    }
    lines.rest().iter().for_each(|line| gateway.count(line));
}

impl Gateway {
    fn way(&mut self, outward: bool) -> &mut Traffic {
        if outward {
            &mut self.to_boat
        } else {
            &mut self.from_boat
        }
    }

    fn count(&mut self, line: &Line) {
        *self
            .way(line.outward)
            .sentences
            .entry(line.kind().to_owned())
            .or_insert(0) += 1;
    }
}
