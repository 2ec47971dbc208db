//! The control port of a gateway: what operators ask over TCP, with a game or without.
//!
//! A line is a request, as on the network (`bus::token`), and so is the answer to it. Everybody may ask for the status and stop
//! the boat; for the rest the game's token is proven. An E-stop waits for nothing; nobody's silence, garbage or number of
//! connections keeps it out.

use super::NodeError;
use super::loop_input::LoopInput;
use super::tcp_port::TcpPort;
use crate::supervisor::Scope;
use bus::token::{self, Checked, Guard};
use bus::{CurrentToken, GATEWAY_PORT_KEY, Slot};
use game::external::{FleetCommand, GatewayCommand, GatewayStatus, OperatorCommand, OperatorReply};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

/// The most connections at once.
const CONNECTIONS_MAX: usize = 128;
/// A connection on which nothing comes for so long is closed, and one that does not read.
const IDLE_MAX: Duration = Duration::from_secs(30);
const WRITE_MAX: Duration = Duration::from_secs(2);
/// The longest request, bytes: a mission has some hundred waypoints.
const REQUEST_MAX: u64 = 64 * 1024;
/// How long the gateway loop may take to reply.
const REPLY_MAX: Duration = Duration::from_secs(2);

/// A port that is open as long as this is kept.
pub(super) struct ControlPort {
    server: Arc<Server>,
    _port: TcpPort,
    pub(super) address: SocketAddr,
    /// The token that it asks for.
    pub(super) token: CurrentToken,
}

/// What all connections share.
struct Server {
    vehicle: String,
    token: CurrentToken,
    input: LoopInput,
    /// Whether the gateway loop runs.
    is_running: AtomicBool,
}

impl ControlPort {
    /// Opens the port of the gateway of a boat.
    pub(super) fn open(
        listen: SocketAddr,
        vehicle: &str,
        token: CurrentToken,
        input: LoopInput,
    ) -> Result<ControlPort, NodeError> {
        let is_running = AtomicBool::new(false);
        let server = Arc::new(Server { vehicle: vehicle.to_owned(), token: token.clone(), input, is_running });
        let shared = Arc::clone(&server);
        // However a connection ends, nobody misses it.
        let serve = move |slot: &Slot, stream: &TcpStream| drop(shared.serve(slot, stream));
        let port = TcpPort::open(listen, "control port", CONNECTIONS_MAX, serve);
        let port = port.map_err(|source| NodeError::ControlPort { listen, source })?;
        Ok(ControlPort { server, address: port.address, _port: port, token })
    }

    /// From now on the gateway loop answers.
    pub(super) fn begin(&self) {
        self.server.is_running.store(true, Ordering::SeqCst);
    }
}

impl Server {
    /// Answers requests, line by line, until one is garbage or too long, or none comes.
    fn serve(&self, slot: &Slot, mut stream: &TcpStream) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(IDLE_MAX))?;
        stream.set_write_timeout(Some(WRITE_MAX))?;
        // A challenge is for this connection: those of others cannot displace it.
        let mut guard = Guard::new(self.token.clone());
        let mut reader = BufReader::new(stream);
        loop {
            let mut line = Vec::new();
            reader.by_ref().take(REQUEST_MAX).read_until(b'\n', &mut line)?;
            if line.pop() != Some(b'\n') {
                return Ok(());
            }
            // Before the check: what was checked while no token was known never reaches the loop.
            let is_running = self.is_running.load(Ordering::SeqCst);
            let (mut answer, is_garbage) = match guard.check(GATEWAY_PORT_KEY, &line, GatewayCommand::needs_token) {
                Checked::Granted(command) => {
                    slot.touch();
                    (token::answer(&self.execute(command, is_running)), false)
                }
                Checked::Challenged(challenge) => (challenge, false),
                Checked::Garbage(e) => {
                    (token::answer(&self.refusal(&format!("the request is not understood: {e}"))), true)
                }
            };
            answer.push(b'\n');
            stream.write_all(&answer)?;
            if is_garbage {
                return Ok(());
            }
        }
    }

    fn execute(&self, command: GatewayCommand, is_running: bool) -> OperatorReply {
        let status = || GatewayCommand::Boat { name: self.vehicle.clone(), command: OperatorCommand::Status };
        let (stop, ask) = match command {
            GatewayCommand::Boat { name, .. } if name != self.vehicle => {
                return self.refusal(&format!("this is the gateway of {}, not of {name}", self.vehicle));
            }
            GatewayCommand::Boat { command: OperatorCommand::EStop, .. } => (Some(Scope::Boat), status()),
            GatewayCommand::Fleet(FleetCommand::EStop) => (Some(Scope::Fleet), status()),
            command => (None, command),
        };
        // The loop reads E-stops before everything else: what is left to be asked is how the boat is then.
        if let Some(scope) = stop {
            self.input.stop(scope);
        }
        if !is_running {
            let is_free = matches!(&ask, GatewayCommand::Boat { command: OperatorCommand::Status, .. });
            let refused = (!is_free).then(|| "there is no link to the boat yet".to_owned());
            return OperatorReply { refused, status: self.status_before() };
        }
        let (reply, replied) = sync_channel(1);
        self.input.request((ask, reply));
        let reply = replied.recv_timeout(REPLY_MAX);
        reply.unwrap_or_else(|_| self.refusal("the gateway is ending, or does not answer"))
    }

    fn refusal(&self, reason: &str) -> OperatorReply {
        OperatorReply { refused: Some(reason.to_owned()), status: self.status_before() }
    }

    /// The status where the loop is not asked.
    fn status_before(&self) -> GatewayStatus {
        let is_stopped = self.input.has_stop();
        let state = if is_stopped { "e-stopped, as soon as there is a link" } else { "no link to the boat yet" };
        let link = "no link yet: looking for the game".to_owned();
        GatewayStatus { vehicle: self.vehicle.clone(), link, state: state.to_owned(), ..GatewayStatus::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::loop_input::loop_input;
    use super::*;
    use bus::{BusError, Token, ask_gateway};

    const LIMIT: Duration = Duration::from_secs(10);

    fn boat(command: OperatorCommand) -> GatewayCommand {
        GatewayCommand::Boat { name: "blue_one".to_owned(), command }
    }

    fn port() -> (ControlPort, Token, super::super::loop_input::LoopOutput) {
        let (input, output) = loop_input();
        let (token, here) = (Token::random(), SocketAddr::from(([127, 0, 0, 1], 0)));
        let port = ControlPort::open(here, "blue_one", Some(token.clone()).into(), input).expect("a free port");
        (port, token, output)
    }

    #[test]
    fn before_there_is_a_link_everybody_may_stop_and_look_and_nobody_arms() {
        let (port, token, output) = port();
        let ask = |token: Option<&Token>, command| ask_gateway(port.address, token, &command, LIMIT);
        let other = Token::random();
        let status = ask(None, boat(OperatorCommand::Status)).expect("a reply");
        assert_eq!((status.refused, status.status.vehicle.as_str()), (None, "blue_one"));
        for command in [boat(OperatorCommand::Arm), GatewayCommand::Fleet(FleetCommand::Release)] {
            assert!(matches!(ask(None, command.clone()), Err(BusError::NeedsToken)));
            assert!(matches!(ask(Some(&other), command.clone()), Err(BusError::WrongToken)));
            assert!(ask(Some(&token), command).expect("a reply").refused.expect("refused").contains("no link"));
        }
        assert!(!output.take_stop(Scope::Boat) && !output.take_stop(Scope::Fleet));
        assert_eq!(ask(None, boat(OperatorCommand::EStop)).expect("a reply").refused, None);
        let stopped = ask(None, GatewayCommand::Fleet(FleetCommand::EStop)).expect("a reply");
        assert!(stopped.refused.is_none() && stopped.status.state.contains("e-stopped"), "{stopped:?}");
        assert!(output.take_stop(Scope::Boat) && output.take_stop(Scope::Fleet));
        let other = GatewayCommand::Boat { name: "red_one".to_owned(), command: OperatorCommand::EStop };
        assert!(ask(None, other).expect("a reply").refused.expect("refused").contains("of blue_one, not of red_one"));
    }

    #[test]
    fn idle_and_garbage_connections_shut_nobody_out() {
        let (port, _, output) = port();
        let connect = || TcpStream::connect(port.address).expect("the port is open");
        let idle: Vec<TcpStream> = (0..4 * CONNECTIONS_MAX).map(|_| connect()).collect();
        let garbage: Vec<TcpStream> = (0..CONNECTIONS_MAX)
            .map(|i| {
                let mut stream = connect();
                // Some are dropped while they write.
                drop(stream.write_all(&vec![b'x'; if i % 2 == 0 { 10 } else { 100_000 }]));
                stream
            })
            .collect();
        for _ in 0..50 {
            let stopped = ask_gateway(port.address, None, &GatewayCommand::Fleet(FleetCommand::EStop), LIMIT);
            assert_eq!(stopped.expect("a reply").refused, None);
            assert!(output.take_stop(Scope::Fleet));
        }
        drop((idle, garbage));
    }

    #[test]
    fn garbage_is_told_so_and_a_request_without_end_is_cut_off() {
        let (port, _, output) = port();
        let said = |bytes: &[u8]| {
            let mut stream = TcpStream::connect(port.address).expect("the port is open");
            drop(stream.write_all(bytes));
            let mut said = String::new();
            drop(stream.read_to_string(&mut said));
            said
        };
        // A browser can be made to send this, by any page.
        let post = b"POST / HTTP/1.1\r\n\r\n{\"body\":{\"fleet\":\"e_stop\"}}\n";
        assert!(said(post).contains("not understood") && !output.take_stop(Scope::Fleet));
        assert!(said(&[b'['; 1000].iter().chain(b"\n").copied().collect::<Vec<u8>>()).contains("not understood"));
        assert_eq!(said(&vec![b'x'; 10 * REQUEST_MAX as usize]), "");
    }
}
