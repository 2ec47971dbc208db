//! The sim's ports for stop datagrams, in addition to the links of its session.

use super::StopTopics;
use super::datagram::{States, StopRequest};
use super::datagram_port::DatagramPort;
use crate::net::address;
use crate::runtime::runtime;
use crate::{Bus, BusError, Net, Publisher, clock};
use messages::Control;
use messages::external::{FleetCommand, GatewayCommand, OperatorCommand};
use messages::topic::GameName;
use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::net::{ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Maximum age of states in answers.
const FRESH: Duration = Duration::from_secs(3);

/// The ports of a sim, closed on drop.
pub struct HubStopPort(#[expect(dead_code, reason = "kept for its drop")] Vec<DatagramPort>);

/// The states of the real boats by name, and when each state was received.
type Heard = BTreeMap<String, Option<(String, Instant)>>;

/// The state shared by the threads.
struct Server {
    topics: StopTopics,
    heard: Arc<Mutex<Heard>>,
}

impl HubStopPort {
    /// Accepts stops at the hosts and ports of the hub of a game with these real boats. In a game
    /// with keys it opens no port, since a datagram does not identify its sender.
    ///
    /// # Errors
    /// [`BusError`] if a port is taken, or the session is closed.
    pub fn open(
        bus: &Bus,
        net: &Net,
        game: &GameName,
        boats: &[String],
    ) -> Result<HubStopPort, BusError> {
        if !runtime().has_sockets() || net.keys.is_some() {
            return Ok(HubStopPort(vec![]));
        }
        let heard = Arc::new(Mutex::new(
            boats
                .iter()
                .map(|boat| (boat.clone(), None))
                .collect::<Heard>(),
        ));
        let told = Arc::clone(&heard);
        let topics = StopTopics::open(bus, game, boats, move |status| {
            told.lock()
                .insert(status.vehicle, Some((status.state, clock::now())));
        })?;
        let server = Arc::new(Server { topics, heard });
        let mut ports = Vec::new();
        for endpoint in net
            .listen
            .iter()
            .filter(|endpoint| endpoint.starts_with("tcp/"))
        {
            let failed = |e: std::io::Error| BusError::Open {
                what: format!("receive stops at udp/{}", address(endpoint)),
                reason: e.to_string(),
            };
            let found = address(endpoint).to_socket_addrs().map_err(failed)?;
            // A name may have addresses in a family that this machine does not use.
            let (bound, missed): (Vec<_>, Vec<_>) =
                found.map(UdpSocket::bind).partition(Result::is_ok);
            if bound.is_empty() {
                let missed = missed.into_iter().find_map(Result::err);
                return Err(failed(missed.unwrap_or_else(|| {
                    std::io::Error::other("the host has no address")
                })));
            }
            for socket in bound.into_iter().flatten() {
                let server = Arc::clone(&server);
                ports.push(
                    DatagramPort::open(socket, "stops", move |bytes| server.serve(bytes))
                        .map_err(failed)?,
                );
            }
        }
        Ok(HubStopPort(ports))
    }
}

impl Server {
    fn serve(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        let request = StopRequest::decode(bytes)?;
        let StopTopics {
            bus,
            game: own,
            control,
            stops,
            ..
        } = &self.topics;
        if request
            .game
            .as_ref()
            .is_some_and(|game| game != own.as_str())
        {
            return None;
        }
        let publish = |publisher: &Publisher, json: serde_json::Result<Vec<u8>>| {
            // A closed session has nothing to stop.
            json.into_iter()
                .for_each(|json| drop(publisher.send_json(json)));
        };
        match &request.command {
            // This session also receives the E-stop.
            GatewayCommand::Fleet(FleetCommand::EStop) => {
                publish(control, serde_json::to_vec(&Control::EStop))
            }
            GatewayCommand::Boat { name, command } if *command != OperatorCommand::Status => {
                // Published in the sim's session, which needs no rule at the hub. For an unknown
                // boat there is no answer, which reveals nothing.
                publish(stops.get(name)?, serde_json::to_vec(command));
            }
            _ => {}
        }
        let now = clock::now();
        let state = |heard: &Option<(String, Instant)>| {
            let fresh = heard
                .as_ref()
                .map(|(state, at)| (state, now.saturating_duration_since(*at)));
            let fresh = fresh.filter(|(_, age)| *age < FRESH);
            fresh
                .map(|(state, age)| (state.clone(), age.as_millis() as u64))
                .unwrap_or_default()
        };
        // List all boats, so that the operator knows that there are no others.
        let states: States = self
            .heard
            .lock()
            .iter()
            .map(|(boat, heard)| (boat.clone(), state(heard)))
            .collect();
        request.answer(bytes.len(), bus.token.as_ref(), &states)
    }
}
