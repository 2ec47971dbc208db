//! Payload pass-through: clients connect here, bytes pass both ways, and all are recorded.
//!
//! A payload never harms the boat: it has its own threads, and the gateway loop only logs a remark
//! for it now and then. A slow or stopped client or payload delays only its own connection.

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

/// The payloads of a boat, open until dropped.
pub(super) struct Payloads(Vec<Passage>);

/// The connection to a payload that is open to clients.
struct Passage {
    payload: Arc<Payload>,
    port: TcpPort,
}

impl Payloads {
    /// Opens a port for each. Failure to open one does not abandon the boat; it is a warning.
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
        // Without a recording, nobody would receive the values.
        // A sonde sends nothing unasked, and two simultaneous queries get each other's answers. So
        // the gateway queries it, in turn with clients.
        if let (Some(exo2), true) = (port.exo2, shell.record.is_some()) {
            let payload = Arc::clone(&passage.payload);
            let thread = std::thread::Builder::new().name(format!("sonde {}", port.name));
            drop(thread.spawn(move || poll::run(&payload, &way, exo2))?);
        }
        Ok(passage)
    }
}
