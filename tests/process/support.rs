//! Starting the program, reading what it tells, waiting with a limit.

use bus::{Bus, Net};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Output, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Longer than anything should take on a busy machine; a test that waits this long has failed.
pub(crate) const LIMIT: Duration = Duration::from_secs(60);

/// The program, in the folder of the project.
pub(crate) fn squall(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squall"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    command
}

/// Runs the program to its end.
pub(crate) fn run(args: &[&str]) -> Output {
    squall(args).output().expect("the program starts")
}

/// Runs a game to its end and gives its result.
pub(crate) fn result_of(args: &[&str]) -> Value {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let json = dir.path().join("result.json");
    let json_text = json.display().to_string();
    let unrecorded: &[&str] = if args.contains(&"--record") { &[] } else { &["--no-record"] };
    let output = run(&[&["run"], args, unrecorded, &["--json", &json_text]].concat());
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_str(&std::fs::read_to_string(&json).expect("a result was written")).expect("it is JSON")
}

/// A game file of two against two that lasts long enough for anything; `more` are further lines on top.
pub(crate) fn long_game(dir: &Path, more: &str) -> PathBuf {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let path = dir.join("long_game.toml");
    let base = scenarios.join("games/pav01_vs_pav01.toml");
    let text = format!("base = \"{}\"\nduration_s = 80000\n{more}\n", base.display());
    std::fs::write(&path, text).expect("a file can be written");
    path
}

/// The folder of scenario files.
pub(crate) fn scenarios() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").display().to_string()
}

/// A file of this name in a folder.
pub(crate) fn write(dir: &Path, name: &str, text: &str) -> PathBuf {
    let path = dir.join(name);
    std::fs::write(&path, text).expect("a file can be written");
    path
}

/// A real boat that attacks, and a simulated one that lies still.
pub(crate) fn real_attacker(dir: &Path) -> PathBuf {
    let root = scenarios();
    let text = format!(
        "base = \"{root}/games/pav01_vs_pav01.toml\"\nduration_s = 80000\n\
         [[team]]\nname = \"blue\"\nstrategy = \"{root}/strategies/easy_attacker.toml\"\n\
         [[team]]\nname = \"red\"\nstrategy = \"{root}/strategies/idle.toml\"\n\
         [[vehicle]]\nname = \"blue_one\"\nteam = \"blue\"\nsource = \"external\"\n\
         [[vehicle]]\nname = \"red_one\"\nteam = \"red\"\n"
    );
    write(dir, "real_attacker.toml", &text)
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
        let start = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().expect("it can be waited for") {
                return status;
            }
            assert!(start.elapsed() < LIMIT, "the process does not end");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A sim whose tellings the test reads.
pub(crate) struct Sim {
    pub(crate) process: Process,
    life_line: Option<ChildStdin>,
    tellings: Receiver<Value>,
    pub(crate) game: String,
    pub(crate) endpoint: String,
}

impl Sim {
    /// Serves a game file on a free port of loopback.
    pub(crate) fn start(scenario: &Path, args: &[&str]) -> Sim {
        let endpoint = free_endpoint();
        Sim::start_with(squall(&[]), scenario, &[&["--listen", &endpoint], args].concat())
    }

    /// Serves a game file by a program that takes the arguments of `squall`.
    pub(crate) fn start_with(mut program: Command, scenario: &Path, args: &[&str]) -> Sim {
        program.args(["sim", &scenario.display().to_string(), "--for-parent"]).args(args);
        program.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = Process::start(program);
        let output = process.0.stdout.take().expect("its output is piped");
        let (sender, tellings) = channel();
        std::thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(Result::ok);
            lines.filter_map(|line| serde_json::from_str(&line).ok()).map_while(|v| sender.send(v).ok()).for_each(drop);
        });
        let life_line = process.0.stdin.take();
        let mut sim = Sim { process, life_line, tellings, game: String::new(), endpoint: String::new() };
        let open = sim.wait_for(|telling| telling["tell"] == "open");
        sim.game = open["game"].as_str().expect("a name").to_owned();
        sim.endpoint = open["endpoint"].as_str().expect("an endpoint").to_owned();
        sim
    }

    /// The next telling like this.
    pub(crate) fn wait_for(&self, is_it: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let left = LIMIT.saturating_sub(start.elapsed());
            let telling = self.tellings.recv_timeout(left).expect("the sim tells it in time");
            if is_it(&telling) {
                return telling;
            }
        }
    }

    /// Waits until the game has gone on for a while.
    pub(crate) fn play_on(&self, seconds: f64) -> f64 {
        let now_s = |telling: &Value| telling["now_s"].as_f64();
        let from_s = now_s(&self.wait_for(|t| t["tell"] == "progress")).expect("a time");
        let there = |telling: &Value| now_s(telling).is_some_and(|now| now >= from_s + seconds);
        now_s(&self.wait_for(there)).expect("a time")
    }

    /// Waits for an event of a boat.
    pub(crate) fn wait_for_event(&self, event: &str, vehicle: &str) -> Value {
        self.wait_for(|t| t["tell"] == "event" && t["event"] == event && t["vehicle"] == vehicle)
    }

    /// Ends the game and gives its report.
    pub(crate) fn stop(mut self) -> Value {
        self.life_line = None;
        let done = self.wait_for(|telling| telling["tell"] == "done");
        self.process.wait();
        done
    }

    /// An agent for some of its vehicles.
    pub(crate) fn agent(&self, vehicles: &[&str]) -> Process {
        agent(&self.endpoint, &self.game, vehicles)
    }

    /// A session of our own at its hub.
    pub(crate) fn bus(&self) -> Bus {
        Bus::leaf(&Net { connect: vec![self.endpoint.clone()], ..Net::default() }).expect("the hub is there")
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
