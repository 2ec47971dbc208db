//! Games with keys: the same game as without; nodes with the wrong keys get an error that says so.

use crate::gateway::assert_no_boat_was_lost;
use crate::support::{
    FOUR, LIMIT, Process, Sim, free_endpoint, game_itself, gateway_args, own, printed, printed_by,
    refusal_of, refused, result_of, squall, temporary, wait_until,
};
use bus::token::TOKEN_VARIABLE;
use bus::{BusError, Token};
use messages::external::{GatewayCommand, OperatorCommand};
use serde_json::Value;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Keys for all roles.
fn keys() -> (TempDir, PathBuf) {
    let dir = temporary();
    let folder = dir.path().join("keys");
    let words = [
        "--team",
        "blue",
        "--team",
        "red",
        "--gateway",
        "--observer",
        "--operator",
    ];
    let made = printed(&[&["keys", "new", text(&folder)], &words[..]].concat());
    assert!(made.contains("team-blue, valid from"), "{made}");
    (dir, folder)
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// The program without a token.
fn without_token(mut command: Command) -> Command {
    command.env_remove(TOKEN_VARIABLE);
    command
}

#[test]
fn a_game_with_keys_is_the_game_in_one_process_byte_for_byte() {
    let (_dir, folder) = keys();
    let game = own("seeded_3v3");
    let here = game_itself(result_of(&[&game, "--in-process"]));
    // With keys each process serves one team; four boats per process would mix teams.
    let there = game_itself(result_of(&[
        &game,
        "--keys",
        text(&folder),
        "--agents-per-process",
        "4",
    ]));
    assert_eq!(here, there);
    std::fs::remove_dir_all(folder.join("team-red")).expect("it was there");
    let refused = refusal_of(&["run", &game, "--keys", text(&folder)]);
    assert!(refused.contains("team-red: no keys found"), "{refused}");
}

#[test]
fn sixteen_agents_with_keys_play_the_game_in_one_process() {
    let (_dir, folder) = keys();
    let game = own("eight_a_side");
    let here = game_itself(result_of(&[&game, "--in-process"]));
    for _ in 0..2 {
        assert_eq!(
            here,
            game_itself(result_of(&[&game, "--keys", text(&folder)]))
        );
    }
}

#[test]
fn a_real_boat_plays_in_a_game_with_keys() {
    let (_dir, folder) = keys();
    let game = [
        &own("mixed_30s"),
        "--pace",
        "10x",
        "--emulate",
        "--keys",
        text(&folder),
    ];
    assert_no_boat_was_lost(&result_of(&game));
}

#[test]
fn the_control_port_of_a_gateway_with_keys_has_a_token_of_its_own() {
    let (_dir, folder) = keys();
    let of = |part: &str| folder.join(part).display().to_string();
    let sim = without_token(squall(&[]));
    let sim = Sim::start_with(
        sim,
        "mixed_60s",
        &[
            "--pace",
            "1x",
            "--listen",
            &free_endpoint(),
            "--keys",
            &of("sim"),
        ],
    );
    let boat = TcpListener::bind("127.0.0.1:0").expect("a port");
    let link = format!("tcp://{}", boat.local_addr().expect("an address"));
    let port: SocketAddr = free_endpoint()
        .trim_start_matches("tcp/")
        .parse()
        .expect("an address");
    let (keys, control) = (of("gateway"), port.to_string());
    let more = ["--no-record", "--keys", &keys, "--control-listen", &control];
    let gateway = sim.squall(&gateway_args("blue_one", &link, &more));
    let _gateway = Process::quiet(without_token(gateway));
    let ask = |token: Option<&Token>, command: OperatorCommand| {
        bus::ask_gateway(
            port,
            token,
            &GatewayCommand::boat("blue_one", command),
            LIMIT,
        )
    };
    // The port accepts stops before the gateway is registered for operators on this machine.
    let registered = || {
        bus::local_gateways()
            .into_iter()
            .find(|entry| entry.control == port)
    };
    wait_until("this user finds the gateway", || registered().is_some());
    let token = registered()
        .and_then(|entry| entry.token)
        .expect("the file has the token");
    let is_running =
        || ask(None, OperatorCommand::Disarm).is_ok_and(|reply| reply.refused.is_none());
    wait_until("the gateway accepts stops from anyone", is_running);
    assert!(matches!(
        ask(None, OperatorCommand::Arm),
        Err(BusError::NeedsToken)
    ));
    assert!(matches!(
        ask(Some(&Token::random()), OperatorCommand::Arm),
        Err(BusError::WrongToken)
    ));
    let reply = ask(Some(&token.parse().expect("a token")), OperatorCommand::Arm).expect("it may");
    assert!(reply.refused.is_some(), "but the boat sends nothing");
    sim.stop();
}

#[test]
fn who_has_the_wrong_keys_is_told_so_and_everybody_with_keys_may_stop_the_boats() {
    let (_dir, folder) = keys();
    let (_other_dir, other) = keys();
    let of = |part: &str| folder.join(part);
    let sim = Sim::start_with(
        without_token(squall(&[])),
        "long",
        &[
            "--pace",
            "10x",
            "--listen",
            &free_endpoint(),
            "--keys",
            text(&of("sim")),
        ],
    );
    assert!(sim.endpoint.starts_with("tls/"), "{}", sim.endpoint);
    let with = |args: &[&str], keys: &Path| {
        without_token(sim.squall(&[args, &["--keys", text(keys)]].concat()))
    };
    for (text, want) in [
        (
            refused(without_token(sim.squall(&[
                "agent",
                "--vehicle",
                "blue_one",
            ]))),
            "the game has keys",
        ),
        (
            refused(with(
                &["agent", "--vehicle", "blue_one"],
                &other.join("team-blue"),
            )),
            "from a different authority",
        ),
        (
            refused(with(&["agent", "--vehicle", "blue_one"], &of("team-red"))),
            "the keys of team-red are not for the agent of blue_one",
        ),
        (
            refused(with(&["agent", "--vehicle", "blue_one"], &of("observer"))),
            "are not for the agent of blue_one",
        ),
        (refused(with(&["watch"], &of("sim"))), "only for serving"),
        (
            refused(with(&["watch"], &folder)),
            "this folder contains the bundles gateway, observer, operator, sim",
        ),
    ] {
        assert!(text.contains(want), "{text}");
    }
    let agents = FOUR.map(|name| {
        let team = of(&format!("team-{}", name.split('_').next().expect("a team")));
        let mut command = with(&["agent", "--vehicle", name], &team);
        command.stdout(Stdio::null());
        Process::start(command)
    });
    sim.wait_for_kind("started");
    let tell = |what: &str, part: &str| with(&["gateway", "tell", "all", what], &of(part));
    printed_by(tell("estop", "observer"));
    sim.wait_for_event("e_stopped", Value::Null);
    let said = refused(tell("release", "observer"));
    assert!(
        said.contains("the keys of observer do not allow this"),
        "{said}"
    );
    printed_by(tell("release", "operator"));
    sim.wait_for_event("released", Value::Null);
    sim.stop();
    drop(agents);
}
