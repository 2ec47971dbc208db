//! Starting the program, reading what it reports, waiting with a limit.

use bus::token::TOKEN_VARIABLE;
use bus::{Bus, Declaration, Net, Token, Watched};
use messages::GameInfo;
use messages::topic::{self, GameName};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdin, Command, ExitStatus, Output, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longer than anything should take on a busy machine; a test that waits this long has failed.
pub(crate) const LIMIT: Duration = Duration::from_secs(60);

/// The program, in the folder of the project.
pub(crate) fn squall(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squall"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args).env(TOKEN_VARIABLE, token().hex());
    command
}

/// The same where no file may have more blocks, of 512 or 1024 bytes as the shell counts: a disk that is full.
pub(crate) fn squall_on_a_disk_of(blocks: u32, args: &[&str]) -> Command {
    let mut shell = Command::new("sh");
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    shell.current_dir(env!("CARGO_MANIFEST_DIR")).args(["-c", &limited, env!("CARGO_BIN_EXE_squall")]).args(args);
    shell
}

/// The token of all games of the tests.
pub(crate) fn token() -> Token {
    "0123456789abcdef".repeat(4).parse().expect("64 digits")
}

/// Runs the program to its end.
pub(crate) fn run(args: &[&str]) -> Output {
    squall(args).output().expect("the program starts")
}

/// What it printed to standard output.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What it printed to standard error.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the program, which is to fail, and gives what it says.
pub(crate) fn refusal_of(args: &[&str]) -> String {
    refused(squall(args))
}

fn refused(mut command: Command) -> String {
    let output = command.output().expect("the program starts");
    assert!(!output.status.success(), "{command:?} works");
    stderr(&output)
}

/// A folder that is gone with the test.
pub(crate) fn temporary() -> TempDir {
    tempfile::tempdir().expect("a temporary directory")
}

/// Waits until something is so; for how long it did.
pub(crate) fn wait_until(what: &str, is_so: impl FnMut() -> bool) -> Duration {
    wait_within(LIMIT, what, is_so)
}

/// The same, with a limit of its own.
pub(crate) fn wait_within(limit: Duration, what: &str, mut is_so: impl FnMut() -> bool) -> Duration {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < limit, "not within {limit:?}: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
    start.elapsed()
}

/// The newest of what comes on a key.
pub(crate) fn newest<T: Default + Send + 'static>(
    bus: &Bus,
    key: String,
    read: fn(&[u8]) -> T,
) -> (Arc<Watched<T>>, Declaration) {
    let newest = Arc::new(Watched::<T>::default());
    let to = Arc::clone(&newest);
    let standing = bus.subscribe(key, move |bytes| to.visit(|newest| *newest = read(bytes)));
    (newest, standing.expect("the hub is there"))
}

/// Runs a game to its end and gives its result.
pub(crate) fn result_of(args: &[&str]) -> Value {
    let dir = temporary();
    let json = dir.path().join("result.json");
    let json_text = json.display().to_string();
    let unrecorded: &[&str] = if args.contains(&"--record") { &[] } else { &["--no-record"] };
    let output = run(&[&["run"], args, unrecorded, &["--json", &json_text]].concat());
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    serde_json::from_str(&std::fs::read_to_string(&json).expect("a result was written")).expect("it is JSON")
}

/// Each of these seeds gives one game, byte for byte, in one process and across processes, and each another.
pub(crate) fn assert_a_game_each(game: &str, seeds: &[&str]) {
    let mut digests = Vec::new();
    for seed in seeds {
        let here = game_itself(result_of(&[game, "--seed", seed, "--in-process"]));
        // With two boats a process one process decides for a boat of each team.
        for boats_each in ["1", "2", "6"] {
            let there = result_of(&[game, "--seed", seed, "--agents-per-process", boats_each]);
            assert_eq!(here, game_itself(there), "seed {seed}, {boats_each} boats a process");
        }
        digests.push(here["digest"].clone());
    }
    digests.dedup();
    assert_eq!(digests.len(), seeds.len(), "each seed is another game");
}

/// What must not depend on how a game was run.
pub(crate) fn game_itself(mut result: Value) -> Value {
    result.as_object_mut().expect("an object").remove("run");
    result
}

/// A file of the tests' own, from the folder of the project.
pub(crate) fn own(name: &str) -> String {
    format!("tests/process/scenarios/{name}.toml")
}

/// A process that is gone with the test.
pub(crate) struct Process(pub(crate) Child);

impl Process {
    pub(crate) fn start(mut command: Command) -> Process {
        Process(command.spawn().expect("the program starts"))
    }

    /// kill -9.
    pub(crate) fn kill(&mut self) {
        self.0.kill().expect("it can be killed");
        self.0.wait().expect("it can be collected");
    }

    /// Any signal, by name.
    pub(crate) fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([&format!("-{name}"), &self.0.id().to_string()]).status();
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

    /// Waits for it to fail, and gives what it said on its piped standard error.
    pub(crate) fn refusal(&mut self) -> String {
        assert!(!self.wait().success());
        let mut said = String::new();
        self.0.stderr.take().expect("piped").read_to_string(&mut said).expect("text");
        said
    }

    /// The lines of its piped standard output.
    pub(crate) fn lines(&mut self) -> impl Iterator<Item = String> + use<> {
        BufReader::new(self.0.stdout.take().expect("piped")).lines().map_while(Result::ok)
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
    /// Serves a game of the tests' own on a free port of loopback.
    pub(crate) fn start(name: &str, args: &[&str]) -> Sim {
        let endpoint = free_endpoint();
        Sim::start_with(squall(&[]), name, &[&["--listen", &endpoint], args].concat())
    }

    /// The same, with an agent process for each boat of two against two, when all have joined.
    pub(crate) fn start_with_agents(name: &str, args: &[&str]) -> (Sim, Vec<Process>) {
        let sim = Sim::start(name, args);
        let agents = FOUR.iter().map(|name| sim.agent(&[name])).collect();
        sim.wait_for_kind("started");
        (sim, agents)
    }

    /// Serves such a game by a program that takes the arguments of `squall`.
    pub(crate) fn start_with(mut program: Command, name: &str, args: &[&str]) -> Sim {
        program.args(["sim", &own(name), "--for-parent"]).args(args);
        program.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = Process::start(program);
        let lines = process.lines();
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            lines.filter_map(|line| serde_json::from_str(&line).ok()).map_while(|v| sender.send(v).ok()).for_each(drop);
        });
        let stdin = process.0.stdin.take();
        let mut sim = Sim { process, stdin, messages, game: String::new(), endpoint: String::new() };
        let open = sim.wait_for_kind("open");
        sim.game = open["game"].as_str().expect("a name").to_owned();
        sim.endpoint = open["endpoint"].as_str().expect("an endpoint").to_owned();
        sim
    }

    /// The next message like this.
    pub(crate) fn wait_for(&self, is_it: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let left = LIMIT.saturating_sub(start.elapsed());
            let message = self.messages.recv_timeout(left).expect("the sim reports it in time");
            if is_it(&message) {
                return message;
            }
        }
    }

    /// The newest progress that it has reported, or the next.
    pub(crate) fn newest_progress(&self) -> Value {
        let newest = self.messages.try_iter().filter(|message| message["kind"] == "progress").last();
        newest.unwrap_or_else(|| self.wait_for_kind("progress"))
    }

    /// The next message of this kind.
    pub(crate) fn wait_for_kind(&self, kind: &str) -> Value {
        self.wait_for(|message| message["kind"] == kind)
    }

    /// Waits until the game has gone on for a while.
    pub(crate) fn play_on(&self, seconds: f64) -> f64 {
        let now_s = |message: &Value| message["now_s"].as_f64();
        let from_s = now_s(&self.wait_for_kind("progress")).expect("a time");
        let there = |message: &Value| now_s(message).is_some_and(|now| now >= from_s + seconds);
        now_s(&self.wait_for(there)).expect("a time")
    }

    /// Waits for an event of a boat; `null` is one of the whole game.
    pub(crate) fn wait_for_event(&self, event: &str, vehicle: impl Into<Value>) -> Value {
        let vehicle = vehicle.into();
        self.wait_for(|message| {
            message["kind"] == "event" && message["event"] == event && message["vehicle"] == vehicle
        })
    }

    /// Ends the game and gives its report.
    pub(crate) fn stop(mut self) -> Value {
        self.stdin = None;
        let done = self.wait_for_kind("done");
        self.process.wait();
        done
    }

    /// An agent for some of its vehicles.
    pub(crate) fn agent(&self, vehicles: &[&str]) -> Process {
        agent(&self.endpoint, &self.game, vehicles)
    }

    /// A process with these arguments, and where this game is; nobody reads what it prints.
    pub(crate) fn quiet(&self, args: &[&str]) -> Process {
        let mut command = self.squall(args);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        Process::start(command)
    }

    /// The game's name.
    pub(crate) fn name(&self) -> GameName {
        GameName::new(&self.game).expect("a name")
    }

    /// The program with these arguments, and where this game is.
    pub(crate) fn squall(&self, args: &[&str]) -> Command {
        squall(&[args, &["--connect", &self.endpoint, "--game", &self.game]].concat())
    }

    /// Runs it to its end.
    pub(crate) fn run(&self, args: &[&str]) -> Output {
        self.squall(args).output().expect("the program starts")
    }

    /// Runs it; it is to fail, and this is what it says.
    pub(crate) fn refusal_of(&self, args: &[&str]) -> String {
        refused(self.squall(args))
    }

    /// What the game is, as it says itself.
    pub(crate) fn info(&self, bus: &Bus) -> GameInfo {
        let info = bus.ask(&topic::scenario(&self.name()), Vec::new(), LIMIT).expect("the hub is there");
        serde_json::from_slice(&info.expect("an answer")).expect("a game")
    }

    /// A session of our own at its hub.
    pub(crate) fn bus(&self) -> Bus {
        let net = Net { connect: vec![self.endpoint.clone()], token: Some(token()), ..Net::default() };
        Bus::leaf(&net).expect("the hub is there")
    }
}

/// An agent process.
pub(crate) fn agent(endpoint: &str, game: &str, vehicles: &[&str]) -> Process {
    let args = ["agent", "--connect", endpoint, "--game", game, "--vehicle"];
    let mut command = squall(&[&args[..], vehicles].concat());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    Process::start(command)
}

/// A free port of loopback.
pub(crate) fn free_endpoint() -> String {
    format!("tcp/127.0.0.1:{}", bus::free_port(false).expect("a free port"))
}

/// All vehicles of the game of two against two.
pub(crate) const FOUR: [&str; 4] = ["blue_one", "blue_two", "red_one", "red_two"];
