//! The hardware loop with real processes and real sockets: whatever dies or is cut, the boat comes
//! to rest in time.
//!
//! The loop has water with one boat, its emulator, a proxy that can be cut, the gateway, the game
//! and its agents. The test observes the true thrust in the water game.

use crate::boat_alone::tell;
use crate::proxy::{PASS, Proxy, REFUSE, SWALLOW};
use crate::support::{
    LIMIT, Process, Sim, gateway_args, newest, refusal_of, result_of, run, squall,
    squall_on_a_disk_of, stderr, stdout, temporary, wait_until, wait_within,
};
use bus::{Bus, Declaration, Watched};
use messages::external::{GatewayStatus, OperatorCommand, OperatorReply};
use messages::{Frame, topic};
use primitives::codec;
use serde_json::Value;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Margin beyond the documented time, for a busy machine.
const SLACK: Duration = Duration::from_millis(1500);

/// A thruster that is commanded to stop changes by a fifth of its range per second, with a lag of
/// 0.25 s: from 70 % it gives less than this after 3.5 + 1.1 s.
const STILL_NEWTON: f64 = 0.5;
const LAG: Duration = Duration::from_millis(4600);

/// The first sentences to a boat: thrust zero, then standby.
const STANDBY: &str = "$PSEAC,T,0,0,0,*0C\r\n$PSEAC,L,0,0,0,*14\r\n";

/// Water with one emulated boat.
pub(crate) struct Water {
    _emulator: Process,
    _sim: Sim,
    /// The addresses for a back seat and, if there is one, a primary operator.
    pub(crate) back_seat: String,
    primary: Option<String>,
    /// The newest true state of the water.
    frame: Arc<Watched<Frame>>,
    _observer: (Bus, Declaration),
}

impl Water {
    /// Starts a boat at rest, with these options of its emulator.
    pub(crate) fn start(more: &[&str]) -> Water {
        let sim = Sim::start(
            "real_attacker",
            &["--pace", "realtime", "--afloat", "blue_one"],
        );
        let listen = [
            "gateway",
            "emulate",
            "--vehicle",
            "blue_one",
            "--listen",
            "tcp://127.0.0.1:0",
        ];
        let mut command = sim.squall(&[&listen[..], more].concat());
        command.stdout(Stdio::piped()).stderr(Stdio::null());
        let mut emulator = Process::start(command);
        let mut lines = emulator.lines();
        let mut reach = |what: &str| {
            let line = lines
                .find(|line| line.starts_with(what))
                .expect("it prints where it listens");
            line.rsplit("tcp://")
                .next()
                .expect("an address")
                .trim()
                .to_owned()
        };
        let back_seat = reach("back seat at ");
        let primary = more
            .contains(&"--primary")
            .then(|| reach("primary operator at "));
        std::thread::spawn(move || lines.for_each(drop));
        let bus = sim.bus();
        let key = topic::frame(&sim.name());
        let (frame, frames) = newest(&bus, key, |bytes| codec::decode(bytes).expect("a frame"));
        Water {
            _emulator: emulator,
            _sim: sim,
            back_seat,
            primary,
            frame,
            _observer: (bus, frames),
        }
    }

    /// The boat's speed (m/s), and whether its thrusters are stopped.
    pub(crate) fn boat(&self) -> (f64, bool) {
        let boat = self.frame.visit(|frame| frame.vehicles.first().cloned());
        boat.map_or((0.0, true), |boat| {
            let still =
                boat.port_newton.abs() < STILL_NEWTON && boat.starboard_newton.abs() < STILL_NEWTON;
            (boat.nav.surge_m_s, still)
        })
    }
}

/// All processes of the loop.
pub(crate) struct Loop {
    pub(crate) sim: Sim,
    agents: Process,
    gateway: Process,
    pub(crate) proxy: Proxy,
    water: Water,
}

impl Loop {
    /// Starts a boat that is under way, following its agent's orders.
    fn under_way(watchdog: &str) -> Loop {
        Loop::of(
            &["--primary", "tcp://127.0.0.1:0", "--watchdog-s", watchdog],
            &[],
        )
    }

    /// Starts a boat that is under way, with these options for emulator and gateway.
    pub(crate) fn of(emulator: &[&str], gateway: &[&str]) -> Loop {
        let all = Loop::begin(emulator, &[&["--arm"], gateway].concat());
        all.wait(LIMIT, "the boat is under way", |boat| boat.0 > 0.6);
        all
    }

    /// Starts a boat that need not be under way.
    pub(crate) fn begin(emulator: &[&str], gateway: &[&str]) -> Loop {
        let sim = Sim::start("real_attacker", &["--pace", "realtime"]);
        let water = Water::start(emulator);
        let proxy = Proxy::start(water.back_seat.clone());
        let gateway = start_gateway(&sim, proxy.port, gateway);
        let agents = sim.agent(&["blue_one", "red_one"]);
        Loop {
            sim,
            agents,
            gateway,
            proxy,
            water,
        }
    }

    /// The boat's speed (m/s), and whether its thrusters are stopped.
    pub(crate) fn boat(&self) -> (f64, bool) {
        self.water.boat()
    }

    fn wait(&self, limit: Duration, what: &str, is_so: impl Fn((f64, bool)) -> bool) -> Duration {
        wait_within(limit, what, || is_so(self.boat()))
    }

    /// Checks that the thrusters stop within this time and stay stopped.
    pub(crate) fn stops_within(&self, stated: Duration) -> Duration {
        let took = self.wait(
            stated + LAG + SLACK,
            "the thrusters stand still",
            |(_, still)| still,
        );
        for _ in 0..20 {
            std::thread::sleep(Duration::from_millis(100));
            assert!(self.boat().1, "it drives again");
        }
        took
    }

    pub(crate) fn ask(&self, command: &OperatorCommand) -> OperatorReply {
        self.try_ask(command).expect("the gateway answers")
    }

    pub(crate) fn try_ask(&self, command: &OperatorCommand) -> Option<OperatorReply> {
        let bus = self.sim.bus();
        let key = topic::operate(&self.sim.name(), "blue_one");
        bus.request_node(&key, command, Duration::from_secs(10))
            .expect("the hub is up")
    }

    pub(crate) fn status(&self) -> GatewayStatus {
        self.ask(&OperatorCommand::Status).status
    }

    /// Waits until the gateway's state contains these words.
    pub(crate) fn wait_for_state(&self, words: &str) {
        wait_until(words, || self.status().state.contains(words));
    }

    /// Checks that an E-stop of all boats stops it, and that it cannot be armed before the release.
    pub(crate) fn e_stop_and_release(&self) {
        let output = self.sim.run(&["gateway", "tell", "all", "estop"]);
        assert!(output.status.success(), "{}", stderr(&output));
        self.stops_within(Duration::from_millis(300));
        self.wait_for_state("e-stopped");
        assert!(
            self.ask(&OperatorCommand::Arm)
                .refused
                .is_some_and(|reason| reason.contains("release it first"))
        );
        assert!(
            self.sim
                .run(&["gateway", "tell", "all", "release"])
                .status
                .success()
        );
        self.wait_for_state("disarmed");
    }

    /// Arms the boat as soon as it is ready.
    pub(crate) fn arm(&self) {
        wait_until("it can be armed", || {
            self.ask(&OperatorCommand::Arm).refused.is_none()
        });
        self.wait(LIMIT, "it is under way again", |boat| boat.0 > 0.6);
    }

    /// Ends the gateway, because the boat serves one program at a time.
    pub(crate) fn end_gateway(&mut self) {
        self.gateway.signal("INT");
        self.gateway.wait();
    }

    /// Starts a new gateway with these options.
    pub(crate) fn restart_gateway(&mut self, more: &[&str]) {
        self.gateway = start_gateway(&self.sim, self.proxy.port, more);
        self.await_gateway();
    }

    pub(crate) fn await_gateway(&self) {
        wait_until("it is in the game", || {
            self.try_ask(&OperatorCommand::Status).is_some()
        });
    }

    /// Checks that a killed agent stops the boat, and that only an operator can arm it again.
    pub(crate) fn outlive_an_agent(&mut self) {
        self.agents.kill();
        self.stops_within(Duration::from_secs(1));
        self.wait_for_state("no fresh order");
        self.agents = self.sim.agent(&["blue_one", "red_one"]);
        self.sim.wait_for_event("agent_back", "blue_one");
        self.stays_at_rest();
        self.arm();
    }

    /// Checks that the guard outlives a killed gateway and stops the boat.
    pub(crate) fn outlive_a_gateway(&mut self, more: &[&str]) {
        self.gateway.kill();
        self.stops_within(Duration::from_millis(500));
        self.restart_gateway(more);
        self.wait_for_state("disarmed");
        self.arm();
    }

    /// Checks that the guard replaces a suspended gateway until an operator arms it again.
    pub(crate) fn suspend_the_gateway(&self) {
        self.gateway.signal("STOP");
        self.stops_within(Duration::from_millis(500));
        self.gateway.signal("CONT");
        wait_until("it reports what happened", || {
            !self.status().failsafes.is_empty()
        });
        let failsafes = self.status().failsafes;
        assert!(
            failsafes[0].cause.contains("the gateway hung for"),
            "{failsafes:?}"
        );
        self.stays_at_rest();
        self.arm();
    }

    fn stays_at_rest(&self) {
        std::thread::sleep(Duration::from_secs(1));
        assert!(self.boat().1, "it does not continue by itself");
    }
}

fn start_gateway(sim: &Sim, port: u16, more: &[&str]) -> Process {
    let link = format!("tcp://127.0.0.1:{port}");
    let more = [&["--no-record"][..], more].concat();
    sim.quiet(&gateway_args("blue_one", &link, &more))
}

#[test]
fn a_killed_agent_stops_the_boat_and_only_an_operator_arms_it_again() {
    Loop::under_way("none").outlive_an_agent();
}

#[test]
fn a_killed_sim_stops_the_boat_when_its_orders_are_too_old() {
    let mut all = Loop::under_way("none");
    all.sim.process.kill();
    all.stops_within(Duration::from_secs(1));
}

#[test]
fn the_end_of_a_game_disarms_the_boat_without_a_failsafe() {
    let Loop {
        sim,
        agents: _agents,
        gateway: _gateway,
        proxy: _proxy,
        water: _water,
    } = Loop::under_way("none");
    let game = sim.game.clone();
    sim.stop();
    wait_until("it is disarmed", || {
        tell(&game, "status").contains("blue_one: disarmed")
    });
    // Wait for longer than an order is valid.
    std::thread::sleep(Duration::from_secs(2));
    let status = tell(&game, "status");
    assert!(!status.contains("failsafe"), "{status}");
}

#[test]
fn a_killed_gateway_is_outlived_by_its_guard_which_stops_the_boat() {
    Loop::under_way("none").outlive_a_gateway(&[]);
}

#[test]
fn a_suspended_gateway_is_replaced_by_its_guard_until_an_operator_arms_it_again() {
    Loop::under_way("none").suspend_the_gateway();
}

#[test]
fn a_gateway_asked_to_exit_stops_the_boat_first() {
    for signal in ["TERM", "INT"] {
        let mut all = Loop::under_way("none");
        all.gateway.signal(signal);
        assert!(all.gateway.wait().success());
        all.stops_within(Duration::from_millis(200));
    }
}

/// The error of a gateway that must fail within this time, whether it found the boat or not.
fn refusal_within(limit: Duration, mut gateway: Command) -> String {
    let start = Instant::now();
    gateway.stdout(Stdio::null()).stderr(Stdio::piped());
    let said = Process::start(gateway).refusal();
    assert!(start.elapsed() < limit, "{:?}: {said}", start.elapsed());
    said
}

#[test]
fn a_gateway_that_cannot_record_exits_with_the_reason_and_leaves_the_boat_alone() {
    let dir = temporary();
    let boat = TcpListener::bind("127.0.0.1:0").expect("a port");
    boat.set_nonblocking(true).expect("a socket");
    let link = format!("tcp://{}", boat.local_addr().expect("it is bound"));
    let [taken, nowhere, full] =
        ["taken.mcap", "nowhere/x.mcap", "full.mcap"].map(|name| dir.path().join(name));
    std::fs::write(&taken, "of the previous run").expect("a file can be written");
    for (path, blocks, reason) in [
        (&taken, 2048, "File exists"),
        (&nowhere, 2048, "No such file"),
        (&full, 0, "File too large"),
    ] {
        let file = path.display().to_string();
        let args = gateway_args("blue_one", &link, &["--game", "nobody", "--record", &file]);
        let said = refusal_within(LIMIT / 4, squall_on_a_disk_of(blocks, &args));
        assert!(
            said.contains(&format!("cannot record to {file}")) && said.contains(reason),
            "{said}"
        );
        assert!(
            !said.contains("recording to") && !said.contains("operators reach"),
            "{said}"
        );
        assert!(boat.accept().is_err(), "{reason}: the boat is connected to");
    }
    assert_eq!(
        std::fs::read_to_string(&taken).expect("it is there"),
        "of the previous run"
    );
    assert!(
        !full.exists(),
        "a recording that did not begin leaves nothing behind"
    );
}

#[test]
fn a_gateway_that_fails_sends_its_boat_standby_first_and_ends() {
    let boat = TcpListener::bind("127.0.0.1:0").expect("a port");
    let link = format!("tcp://{}", boat.local_addr().expect("it is bound"));
    let more = ["--game", "nobody", "--wait-s", "0.001", "--no-record"];
    let said = refusal_within(LIMIT / 4, squall(&gateway_args("blue_one", &link, &more)));
    assert!(said.contains("no game to join"), "{said}");
    let mut words = String::new();
    boat.accept()
        .expect("it was connected to")
        .0
        .read_to_string(&mut words)
        .expect("text");
    assert!(words.starts_with(STANDBY), "{words:?}");
    // Nor does it wait for a boat that does not exist.
    let nowhere = format!(
        "serial://{}?baud=38400",
        temporary().path().join("none").display()
    );
    refusal_within(
        LIMIT / 4,
        squall(&gateway_args("blue_one", &nowhere, &more)),
    );
}

#[test]
fn gateways_that_could_not_record_begin_no_game() {
    let dir = temporary();
    let gateways = "scenarios/gateways/emulated.toml";
    let file = dir.path().join("blue_one.mcap").display().to_string();
    std::fs::write(&file, "of the previous run").expect("a file can be written");
    let records = dir.path().display().to_string();
    let args = ["run", MIXED, "--emulate", "--pace", "10x", "--no-record"];
    let said = refusal_of(
        &[
            &args[..],
            &["--gateway", gateways, "--record-gateways", &records],
        ]
        .concat(),
    );
    assert!(
        said.contains(&format!("cannot record to {file}")) && said.contains("File exists"),
        "{said}"
    );
}

#[test]
fn a_cut_half_open_or_intermittent_link_leaves_the_boat_at_rest() {
    // Cut: failsafe at once; the first command on the next connection is standby.
    let all = Loop::under_way("none");
    all.proxy.cut();
    all.stops_within(Duration::from_millis(300));
    all.wait_for_state("the link is lost");
    all.arm();
    // Half open: no data passes, but neither side closed the link. It is detected after three
    // seconds of silence.
    all.proxy.set(SWALLOW);
    std::thread::sleep(Duration::from_millis(1500));
    all.proxy.set(PASS);
    all.stops_within(Duration::from_secs(3));
    all.arm();
    // The link goes up and down.
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(4) {
        all.proxy.cut();
        std::thread::sleep(Duration::from_millis(150));
    }
    all.stops_within(Duration::from_millis(300));
    // After a long outage it reconnects by itself.
    all.proxy.set(REFUSE);
    all.proxy.cut();
    std::thread::sleep(Duration::from_secs(2));
    all.proxy.set(PASS);
    all.arm();
}

#[test]
fn the_primary_operator_and_an_e_stop_stop_the_boat_through_the_whole_loop() {
    let all = Loop::under_way("none");
    let mut operator =
        TcpStream::connect(all.water.primary.as_deref().expect("it listens")).expect("it accepts");
    operator
        .write_all(b"$PSEAC,L,0,0,0,*14\r\n")
        .expect("a command");
    all.stops_within(Duration::from_millis(300));
    all.wait_for_state("the primary operator has taken over");
    assert!(
        all.ask(&OperatorCommand::Arm)
            .refused
            .is_some_and(|reason| reason.contains("secondary control"))
    );
    operator
        .write_all(b"$PSEAC,L,0,0,0,OP2_ON*67\r\n")
        .expect("a command");
    all.arm();
    all.e_stop_and_release();
    all.arm();
}

/// The games through gateways have this scenario.
const MIXED: &str = "scenarios/games/mixed_2v2.toml";

/// Plays a game through gateways with this file and emulated boats: no boat is lost, and the
/// gateways' recordings are replayed. Returns its result.
pub(crate) fn emulated_game(gateways: &str) -> Value {
    let dir = temporary();
    let records = dir.path().display().to_string();
    let result = result_of(&[
        MIXED,
        "--emulate",
        "--pace",
        "10x",
        "--gateway",
        gateways,
        "--record-gateways",
        &records,
    ]);
    assert_no_boat_was_lost(&result);
    for name in ["blue_one", "red_one"] {
        let file = dir
            .path()
            .join(format!("{name}.mcap"))
            .display()
            .to_string();
        let output = run(&["gateway", "replay", &file]);
        let printed = stdout(&output);
        assert!(
            output.status.success() && printed.contains("the recording, byte for byte"),
            "{printed}"
        );
    }
    result
}

pub(crate) fn assert_no_boat_was_lost(result: &Value) {
    let events = result["events"].as_array().expect("events");
    for bad in ["nav_lost", "agent_lost", "quarantined"] {
        assert!(
            !events.iter().any(|event| event["event"] == bad),
            "{bad}: {events:?}"
        );
    }
}

/// The sum of a count over all teams.
pub(crate) fn count(result: &Value, what: &str) -> u64 {
    let teams = result["counts"]["teams"].as_object().expect("teams");
    teams
        .values()
        .map(|counts| counts[what].as_u64().expect("a count"))
        .sum()
}

#[test]
fn a_game_through_gateways_and_emulated_boats_is_like_one_without() {
    let looped = emulated_game("scenarios/gateways/emulated.toml");
    let pure = result_of(&[MIXED, "--rehearse", "--in-process"]);
    for what in ["grabs", "tags"] {
        let got = count(&looped, what);
        let want = count(&pure, what);
        assert!(
            got > 0 && want > 0 && got <= 4 * want && want <= 4 * got,
            "{what}: {got} through gateways, {want} without"
        );
    }
    assert_eq!(looped["duration_s"], pure["duration_s"]);
}
