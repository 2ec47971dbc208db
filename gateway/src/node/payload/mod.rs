//! Payload pass-through: clients connect here, bytes pass both ways, and all are recorded.
//!
//! A payload never harms the boat: it has its own threads, and the gateway loop only logs a remark
//! for it now and then. A slow or stopped client or payload delays only its own connection.

mod forward;
mod passed_payload;
mod poll;
mod shared_line;
mod turn;

use super::clock::Clock;
use super::loop_input::Call;
use super::node_event::NodeEvent;
use super::tcp_port::TcpPort;
use crate::bridge::Event;
use crate::link::{HostPort, LinkAddress, LinkError};
use crate::payload::PayloadPort;
use bus::{InboxSender, Slot};
use passed_payload::Payload;
use recording::BulkRecorder;
use shared_line::SharedLine;
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Maximum number of simultaneous clients of a payload.
const CLIENTS_MAX: usize = 16;

/// Maximum time to connect to a payload.
const CONNECT_MAX: Duration = Duration::from_secs(2);
/// A side that accepts no bytes for this long is disconnected.
const WRITE_MAX: Duration = Duration::from_secs(10);
/// Maximum pause in the answer to a client that sends nothing more.
const ANSWER_PAUSE: Duration = Duration::from_secs(5);

/// The gateway services that payloads need.
pub(super) struct Shell {
    /// The recorder, and its file.
    pub(super) record: Option<(BulkRecorder, PathBuf)>,
    /// Minimum free disk space for recording payload bytes, MiB.
    pub(super) space_min_mib: u64,
    pub(super) clock: Clock,
    pub(super) calls: InboxSender<Call>,
}

/// The payloads of a boat, open until dropped.
pub(super) struct Payloads(Vec<Passage>);

/// The connection to a payload that is open to clients.
struct Passage {
    payload: Arc<Payload>,
    port: TcpPort,
}

/// How a payload is reached.
enum Way {
    /// One connection for each client.
    Tcp(HostPort),
    /// One connection shared by all clients.
    Shared(SharedLine),
}

impl Payloads {
    /// Opens a port for each. Failure to open one does not abandon the boat; it is a warning.
    pub(super) fn open(
        ports: &[PayloadPort],
        shell: &Shell,
        notify: &mut dyn FnMut(NodeEvent<'_>),
    ) -> Payloads {
        let mut passages = vec![];
        for port in ports {
            match Passage::open(port, shell) {
                Ok(passage) => {
                    let reach = format!("tcp://{} (from {})", passage.port.address, port.address);
                    notify(NodeEvent::Listening {
                        what: &format!("payload {}", port.name),
                        reach: &reach,
                    });
                    passages.push(passage);
                }
                Err(e) => {
                    let text = format!("payload {} is not passed through: {e}", port.name);
                    notify(NodeEvent::Event {
                        at_s: shell.clock.now().as_s(),
                        event: &Event::Warning(text),
                    });
                }
            }
        }
        Payloads(passages)
    }
}

impl Drop for Payloads {
    fn drop(&mut self) {
        self.0
            .iter()
            .for_each(|passage| passage.payload.turn.close());
    }
}

impl Passage {
    fn open(port: &PayloadPort, shell: &Shell) -> Result<Passage, Box<dyn std::error::Error>> {
        let payload = Arc::new(Payload::new(port, shell));
        let way = Arc::new(Way::open(&payload)?);
        let clients = Arc::clone(&payload);
        let to = Arc::clone(&way);
        let serve = move |slot: &Slot, client: &TcpStream| to.serve(&clients, slot, client);
        let name = format!("payload {}", port.name);
        let passage = Passage {
            port: TcpPort::open(port.listen, &name, CLIENTS_MAX, serve)?,
            payload,
        };
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

impl Way {
    fn open(payload: &Arc<Payload>) -> Result<Way, LinkError> {
        Ok(match &payload.port.address {
            LinkAddress::Tcp(_, at) => Way::Tcp(at.clone()),
            address => Way::Shared(SharedLine::open(payload, address)?),
        })
    }

    /// Serves a client until it or the payload is lost.
    fn serve(&self, payload: &Payload, slot: &Slot, client: &TcpStream) {
        match self {
            Way::Tcp(at) => forward::serve(payload, at, slot, client),
            Way::Shared(line) => line.serve(slot, client),
        }
    }
}
