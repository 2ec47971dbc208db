//! The game's address and token: nodes that start before their sim or outlive it find both by
//! themselves.

use crate::support::{
    FOUR, LIMIT, Process, Sim, free_endpoint, gateway_args, printed_by, squall, stdout, temporary,
    wait_until,
};
use bus::token::TOKEN_VARIABLE;
use bus::{Bus, BusError, Net};
use messages::external::{OperatorCommand, OperatorReply};
use messages::topic;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// A user who gives commands neither an address nor a token.
struct User(TempDir);

impl User {
    fn new() -> User {
        User(temporary())
    }

    fn squall(&self, args: &[&str]) -> Command {
        let mut command = squall(args);
        command
            .env_remove(TOKEN_VARIABLE)
            .env("XDG_RUNTIME_DIR", self.0.path());
        command
    }

    fn agent(&self, game: &str, vehicles: &[&str], more: &[&str]) -> Process {
        let mut command =
            self.squall(&[&["agent", "--game", game, "--vehicle"], vehicles, more].concat());
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        Process::start(command)
    }

    fn sim(&self, scenario: &str, game: &str, endpoint: &str, more: &[&str]) -> Sim {
        let place = ["--listen", endpoint, "--game", game];
        Sim::start_with(self.squall(&[]), scenario, &[&place, more].concat())
    }

    /// A session in the game, with its current token.
    fn bus(&self, sim: &Sim) -> Bus {
        let file =
            self.0
                .path()
                .join("squall")
                .join(format!("{}-{}.json", sim.game, sim.process.0.id()));
        let entry: Value =
            serde_json::from_slice(&std::fs::read(file).expect("it is registered")).expect("JSON");
        let token = entry["token"]
            .as_str()
            .expect("a token")
            .parse()
            .expect("it is one");
        Bus::leaf(&Net {
            connect: vec![sim.endpoint.clone()],
            token: Some(token),
            ..Net::default()
        })
        .expect("a hub")
    }
}

#[test]
fn an_agent_that_is_started_before_its_sim_plays() {
    let user = User::new();
    let mut agent = user.agent("late", &FOUR, &[]);
    let mut said = BufReader::new(agent.0.stderr.take().expect("piped"))
        .lines()
        .map_while(Result::ok);
    assert!(
        said.any(|line| line.contains("looking for the game")),
        "it waits"
    );
    std::thread::spawn(move || said.for_each(drop));
    let sim = user.sim("impatient", "late", &free_endpoint(), &[]);
    sim.wait_for_kind("started");
    sim.play_on(2.0);
    sim.stop();
    assert!(agent.wait().success());
}

#[test]
fn a_game_that_does_not_begin_is_waited_for_longer_than_a_silent_sim() {
    let user = User::new();
    let sim = user.sim("impatient", "slow", &free_endpoint(), &[]);
    let mut first = user.agent("slow", &FOUR[..1], &["--silence-s", "1"]);
    sim.wait_for(|message| {
        message["kind"] == "waiting" && message["agents"].as_array().is_some_and(|a| a.len() == 3)
    });
    // Wait for longer than the silence limit and the time allowed without a token.
    std::thread::sleep(Duration::from_secs(7));
    assert!(
        first.0.try_wait().expect("it can be waited for").is_none(),
        "{}",
        first.refusal()
    );
    let _others = user.agent("slow", &FOUR[1..], &[]);
    sim.wait_for_kind("started");
    sim.play_on(2.0);
    sim.stop();
    assert!(first.wait().success());
}

/// A gateway of `blue_one` for a boat that sends nothing.
fn gateway(user: &User, game: &str, boat: &TcpListener) -> Command {
    let link = format!("tcp://{}", boat.local_addr().expect("it is bound"));
    let more = ["--game", game, "--no-record"];
    user.squall(&gateway_args("blue_one", &link, &more))
}

#[test]
fn a_gateway_that_outlives_its_sim_joins_the_next_and_requires_its_token() {
    let user = User::new();
    let endpoint = free_endpoint();
    let boat = TcpListener::bind("127.0.0.1:0").expect("a port");
    let pace = ["--pace", "realtime"];
    // The gateway starts before the first sim, too.
    let mut command = gateway(&user, "twice", &boat);
    command.stderr(Stdio::null());
    let (mut gateway, mut said) = Process::with_lines(command);
    let mut sim = user.sim("real_attacker", "twice", &endpoint, &pace);
    assert!(said.any(|line| line.contains("joined: the sim accepts the boat")));
    let before = user.bus(&sim);
    sim.process.kill();
    assert!(said.any(|line| line.contains("waiting for the next")));
    let next = user.sim("real_attacker", "twice", &endpoint, &pace);
    assert!(said.any(|line| line.contains("joined: the sim accepts the boat")));
    std::thread::spawn(move || said.for_each(drop));
    // Actions that need the token of the current game.
    let release = |bus: &Bus| {
        bus.request_node::<_, OperatorReply>(
            &topic::operate(&next.name(), "blue_one"),
            &OperatorCommand::Release,
            LIMIT,
        )
    };
    wait_until("the earlier session is connected again", || {
        matches!(release(&before), Err(BusError::Unsealed { .. }))
    });
    let reply = release(&user.bus(&next))
        .expect("the token is known")
        .expect("an answer");
    assert_eq!(reply.status.vehicle, "blue_one");
    // A command that is given neither token nor address reaches the gateway's control port.
    for command in ["estop", "release"] {
        printed_by(user.squall(&["gateway", "tell", "blue_one", command]));
    }
    gateway.signal("TERM");
    assert!(gateway.wait().success());
}

#[test]
fn a_gateway_whose_terminal_is_held_obeys_all_the_same() {
    let user = User::new();
    let boat = TcpListener::bind("127.0.0.1:0").expect("a port");
    let _sim = user.sim(
        "real_attacker",
        "held",
        &free_endpoint(),
        &["--pace", "realtime"],
    );
    // A full pipe without a reader.
    let (_reader, mut pipe) = std::io::pipe().expect("a pipe");
    let full = pipe.try_clone().expect("a handle");
    std::thread::spawn(move || while std::io::Write::write(&mut pipe, &[b'.'; 4096]).is_ok() {});
    let mut command = gateway(&user, "held", &boat);
    command
        .stdout(full.try_clone().expect("a handle"))
        .stderr(full);
    let _gateway = Process::start(command);
    let tell = |command| user.squall(&["gateway", "tell", "blue_one", command]);
    // Before it joins, the gateway answers without its main loop.
    let is_running =
        |told: Output| told.status.success() && !stdout(&told).contains("looking for the game");
    wait_until("its loop answers", || {
        is_running(tell("status").output().expect("the program starts"))
    });
    for command in ["estop", "release"] {
        printed_by(tell(command));
    }
}
