//! Scenes as text files: this test runs those in `scenes`.
//!
//! - `## NAME` begins a scene, `# …` is a comment.
//! - `rules BOOK KEY=VALUE …` comes next: a book of `preset.rs`, its overrides (JSON values, times
//!   in nanoseconds), and `boats=2` for each team (default 1), `sides=3` (default 2),
//!   `flag=[TEAM,X,Y]` for an extra flag, `own=[FLAG,{KEY:VALUE}]` for a flag's own radii,
//!   `route=[FLAG,SPEED,[[X,Y],…]]` for a moving flag,
//!   `obstacle=[X,Y,RADIUS]`, `walls="all_round"`.
//! - `0 at 60 40; 1 at 65 40 -> Tagged 1 Opponent 0, …`: boats are placed at x and y in metres, and
//!   the next check returns exactly these events, in this order; or `nothing`. Boats stay until
//!   they are placed elsewhere. `0 goes 60 40` moves a boat there from its position. `0 asks tag`
//!   (or `grab`) is a request from then on. `wait 10` lets 10 s pass before the check, `clock 0`
//!   sets the time. An event is its name, then its vehicle, flag or team.
//! - `WHAT is VALUE`: a part of the referee's standing as JSON (`vehicles.0.tagged`, `score`,
//!   `flags.1.carrier`; a time may be `LONG_AGO`), `directive VEHICLE`, or `keepout VEHICLE X Y`
//!   with the circle's x, y and radius.

use crate::preset;
use crate::scene::{Scene, field, flag, teams_of, three_sided};
use primitives::{Ned, SimTime, VehicleId};
use rules::Event;
use rules::field::{Field, FlagRadii, Obstacle, Route};
use serde_json::Value;
use std::path::Path;

/// A result whose error says where a scene fails.
type Told<T> = Result<T, String>;

fn read<T: serde::de::DeserializeOwned>(text: &str) -> Told<T> {
    serde_json::from_str(text).map_err(|e| format!("{text}: {e}"))
}

/// `vehicles.0.tagged` as a JSON pointer.
fn pointer(path: &str) -> String {
    format!("/{}", path.replace('.', "/"))
}

fn opened(line: &str) -> Told<Scene> {
    let mut words = line
        .strip_prefix("rules ")
        .ok_or("expected `rules BOOK`")?
        .split(' ');
    let book = words
        .next()
        .and_then(|name| preset::all().into_iter().find(|rules| rules.name == name));
    let mut rules = serde_json::to_value(book.ok_or("no such book")?).map_err(|e| e.to_string())?;
    let mut boats = 1;
    let mut sides = 2;
    let mut field = field(vec![]);
    for word in words {
        let (key, value) = word.split_once('=').ok_or("expected KEY=VALUE")?;
        match key {
            "boats" => boats = read(value)?,
            "sides" => sides = read(value)?,
            "flag" | "own" | "route" | "walls" | "obstacle" => change(&mut field, key, value)?,
            key => {
                *rules
                    .pointer_mut(&pointer(key))
                    .ok_or(format!("unknown rule {key}"))? = read(value)?
            }
        }
    }
    let rules = serde_json::from_value(rules).map_err(|e| e.to_string())?;
    Ok(if sides == 3 {
        three_sided(rules)
    } else {
        Scene::on(rules, field, teams_of(boats, sides))
    })
}

/// Applies a word about the field.
fn change(field: &mut Field, key: &str, value: &str) -> Told<()> {
    match key {
        "flag" => {
            let (team, x, y) = read(value)?;
            field.flags.push(flag(team, x, y));
        }
        "own" => {
            let (flag, radii): (usize, FlagRadii) = read(value)?;
            field.flags[flag].settings.radii = radii;
        }
        "route" => {
            let (flag, speed_m_s, corners): (usize, f64, Vec<(f64, f64)>) = read(value)?;
            let flag = &mut field.flags[flag];
            let corners = corners.into_iter().map(|(x, y)| Ned::from_xy(x, y));
            let points = std::iter::once(flag.start).chain(corners).collect();
            flag.settings.route = Some(Route::new(points, speed_m_s));
        }
        "walls" => field.plan.walls = read(value)?,
        _ => {
            let (x, y, radius_m) = read(value)?;
            let centre = Ned::from_xy(x, y);
            let obstacle = Obstacle::Circle { centre, radius_m };
            field.plan.obstacles.push(obstacle);
        }
    }
    Ok(())
}

/// An event in scene notation: its name, then the ids, as in `Tagged 1 Opponent 0`.
fn brief(event: &Event) -> String {
    let text = format!("{event:?}");
    let is_told = |word: &&str| {
        !word.starts_with(char::is_lowercase) && !word.ends_with("Id") && *word != "Some"
    };
    let words: Vec<&str> = text
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    words
        .into_iter()
        .filter(is_told)
        .collect::<Vec<_>>()
        .join(" ")
}

/// The actual value for a line `WHAT is VALUE`.
fn asked(scene: &Scene, what: &str) -> Told<String> {
    let words: Vec<&str> = what.split(' ').collect();
    Ok(match words[..] {
        ["directive", vehicle] => format!("{:?}", scene.directive(read(vehicle)?)),
        ["keepout", vehicle, x, y] => {
            let at = Ned::from_xy(read(x)?, read(y)?);
            let circle = scene
                .referee
                .keepout(&scene.standing, VehicleId(read(vehicle)?), at);
            format!(
                "{:?}",
                circle.map(|(centre, radius_m)| (centre.east, centre.north, radius_m))
            )
        }
        _ => {
            let standing = serde_json::to_value(&scene.standing).map_err(|e| e.to_string())?;
            standing
                .pointer(&pointer(what))
                .map(Value::to_string)
                .ok_or(format!("the standing has no {what}"))?
        }
    })
}

/// Executes one step before a check.
fn step(scene: &mut Scene, words: &str) -> Told<()> {
    match words.split(' ').collect::<Vec<_>>()[..] {
        [vehicle, "at", x, y] => {
            scene.put(read(vehicle)?, read(x)?, read(y)?);
        }
        [vehicle, "goes", x, y] => {
            scene.go(read(vehicle)?, read(x)?, read(y)?);
        }
        [vehicle, "asks", what] => {
            let asks = &mut scene.asks[read::<usize>(vehicle)?];
            match what {
                "tag" => asks.tag = true,
                "grab" => asks.grab = true,
                _ => return Err(format!("unknown request {what}")),
            }
        }
        ["wait", seconds] => {
            scene.wait(read(seconds)?);
        }
        ["clock", seconds] => scene.now = SimTime::from_s(read(seconds)?),
        _ => return Err(format!("unknown step {words}")),
    }
    Ok(())
}

/// Executes a line and checks what it states.
fn follow(scene: &mut Scene, line: &str) -> Told<()> {
    let (got, want) = if let Some((what, want)) = line.split_once(" is ") {
        (
            asked(scene, what)?,
            want.replace("LONG_AGO", &SimTime::LONG_AGO.0.to_string()),
        )
    } else {
        let (steps, want) = line
            .split_once("-> ")
            .ok_or("expected `STEPS -> EVENTS` or `WHAT is VALUE`")?;
        for words in steps
            .split(';')
            .map(str::trim)
            .filter(|words| !words.is_empty())
        {
            step(scene, words)?;
        }
        let events: Vec<String> = scene.look().iter().map(brief).collect();
        (
            if events.is_empty() {
                "nothing".to_owned()
            } else {
                events.join(", ")
            },
            want.to_owned(),
        )
    };
    if got == want {
        Ok(())
    } else {
        Err(format!("is {got}"))
    }
}

/// Plays a scene to its end, or to the first line that fails.
fn played(told: &str) -> Told<()> {
    let mut lines = told
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with("# "));
    let first = lines.next().unwrap_or_default();
    let mut scene = opened(first).map_err(|e| format!("{first}: {e}"))?;
    let mut looks = 0;
    for line in lines {
        follow(&mut scene, line).map_err(|e| format!("{line}: {e}"))?;
        looks += 1;
    }
    if looks > 0 {
        Ok(())
    } else {
        Err("the scene has no check".to_owned())
    }
}

#[test]
fn every_scene_goes_as_it_is_told() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/referee/scenes");
    let mut wrong = vec![];
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("it can be read").path();
        let file = path.display();
        let text = std::fs::read_to_string(&path).expect("a text");
        let scenes: Vec<&str> = text.split("\n## ").skip(1).collect();
        let begun = text.lines().filter(|line| line.starts_with("##")).count();
        assert!(
            begun > 0 && begun == scenes.len(),
            "{file}: only {} of {begun} scenes can be read",
            scenes.len()
        );
        for scene in scenes {
            let (name, told) = scene.split_once('\n').unwrap_or((scene, ""));
            wrong.extend(
                played(told)
                    .err()
                    .map(|why| format!("{file}: {name}: {why}")),
            );
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
