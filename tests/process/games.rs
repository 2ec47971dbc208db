//! Whole games: the same bytes in one process and across processes.

use crate::support::{
    FOUR, Process, Sim, agent, all_output, assert_a_game_each, free_endpoint, game_itself, own,
    printed, refused, result_of, squall, stdout, temporary, wait_until,
};
use messages::Control;
use serde_json::{Value, json};
use std::net::TcpListener;
use std::os::unix::fs::DirBuilderExt;
use std::path::Path;
use std::process::Command;

#[test]
fn a_lockstep_game_over_the_network_is_the_game_in_one_process_byte_for_byte() {
    assert_a_game_each(&own("seeded_3v3"), &["1", "2", "3", "4", "5"]);
}

#[test]
fn a_rough_game_with_lossy_links_is_the_same_over_the_network_too() {
    let game = own("rough");
    let bay = "scenarios/seas/bay_fresh_breeze.toml";
    let mut digests = Vec::new();
    for (seed, sea) in [("1", &[][..]), ("2", &[]), ("1", &["--sea", bay])] {
        let words = [&[game.as_str(), "--seed", seed], sea].concat();
        let here = game_itself(result_of(&[words.as_slice(), &["--in-process"]].concat()));
        let there = game_itself(result_of(
            &[words.as_slice(), &["--agents-per-process", "2"]].concat(),
        ));
        assert_eq!(here, there, "seed {seed} {sea:?}");
        let mass_kg = here["drawn"]["blue_one/hull.mass_kg"]
            .as_f64()
            .expect("the mass was drawn");
        assert!((0.9 * 52.3..1.1 * 52.3).contains(&mass_kg));
        digests.push(here["digest"].clone());
    }
    digests.dedup();
    assert_eq!(digests.len(), 3, "each is a different game");
}

#[test]
fn pictures_of_a_thousand_boats_reach_the_agents() {
    let game = own("six_hundred_a_side");
    let here = game_itself(result_of(&[&game, "--in-process"]));
    let output = all_output(squall(&[
        "run",
        &game,
        "--no-record",
        "--agents-per-process",
        "300",
    ]));
    let digest = here["digest"].as_str().expect("a digest");
    assert!(output.contains(digest), "{digest}, but {output}");
    // Agents that miss the end of the game are killed.
    assert!(!output.contains("killed"), "{output}");
}

#[test]
fn a_game_that_was_reset_is_the_game_of_that_seed() {
    // Its boats and sea are drawn with the seed, too.
    let game = own("rough");
    let here = result_of(&[&game, "--seed", "2", "--in-process"]);
    let (sim, _agents) = Sim::start_with_agents("rough", &["--seed", "1", "--speed", "20"]);
    sim.play_on(5.0);
    bus::control(&sim.bus(), &sim.name(), Control::Reset(2)).expect("it can be reset");
    let report = sim.wait_for_kind("done");
    assert_eq!(report["outcome"]["digest"], here["digest"]);
    assert_eq!(report["outcome"]["drawn"], here["drawn"]);
}

#[test]
fn a_game_with_a_recording_or_real_boats_is_not_reset() {
    let folder = temporary();
    let file = folder.path().join("game.mcap").display().to_string();
    for (game, args) in [
        ("long", ["--record", file.as_str()]),
        ("real_attacker", ["--pace", "realtime"]),
    ] {
        let sim = Sim::start(game, &args);
        let refused = bus::control(&sim.bus(), &sim.name(), Control::Reset(2));
        let reason = refused.expect_err("it goes on").to_string();
        assert!(reason.contains("cannot be reset"), "{game}: {reason}");
    }
}

#[test]
fn the_first_game_of_the_readme_runs_to_its_end() {
    let result = result_of(&["scenarios/games/pav01_vs_pav01.toml"]);
    assert_eq!(
        (&result["duration_s"], &result["ticks"]),
        (&600.0.into(), &12000.into())
    );
    assert_eq!(result["digest"].as_str().map(str::len), Some(32));
    assert!(
        result["score"]["teams"]["blue"].is_u64()
            && result["counts"]["boats"]["blue_one"]["tags"].is_u64()
    );
    let events = result["events"].as_array().expect("a list");
    assert_eq!(
        events.last().map(|event| &event["event"]),
        Some(&Value::from("ended"))
    );
    assert!(
        events
            .iter()
            .all(|event| event["tick"].is_u64() && event["at_s"].is_f64())
    );
    // Mirrored teams give mirrored results.
    assert_eq!(
        result["counts"]["teams"]["blue"],
        result["counts"]["teams"]["red"]
    );
    assert!(
        result["counts"]["teams"]["blue"]["grabs"].as_u64() > Some(0),
        "a boat reached a flag"
    );
}

#[test]
fn two_runs_at_once_do_not_see_each_other() {
    let alone = game_itself(result_of(&[
        "scenarios/games/pav01_popolopen.toml",
        "--in-process",
    ]));
    let both: Vec<_> = (0..2)
        .map(|_| {
            std::thread::spawn(|| game_itself(result_of(&["scenarios/games/pav01_popolopen.toml"])))
        })
        .collect();
    for one in both {
        assert_eq!(one.join().expect("it runs"), alone);
    }
}

#[test]
fn a_paced_game_keeps_its_pace() {
    let result = result_of(&[&own("pav01_20s"), "--pace", "4x"]);
    let wall_s = result["run"]["wall_s"].as_f64().expect("a number");
    // The clock may be late on a busy machine, but never early.
    assert!(wall_s > 20.0 / 4.0 * 0.98, "{wall_s}");
    assert_eq!(result["run"]["pace"], "4x");
    assert_eq!(result["ticks"], 400);
}

#[test]
fn agents_may_come_before_the_sim_and_in_any_order() {
    let endpoint = free_endpoint();
    let mut agents: Vec<Process> = FOUR
        .iter()
        .rev()
        .map(|name| agent(&endpoint, "early", &[name]))
        .collect();
    std::thread::sleep(std::time::Duration::from_millis(500));
    let sim = Sim::start_with(
        squall(&[]),
        "long",
        &["--game", "early", "--listen", &endpoint],
    );
    sim.wait_for_kind("started");
    sim.play_on(5.0);
    let done = sim.stop();
    assert!(
        done["outcome"]["events"]
            .as_array()
            .expect("a list")
            .iter()
            .all(|e| e["event"] != "agent_lost"),
        "{done}"
    );
    for agent in &mut agents {
        assert!(
            agent.wait().success(),
            "an agent leaves without an error when the game ends"
        );
    }
}

#[test]
fn a_mind_may_join_late() {
    let sim = Sim::start("long", &["--join-s", "1"]);
    let _three = sim.agent(&FOUR[..3]);
    sim.wait_for_event("agent_lost", "red_two");
    let _late = sim.agent(&FOUR[3..]);
    sim.wait_for_event("agent_back", "red_two");
    sim.play_on(5.0);
    sim.stop();
}

#[test]
fn a_run_that_is_ended_early_leaves_nothing_behind() {
    for signal in ["INT", "TERM", "KILL"] {
        let mut run = Process::quiet(squall(&[
            "run",
            &own("long"),
            "--pace",
            "realtime",
            "--no-record",
        ]));
        let mut family = Vec::new();
        wait_until("sim and agents start", || {
            family = children_of(run.0.id());
            family.len() >= 5
        });
        run.signal(signal);
        let status = run.wait();
        assert!(
            !status.success(),
            "{signal}: a game that was cut short is not a success"
        );
        let is_there = |pid: &u32| Path::new(&format!("/proc/{pid}/exe")).exists();
        wait_until(&format!("after {signal} all of {family:?} end"), || {
            !family.iter().any(is_there)
        });
    }
}

/// The child processes of a process.
fn children_of(pid: u32) -> Vec<u32> {
    let output = Command::new("ps")
        .args(["-o", "pid=", "--ppid", &pid.to_string()])
        .output()
        .expect("ps is there");
    stdout(&output)
        .split_whitespace()
        .filter_map(|pid| pid.parse().ok())
        .collect()
}

#[test]
fn games_on_this_machine_are_listed_and_can_be_watched() {
    let sim = Sim::start("long", &[]);
    let _agents = sim.agent(&FOUR);
    sim.play_on(1.0);
    let list = printed(&["list"]);
    assert!(
        list.contains(&sim.game) && list.contains("  playing at ") && list.contains("4 boats"),
        "{list}"
    );
    let (mut watch, mut lines) =
        Process::with_lines(squall(&["watch", "--game", &sim.game, "--rate", "20"]));
    for _ in 0..3 {
        let line = lines.next().expect("it continues");
        assert!(line.contains("blue") && line.contains("frames/s"), "{line}");
    }
    sim.stop();
    assert!(watch.wait().success(), "watching ends with the game");
}

#[test]
fn a_game_is_not_registered_in_a_folder_that_another_user_could_have_linked() {
    let dir = temporary();
    let elsewhere = dir.path().join("elsewhere");
    std::fs::DirBuilder::new()
        .mode(0o700)
        .create(&elsewhere)
        .expect("a folder");
    std::os::unix::fs::symlink(&elsewhere, dir.path().join("squall")).expect("a link");
    let mut sim = squall(&["sim", "scenarios/games/attack_1v1.toml", "--join-s", "0"]);
    sim.env("XDG_RUNTIME_DIR", dir.path());
    let said = all_output(sim);
    assert!(
        said.contains("can be found only by its address") && said.contains("squall is a link"),
        "{said}"
    );
    assert_eq!(
        std::fs::read_dir(&elsewhere).expect("it is there").count(),
        0
    );
}

#[test]
fn a_release_of_all_boats_while_two_games_run_is_refused_and_reaches_no_boat() {
    let dir = temporary();
    let registry = dir.path().join("squall");
    std::fs::DirBuilder::new()
        .mode(0o700)
        .create(&registry)
        .expect("a folder");
    let port = TcpListener::bind("127.0.0.1:0").expect("a port");
    port.set_nonblocking(true).expect("a socket");
    let control = port.local_addr().expect("it is bound");
    for (boat, game) in [("blue_one", "morning"), ("red_one", "evening")] {
        let entry =
            json!({ "vehicle": boat, "game": game, "control": control, "pid": std::process::id() });
        std::fs::write(registry.join(format!("{boat}.gateway")), entry.to_string())
            .expect("it is written");
    }
    let mut tell = squall(&["gateway", "tell", "all", "release"]);
    tell.env("XDG_RUNTIME_DIR", dir.path());
    let said = refused(tell);
    assert!(
        said.contains("select one with --game: evening, morning"),
        "{said}"
    );
    assert!(port.accept().is_err(), "a gateway was told");
}

#[test]
fn a_token_that_is_none_is_refused_before_the_game() {
    let mut run = squall(&["run", "scenarios/games/attack_1v1.toml", "--no-record"]);
    run.env(bus::token::TOKEN_VARIABLE, "abc");
    let said = refused(run);
    assert!(
        said.contains("SQUALL_TOKEN: not a token (3 characters)"),
        "{said}"
    );
}
