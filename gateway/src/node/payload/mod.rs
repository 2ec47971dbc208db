//! Payloads passed through: clients connect here, bytes pass both ways, and all of them are recorded.
//!
//! A payload never harms the boat: it has threads of its own, and of the gateway loop it wants nothing but that a remark is logged now
//! and then. Whoever is slow or stopped, a client or a payload, holds up its own connection alone.

mod forward;
mod poll;
mod remarks;
mod shared_line;
mod tap;
mod turn;

use super::NodeEvent;
use super::clock::Clock;
use super::loop_input::Call;
use super::tcp_port::TcpPort;
use crate::bridge::Event;
use crate::link::{HostPort, LinkAddress, LinkError};
use crate::payload::PayloadPort;
use bus::{InboxSender, Slot};
use recording::BulkRecorder;
use remarks::Remarks;
use shared_line::SharedLine;
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tap::Taps;
use turn::Turn;

/// The most clients of a payload at once.
const CLIENTS_MAX: usize = 16;

/// The longest attempt to reach a payload.
const CONNECT_MAX: Duration = Duration::from_secs(2);
/// Whoever takes nothing for this long is given up.
const WRITE_MAX: Duration = Duration::from_secs(10);
/// How often a thread that waits for bytes looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);
/// How long the answer to a client that sends nothing more may pause.
const ANSWER_PAUSE: Duration = Duration::from_secs(5);

/// The payloads of a boat, as long as this is kept.
pub(super) struct Payloads(Vec<Passage>);

/// What payloads need of the gateway.
pub(super) struct Shell {
    /// The recorder, and its file.
    pub(super) record: Option<(BulkRecorder, PathBuf)>,
    /// What the disk must have free for bytes of payloads to be recorded, MiB.
    pub(super) space_min_mib: u64,
    pub(super) clock: Clock,
    pub(super) calls: InboxSender<Call>,
}

/// The way to a payload that is open to clients.
struct Passage {
    payload: Arc<Payload>,
    port: TcpPort,
}

/// How a payload is reached.
enum Way {
    /// By a connection for each client.
    Tcp(HostPort),
    /// By one that they share.
    Shared(SharedLine),
}

/// What the threads of a payload share.
struct Payload {
    port: PayloadPort,
    taps: Taps,
    turn: Turn,
    remarks: Arc<Remarks>,
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

impl Way {
    fn open(payload: &Arc<Payload>) -> Result<Way, LinkError> {
        Ok(match &payload.port.address {
            LinkAddress::Tcp(_, at) => Way::Tcp(at.clone()),
            address => Way::Shared(SharedLine::open(payload, address)?),
        })
    }

    /// Serves a client, until it or the payload is gone.
    fn serve(&self, payload: &Payload, slot: &Slot, client: &TcpStream) {
        match self {
            Way::Tcp(at) => forward::serve(payload, at, slot, client),
            Way::Shared(line) => line.serve(slot, client),
        }
    }
}

impl Payload {
    /// Has something logged, unless something was just now.
    fn remark(&self, text: &str) {
        self.remarks.make(text);
    }
}
