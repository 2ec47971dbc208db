//! A boat with no node but its gateway, or without even that: it can be stopped without a sim, and
//! it stops when its gateway dies.

use crate::gateway::Water;
use crate::support::{
    LIMIT, Process, gateway_args, run, squall, stderr, stdout, wait_until, wait_within,
};
use bus::Watched;
use bus::token::TOKEN_VARIABLE;
use gateway::link::{BoatLink, Link, LinkAddress, LinkEvent, LinkSettings};
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

/// Water with an emulated boat that has no watchdog: it follows the last command forever.
struct Afloat {
    /// The name of a game that does not exist.
    game: &'static str,
    water: Water,
    /// The link to the boat.
    link: String,
}

impl Afloat {
    fn start(game: &'static str) -> Afloat {
        let water = Water::start(&[]);
        let link = format!("tcp://{}", water.back_seat);
        Afloat { game, water, link }
    }

    /// Sets the boat in motion like a back seat that then dies: it stays at 43 %.
    fn set_going(&self) {
        let mut stream = TcpStream::connect(&self.water.back_seat).expect("it accepts");
        stream
            .write_all(b"$PSEAC,T,0,43,0,*3B\r\n")
            .expect("a command");
        wait_within(LIMIT, "the boat is under way", || !self.is_still());
        drop(stream);
        std::thread::sleep(Duration::from_secs(2));
        assert!(!self.is_still(), "it continues with no program connected");
    }

    fn is_still(&self) -> bool {
        self.water.boat().1
    }

    fn stops(&self) {
        wait_within(STOPS, "the thrusters stand still", || self.is_still());
        std::thread::sleep(Duration::from_secs(1));
        assert!(self.is_still(), "it drives again");
    }

    /// The command for a gateway whose game has no other node.
    fn command(&self) -> Command {
        let more = ["--no-record", "--game", self.game];
        squall(&gateway_args("blue_one", &self.link, &more))
    }

    fn tell(&self, command: &str) -> String {
        tell(self.game, command)
    }

    fn gateway(&self) -> Process {
        let mut command = self.command();
        command
            .env_remove(TOKEN_VARIABLE)
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        Process::start(command)
    }
}

/// Runs an operator's command on the machine of a gateway in this game.
pub(crate) fn tell(game: &str, command: &str) -> String {
    let mut tell = squall(&["gateway", "tell", "blue_one", command, "--game", game]);
    let output = tell
        .env_remove(TOKEN_VARIABLE)
        .output()
        .expect("the program starts");
    let told = format!("{}{}", stdout(&output), stderr(&output));
    assert!(
        !told.contains('\x1b') && !told.contains("u001b"),
        "colours without a terminal: {told}"
    );
    told
}

#[test]
fn a_gateway_stops_its_boat_and_serves_operators_before_there_is_a_game() {
    let afloat = Afloat::start("alone");
    afloat.set_going();
    let mut gateway = afloat.gateway();
    afloat.stops();
    wait_until("it serves operators", || {
        afloat.tell("status").contains("disarmed")
    });
    let status = afloat.tell("status");
    assert!(
        status.contains("link        up") && status.contains("no game yet"),
        "{status}"
    );
    assert!(afloat.tell("arm").contains("no game yet"), "nobody arms it");
    assert!(afloat.tell("estop").contains("e-stopped"));
    let released = afloat.tell("release");
    assert!(
        released.contains("disarmed"),
        "by the gateway's own token: {released}"
    );
    // A second gateway on this machine is refused without any effect on the boat.
    let output = afloat.command().output().expect("the program starts");
    assert!(!output.status.success());
    let said = stderr(&output);
    assert!(
        said.contains("another gateway on this machine holds the link"),
        "{said}"
    );
    assert!(afloat.tell("status").contains("disarmed"));
    // A stop over the link goes to the gateway that holds it.
    let output = run(&["gateway", "stop", &afloat.link]);
    assert!(
        output.status.success()
            && stdout(&output).contains("the gateway of blue_one holds the link: e-stopped")
    );
    gateway.signal("TERM");
    assert!(gateway.wait().success());
}

#[test]
fn a_boat_can_be_stopped_over_its_link_with_nothing_else_running() {
    let afloat = Afloat::start("alone-stop");
    afloat.set_going();
    let output = run(&["gateway", "stop", &afloat.link]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("the boat reports standby"),
        "{}",
        stdout(&output)
    );
    afloat.stops();
    let nobody = format!(
        "tcp://127.0.0.1:{}",
        bus::free_port(false).expect("a free port")
    );
    let output = run(&["gateway", "stop", &nobody, "--wait-s", "0.5"]);
    assert!(
        !output.status.success() && stderr(&output).contains("was not reached"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn enter_in_the_gateways_own_terminal_triggers_an_e_stop() {
    let afloat = Afloat::start("alone-key");
    let gateway = afloat.command();
    let words = std::iter::once(gateway.get_program()).chain(gateway.get_args());
    let words: Vec<&str> = words.map(|word| word.to_str().expect("UTF-8")).collect();
    // Provide a terminal.
    let mut command = Command::new("script");
    command
        .args(["-qfec", &words.join(" "), "/dev/null"])
        .current_dir(env!("CARGO_MANIFEST_DIR"));
    command.stdin(Stdio::piped()).stdout(Stdio::null());
    let mut terminal = Process::start(command);
    wait_until("it is disarmed", || {
        afloat.tell("status").contains("blue_one: disarmed")
    });
    let Child { stdin, .. } = &mut terminal.0;
    let stdin = stdin.as_mut().expect("piped");
    std::thread::sleep(Duration::from_millis(300));
    assert!(
        afloat.tell("status").contains("blue_one: disarmed"),
        "nothing was pressed"
    );
    stdin.write_all(b"\n").expect("a key");
    stdin.flush().expect("a key");
    wait_within(Duration::from_secs(2), "it is e-stopped", || {
        afloat.tell("status").contains("e-stopped")
    });
    drop(terminal);
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
        let settings = LinkSettings {
            silence: None,
            ..LinkSettings::default()
        };
        let link = Arc::new(Link::open(&address, settings, take).expect("it listens"));
        let stop = Arc::<AtomicBool>::default();
        let sender = Arc::clone(&link);
        let ended = Arc::clone(&stop);
        std::thread::spawn(move || {
            while !ended.load(Ordering::Relaxed) {
                sender.send(b"$PSEAG,N*22\r\n".to_vec(), 0);
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        Wire {
            link,
            received,
            stop,
        }
    }

    /// The address for a gateway.
    pub(crate) fn address(&self) -> String {
        let reach = self.link.reach();
        if reach.starts_with('/') {
            format!("serial://{reach}?baud=115200")
        } else {
            reach
        }
    }

    /// Waits until this is received, counting from the last reset.
    pub(crate) fn wait_for(&self, what: &str, limit: Duration) -> Duration {
        let start = Instant::now();
        let came = self.received.wait(limit, |text| text.contains(what));
        assert!(
            came,
            "{what:?} not within {limit:?}: {:?}",
            self.received.visit(|text| text.clone())
        );
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
    // Zero thrust comes first: a gateway that sends only standby omits it.
    let zero = "$PSEAC,T,0,0,0,*";
    let standby = "$PSEAC,L,0,0,0,*";
    for listen in ["tcp://127.0.0.1:0", "udp://127.0.0.1:0", "pty"] {
        let wire = Wire::listen(listen);
        let more = ["--no-record", "--game", "nowhere-else"];
        let command = squall(&gateway_args("blue_one", &wire.address(), &more));
        let mut gateway = Process::quiet(command);
        wire.wait_for(zero, LIMIT);
        wire.wait_for(standby, LIMIT);
        let text = wire.received.visit(|text| text.clone());
        assert!(
            text.trim_start().starts_with(zero),
            "{listen}: zero comes first: {text:?}"
        );
        std::thread::sleep(Duration::from_millis(300));
        wire.forget();
        std::thread::sleep(Duration::from_secs(1));
        assert!(
            !wire.received.visit(|text| text.contains(zero)),
            "{listen}: a guard whose gateway runs is silent"
        );
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
        assert!(
            !wire.received.visit(|text| text.contains(zero)),
            "{listen}: the guard leaves it to the gateway again"
        );
        wire.forget();
        let killed = Instant::now();
        gateway.kill();
        wire.wait_for(zero, GUARD_PROMISES);
        let took = killed.elapsed();
        eprintln!("{listen}: killed, and zero and standby on the wire after {took:.1?}");
    }
}
