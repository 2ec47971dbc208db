//! Helpers that run the program, read its output, and wait with a limit.

use bus::token::TOKEN_VARIABLE;
use bus::{Bus, Declaration, Net, Token, Watched};
use messages::helm::HelmReport;
use messages::topic::{self, GameName};
use messages::{GameInfo, JoinReply, JoinRequest};
use scenario::Scenario;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdin, Command, ExitStatus, Output, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Timeout, generous for a busy machine; a test that waits this long has failed.
pub(crate) const LIMIT: Duration = Duration::from_secs(60);

/// The program, in the project folder.
pub(crate) fn squall(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squall"));
    command
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(args)
        .env(TOKEN_VARIABLE, token().hex());
    command
}

/// The program with a limit on file sizes, in blocks of 512 or 1024 bytes depending on the shell:
/// simulates a full disk.
pub(crate) fn squall_on_a_disk_of(blocks: u32, args: &[&str]) -> Command {
    let mut shell = Command::new("sh");
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    shell
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["-c", &limited, env!("CARGO_BIN_EXE_squall")])
        .args(args);
    shell
}

/// The arguments for a boat's gateway.
pub(crate) fn gateway_args<'a>(boat: &'a str, link: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let args = ["gateway", "surveyor", "--vehicle", boat, "--link", link];
    [&args[..], more].concat()
}

/// The token of all test games.
pub(crate) fn token() -> Token {
    "0123456789abcdef".repeat(4).parse().expect("64 digits")
}

/// Runs the program to its end.
pub(crate) fn run(args: &[&str]) -> Output {
    squall(args).output().expect("the program starts")
}

/// The program's standard output as a string.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The program's standard error as a string.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program, which must fail; returns its error output.
pub(crate) fn refusal_of(args: &[&str]) -> String {
    refused(squall(args))
}

/// Runs a command, which must fail; returns its error output.
pub(crate) fn refused(mut command: Command) -> String {
    let output = command.output().expect("the program starts");
    assert!(!output.status.success(), "{command:?} works");
    stderr(&output)
}

/// Runs the program, which must succeed; returns its standard output.
pub(crate) fn printed(args: &[&str]) -> String {
    printed_by(squall(args))
}

/// Runs a command, which must succeed; returns its standard output.
pub(crate) fn printed_by(mut command: Command) -> String {
    let output = command.output().expect("the program starts");
    assert!(
        output.status.success(),
        "{command:?}: {}{}",
        stdout(&output),
        stderr(&output)
    );
    stdout(&output)
}

/// All output of the program, whether it succeeds or not.
pub(crate) fn all_output(mut command: Command) -> String {
    let output = command.output().expect("the program starts");
    stdout(&output) + &stderr(&output)
}

/// A folder that is deleted when dropped.
pub(crate) fn temporary() -> TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

/// Waits until a condition is true; returns the time taken.
pub(crate) fn wait_until(what: &str, is_so: impl FnMut() -> bool) -> Duration {
    wait_within(LIMIT, what, is_so)
}

/// Waits until a condition is true, with its own limit.
pub(crate) fn wait_within(
    limit: Duration,
    what: &str,
    mut is_so: impl FnMut() -> bool,
) -> Duration {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < limit, "not within {limit:?}: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
    start.elapsed()
}

/// Subscribes to a key and keeps the newest message.
pub(crate) fn newest<T: Default + Send + 'static>(
    bus: &Bus,
    key: String,
    read: fn(&[u8]) -> T,
) -> (Arc<Watched<T>>, Declaration) {
    let newest = Arc::new(Watched::<T>::default());
    let to = Arc::clone(&newest);
    let standing = bus.subscribe(key, move |bytes| to.visit(|newest| *newest = read(bytes)));
    (newest, standing.expect("the hub is up"))
}

/// The reply to a node that asks for boats.
pub(crate) fn join(
    bus: &Bus,
    (name, scenario): (&GameName, &Scenario),
    request: &JoinRequest,
) -> JoinReply {
    let key = topic::join(name, scenario, request.role, &request.vehicles);
    bus.request(&key, request, LIMIT)
        .expect("the hub is up")
        .expect("an answer")
}

/// The report of a vehicle's helm.
pub(crate) fn helm(
    bus: &Bus,
    (name, scenario): (&GameName, &Scenario),
    vehicle: &str,
    question: &[u8],
) -> HelmReport {
    let vehicle = scenario.vehicle_by_name(vehicle).expect("it is there");
    let answer = bus.ask_node(
        &topic::helm(name, scenario, vehicle),
        question.to_vec(),
        LIMIT,
    );
    serde_json::from_slice(&answer.expect("the hub is up").expect("an answer")).expect("a report")
}

/// Runs a game to its end and returns its result.
pub(crate) fn result_of(args: &[&str]) -> Value {
    let dir = temporary();
    let json = dir.path().join("result.json");
    let json_text = json.display().to_string();
    let unrecorded: &[&str] = if args.contains(&"--record") {
        &[]
    } else {
        &["--no-record"]
    };
    printed(&[&["run"], args, unrecorded, &["--json", &json_text]].concat());
    serde_json::from_str(&std::fs::read_to_string(&json).expect("a result was written"))
        .expect("it is JSON")
}

/// Checks that each seed gives one game, byte for byte, in one process and across processes, and
/// that different seeds give different games.
pub(crate) fn assert_a_game_each(game: &str, seeds: &[&str]) {
    let mut digests = Vec::new();
    for seed in seeds {
        let here = game_itself(result_of(&[game, "--seed", seed, "--in-process"]));
        // With two boats per process, one process decides for a boat of each team.
        for boats_each in ["1", "2", "6"] {
            let there = result_of(&[game, "--seed", seed, "--agents-per-process", boats_each]);
            assert_eq!(
                here,
                game_itself(there),
                "seed {seed}, {boats_each} boats per process"
            );
        }
        digests.push(here["digest"].clone());
    }
    digests.dedup();
    assert_eq!(digests.len(), seeds.len(), "each seed is a different game");
}

/// The part of the result that must not depend on how a game was run.
pub(crate) fn game_itself(mut result: Value) -> Value {
    result.as_object_mut().expect("an object").remove("run");
    result
}

/// A test scenario, by its path from the project folder.
pub(crate) fn own(name: &str) -> String {
    format!("tests/process/scenarios/{name}.toml")
}

/// A process that is killed when dropped.
pub(crate) struct Process(pub(crate) Child);

impl Process {
    pub(crate) fn start(mut command: Command) -> Process {
        Process(command.spawn().expect("the program starts"))
    }

    /// Starts a command whose output is discarded.
    pub(crate) fn quiet(mut command: Command) -> Process {
        command.stdout(Stdio::null()).stderr(Stdio::null());
        Process::start(command)
    }

    /// Starts a command; also returns the lines of its standard output.
    pub(crate) fn with_lines(
        mut command: Command,
    ) -> (Process, impl Iterator<Item = String> + use<>) {
        command.stdout(Stdio::piped());
        let mut process = Process::start(command);
        let lines = process.lines();
        (process, lines)
    }

    /// Sends SIGKILL.
    pub(crate) fn kill(&mut self) {
        self.0.kill().expect("it can be killed");
        self.0.wait().expect("its exit can be awaited");
    }

    /// Sends any signal, by name.
    pub(crate) fn signal(&self, name: &str) {
        let sent = Command::new("kill")
            .args([&format!("-{name}"), &self.0.id().to_string()])
            .status();
        assert!(sent.expect("kill is there").success());
    }

    pub(crate) fn wait(&mut self) -> ExitStatus {
        let mut ended = None;
        wait_until("the process ends", || {
            ended = self.0.try_wait().expect("it can be waited for");
            ended.is_some()
        });
        ended.expect("it has ended")
    }

    /// Waits for the process to fail; returns its piped standard error.
    pub(crate) fn refusal(&mut self) -> String {
        assert!(!self.wait().success());
        self.errors()
    }

    /// The piped standard error of the process, once it has ended.
    pub(crate) fn errors(&mut self) -> String {
        let mut said = String::new();
        self.0
            .stderr
            .take()
            .expect("piped")
            .read_to_string(&mut said)
            .expect("text");
        said
    }

    /// The lines of its piped standard output.
    pub(crate) fn lines(&mut self) -> impl Iterator<Item = String> + use<> {
        BufReader::new(self.0.stdout.take().expect("piped"))
            .lines()
            .map_while(Result::ok)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A sim whose progress messages the test reads.
pub(crate) struct Sim {
    pub(crate) process: Process,
    stdin: Option<ChildStdin>,
    messages: Receiver<Value>,
    pub(crate) game: String,
    pub(crate) endpoint: String,
}

impl Sim {
    /// Serves a test scenario on a free loopback port.
    pub(crate) fn start(name: &str, args: &[&str]) -> Sim {
        let endpoint = free_endpoint();
        Sim::start_with(
            squall(&[]),
            name,
            &[&["--listen", &endpoint], args].concat(),
        )
    }

    /// Starts a sim and an agent process for each boat of a two-against-two game, and waits until
    /// all have joined.
    pub(crate) fn start_with_agents(name: &str, args: &[&str]) -> (Sim, Vec<Process>) {
        let sim = Sim::start(name, args);
        let agents = FOUR.iter().map(|name| sim.agent(&[name])).collect();
        sim.wait_for_kind("started");
        (sim, agents)
    }

    /// Serves a test scenario with a program that accepts the arguments of `squall`.
    pub(crate) fn start_with(mut program: Command, name: &str, args: &[&str]) -> Sim {
        program.args(["sim", &own(name), "--for-parent"]).args(args);
        program.stdin(Stdio::piped());
        let (mut process, lines) = Process::with_lines(program);
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            lines
                .filter_map(|line| serde_json::from_str(&line).ok())
                .map_while(|v| sender.send(v).ok())
                .for_each(drop);
        });
        let stdin = process.0.stdin.take();
        let mut sim = Sim {
            process,
            stdin,
            messages,
            game: String::new(),
            endpoint: String::new(),
        };
        let open = sim.wait_for_kind("open");
        sim.game = open["game"].as_str().expect("a name").to_owned();
        sim.endpoint = open["endpoint"].as_str().expect("an endpoint").to_owned();
        sim
    }

    /// The next message that matches.
    pub(crate) fn wait_for(&self, is_it: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let left = LIMIT.saturating_sub(start.elapsed());
            let message = self
                .messages
                .recv_timeout(left)
                .expect("the sim reports it in time");
            if is_it(&message) {
                return message;
            }
        }
    }

    /// The newest reported progress, or else the next.
    pub(crate) fn newest_progress(&self) -> Value {
        let newest = self
            .messages
            .try_iter()
            .filter(|message| message["kind"] == "progress")
            .last();
        newest.unwrap_or_else(|| self.wait_for_kind("progress"))
    }

    /// The next message of this kind.
    pub(crate) fn wait_for_kind(&self, kind: &str) -> Value {
        self.wait_for(|message| message["kind"] == kind)
    }

    /// Waits until the game has advanced by this many seconds.
    pub(crate) fn play_on(&self, seconds: f64) -> f64 {
        let now_s = |message: &Value| message["now_s"].as_f64();
        let from_s = now_s(&self.wait_for_kind("progress")).expect("a time");
        let there = |message: &Value| now_s(message).is_some_and(|now| now >= from_s + seconds);
        now_s(&self.wait_for(there)).expect("a time")
    }

    /// Waits for an event of a boat, or of the whole game for `null`.
    pub(crate) fn wait_for_event(&self, event: &str, vehicle: impl Into<Value>) -> Value {
        let vehicle = vehicle.into();
        self.wait_for(|message| {
            message["kind"] == "event" && message["event"] == event && message["vehicle"] == vehicle
        })
    }

    /// Stops the game and returns its report.
    pub(crate) fn stop(mut self) -> Value {
        self.stdin = None;
        let done = self.wait_for_kind("done");
        self.process.wait();
        done
    }

    /// Starts an agent for some of its vehicles.
    pub(crate) fn agent(&self, vehicles: &[&str]) -> Process {
        agent(&self.endpoint, &self.game, vehicles)
    }

    /// Starts a process with these arguments and the game's address; its output is discarded.
    pub(crate) fn quiet(&self, args: &[&str]) -> Process {
        Process::quiet(self.squall(args))
    }

    /// The game's name.
    pub(crate) fn name(&self) -> GameName {
        GameName::new(&self.game).expect("a name")
    }

    /// The program with these arguments and the game's address.
    pub(crate) fn squall(&self, args: &[&str]) -> Command {
        squall(&[args, &["--connect", &self.endpoint, "--game", &self.game]].concat())
    }

    /// Runs the program with these arguments to its end.
    pub(crate) fn run(&self, args: &[&str]) -> Output {
        self.squall(args).output().expect("the program starts")
    }

    /// Runs the program with these arguments; it must succeed. Returns its standard output.
    pub(crate) fn printed(&self, args: &[&str]) -> String {
        printed_by(self.squall(args))
    }

    /// Runs the program with these arguments; it must fail. Returns its error text.
    pub(crate) fn refusal_of(&self, args: &[&str]) -> String {
        refused(self.squall(args))
    }

    /// The game's description of itself.
    pub(crate) fn info(&self, bus: &Bus) -> GameInfo {
        let info = bus
            .ask(&topic::scenario(&self.name()), Vec::new(), LIMIT)
            .expect("the hub is up");
        serde_json::from_slice(&info.expect("an answer")).expect("a game")
    }

    /// A session at the sim's hub, with the game's name and scenario.
    pub(crate) fn session(&self) -> (Bus, GameName, Scenario) {
        let bus = self.bus();
        let scenario = self.info(&bus).scenario;
        (bus, self.name(), scenario)
    }

    /// A session at the sim's hub.
    pub(crate) fn bus(&self) -> Bus {
        let net = Net {
            connect: vec![self.endpoint.clone()],
            token: Some(token()),
            ..Net::default()
        };
        Bus::leaf(&net).expect("the hub is up")
    }
}

/// Starts an agent process.
pub(crate) fn agent(endpoint: &str, game: &str, vehicles: &[&str]) -> Process {
    let args = ["agent", "--connect", endpoint, "--game", game, "--vehicle"];
    let mut command = squall(&[&args[..], vehicles].concat());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    Process::start(command)
}

/// An endpoint with a free loopback port.
pub(crate) fn free_endpoint() -> String {
    format!(
        "tcp/127.0.0.1:{}",
        bus::free_port(false).expect("a free port")
    )
}

/// All vehicles of the two-against-two game.
pub(crate) const FOUR: [&str; 4] = ["blue_one", "blue_two", "red_one", "red_two"];
