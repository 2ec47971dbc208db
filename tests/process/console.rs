//! The operator console: stops use every path, and count as complete when the boats report them.

use crate::boat_alone::Wire;
use crate::support::{LIMIT, Process, Sim, gateway_args, printed_by, refused, temporary};
use std::io::{BufRead, BufReader, Write};
use std::net::SocketAddr;
use std::process::{ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

const BOATS: [&str; 2] = ["blue_one", "red_one"];
/// Time limit from an input line to the report, on a busy machine, ms.
const PROMPT_MS: u128 = 1000;

/// A game with two real boats that send little, and their gateways.
struct Fleet {
    sim: Sim,
    wires: [Wire; 2],
    gateways: [Process; 2],
    controls: [SocketAddr; 2],
}

impl Fleet {
    fn start() -> Fleet {
        let sim = Sim::start("two_real", &["--pace", "realtime"]);
        let wires = BOATS.map(|_| Wire::listen("tcp://127.0.0.1:0"));
        let controls = BOATS.map(|_| {
            SocketAddr::from(([127, 0, 0, 1], bus::free_port(false).expect("a free port")))
        });
        let gateways = std::array::from_fn(|i| {
            let control = controls[i].to_string();
            let more = ["--no-record", "--control-listen", &control];
            sim.quiet(&gateway_args(BOATS[i], &wires[i].address(), &more))
        });
        Fleet {
            sim,
            wires,
            gateways,
            controls,
        }
    }

    fn forget(&self) {
        self.wires.iter().for_each(Wire::forget);
    }

    /// A console that has found both boats.
    fn console(&self) -> Console {
        self.console_of(&["blue_one  disarmed", "red_one  disarmed"])
    }

    /// A console that has printed these lines.
    fn console_of(&self, beginnings: &[&str]) -> Console {
        let controls = self.controls.map(|at| at.to_string());
        let mut command = self.sim.squall(&[
            "gateway",
            "console",
            "--gateway",
            &controls[0],
            "--gateway",
            &controls[1],
        ]);
        command.stdin(Stdio::piped()).stderr(Stdio::piped());
        let (mut process, said) = Process::with_lines(command);
        let (sender, lines) = channel();
        let (complainer, complaints) = channel();
        let stderr = BufReader::new(process.0.stderr.take().expect("piped"));
        std::thread::spawn(move || said.map_while(|line| sender.send(line).ok()).for_each(drop));
        std::thread::spawn(move || {
            stderr
                .lines()
                .map_while(|line| complainer.send(line.ok()?).ok())
                .for_each(drop);
        });
        let console = Console {
            process,
            lines,
            complaints,
            complained: String::new(),
        };
        console.wait_for(beginnings);
        console
    }
}

struct Console {
    process: Process,
    lines: Receiver<String>,
    complaints: Receiver<String>,
    /// The standard error read so far.
    complained: String,
}

impl Console {
    fn say(&mut self, line: &str) {
        let stdin = self.process.0.stdin.as_mut().expect("piped");
        stdin
            .write_all(format!("{line}\n").as_bytes())
            .expect("it reads");
    }

    /// Waits for lines that begin with these strings, in any order; returns their times, ms.
    fn wait_for(&self, beginnings: &[&str]) -> Vec<u128> {
        let mut left = beginnings.to_vec();
        let mut times = Vec::new();
        let mut all = Vec::new();
        let start = Instant::now();
        while !left.is_empty() {
            let line = self
                .lines
                .recv_timeout(LIMIT.saturating_sub(start.elapsed()));
            let line = line.unwrap_or_else(|_| panic!("{left:?} is not printed: {all:?}"));
            if let Some(i) = left
                .iter()
                .position(|beginning| line.starts_with(beginning))
            {
                left.remove(i);
                times.extend(
                    line.split("  after ")
                        .nth(1)
                        .and_then(|time| time.trim_end_matches(" ms").parse::<u128>().ok()),
                );
            }
            all.push(line);
        }
        times
    }

    /// Enters a line, and waits for the reports of these boats.
    fn ask(&mut self, line: &str, reports: &[&str]) {
        self.say(line);
        let times = self.wait_for(reports);
        assert!(
            times.len() == reports.len() && times.iter().all(|ms| *ms < PROMPT_MS),
            "{line}: {times:?} ms"
        );
    }

    /// Waits for an error that contains these words.
    fn wait_for_complaint(&mut self, words: &str) {
        let start = Instant::now();
        while !self.complained.contains(words) {
            let line = self
                .complaints
                .recv_timeout(LIMIT.saturating_sub(start.elapsed()));
            self.complained +=
                &line.unwrap_or_else(|_| panic!("no {words:?}: {}", self.complained));
            self.complained.push('\n');
        }
    }

    fn end(mut self) -> (ExitStatus, String) {
        drop(self.process.0.stdin.take());
        let status = self.process.wait();
        self.complained.extend(
            self.complaints
                .iter()
                .flat_map(|line| [line, "\n".to_owned()]),
        );
        (status, self.complained)
    }
}

const ALL_STOPPED: [&str; 2] = ["blue_one  e-stopped  after ", "red_one  e-stopped  after "];
const ALL_DISARMED: [&str; 2] = ["blue_one  disarmed  after ", "red_one  disarmed  after "];

#[test]
fn a_console_stops_one_boat_or_all_and_releases_them() {
    let fleet = Fleet::start();
    let mut console = fleet.console();
    console.ask("blue_one estop", &ALL_STOPPED[..1]);
    console.say("status");
    console.wait_for(&[
        "blue_one  e-stopped (by an E-stop of this boat), ",
        "red_one  disarmed, ",
    ]);
    // Enter alone stops both boats.
    console.ask("", &ALL_STOPPED);
    // A stop uses every path. On a busy machine, the slowest copy arrives after the reports; a copy
    // that arrived after the release would stop the boats again, as it should.
    std::thread::sleep(Duration::from_secs(2));
    // A stop of one boat remains in force after the release of all.
    console.say("all release");
    console.wait_for(&["red_one  disarmed"]);
    console.say("blue_one arm");
    console.wait_for_complaint("refused by blue_one: an E-stop of this boat");
    console.ask("blue_one release", &["blue_one  disarmed  after "]);
    console.ask("red_one disarm", &ALL_DISARMED[1..]);
    console.ask("all disarm", &ALL_DISARMED);
    console.say("blue_one dance");
    let (status, said) = console.end();
    assert!(status.success(), "{said}");
    assert!(
        said.contains("dance") && said.contains("refused by blue_one: an E-stop of this boat"),
        "{said}"
    );
}

#[test]
fn a_suspended_or_killed_sim_blocks_neither_stops_nor_their_reports() {
    let mut fleet = Fleet::start();
    let mut console = fleet.console();
    fleet.sim.process.signal("STOP");
    console.ask("all estop", &ALL_STOPPED);
    let told = fleet.sim.printed(&["gateway", "tell", "all", "estop"]);
    assert!(told.contains("red_one: e-stopped"), "{told}");
    fleet.sim.process.signal("CONT");
    fleet.sim.process.kill();
    for _ in 0..3 {
        fleet.forget();
        console.ask("estop", &ALL_STOPPED);
    }
    let (status, said) = console.end();
    assert!(status.success(), "{said}");
}

#[test]
fn a_boat_that_does_not_report_its_stop_fails_the_console_and_tell() {
    let fleet = Fleet::start();
    let mut console = fleet.console();
    fleet.gateways[1].signal("STOP");
    console.wait_for(&["red_one  silent"]);
    console.ask("all estop", &ALL_STOPPED[..1]);
    console.wait_for(&["red_one  has not confirmed E-stop"]);
    let told = fleet
        .sim
        .refusal_of(&["gateway", "tell", "red_one", "estop"]);
    assert!(told.contains("red_one"), "{told}");
    let (status, said) = console.end();
    assert!(
        !status.success() && said.contains("red_one does not report that it has stopped: disarmed"),
        "{said}"
    );
    // The stop was repeated for as long as the console ran.
    fleet.gateways[1].signal("CONT");
    let mut console = fleet.console_of(&["red_one  e-stopped"]);
    console.ask("all estop", &ALL_STOPPED);
    assert!(console.end().0.success());
}

#[test]
fn tell_stops_boats_by_way_of_the_game_alone_within_its_time() {
    let fleet = Fleet::start();
    let console = fleet.console();
    // A console that finds no gateway, as on another machine.
    let nothing = temporary();
    let estop = |name: &str| {
        let mut command = fleet.sim.squall(&["gateway", "tell", name, "estop"]);
        command.env("XDG_RUNTIME_DIR", nothing.path());
        command
    };
    for (name, reports) in [
        ("red_one", &["red_one: e-stopped"][..]),
        ("all", &["blue_one: e-stopped", "red_one: e-stopped"]),
    ] {
        let said = printed_by(estop(name));
        assert!(
            reports.iter().all(|report| said.contains(report)),
            "{name}: {said}"
        );
    }
    assert!(refused(estop("nobody")).contains("nobody"));
    drop(console);
}
