//! Payloads passed through: clients connect here, bytes pass both ways, and all of them are recorded.
//!
//! A payload never harms the boat: it has threads of its own, and of the gateway loop it wants nothing but that a remark is logged now
//! and then. Whoever is slow or stopped, a client or a payload, holds up its own connection alone.

mod forward;
mod limit;
mod passed_payload;
mod poll;
mod remarks;
mod shared_line;
mod shell;
mod tap;
mod turn;
mod way;

pub(super) use shell::Shell;

use super::node_event::NodeEvent;
use super::tcp_port::TcpPort;
use crate::bridge::Event;
use crate::payload::PayloadPort;
use bus::Slot;
use limit::CLIENTS_MAX;
use passed_payload::Payload;
use remarks::Remarks;
use std::net::TcpStream;
use std::sync::Arc;
use tap::Taps;
use turn::Turn;
use way::Way;

/// The payloads of a boat, as long as this is kept.
pub(super) struct Payloads(Vec<Passage>);

/// The way to a payload that is open to clients.
struct Passage {
    payload: Arc<Payload>,
    port: TcpPort,
}

impl Payloads {
    /// Opens a port for each. A boat is not left alone since one of them cannot be opened: that is a warning.
    pub(super) fn open(ports: &[PayloadPort], shell: &Shell, notify: &mut dyn FnMut(NodeEvent<'_>)) -> Payloads {
        let mut passages = vec![];
        for port in ports {
            match Passage::open(port, shell) {
                Ok(passage) => {
                    let reach = format!("tcp://{} (from {})", passage.port.address, port.address);
                    notify(NodeEvent::Listening { what: &format!("payload {}", port.name), reach: &reach });
                    passages.push(passage);
                }
                Err(e) => {
                    let text = format!("payload {} is not passed through: {e}", port.name);
                    notify(NodeEvent::Event { at_s: shell.clock.now().as_s(), event: &Event::Warning(text) });
                }
            }
        }
        Payloads(passages)
    }
}

impl Drop for Payloads {
    fn drop(&mut self) {
        self.0.iter().for_each(|passage| passage.payload.turn.close());
    }
}

impl Passage {
    fn open(port: &PayloadPort, shell: &Shell) -> Result<Passage, Box<dyn std::error::Error>> {
        let remarks = Arc::new(Remarks::new(&port.name, shell.calls.clone()));
        let taps = Taps::new(port, shell, &remarks);
        let payload = Arc::new(Payload { port: port.clone(), taps, turn: Turn::default(), remarks });
        let way = Arc::new(Way::open(&payload)?);
        let (clients, to) = (Arc::clone(&payload), Arc::clone(&way));
        let serve = move |slot: &Slot, client: &TcpStream| to.serve(&clients, slot, client);
        let name = format!("payload {}", port.name);
        let passage = Passage { port: TcpPort::open(port.listen, &name, CLIENTS_MAX, serve)?, payload };
        // Without a recording nobody would learn what was measured.
        // A sonde says nothing unasked, and two who ask at once get each other's answers: so
        // the gateway asks itself, in turn with clients.
        if let (Some(exo2), true) = (port.exo2, shell.record.is_some()) {
            let payload = Arc::clone(&passage.payload);
            let thread = std::thread::Builder::new().name(format!("sonde {}", port.name));
            drop(thread.spawn(move || poll::run(&payload, &way, exo2))?);
        }
        Ok(passage)
    }
}
