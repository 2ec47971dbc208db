//! Strategy files as programs: programs match their files, and reachable modes are accepted.

#![expect(clippy::unwrap_used, reason = "a test that cannot continue has failed")]

use primitives::Ned;
use scenario::strategy::{
    Assignment, Boat, Contacts, Ellipse, Moment, Place, Program, Shape, Strategy, Task, Trigger,
    Turn, What, Who,
};
use scenario::{Kind, Problems, strategy};
use serde_json::Value;
use std::time::Duration;

const SAFE: &str = "[behaviour.stay_in]\nkind = \"op_region\"\n[behaviour.keep_clear]\nkind = \"avoid_collision\"\n";

/// The strategy of `x.toml`, with the other files in the same folder.
fn strategy_of(text: &str, others: &[(&str, &str)]) -> Result<Strategy, Problems> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in others
        .iter()
        .chain([&("x.toml", text), &("safe.toml", SAFE)])
    {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    scenario::load_file(&folder.path().join("x.toml"))
}

fn program(text: &str) -> Program {
    let strategy = strategy_of(text, &[]).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(strategy.roles.len(), 1);
    strategy.roles.into_iter().next().unwrap()
}

fn behaviour<'a>(program: &'a Program, name: &str) -> &'a strategy::Behaviour {
    let mut behaviours = program.behaviours.iter();
    behaviours.find(|one| one.name == name).unwrap()
}

const FULL: &str = r#"
base = "safe.toml"
about = "all there is"
helm = { courses = 72, hysteresis = 0.1 }

[variables]
laps = 2
phase = { values = ["go", "return"], initial = "return", shared = true }

[[mode]]
name = "tagged"
when = "tagged"
[[mode]]
name = "defending"
when = "phase == 'return'"
set = { phase = "go", laps = "laps + 1" }
[[mode]]
name = "intercepting"
in = "defending"
when = "enemy_in_zone"
[[mode]]
name = "loitering"
in = "defending"
[[mode]]
name = "attacking"

[[rule]]
on = "enemy grabs"
set = { phase = "return" }

[behaviour.keep_clear]
outer_m = 20

[behaviour.go]
kind = "waypoint"
in = ["defending"]
when = "laps > 1"
weight = "50 + laps"
points = ["CF", "own_flag", [3, 4], "opponent"]
perpetual = true
duration_s = 30
on_reach = { laps = "laps + 1" }
on_complete = { laps = 0 }

[behaviour.round]
kind = "loiter"
in = ["loitering"]
ellipse = { centre = "CH", along_m = 15, across_m = 50 }
turn = "clockwise"
"#;

#[test]
fn a_program_says_what_its_file_says() {
    let program = program(FULL);
    assert_eq!(
        (program.name.as_str(), program.about.as_str()),
        ("x", "all there is")
    );
    let helm = &program.helm;
    let numbers = (helm.courses, helm.speeds, helm.speed_max_m_s);
    assert_eq!(numbers, (72, 36, None));
    let variables = program.variables.iter();
    let initial = variables.map(|v| (v.name.as_str(), v.initial, v.shared));
    let want = [("laps", 2.0, false), ("phase", 1.0, true)];
    assert_eq!(initial.collect::<Vec<_>>(), want);
    let paths: Vec<String> = (0..5).map(|mode| program.path(mode)).collect();
    assert_eq!(
        paths.join(" "),
        "tagged defending defending:intercepting defending:loitering attacking"
    );
    assert_eq!(program.modes.len(), 5);
    assert_eq!(program.leaves().collect::<Vec<_>>(), [0, 2, 3, 4]);
    let set = program.modes[1].enter.iter();
    let set = set.map(|(v, value)| (*v, program.value_text(*v, value)));
    let set: Vec<(u16, String)> = set.collect();
    assert_eq!(set, [(0, "laps + 1".to_owned()), (1, "'go'".to_owned())]);
    let (who, what) = (Who::Enemy, What::Grabs);
    assert_eq!(program.rules[0].on, Some(Trigger { who, what }));
    assert_eq!(program.rules[0].when, None);

    let go = behaviour(&program, "go");
    assert_eq!(go.modes, [false, true, true, true, false]);
    let when = program.condition_text(go.when.as_ref().unwrap());
    assert_eq!(when, "laps > 1");
    assert_eq!(program.number_text(&go.weight.expression), "50 + laps");
    assert_eq!(
        (go.weight.range, go.weight.constant(), go.perpetual),
        ((0.0, 300.0), None, true)
    );
    let moments: Vec<Moment> = go.posts.iter().map(|post| post.at).collect();
    assert_eq!(moments, [Moment::Reach, Moment::Complete]);
    let Task::Waypoint(waypoint) = &go.task else {
        panic!("{go:?}")
    };
    let corner = Place::At(Ned::from_xy(3.0, 4.0));
    let own_flag = Place::by_name("own_flag").unwrap();
    let [first, last] = [Place::Point("CF".into()), Place::Boat(Boat::Opponent)];
    assert_eq!(waypoint.points, [first, own_flag, corner, last]);

    let round = behaviour(&program, "round");
    assert_eq!(round.modes, [false, false, false, true, false]);
    let Task::Loiter(loiter) = &round.task else {
        panic!("{round:?}")
    };
    assert_eq!(loiter.turn, Turn::Clockwise);
    assert!(matches!(
        loiter.shape,
        Shape::Ellipse(Ellipse {
            along_m: 15.0,
            across_m: 50.0,
            corners: 24,
            ..
        })
    ));

    // Values of the base apply unless the file overrides them.
    let keep_clear = behaviour(&program, "keep_clear");
    let Task::AvoidCollision(avoid) = &keep_clear.task else {
        panic!("{keep_clear:?}")
    };
    assert_eq!(avoid.contacts, Contacts::All);
    let weights = [&keep_clear.weight, &round.weight];
    let [outer_m, inner_m] = [&avoid.outer_m, &avoid.inner_m];
    let numbers = [outer_m, inner_m, weights[0], weights[1]].map(|one| one.constant());
    assert_eq!(numbers, [20.0, 9.0, 300.0, 100.0].map(Some));
    assert!(keep_clear.is_guard() && behaviour(&program, "stay_in").is_guard() && !go.is_guard());
}

#[test]
fn a_strategy_deals_the_programs_of_its_roles() {
    let roles = "about = \"two\"\nroles = [\"safe.toml\", \"y.toml\", \"safe.toml\"]\nassignment = \"seeded\"\n";
    let strategy = strategy_of(
        roles,
        &[("y.toml", "base = \"safe.toml\"\nabout = \"the other\"\n")],
    )
    .unwrap();
    let names = strategy.roles.iter().map(|role| role.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["safe", "y", "safe"]);
    assert_eq!(
        (strategy.name.as_str(), strategy.about.as_str()),
        ("x", "two")
    );
    assert_eq!(
        (strategy.assignment, strategy.roles[1].about.as_str()),
        (Assignment::Seeded, "the other")
    );
    // All boats follow a program used as a strategy.
    let alone = strategy_of("base = \"safe.toml\"\nabout = \"alone\"\n", &[]).unwrap();
    assert_eq!(
        (alone.roles.len(), alone.about.as_str(), alone.assignment),
        (1, "alone", Assignment::Fixed)
    );
    assert_eq!(alone.roles[0].modes[0].name, "active");
}

#[test]
fn a_file_that_is_unsafe_keeps_its_reason() {
    let text = "unsafe_i_know = true\nunsafe_because = \"a test\"\n[behaviour.stop]\nkind = \"full_stop\"\n";
    assert_eq!(program(text).unsafe_because.as_deref(), Some("a test"));
    assert_eq!(program("base = \"safe.toml\"\n").unsafe_because, None);
}

/// A program whose first modes have these conditions, and a rule with these assignments.
fn with_modes(conditions: &[&str], set: &str) -> String {
    let variables = "[variables]\nalarmed = false\nlaps = 0\nphase = { values = [\"go\", \"return\"], shared = true }\n";
    let mode =
        |(i, when): (usize, &&str)| format!("[[mode]]\nname = \"m{i}\"\nwhen = \"{when}\"\n");
    let modes: String = conditions.iter().enumerate().map(mode).collect();
    let rule = format!("[[rule]]\nwhen = \"tagged\"\nset = {set}\n");
    format!("base = \"safe.toml\"\n{variables}{modes}[[mode]]\nname = \"last\"\n{rule}")
}

#[test]
fn what_can_be_is_allowed() {
    let once = "{ laps = 1 }";
    let more = "{ laps = \"laps + 1\" }";
    for (conditions, set) in [
        ("tagged == own_side; tagged", once),
        ("enemies < 2; enemies < 3; enemies < 4", once),
        (
            "distance(CF) > 1 && distance(CF) < 2; distance(CF) < 1.5",
            once,
        ),
        // The distance to one place does not determine the distance to a different one.
        ("distance(CF) < 1; distance(CH) < 1", once),
        ("closing(opponent) < 0; closing(opponent) < 1", once),
        // The same two numbers in a different comparison may have any result.
        (
            "score < enemy_score; score > enemy_score; score == enemy_score",
            once,
        ),
        ("laps == 1", once),
        ("laps > 1000", more),
        ("alarmed", "{ alarmed = true }"),
        ("alarmed; !alarmed && tagged", "{ alarmed = \"tagged\" }"),
        ("phase == 'return'", "{ phase = \"return\" }"),
        (
            "enemy_in_zone && enemies_in_zone > 1; enemies_in_zone == 1; tagged",
            once,
        ),
        ("has_flag; enemy_flag_taken; tagged", once),
        (
            "mates(phase == 'go') > 0; mates(phase == 'go') < 1 && mates > 1",
            once,
        ),
        ("time_s < 10; time_s <= 10; time_s == 20; mode_s > 3", once),
        ("rank == 0; rank == 1; rank < 3", once),
        (
            "score * 2 > 3; score * 2 <= 3 && tagged; min(score, laps) > 1",
            more,
        ),
    ] {
        let modes: Vec<&str> = conditions.split("; ").collect();
        let found = strategy_of(&with_modes(&modes, set), &[]);
        let problems = found.map_err(|problems| problems.to_string()).err();
        assert_eq!(problems, None, "{conditions} {set}");
    }
}

#[test]
fn what_is_too_hard_to_decide_is_allowed_before_long() {
    // Ten pigeons do not fit into nine holes, but only an exhaustive search would show this.
    let pigeons = ["CB", "CF", "CH", "CM", "CC", "PB", "PF", "PH", "PM", "PC"];
    let holes = pigeons.len() - 1;
    let sits = |pigeon: usize, hole: usize| format!("distance({}) * {hole} > 1", pigeons[pigeon]);
    let mut conditions = vec![];
    for pigeon in 0..=holes {
        let somewhere: Vec<String> = (0..holes).map(|hole| sits(pigeon, hole)).collect();
        conditions.push(format!("!({})", somewhere.join(" || ")));
    }
    for hole in 0..holes {
        for (a, b) in (0..=holes).flat_map(|a| (0..a).map(move |b| (a, b))) {
            conditions.push(format!("{} && {}", sits(a, hole), sits(b, hole)));
        }
    }
    let conditions: Vec<&str> = conditions.iter().map(String::as_str).collect();
    assert_eq!(
        before_long(with_modes(&conditions, "{ laps = 1 }")),
        Ok("x".to_owned())
    );
}

#[test]
fn many_numbers_in_many_conditions_are_looked_at_before_long() {
    let above = |mode: usize| (0..70).map(move |i| format!("score>{}", mode * 70 + i));
    let conditions: Vec<String> = (0..300)
        .rev()
        .map(|mode| above(mode).collect::<Vec<_>>().join("||"))
        .collect();
    let conditions: Vec<&str> = conditions.iter().map(String::as_str).collect();
    assert_eq!(
        before_long(with_modes(&conditions, "{ laps = 1 }")),
        Ok("x".to_owned())
    );
}

/// The name of a strategy with this content, or its problems; fails if there is no result in time.
fn before_long(text: String) -> Result<String, Problems> {
    let (send, receive) = std::sync::mpsc::channel();
    std::thread::spawn(move || send.send(strategy_of(&text, &[]).map(|strategy| strategy.name)));
    receive
        .recv_timeout(Duration::from_secs(120))
        .expect("an answer before long")
}

/// The required keys of each kind.
fn required(kind: &str) -> &'static str {
    match kind {
        "waypoint" => "points = [\"CF\"]\n",
        "loiter" => "ellipse = { centre = \"CH\", along_m = 15, across_m = 50 }\n",
        "cut_range" | "trail" | "intercept" => "contact = \"opponent\"\n",
        "shield" => "guarded = \"own_flag\"\n",
        "attractor" => "to = \"CF\"\n",
        "max_speed" | "constant_speed" => "speed_m_s = 1\n",
        "constant_heading" => "heading_deg = 1\n",
        "timer" => "duration_s = 1\n",
        _ => "",
    }
}

#[test]
fn numbers_of_behaviours_have_the_ranges_and_defaults_that_are_declared() {
    let schema = scenario::schema(Kind::STRATEGY);
    let mut kinds = 0;
    let mut ranges = 0;
    let mut defaults = 0;
    for about in schema["properties"]["behaviour"]["additionalProperties"]["anyOf"]
        .as_array()
        .unwrap()
    {
        let kind = about["properties"]["kind"]["const"].as_str().unwrap();
        kinds += 1;
        let file =
            |keys: &str| format!("base = \"safe.toml\"\n[behaviour.it]\nkind = \"{kind}\"\n{keys}");
        let sound = program(&file(required(kind)));
        let sound = serde_json::to_value(behaviour(&sound, "it")).unwrap();
        let task = sound["task"].as_object().unwrap().values().next().unwrap();
        for (key, about) in about["properties"].as_object().unwrap() {
            if about["title"] != "a number or an expression" {
                continue;
            }
            let low = about["minimum"].as_f64().unwrap();
            let high = about["maximum"].as_f64().unwrap();
            for value in [low - 1.0, high + 1.0] {
                // An expression is limited to the same range.
                for value in [format!("{value:?}"), format!("\"{value:?} * 1\"")] {
                    let file = file(&format!("{key} = {value}\n"));
                    let problems = strategy_of(&file, &[]).unwrap_err().to_string();
                    let parts = [format!("{key} is"), format!("expected {low} to {high}")];
                    assert!(
                        parts.iter().all(|part| problems.contains(part)),
                        "{kind} {key}: {problems}"
                    );
                    ranges += 1;
                }
            }
            if let (Some(want), Value::Object(given)) = (about["default"].as_f64(), &task[key]) {
                assert_eq!(given["expression"]["Constant"], want, "{kind} {key}");
                assert_eq!(
                    given["range"],
                    serde_json::json!([low, high]),
                    "{kind} {key}"
                );
                defaults += 1;
            }
        }
    }
    assert_eq!(kinds, 18);
    assert!(
        ranges > 200 && defaults > 50,
        "{ranges} ranges, {defaults} defaults"
    );
}
