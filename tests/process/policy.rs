//! Policies outside of the helm: another program proposes, the helm weighs it against keeping inside of the field.

use crate::support::{LIMIT, Process, Sim, scenarios, squall, write};
use bus::{Bus, Delivery, Standing};
use game::message::{Frame, Message, Notice, PolicyProposal, Stamp};
use game::topic::{self, GameName};
use game::{Picture, TeamId, VehicleId, codec};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::{Arc, Mutex};

const ME: VehicleId = VehicleId(0);
const LIMIT_S: f64 = 100.0;

/// Two boats that lie still, and a strategy for one that lets a policy steer.
fn game(dir: &Path) -> (PathBuf, PathBuf) {
    let root = scenarios();
    let strategy = format!(
        "base = \"{root}/strategies/safety.toml\"\nabout = \"does what it is told\"\n\
         [behaviour.told]\nkind = \"policy\"\nttl_s = 2\n"
    );
    let boat = |name: &str| {
        format!(
            "[[team]]\nname = \"{name}\"\nstrategy = \"{root}/strategies/idle.toml\"\n\
             [[fleet]]\nteam = \"{name}\"\nname = \"{name}_{{}}\"\ncount = 1\nspawn = {{}}\n"
        )
    };
    let game = format!(
        "field = \"{root}/fields/popolopen_2025.toml\"\nrules = \"{root}/rules/aquaticus_2023.toml\"\n\
         boat = \"{root}/boats/surveyor_m1_8.toml\"\nduration_s = {LIMIT_S}\n{}{}",
        boat("blue"),
        boat("red")
    );
    (write(dir, "told_game.toml", &game), write(dir, "told.toml", &strategy))
}

/// A policy as another program would be: it sees the picture and wants to drive north, whatever happens.
fn drive_north(bus: &Bus, name: &GameName, notice: &Notice) -> Standing {
    let publisher = bus.publisher(topic::policy(name, &notice.scenario, ME), Delivery::Wait).expect("the hub is there");
    let answer = move |bytes: &[u8]| {
        let picture: Picture = codec::decode(bytes).expect("a picture");
        let stamp = Stamp { version: PolicyProposal::VERSION, ..picture.stamp };
        let proposal = PolicyProposal { stamp, vehicle: ME, course_rad: 0.0, speed_m_s: 2.0 };
        // Nonsense in between does no harm.
        publisher.send(&PolicyProposal { course_rad: f64::NAN, ..proposal }).unwrap_or_default();
        publisher.send(&PolicyProposal { vehicle: VehicleId(1), course_rad: 3.0, ..proposal }).unwrap_or_default();
        publisher.send(&proposal).unwrap_or_default();
    };
    bus.subscribe(topic::picture(name, &notice.scenario, TeamId(0)), answer).expect("the hub is there")
}

/// Plays a game with the policy, or without one: what happened, and the frames that were seen of it.
fn play(has_policy: bool) -> (serde_json::Value, Vec<Frame>) {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let (game, strategy) = game(dir.path());
    let sim = Sim::start(&game, &[]);
    let (bus, name) = (sim.bus(), GameName::new(&sim.game).expect("a name"));
    let notice = bus.ask(&topic::scenario(&name), Vec::new(), LIMIT).expect("the hub is there").expect("an answer");
    let notice: Notice = serde_json::from_slice(&notice).expect("a notice");
    let frames = Arc::new(Mutex::new(Vec::new()));
    let film = Arc::clone(&frames);
    let see = move |bytes: &[u8]| film.lock().expect("whole").push(codec::decode(bytes).expect("a frame"));
    let _seen = bus.subscribe(topic::frame(&name), see).expect("the hub is there");
    let _policy = has_policy.then(|| drive_north(&bus, &name, &notice));
    let strategy = strategy.display().to_string();
    let mut words = vec!["agent", "--connect", &sim.endpoint, "--game", &sim.game, "--vehicle", "blue_1"];
    words.extend(["--strategy", &strategy]);
    if has_policy {
        words.extend(["--policy-wait-s", "2"]);
    }
    let mut command = squall(&words);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let _told = Process::start(command);
    let _still = sim.agent(&["red_1"]);
    let done = sim.wait_for(|telling| telling["tell"] == "done");
    let frames = frames.lock().expect("whole").clone();
    (done["outcome"].clone(), frames)
}

#[test]
fn a_boat_follows_a_policy_but_not_out_of_the_field_and_the_game_is_the_same_again() {
    let (outcome, frames) = play(true);
    let (again, _) = play(true);
    assert_eq!(outcome["digest"], again["digest"], "a policy that is waited for makes no difference");
    assert!(frames.len() > 500, "{} frames", frames.len());
    let navs: Vec<_> = frames.iter().map(|frame| &frame.vehicles[ME.index()].nav).collect();
    let north_m = navs.iter().map(|nav| nav.north_m).fold(f64::NEG_INFINITY, f64::max) - navs[0].north_m;
    assert!(north_m > 20.0, "it went {north_m} m north");
    let early = navs[navs.len() / 20];
    assert!(early.psi_rad.abs() < 0.3 || early.surge_m_s > 0.5, "it turned north: {early:?}");
    assert!(frames.iter().all(|frame| !frame.vehicles[ME.index()].outside), "it stayed inside");
    assert_eq!(outcome["counts"]["boats"]["blue_1"]["minds_lost"], 0);
    // At the boundary the boat still runs, and the helm turns it away: 100 s at 2 m/s would be 200 m.
    assert!(north_m < 0.9 * 2.0 * LIMIT_S, "{north_m}");
}

#[test]
fn without_a_policy_the_boat_lies_still() {
    let (_, frames) = play(false);
    let at = |frame: &Frame| frame.vehicles[ME.index()].nav.at();
    let (first, last) = (frames.first().expect("frames"), frames.last().expect("frames"));
    assert!(at(first).distance(at(last)) < 1.0);
}
