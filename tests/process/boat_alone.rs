//! A boat with no node but its gateway, or not even that: it can be stopped without a sim, and it
//! stops when its gateway dies.

use crate::support::{LIMIT, Process, Sim, all_output, newest, printed, refusal_of, squall, wait_until, wait_within};
use bus::token::TOKEN_VARIABLE;
use bus::{Bus, Declaration, Watched};
use gateway::link::{Link, LinkAddress, LinkEvent, LinkSettings};
use messages::{Frame, topic};
use primitives::codec;
use std::io::Write;
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A thruster that is commanded to stop changes by a fifth of its range a second, with a lag of
/// 0.25 s: from 43 % it gives less than `STILL_NEWTON` after 2.2 + 1.1 s. The rest allows for a
/// busy machine.
const STOPS: Duration = Duration::from_millis(3300 + 1500);
const STILL_NEWTON: f64 = 0.5;

/// Water with an emulated boat that has no watchdog: it follows the last command for ever.
struct Afloat {
    /// The name of a game that does not exist.
    game: &'static str,
    water: Sim,
    _emulator: Process,
    /// The address for a back seat.
    back_seat: String,
    frame: Arc<Watched<Frame>>,
    _observer: (Bus, Declaration),
}

impl Afloat {
    fn start(game: &'static str) -> Afloat {
        let water = Sim::start("real_attacker", &["--pace", "realtime", "--afloat", "blue_one"]);
        let mut command =
            water.squall(&["gateway", "emulate", "--vehicle", "blue_one", "--listen", "tcp://127.0.0.1:0"]);
        command.stderr(Stdio::null());
        let (emulator, mut lines) = Process::with_lines(command);
        let line = lines.find(|line| line.starts_with("back seat at ")).expect("it prints where it listens");
        let back_seat = line.rsplit("back seat at ").next().expect("an address").trim().to_owned();
        std::thread::spawn(move || lines.for_each(drop));
        let bus = water.bus();
        let key = topic::frame(&water.name());
        let (frame, frames) = newest(&bus, key, |bytes| codec::decode(bytes).expect("a frame"));
        Afloat { game, water, _emulator: emulator, back_seat, frame, _observer: (bus, frames) }
    }

    /// Sets the boat going like a back seat that then dies: it stays at 43 %.
    fn set_going(&self) {
        let address = self.back_seat.trim_start_matches("tcp://");
        let mut stream = TcpStream::connect(address).expect("it accepts");
        stream.write_all(b"$PSEAC,T,0,43,0,*3B\r\n").expect("a command");
        wait_within(LIMIT, "the boat sails", || !self.is_still());
        drop(stream);
        std::thread::sleep(Duration::from_secs(2));
        assert!(!self.is_still(), "it goes on without anybody");
    }

    fn is_still(&self) -> bool {
        let boat = self.frame.visit(|frame| frame.vehicles.first().cloned());
        boat.is_none_or(|boat| boat.port_newton.abs() < STILL_NEWTON && boat.starboard_newton.abs() < STILL_NEWTON)
    }

    fn stops(&self) {
        wait_within(STOPS, "the thrusters stand still", || self.is_still());
        std::thread::sleep(Duration::from_secs(1));
        assert!(self.is_still(), "it goes on again");
    }

    /// Arguments of a gateway whose game has no other node.
    fn gateway_args(&self) -> Vec<String> {
        let args = ["gateway", "surveyor", "--vehicle", "blue_one", "--no-record", "--game", self.game, "--link"];
        args.iter().map(|arg| (*arg).to_owned()).chain([self.back_seat.clone()]).collect()
    }

    /// Runs an operator's command on the gateway's machine.
    fn tell(&self, command: &str) -> String {
        let mut tell = squall(&["gateway", "tell", "blue_one", command, "--game", self.game]);
        tell.env_remove(TOKEN_VARIABLE);
        let told = all_output(tell);
        assert!(!told.contains('\x1b') && !told.contains("u001b"), "colours where there is no terminal: {told}");
        told
    }

    fn gateway(&self) -> Process {
        let args = self.gateway_args();
        let mut command = squall(&args.iter().map(String::as_str).collect::<Vec<_>>());
        command.env_remove(TOKEN_VARIABLE);
        Process::quiet(command)
    }
}

#[test]
fn a_gateway_stops_its_boat_and_serves_operators_before_there_is_a_game() {
    let afloat = Afloat::start("alone");
    afloat.set_going();
    let mut gateway = afloat.gateway();
    afloat.stops();
    wait_until("it serves operators", || afloat.tell("status").contains("safed"));
    let status = afloat.tell("status");
    assert!(status.contains("link        up") && status.contains("no game yet"), "{status}");
    assert!(afloat.tell("arm").contains("no game yet"), "nobody arms it");
    assert!(afloat.tell("estop").contains("e-stopped"));
    let released = afloat.tell("release");
    assert!(released.contains("safed"), "by the gateway's own token: {released}");
    // A second gateway on this machine is refused without any effect on the boat.
    let second = afloat.gateway_args();
    let said = refusal_of(&second.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(said.contains("another gateway on this machine has the link"), "{said}");
    assert!(afloat.tell("status").contains("safed"));
    // A stop over the link goes to the gateway that holds it.
    let said = printed(&["gateway", "stop", &afloat.back_seat]);
    assert!(said.contains("the gateway of blue_one has the link: e-stopped"), "{said}");
    gateway.signal("TERM");
    assert!(gateway.wait().success());
}

#[test]
fn a_boat_can_be_stopped_over_its_link_with_nothing_else_running() {
    let afloat = Afloat::start("alone-stop");
    afloat.set_going();
    let said = printed(&["gateway", "stop", &afloat.back_seat]);
    assert!(said.contains("the boat reports standby"), "{said}");
    afloat.stops();
    let nobody = format!("tcp://127.0.0.1:{}", bus::free_port(false).expect("a free port"));
    let said = refusal_of(&["gateway", "stop", &nobody, "--wait-s", "0.5"]);
    assert!(said.contains("was not reached"), "{said}");
}

#[test]
fn enter_in_the_gateways_own_terminal_triggers_an_e_stop() {
    let afloat = Afloat::start("alone-key");
    let words: Vec<String> =
        std::iter::once(env!("CARGO_BIN_EXE_squall").to_owned()).chain(afloat.gateway_args()).collect();
    // Give it a terminal.
    let mut command = Command::new("script");
    command.args(["-qfec", &words.join(" "), "/dev/null"]).current_dir(env!("CARGO_MANIFEST_DIR"));
    command.stdin(Stdio::piped()).stdout(Stdio::null());
    let mut terminal = Process::start(command);
    wait_until("it is safed", || afloat.tell("status").contains("blue_one: safed"));
    let Child { stdin, .. } = &mut terminal.0;
    let stdin = stdin.as_mut().expect("piped");
    std::thread::sleep(Duration::from_millis(300));
    assert!(afloat.tell("status").contains("blue_one: safed"), "nothing was pressed");
    stdin.write_all(b"\n").expect("a key");
    stdin.flush().expect("a key");
    wait_within(Duration::from_secs(2), "it is e-stopped", || afloat.tell("status").contains("e-stopped"));
    drop((terminal, afloat.water));
}

/// The guard's time limit.
const GUARD_PROMISES: Duration = Duration::from_millis(500);

/// A boat's end of a link: sends reports and records what it receives.
pub(crate) struct Wire {
    link: Arc<Link>,
    pub(crate) received: Arc<Watched<String>>,
    stop: Arc<AtomicBool>,
}

impl Wire {
    pub(crate) fn listen(address: &str) -> Wire {
        let address = LinkAddress::to_listen(address).expect("an address");
        let received = Arc::new(Watched::new(String::new()));
        let noted = Arc::clone(&received);
        let take = move |event| {
            if let LinkEvent::Bytes { bytes, .. } = event {
                noted.visit(|text| text.push_str(&String::from_utf8_lossy(&bytes)));
            }
        };
        let settings = LinkSettings { silence: None, ..LinkSettings::default() };
        let link = Arc::new(Link::open(&address, settings, take).expect("it listens"));
        let (stop, sender) = (Arc::<AtomicBool>::default(), Arc::clone(&link));
        let ended = Arc::clone(&stop);
        std::thread::spawn(move || {
            while !ended.load(Ordering::Relaxed) {
                sender.send(b"$PSEAG,N*22\r\n".to_vec(), 0);
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        Wire { link, received, stop }
    }

    /// The address for a gateway.
    pub(crate) fn address(&self) -> String {
        let reach = self.link.reach();
        if reach.starts_with('/') { format!("serial://{reach}?baud=115200") } else { reach }
    }

    /// Waits until this is received, counting from the last reset.
    pub(crate) fn wait_for(&self, what: &str, limit: Duration) -> Duration {
        let start = Instant::now();
        let came = self.received.wait(limit, |text| text.contains(what));
        assert!(came, "{what:?} not within {limit:?}: {:?}", self.received.visit(|text| text.clone()));
        start.elapsed()
    }

    pub(crate) fn forget(&self) {
        self.received.visit(String::clear);
    }
}

impl Drop for Wire {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

#[test]
fn the_guard_stops_a_boat_on_every_kind_of_link_when_its_gateway_is_killed_or_suspended() {
    // Thrust zero comes first: a gateway that sends only standby omits it.
    let (zero, standby) = ("$PSEAC,T,0,0,0,*", "$PSEAC,L,0,0,0,*");
    for listen in ["tcp://127.0.0.1:0", "udp://127.0.0.1:0", "pty"] {
        let wire = Wire::listen(listen);
        let args = ["gateway", "surveyor", "--vehicle", "blue_one", "--no-record", "--game", "nowhere-else", "--link"];
        let mut gateway = Process::quiet(squall(&[&args[..], &[&wire.address()]].concat()));
        wire.wait_for(zero, LIMIT);
        wire.wait_for(standby, LIMIT);
        let text = wire.received.visit(|text| text.clone());
        assert!(text.trim_start().starts_with(zero), "{listen}: zero comes first: {text:?}");
        std::thread::sleep(Duration::from_millis(300));
        wire.forget();
        std::thread::sleep(Duration::from_secs(1));
        assert!(!wire.received.visit(|text| text.contains(zero)), "{listen}: a guard whose gateway runs is silent");
        gateway.signal("STOP");
        wire.forget();
        let took = wire.wait_for(zero, GUARD_PROMISES);
        eprintln!("{listen}: suspended, and zero and standby on the wire after {took:.0?}");
        wire.forget();
        wire.wait_for(zero, GUARD_PROMISES);
        gateway.signal("CONT");
        std::thread::sleep(Duration::from_millis(500));
        wire.forget();
        wire.wait_for(standby, GUARD_PROMISES);
        assert!(!wire.received.visit(|text| text.contains(zero)), "{listen}: the guard leaves it to the gateway again");
        wire.forget();
        let killed = Instant::now();
        gateway.kill();
        wire.wait_for(zero, GUARD_PROMISES);
        let took = killed.elapsed();
        eprintln!("{listen}: killed, and zero and standby on the wire after {took:.1?}");
    }
}
