//! Overrides of a game's files: the sea, and the strategies of teams.

use primitives::id::VehicleId;
use scenario::{Overrides, Scenario, Setting, load, load_with};
use std::path::{Path, PathBuf};

/// A strategy file without references.
const LIES_STILL: &str = "unsafe_i_know = true\nunsafe_because = \"it lies still\"\n[behaviour.stop]\nkind = \"full_stop\"\n";

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(file)
}

fn instead(strategies: &[(&str, PathBuf)]) -> Overrides {
    let strategies = strategies.iter();
    let strategies = strategies.map(|(team, path)| ((*team).to_owned(), path.clone()));
    Overrides {
        strategies: strategies.collect(),
        ..Overrides::default()
    }
}

/// The strategies that the boats follow, in order.
fn followed(scenario: &Scenario) -> Vec<&str> {
    (0..scenario.vehicles.len())
        .map(|i| scenario.strategy_of(VehicleId::at(i)).name.as_str())
        .collect()
}

#[test]
fn all_boats_of_a_team_follow_the_strategy_it_is_given_and_nobody_else_does() {
    let dir = tempfile::tempdir().unwrap();
    let game = dir.path().join("game.toml");
    let own = shipped("strategies/pav01_seeded.toml");
    let own = own.canonicalize().unwrap();
    let base = shipped("games/pav01_vs_pav01.toml").canonicalize().unwrap();
    let boats = ["blue_one", "blue_two", "red_one", "red_two"].map(|name| {
        let (team, _) = name.split_once('_').unwrap();
        let own = if name.ends_with("two") {
            format!("strategy = {own:?}\n")
        } else {
            String::new()
        };
        format!("[[vehicle]]\nname = {name:?}\nteam = {team:?}\n{own}")
    });
    std::fs::write(&game, format!("base = {base:?}\n{}", boats.concat())).unwrap();
    assert_eq!(
        followed(&load(&game).unwrap()),
        ["pav01", "pav01_seeded", "pav01", "pav01_seeded"]
    );

    let attack = shipped("strategies/easy_attackers.toml");
    for (overrides, want) in [
        (
            instead(&[("blue", attack.clone())]),
            ["easy_attackers", "easy_attackers", "pav01", "pav01_seeded"],
        ),
        (
            instead(&[
                ("red", attack.clone()),
                ("blue", shipped("strategies/idle.toml")),
            ]),
            ["idle", "idle", "easy_attackers", "easy_attackers"],
        ),
    ] {
        let scenario = load_with(&game, &overrides).unwrap();
        assert_eq!(followed(&scenario), want);
        assert_eq!(load(&game).unwrap().sea, scenario.sea);
    }
}

#[test]
fn two_files_of_one_name_may_meet_and_what_is_replaced_is_not_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("pav01.toml");
    std::fs::write(&path, LIES_STILL).unwrap();
    let game = shipped("games/pav01_vs_pav01.toml");
    let scenario = load_with(&game, &instead(&[("blue", path.clone())])).unwrap();
    assert_eq!(followed(&scenario), ["pav01"; 4]);
    assert_ne!(scenario.vehicles[0].strategy, scenario.vehicles[2].strategy);

    let text = std::fs::read_to_string(&game).unwrap();
    let folder = shipped("").canonicalize().unwrap().display().to_string();
    let broken = dir.path().join("broken.toml");
    std::fs::write(
        &broken,
        text.replace("pav01.toml", "nonesuch.toml")
            .replace("\"..", &format!("\"{folder}")),
    )
    .unwrap();
    assert!(load(&broken).is_err());
    let both = instead(&[("blue", path.clone()), ("red", path)]);
    assert_eq!(followed(&load_with(&broken, &both).unwrap()), ["pav01"; 4]);
}

#[test]
fn a_game_drawn_again_keeps_what_took_the_place_of_its_own() {
    let dir = tempfile::tempdir().unwrap();
    let game = dir.path().join("game.toml");
    let strategy = dir.path().join("own.toml");
    let base = shipped("games/pav01_vs_pav01.toml").canonicalize().unwrap();
    std::fs::write(
        &game,
        format!("base = {base:?}\nlink = {{ delay_s = {{ uniform = [0.1, 0.2] }} }}\n"),
    )
    .unwrap();
    std::fs::write(&strategy, LIES_STILL).unwrap();
    let overrides = Overrides {
        sea: Some(shipped("seas/gale.toml")),
        ..instead(&[("red", strategy)])
    };
    let scenario = load_with(&game, &overrides).unwrap();
    // The files are no longer needed.
    drop(dir);
    let other = scenario.of_seed(7).unwrap();
    assert_ne!(other.drawn, scenario.drawn);
    assert_eq!(followed(&other), ["pav01", "pav01", "own", "own"]);
    assert_eq!(
        (&other.sea, other.sea.name.as_str()),
        (&scenario.sea, "gale")
    );
}

#[test]
fn in_a_rehearsal_every_boat_is_simulated_also_when_the_game_is_drawn_again() {
    let mixed = shipped("games/mixed_2v2.toml").canonicalize().unwrap();
    let scenario = load(&mixed).unwrap();
    let real: Vec<VehicleId> = scenario.externals().collect();
    assert_eq!(real, [VehicleId(0), VehicleId(2)]);
    let said = scenario.has_no_real_boats().unwrap_err().to_string();
    for part in ["blue_one, red_one", "--pace realtime", "--rehearse"] {
        assert!(said.contains(part), "{said}");
    }
    let dir = tempfile::tempdir().unwrap();
    let drawn = dir.path().join("drawn.toml");
    std::fs::write(
        &drawn,
        format!("base = {mixed:?}\nlink = {{ delay_s = {{ uniform = [0.1, 0.2] }} }}\n"),
    )
    .unwrap();
    let rehearsal = Overrides {
        simulate_all: true,
        ..Overrides::default()
    };
    for game in [mixed, drawn] {
        let scenario = load_with(&game, &rehearsal).unwrap();
        assert_eq!(scenario.has_no_real_boats(), Ok(()));
        assert_eq!(scenario.of_seed(9).unwrap().externals().count(), 0);
    }
}

#[test]
fn an_unknown_team_and_a_file_that_is_not_there_are_explained() {
    let game = shipped("games/pav01_vs_pav01.toml");
    let idle = shipped("strategies/idle.toml");
    for (overrides, want) in [
        (
            instead(&[("green", idle)]),
            "unknown team \"green\", expected one of blue, red",
        ),
        (
            instead(&[("red", "none.toml".into())]),
            "none.toml:1:1: cannot read this file: no such file",
        ),
        (
            Overrides {
                sea: Some("none.toml".into()),
                ..Overrides::default()
            },
            "none.toml:1:1: cannot read this file: no such file",
        ),
        (
            instead(&[("red", shipped("seas/gale.toml"))]),
            "wind is unknown, expected one of",
        ),
    ] {
        let problems = load_with(&game, &overrides).unwrap_err().to_string();
        assert!(problems.contains(want), "{want}\n{problems}");
    }
}

#[test]
fn teams_that_exchange_their_strategies_follow_each_others() {
    let game = shipped("games/strategy_4_vs_3.toml");
    let exchanged = |game: &Path, overrides: Overrides| {
        let overrides = Overrides {
            exchange_strategies: true,
            ..overrides
        };
        load_with(game, &overrides)
    };
    let [three, four] = [["strategy_3"; 2], ["strategy_4"; 2]];
    assert_eq!(followed(&load(&game).unwrap()), [four, three].concat());
    let there = exchanged(&game, Overrides::default()).unwrap();
    assert_eq!(followed(&there), [three, four].concat());
    // Strategies are exchanged in games with other seeds too, including those that override one
    // team's strategy.
    assert_eq!(followed(&there.of_seed(9).unwrap()), followed(&there));
    let idle = instead(&[("blue", shipped("strategies/idle.toml"))]);
    let idle = exchanged(&game, idle).unwrap();
    assert_eq!(followed(&idle), [three, ["idle"; 2]].concat());
    let refused = exchanged(&shipped("games/person_2v2.toml"), Overrides::default());
    let refused = refused.unwrap_err().to_string();
    let want = "strategy is teleop, expected none here because the teams exchange strategies";
    assert!(refused.contains(want), "{refused}");
}

/// Overrides of single values.
fn settings(texts: &[&str]) -> Overrides {
    let settings = texts.iter().map(|text| Setting::parse(text));
    Overrides {
        settings: settings.collect::<Result<_, _>>().expect("settings"),
        ..Overrides::default()
    }
}

#[test]
fn a_single_value_takes_the_place_of_what_a_file_of_its_kind_says() {
    let game = shipped("games/surveyor_2v2.toml");
    let own = load(&game).unwrap();
    let set = settings(&[
        "sea.depth_m=4.5",
        "rules.tag_radius_m=12.5",
        "link.delay_s=0.5",
        "boat.gps.noise_m=0.25",
    ]);
    let other = load_with(&game, &set).unwrap();
    let numbers = [&other, &own].map(|game| (game.sea.depth_m, game.rules.tag_radius_m));
    assert_eq!(numbers, [(Some(4.5), 12.5), (Some(10.0), 10.0)]);
    assert_eq!(other.link.as_ref().unwrap().delay_s, 0.5);
    let mut receivers = other.boats.iter().map(|boat| boat.sensors.gps.as_ref());
    assert!(receivers.all(|gps| gps.unwrap().noise_m == 0.25));
    // Other values are unchanged, and a game drawn again keeps the setting.
    assert_eq!(other.sea.wind, own.sea.wind);
    assert_eq!(other.of_seed(9).unwrap().rules.tag_radius_m, 12.5);
    // If a key is set several times, the last setting counts. A game without a sea file has a
    // default sea at rest.
    let calm = shipped("games/pav01_vs_pav01.toml");
    let wind = ["from_deg=90", "speed_m_s=3", "speed_m_s=4"];
    let wind = wind.map(|value| format!("sea.wind.{value}"));
    let windy = load_with(&calm, &settings(&wind.each_ref().map(String::as_str))).unwrap();
    assert_eq!(windy.sea.wind.as_ref().unwrap().speed_10m_m_s, 4.0);
    assert_eq!(
        (windy.sea.water_density_kg_m3, windy.sea.waves.is_none()),
        (1000.0, true)
    );
    // A distribution is drawn as if it were in the file.
    let set = settings(&["boat.gps.noise_m={ uniform = [0.5, 0.75] }"]);
    let drawn = load_with(&game, &set).unwrap().drawn;
    let of_receivers = drawn
        .iter()
        .filter(|one| one.parameter.ends_with("gps.noise_m"));
    let fitting = of_receivers.filter(|one| (0.5..=0.75).contains(&one.value));
    assert_eq!(fitting.count(), 4, "{drawn:?}");
}

#[test]
fn a_single_value_is_checked_as_if_it_stood_in_the_file() {
    let game = shipped("games/surveyor_2v2.toml");
    for (text, want) in [
        (
            "sea.waves.hs_m=99",
            "--set sea.waves.hs_m:1:14: hs_m is 99, expected",
        ),
        ("rules.tag_radius=3", "tag_radius is unknown"),
        (
            "boat.gps.noise_m=often",
            "--set boat.gps.noise_m:1:15: noise_m is the string \"often\"",
        ),
        ("game.field=nonesuch.toml", "nonesuch.toml: no such file"),
        (
            "rules.time_limit_s=9",
            "duration_s of the game overrides rules.time_limit_s",
        ),
    ] {
        let said = load_with(&game, &settings(&[text]))
            .unwrap_err()
            .to_string();
        assert!(said.contains(want), "{text}: {said}");
    }
}

#[test]
fn a_value_of_a_strategy_changes_that_of_its_team_alone() {
    let game = shipped("games/surveyor_2v2.toml");
    let both = ["blue", "red"].map(|team| (team.to_owned(), shipped("strategies/strategy_4.toml")));
    let with = |texts: &[&str]| {
        let overrides = Overrides {
            strategies: both.clone().into(),
            ..settings(texts)
        };
        load_with(&game, &overrides).map_err(|e| e.to_string())
    };
    let weight = |scenario: &Scenario, vehicle: usize| {
        let strategy = &scenario.strategies[scenario.vehicles[vehicle].strategy];
        let mut behaviours = strategy.roles[0].behaviours.iter();
        let pursue = behaviours.find(|behaviour| behaviour.name == "pursue");
        format!("{:?}", pursue.expect("strategy 4 pursues").weight)
    };
    let own = with(&[]).unwrap();
    let changed = with(&["strategy.red.behaviour.pursue.weight=37"]).unwrap();
    assert_eq!(
        (own.strategies.len(), changed.strategies.len()),
        (1, 2),
        "boats of a team share its strategy"
    );
    let weights =
        |scenario: &Scenario| [0, 1, 2, 3].map(|vehicle| weight(scenario, vehicle).contains("37"));
    assert_eq!(
        (weights(&own), weights(&changed)),
        ([false; 4], [false, false, true, true])
    );
    for (text, want) in [
        (
            "strategy.red.behaviour.pursue.weight=-1",
            "--set strategy.red.behaviour.pursue.weight:1:27: weight is -1, expected",
        ),
        ("strategy.red.behaviour.pursue.wait=1", "wait is unknown"),
        (
            "strategy.green.behaviour.pursue.weight=1",
            "unknown team, expected one of blue, red after strategy",
        ),
    ] {
        let said = with(&[text]).unwrap_err();
        assert!(said.contains(want), "{text}: {said}");
    }
}
