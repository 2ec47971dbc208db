//! Helm queries during a game, and a boat that gets a new strategy.

use crate::support::{FOUR, Process, Sim, helm, own, printed, squall, temporary};
use primitives::VehicleId;

/// A running game with an agent for each boat.
fn game() -> (Sim, Vec<Process>) {
    let (sim, agents) = Sim::start_with_agents("long", &[]);
    sim.play_on(1.0);
    (sim, agents)
}

#[test]
fn a_helm_says_what_it_thinks_and_its_functions_if_they_are_asked_for() {
    let (sim, _agents) = game();
    let (bus, name, scenario) = sim.session();
    let ask = |question: &[u8]| helm(&bus, (&name, &scenario), "blue_two", question);
    for (question, whole) in [
        (&b"{\"functions\":true}"[..], true),
        (b"", false),
        (b"ahoy", false),
    ] {
        let report = ask(question);
        assert_eq!(
            (report.vehicle, report.program.as_str()),
            (VehicleId(1), "easy_attacker")
        );
        assert!(
            !report.mode.is_empty() && !report.functions.is_empty(),
            "{report:?}"
        );
        let length = if whole {
            report.courses * report.speeds
        } else {
            0
        };
        assert!(
            report
                .functions
                .iter()
                .all(|function| function.utilities.len() == length)
        );
        if report.course_deg.is_some() {
            assert!(
                report
                    .functions
                    .iter()
                    .all(|function| function.utility.is_some()),
                "asked for or not"
            );
        }
    }
    // Time advances from answer to answer.
    let before = ask(b"").at;
    sim.play_on(1.0);
    assert!(ask(b"").at > before);
    let said = sim.refusal_of(&["helm", "--vehicle", "green_one"]);
    assert!(
        said.contains("blue_one, blue_two, red_one, red_two"),
        "{said}"
    );
    sim.stop();
}

#[test]
fn watch_shows_a_helm_and_helm_writes_its_functions() {
    let (sim, _agents) = game();
    let dir = temporary();
    let watch = sim.squall(&["watch", "--helm", "blue_two", "--rate", "20"]);
    let (mut watch, mut lines) = Process::with_lines(watch);
    for line in lines.by_ref().take(3) {
        let is_mode = |mode: &&str| line.contains(&format!("blue_two  {mode}  course"));
        assert!(
            ["attacking", "returning", "tagged"].iter().any(is_mode),
            "{line}"
        );
    }
    let file = dir.path().join("one.csv").display().to_string();
    let page = sim.printed(&["helm", "--vehicle", "blue_two", "--csv", &file]);
    assert!(
        page.contains("follows easy_attacker")
            && page.contains("waypoint")
            && page.contains("op_region"),
        "{page}"
    );
    let csv = std::fs::read_to_string(&file).expect("it was written");
    assert!(csv.starts_with("behaviour,contact,weight,course_deg,speed_m_s,utility\n"));
    let collective = csv
        .lines()
        .filter(|line| line.starts_with("collective,"))
        .count();
    assert_eq!(collective, 360 * 36, "a row for each course and speed");
    sim.stop();
    // The watch ends with the game.
    lines.for_each(drop);
    assert!(watch.wait().success());
}

#[test]
fn a_game_goes_on_while_somebody_takes_a_decision_apart() {
    let dir = temporary();
    let game = squall(&["run", &own("long"), "--pace", "1x", "--no-record"]);
    let (game, mut lines) = Process::with_lines(game);
    let open = lines.next().expect("where it is");
    let words: Vec<&str> = open.split_whitespace().collect();
    let ["game", name, "at", endpoint] = words[..] else {
        panic!("{open}")
    };
    lines
        .by_ref()
        .find(|line| line.contains("every boat has an agent"))
        .expect("it starts");
    let csv = dir.path().join("one.csv").display().to_string();
    // All at once: half a megabyte from each passes through the hub.
    std::thread::scope(|scope| {
        for vehicle in FOUR {
            let args = [
                "helm",
                "--connect",
                endpoint,
                "--game",
                name,
                "--vehicle",
                vehicle,
                "--csv",
            ];
            let csv = format!("{csv}.{vehicle}");
            scope.spawn(move || printed(&[&args[..], &[csv.as_str()]].concat()));
        }
    });
    game.signal("INT");
    let lost: Vec<String> = lines.filter(|line| line.contains("LOST")).collect();
    assert_eq!(lost, [""; 0]);
}

#[test]
fn an_agent_plays_by_a_strategy_file_of_its_own() {
    let mine = own("mine");
    let sim = Sim::start("long", &[]);
    let _ours = sim.quiet(&[
        "agent",
        "--vehicle",
        "blue_one",
        "blue_two",
        "--strategy",
        &mine,
    ]);
    let _theirs = sim.quiet(&["agent", "--vehicle", "red_one", "red_two"]);
    sim.wait_for_kind("started");
    for (vehicle, program) in [
        ("blue_one", "mine"),
        ("blue_two", "mine"),
        ("red_two", "easy_attacker"),
    ] {
        let page = sim.printed(&["helm", "--vehicle", vehicle]);
        assert!(page.contains(&format!("follows {program}")), "{page}");
    }
    sim.stop();
}
