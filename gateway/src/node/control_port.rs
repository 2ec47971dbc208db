//! The control port of a gateway: operators' requests over TCP, with or without a game. UDP
//! datagrams can also carry stops.
//!
//! Requests and replies are one line each, as on the network (`bus::token`). Anyone may query the
//! status and stop the boat; everything else requires proof of the game's token. Nothing can delay
//! a stop: neither silent peers nor garbage nor many connections.

use super::error::NodeError;
use super::loop_input::{LoopInput, Stop};
use super::tcp_port::TcpPort;
use crate::supervisor::Scope;
use bus::stop::{DatagramPort, States, StopRequest};
use bus::token::{self, Checked, Guard};
use bus::{CurrentToken, GATEWAY_PORT_KEY, Slot};
use messages::external::{
    FleetCommand, GatewayCommand, GatewayStatus, OperatorCommand, OperatorReply,
};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

/// Maximum number of connections.
const CONNECTIONS_MAX: usize = 128;
/// Time after which a connection that is idle or does not read is closed.
const IDLE_MAX: Duration = Duration::from_secs(30);
const WRITE_MAX: Duration = Duration::from_secs(2);
/// Maximum bytes of a request: enough for a mission of a few hundred waypoints.
const REQUEST_MAX: u64 = 64 * 1024;
/// Maximum time for the gateway loop to reply.
const REPLY_MAX: Duration = Duration::from_secs(2);

/// Maximum time for the loop to provide the boat's state for the reply to a datagram. The next
/// datagram waits meanwhile.
const STATE_MAX: Duration = Duration::from_millis(50);
/// Number of attempts to find a port that is free for both TCP and UDP, if any port will do.
const ATTEMPTS: usize = 16;

/// A port that stays open until dropped.
pub(super) struct ControlPort {
    server: Arc<Server>,
    _port: TcpPort,
    _datagrams: DatagramPort,
    pub(super) address: SocketAddr,
}

/// State shared by all connections.
struct Server {
    vehicle: String,
    token: CurrentToken,
    input: LoopInput,
    /// Whether the gateway loop is running.
    is_running: AtomicBool,
}

impl ControlPort {
    /// Opens the control port of a boat's gateway.
    pub(super) fn open(
        listen: SocketAddr,
        vehicle: &str,
        token: CurrentToken,
        input: LoopInput,
    ) -> Result<ControlPort, NodeError> {
        let is_running = AtomicBool::new(false);
        let server = Arc::new(Server {
            vehicle: vehicle.to_owned(),
            token,
            input,
            is_running,
        });
        let open = || ControlPort::open_once(listen, Arc::clone(&server));
        // If the port is 0, the system chooses it for TCP; the same number may be in use for UDP.
        let attempts = if listen.port() == 0 { ATTEMPTS } else { 1 };
        (1..attempts).fold(open(), |opened, _| opened.or_else(|_| open()))
    }

    fn open_once(listen: SocketAddr, server: Arc<Server>) -> Result<ControlPort, NodeError> {
        let shared = Arc::clone(&server);
        // Errors of a single connection do not matter.
        let serve = move |slot: &Slot, stream: &TcpStream| drop(shared.serve(slot, stream));
        let failed = |source| NodeError::ControlPort { listen, source };
        let port = TcpPort::open(listen, "control port", CONNECTIONS_MAX, serve).map_err(failed)?;
        let shared = Arc::clone(&server);
        let address = port.address;
        let read = |socket| {
            DatagramPort::open(socket, "control datagrams", move |bytes| {
                shared.serve_datagram(bytes)
            })
        };
        let datagrams = UdpSocket::bind(address).and_then(read).map_err(failed)?;
        Ok(ControlPort {
            server,
            address,
            _port: port,
            _datagrams: datagrams,
        })
    }

    /// The required token.
    pub(super) fn token(&self) -> &CurrentToken {
        &self.server.token
    }

    /// Records that the gateway loop is running.
    pub(super) fn begin(&self) {
        self.server.is_running.store(true, Ordering::SeqCst);
    }
}

impl Server {
    /// Answers requests, line by line, until a line is garbage or too long, or the peer is silent.
    fn serve(&self, slot: &Slot, mut stream: &TcpStream) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(IDLE_MAX))?;
        stream.set_write_timeout(Some(WRITE_MAX))?;
        // Each connection has its own guard, so other connections cannot displace its challenge.
        let mut guard = Guard::new(self.token.clone());
        let mut reader = BufReader::new(stream);
        loop {
            let mut line = Vec::new();
            // An endless line must not exhaust memory.
            reader
                .by_ref()
                .take(REQUEST_MAX)
                .read_until(b'\n', &mut line)?;
            if line.pop() != Some(b'\n') {
                return Ok(());
            }
            // Read this before the check, so that no request checked without a token reaches the
            // loop.
            let is_running = self.is_running.load(Ordering::SeqCst);
            let (mut answer, is_garbage) =
                match guard.check(GATEWAY_PORT_KEY, &line, GatewayCommand::needs_token) {
                    Checked::Granted(command) => {
                        slot.touch();
                        (token::answer(&self.execute(command, is_running)), false)
                    }
                    Checked::Challenged(challenge) => (challenge, false),
                    Checked::Garbage(e) => (
                        token::answer(&self.refusal(&format!("cannot parse the request: {e}"))),
                        true,
                    ),
                };
            answer.push(b'\n');
            stream.write_all(&answer)?;
            // If a web page makes a browser post to this port, the browser sends HTTP: the first
            // line is garbage, and the rest is not read.
            if is_garbage {
                return Ok(());
            }
        }
    }

    fn execute(&self, command: GatewayCommand, is_running: bool) -> OperatorReply {
        if let GatewayCommand::Boat { name, command } = &command
            && *name != self.vehicle
            && !(name.is_empty() && *command == OperatorCommand::Status)
        {
            return self.refusal(&format!(
                "this is the gateway of {}, not of {name}",
                self.vehicle
            ));
        }
        // The loop reads stops before everything else; the query only returns the resulting state.
        let ask = match self.stop_in(&command) {
            Some(stop) => {
                // Stop before preparing the reply, so that nothing can delay the stop.
                self.input.stop(stop);
                GatewayCommand::boat(&self.vehicle, OperatorCommand::Status)
            }
            None => command,
        };
        if !is_running {
            let refused = (!ask.is_status()).then(|| "there is no link to the boat yet".to_owned());
            return OperatorReply {
                refused,
                status: self.status_before(),
            };
        }
        let (reply, replied) = sync_channel(1);
        self.input.request((ask, reply));
        let reply = replied.recv_timeout(REPLY_MAX);
        reply.unwrap_or_else(|_| self.refusal("the gateway is shutting down or not responding"))
    }

    /// The stop of this boat that a command requests, if any.
    fn stop_in(&self, command: &GatewayCommand) -> Option<Stop> {
        match command {
            GatewayCommand::Boat { name, command } if *name == self.vehicle => Stop::of(command),
            GatewayCommand::Fleet(FleetCommand::EStop) => Some(Stop::EStop(Scope::Fleet)),
            _ => None,
        }
    }

    /// Executes a stop, and replies with the resulting state of the boat. Before the loop runs,
    /// there is no state to report.
    fn serve_datagram(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        let request = StopRequest::decode(bytes)?;
        let count = match self.stop_in(&request.command) {
            Some(stop) => self.input.stop(stop),
            None if request.command.is_status() => 0,
            None => return None,
        };
        // The stop remains set: the loop reads it when it starts.
        if !self.is_running.load(Ordering::SeqCst) {
            return None;
        }
        let state = self
            .input
            .state_after(count, STATE_MAX)
            .filter(|state| !state.is_empty())?;
        request.answer(
            bytes.len(),
            self.token.get().as_ref(),
            &States::from([(self.vehicle.clone(), (state, 0))]),
        )
    }

    fn refusal(&self, reason: &str) -> OperatorReply {
        OperatorReply {
            refused: Some(reason.to_owned()),
            status: self.status_before(),
        }
    }

    /// The status before the loop runs.
    fn status_before(&self) -> GatewayStatus {
        let is_stopped = self.input.has_e_stop();
        let state = if is_stopped {
            "e-stopped once there is a link"
        } else {
            "no link to the boat yet"
        };
        let link = "no link yet: the gateway is starting".to_owned();
        GatewayStatus {
            vehicle: self.vehicle.clone(),
            link,
            state: state.to_owned(),
            ..GatewayStatus::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::loop_input::loop_input;
    use super::*;
    use bus::{BusError, Token, ask_gateway};

    const LIMIT: Duration = Duration::from_secs(10);

    fn boat(command: OperatorCommand) -> GatewayCommand {
        GatewayCommand::boat("blue_one", command)
    }

    fn port() -> (ControlPort, Token, super::super::loop_input::LoopOutput) {
        let (input, output) = loop_input();
        let token = Token::random();
        let here = SocketAddr::from(([127, 0, 0, 1], 0));
        let port = ControlPort::open(here, "blue_one", Some(token.clone()).into(), input)
            .expect("a free port");
        (port, token, output)
    }

    #[test]
    fn before_there_is_a_link_everybody_may_stop_and_look_and_nobody_arms() {
        let (port, token, output) = port();
        let ask =
            |token: Option<&Token>, command| ask_gateway(port.address, token, &command, LIMIT);
        let other = Token::random();
        let status = ask(None, boat(OperatorCommand::Status)).expect("a reply");
        assert_eq!(
            (status.refused, status.status.vehicle.as_str()),
            (None, "blue_one")
        );
        for command in [
            boat(OperatorCommand::Arm),
            GatewayCommand::Fleet(FleetCommand::Release),
        ] {
            assert!(matches!(
                ask(None, command.clone()),
                Err(BusError::NeedsToken)
            ));
            assert!(matches!(
                ask(Some(&other), command.clone()),
                Err(BusError::WrongToken)
            ));
            assert!(
                ask(Some(&token), command)
                    .expect("a reply")
                    .refused
                    .expect("refused")
                    .contains("no link")
            );
        }
        let [boat_stop, fleet_stop] = [Scope::Boat, Scope::Fleet].map(Stop::EStop);
        assert!(!output.take_stop(boat_stop) && !output.take_stop(fleet_stop));
        assert_eq!(
            ask(None, boat(OperatorCommand::EStop))
                .expect("a reply")
                .refused,
            None
        );
        let stopped = ask(None, GatewayCommand::Fleet(FleetCommand::EStop)).expect("a reply");
        assert!(
            stopped.refused.is_none() && stopped.status.state.contains("e-stopped"),
            "{stopped:?}"
        );
        assert!(output.take_stop(boat_stop) && output.take_stop(fleet_stop));
        let other = GatewayCommand::boat("red_one", OperatorCommand::EStop);
        assert!(
            ask(None, other)
                .expect("a reply")
                .refused
                .expect("refused")
                .contains("of blue_one, not of red_one")
        );
    }

    #[test]
    fn a_datagram_stops_the_boat_and_its_answer_is_no_longer_than_it_and_nothing_else_is_done() {
        let (port, token, output) = port();
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        socket.connect(port.address).expect("an address");
        socket
            .set_read_timeout(Some(Duration::from_millis(300)))
            .expect("a time");
        let request = |command| StopRequest {
            session: 1,
            number: 2,
            game: None,
            command,
        };
        // Before its loop runs, the gateway obeys the stop but has no state to report.
        socket
            .send(&request(boat(OperatorCommand::EStop)).encode())
            .expect("it is sent");
        let mut buffer = [0; 2000];
        assert!(socket.recv(&mut buffer).is_err() && output.take_stop(Stop::EStop(Scope::Boat)));
        port.begin();
        output.show_state(output.stop_count(), "armed".to_owned());
        let other = GatewayCommand::boat("red_one", OperatorCommand::EStop);
        let refused = [
            other,
            boat(OperatorCommand::Arm),
            GatewayCommand::Fleet(FleetCommand::Release),
        ];
        let refused = refused.map(|command| request(command).encode());
        for bytes in refused
            .iter()
            .map(Vec::as_slice)
            .chain([&b"garbage"[..], &[b' '; 1401]])
        {
            socket.send(bytes).expect("it is sent");
            assert!(
                socket.recv(&mut buffer).is_err(),
                "{}",
                String::from_utf8_lossy(bytes)
            );
        }
        assert_eq!(output.stop_count(), 1);
        let status = request(boat(OperatorCommand::Status)).encode();
        socket.send(&status).expect("it is sent");
        let count = socket.recv(&mut buffer).expect("an answer");
        let text = String::from_utf8_lossy(&buffer[..count]);
        assert!(
            count <= status.len() && text.contains("armed") && text.contains("mac"),
            "{text}"
        );
        assert!(!text.contains(&token.hex()));
        // A request shorter than its reply gets no reply.
        socket
            .send(br#"{"body":{"fleet":"e_stop"}}"#)
            .expect("it is sent");
        assert!(socket.recv(&mut buffer).is_err() && output.take_stop(Stop::EStop(Scope::Fleet)));
    }

    #[test]
    fn idle_and_garbage_connections_shut_nobody_out() {
        let (port, _, output) = port();
        let connect = || TcpStream::connect(port.address).expect("the port is open");
        let idle: Vec<TcpStream> = (0..4 * CONNECTIONS_MAX).map(|_| connect()).collect();
        let garbage: Vec<TcpStream> = (0..CONNECTIONS_MAX)
            .map(|i| {
                let mut stream = connect();
                // The gateway drops some of them in mid-write.
                drop(stream.write_all(&vec![b'x'; if i % 2 == 0 { 10 } else { 100_000 }]));
                stream
            })
            .collect();
        for _ in 0..50 {
            let stopped = ask_gateway(
                port.address,
                None,
                &GatewayCommand::Fleet(FleetCommand::EStop),
                LIMIT,
            );
            assert_eq!(stopped.expect("a reply").refused, None);
            assert!(output.take_stop(Stop::EStop(Scope::Fleet)));
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
        // Any web page can make a browser send this.
        let post = b"POST / HTTP/1.1\r\n\r\n{\"body\":{\"fleet\":\"e_stop\"}}\n";
        assert!(
            said(post).contains("cannot parse") && !output.take_stop(Stop::EStop(Scope::Fleet))
        );
        assert!(
            said(
                &[b'['; 1000]
                    .iter()
                    .chain(b"\n")
                    .copied()
                    .collect::<Vec<u8>>()
            )
            .contains("cannot parse")
        );
        assert_eq!(said(&vec![b'x'; 10 * REQUEST_MAX as usize]), "");
    }
}
