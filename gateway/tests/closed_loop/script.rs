//! Text scenarios: events for a boat and its gateway, line by line, with the expected results.
//!
//! The language is described in `scenarios/README.md`.

use crate::rig::{Rig, datum, plan};
use crate::tamper::tamper;
use gateway::bridge::{Input, Preflight};
use gateway::emulator::{FrontSeat, Port};
use gateway::geodesy::LocalFrame;
use messages::Order;
use messages::external::{Mission, OperatorCommand};
use primitives::angle::wrap_pi;
use primitives::frame::Ned;
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// A boat that has been driving east at 1.5 m/s for ten seconds.
const UNDER_WAY: &str =
    "order steer 90 1.5\nrun 1\noperator arm\nexpect state = armed\nexpect refused =\nrun 9
expect speed > 1.2";

const COMPARISONS: [&str; 8] = ["=", "!=", "~", "!~", "^", "!^", "<", ">"];

#[test]
fn every_scenario_runs_as_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/closed_loop/scenarios");
    let mut count = 0;
    let mut failures = Vec::new();
    for file in std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
    {
        let text = std::fs::read_to_string(&file).expect("text");
        for scenario in text
            .split("\n## ")
            .skip(1)
            .filter(|_| file.extension().is_some_and(|ending| ending == "txt"))
        {
            for script in cases(scenario) {
                count += 1;
                failures.extend(
                    failure(&script)
                        .map(|line| format!("{}: {script}\nfails at: {line}", file.display())),
                );
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {count} fail:\n{}",
        failures.len(),
        failures.join("\n\n")
    );
    assert!(count > 70, "only {count} scenarios were found");
}

/// The scripts of a scenario: one for each row of its table, or a single one. The first line is the
/// title.
fn cases(scenario: &str) -> Vec<String> {
    let lines = scenario
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    let (rows, script): (Vec<&str>, Vec<&str>) = lines.partition(|line| line.starts_with('|'));
    let cells = |row: &str| {
        row.trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().to_owned())
            .collect::<Vec<_>>()
    };
    let Some((names, rows)) = rows.split_first() else {
        return vec![script.join("\n")];
    };
    let filled = |row: &&str| {
        let values = cells(names).into_iter().zip(cells(row));
        values.fold(script.join("\n"), |script, (name, value)| {
            script.replace(&format!("<{name}>"), &value)
        })
    };
    rows.iter().map(filled).collect()
}

/// The line at which a script fails, if any.
fn failure(script: &str) -> Option<&str> {
    let mut rig = played("boat");
    let fails = |line: &&str| catch_unwind(AssertUnwindSafe(|| play(&mut rig, line))).is_err();
    script.lines().skip(1).find(fails)
}

/// Runs a script and returns the rig.
pub(crate) fn played(script: &str) -> Rig {
    let mut rig = Rig::of(plan("surveyor.toml"), |_| {});
    play_all(&mut rig, script);
    rig
}

fn play_all(rig: &mut Rig, script: &str) {
    script.lines().for_each(|line| play(rig, line));
}

/// Runs one line.
pub(crate) fn play(rig: &mut Rig, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let rest = |from: usize| words[from..].join(" ");
    match words.as_slice() {
        ["boat", options @ ..] => *rig = boat(options),
        ["under-way", options @ ..] => {
            *rig = boat(options);
            play_all(rig, UNDER_WAY);
        }
        ["run", seconds] => rig.run(number(seconds)),
        ["until", limit_s, ..] => {
            let condition = rest(2);
            rig.after_s = rig.run_until(number(limit_s), |rig| holds(rig, &condition));
        }
        ["stops", limit_s, ..] => {
            let stop = format!("until {limit_s} mode = L\nexpect state ~ {}", rest(2));
            play_all(
                rig,
                &format!("{stop}\nrun 10\nexpect rest = yes\nexpect mode = L"),
            );
        }
        ["expect", ..] => {
            let condition = rest(1);
            assert!(
                holds(rig, &condition),
                "not so: {condition}; it is {:?}",
                value(rig, &condition_of(&condition)[0])
            );
        }
        ["times", count, ..] => (0..number(count) as u64)
            .for_each(|_| rest(2).split(';').for_each(|line| play(rig, line))),
        ["send", body] => rig.send(Port::Secondary, body),
        ["send-as-primary", body] => rig.send(Port::Primary, body),
        ["mark"] => rig.mark(),
        ["order", order @ ..] => (rig.order, rig.hangs) = (order_of(order), false),
        ["agent-hangs"] => rig.hangs = true,
        ["operator", "mission", mission @ ..] => rig.give(&Input::Operator(
            OperatorCommand::Mission(mission_of(mission)),
        )),
        ["operator", "mode", mode] => {
            let mode = serde_json::from_str(mode).unwrap_or_else(|e| panic!("{mode}: {e}"));
            rig.give(&Input::Operator(OperatorCommand::Mode(mode)));
        }
        ["operator", command] => rig.give(&Input::Operator(named(command))),
        ["fleet", command] => rig.give(&Input::Fleet(named(command))),
        ["link", state] => rig.link(*state == "up"),
        ["open", ways] => {
            rig.open = (
                matches!(*ways, "both" | "to-boat"),
                matches!(*ways, "both" | "from-boat"),
            )
        }
        ["tamper", how @ ..] => rig.tamper = tamper(how),
        ["late-telemetry", bytes] => rig.deliver_late(number(bytes) as usize),
        ["fixes", how] => {
            (rig.frozen, rig.pinned) = (*how == "frozen", (*how == "pinned").then_some(rig.boat.at))
        }
        ["jump", north_m, east_m] => {
            rig.offset = Ned {
                north: number(north_m),
                east: number(east_m),
            }
        }
        ["appear", x, y] => rig.offset = Ned::from_xy(number(x), number(y)) - rig.boat.at,
        ["control", operator] => rig.emulator.give_control(rig.now, named(operator)),
        ["volts", volts] => rig.emulator.set_volts(number(volts)),
        ["other", "none"] => rig.others = None,
        ["other", north_m, east_m] => {
            rig.others = Some(vec![
                rig.boat.at
                    + Ned {
                        north: number(north_m),
                        east: number(east_m),
                    },
            ]);
        }
        other => panic!("what is {other:?}?"),
    }
}

fn number(text: &str) -> f64 {
    text.parse()
        .unwrap_or_else(|_| panic!("{text:?} is not a number"))
}

fn named<T: DeserializeOwned>(name: &str) -> T {
    serde_json::from_value(name.into()).unwrap_or_else(|e| panic!("{e}"))
}

/// A boat from its gateway's file and pairs of settings.
fn boat(options: &[&str]) -> Rig {
    let (file, options) = match options {
        [file, rest @ ..] if file.ends_with(".toml") => (*file, rest),
        rest => ("surveyor.toml", rest),
    };
    let mut plan = plan(file);
    let mut watchdog_s = None;
    let mut integers = false;
    let mut charge = Some(1.0);
    for option in options.chunks(2) {
        match option {
            ["watchdog", seconds] => watchdog_s = Some(number(seconds)),
            ["battery", action] => plan.gateway.failsafe.battery_low = named(action),
            ["polygon", corners] => plan.gateway.geofence.polygon = Some(places_of(corners)),
            ["keep-out", corners] => plan.gateway.geofence.keep_out.push(places_of(corners)),
            ["geofence", action] => plan.gateway.failsafe.geofence = named(action),
            ["order", action] => plan.gateway.failsafe.order_stale = named(action),
            ["integers", "only"] => integers = true,
            ["charge", percent] => charge = Some(0.01 * number(percent)),
            ["startup", words] => {
                plan.gateway.startup_words = words.split(',').map(named).collect()
            }
            ["rearm", seconds] => plan.gateway.failsafe.rearm_within_s = number(seconds),
            ["dry-run", "yes"] => plan.dry_run = true,
            ["preflight", "missing"] => {
                plan.preflight = Preflight::Missing("a passed pre-flight check".to_owned())
            }
            ["arms-itself", "once"] => plan.arms_itself = true,
            ["currents", "off"] => {
                let currents = &mut plan.gateway.currents;
                (
                    currents.thruster_max_a,
                    currents.thruster_min_a,
                    currents.bilge_a,
                ) = (0.0, 0.0, 0.0);
            }
            other => panic!("no boat has {other:?}"),
        }
    }
    Rig::of(plan, |boat| {
        (boat.watchdog_s, boat.integers, boat.charge) = (watchdog_s, integers, charge)
    })
}

/// Corners of a polygon from `x,y;x,y;…`.
fn places_of(text: &str) -> Vec<[f64; 2]> {
    mission_of(&text.split(';').collect::<Vec<_>>()).waypoints
}

fn order_of(words: &[&str]) -> Option<Order> {
    Some(match words {
        ["none"] => return None,
        ["hold"] => Order::Hold,
        ["steer", heading_deg, speed_m_s] => Order::Steer {
            heading_rad: number(heading_deg).to_radians(),
            speed_m_s: number(speed_m_s),
        },
        ["thrust", port, starboard] => Order::Thrust {
            port: number(port),
            starboard: number(starboard),
        },
        other => panic!("no order is {other:?}"),
    })
}

/// A mission with waypoints `x,y` on the field or `@latitude,longitude`.
fn mission_of(words: &[&str]) -> Mission {
    let frame = LocalFrame::new(datum());
    let place = |text: &str| {
        let (a, b) = text
            .trim_start_matches('@')
            .split_once(',')
            .expect("two numbers");
        if text.starts_with('@') {
            return [number(a), number(b)];
        }
        let at = frame.lat_lon(Ned::from_xy(number(a), number(b)));
        [at.lat_deg, at.lon_deg]
    };
    let mut mission = Mission {
        throttle_pct: 40.0,
        erp: place("20,40"),
        waypoints: vec![],
    };
    for word in words {
        match word.split_once('=') {
            Some(("throttle", percent)) => mission.throttle_pct = number(percent),
            Some((_, erp)) => mission.erp = place(erp),
            None => mission.waypoints.push(place(word)),
        }
    }
    mission
}

/// The value, operator and expected value of a condition.
fn condition_of(condition: &str) -> [String; 3] {
    let words: Vec<&str> = condition.split_whitespace().collect();
    let at = words
        .iter()
        .position(|word| COMPARISONS.contains(word))
        .expect("a comparison");
    [
        words[..at].join(" "),
        words[at].to_owned(),
        words[at + 1..].join(" "),
    ]
}

fn holds(rig: &Rig, condition: &str) -> bool {
    let [what, comparison, want] = condition_of(condition);
    let got = value(rig, &what);
    match comparison.as_str() {
        "=" => got == want,
        "!=" => got != want,
        "~" => got.contains(&want),
        "^" => got.starts_with(&want),
        "!^" => !got.starts_with(&want),
        "!~" => !got.contains(&want),
        "<" => number(&got) < number(&want),
        _ => number(&got) > number(&want),
    }
}

/// The value with this name.
fn value(rig: &Rig, name: &str) -> String {
    let boat = &rig.boat;
    let status = rig.bridge.status(rig.now);
    let texts = || {
        rig.sent.iter().map(|(_, bytes)| {
            String::from_utf8_lossy(bytes)
                .trim_end()
                .replace("\r\n", " ")
        })
    };
    let (psi_rad, speed_m_s) = match rig.order {
        Some(Order::Steer {
            heading_rad,
            speed_m_s,
        }) => (heading_rad, speed_m_s),
        _ => (f64::NAN, f64::NAN),
    };
    match name.split(' ').collect::<Vec<_>>().as_slice() {
        ["state"] => rig.bridge.state().to_string(),
        ["status"] => status.state,
        ["would-send"] => status.would_send.unwrap_or_default(),
        ["missing"] => status.missing.join("; "),
        ["alarms"] => status.alarms.join("; "),
        ["volts"] => status.battery_v.unwrap_or(f64::NAN).to_string(),
        ["percent"] => status.battery_pct.unwrap_or(f64::NAN).to_string(),
        ["refused"] => rig.refused.clone().unwrap_or_default(),
        ["remark"] => rig.remark.clone(),
        ["events"] => format!("{:?}", rig.events),
        ["mode"] => rig.emulator.command().mode.letter().to_string(),
        ["boat-operator"] => rig
            .emulator
            .operator()
            .map(|operator| format!("{operator:?}"))
            .unwrap_or_default(),
        ["boat-order"] => match rig.boat_order {
            Order::Hold => "hold".to_owned(),
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => format!("steer {:.3} {speed_m_s:.3}", heading_rad.to_degrees()),
            Order::Turn { by_rad, speed_m_s } => {
                format!("turn {:.3} {speed_m_s:.3}", by_rad.to_degrees())
            }
            Order::Thrust { port, starboard } => format!("thrust {port:.3} {starboard:.3}"),
        },
        ["telemetry"] => {
            let mut burst = vec![];
            rig.emulator.telemetry(rig.now, &mut burst);
            String::from_utf8_lossy(&burst).into_owned()
        }
        ["after"] => rig.after_s.to_string(),
        ["rest"] if boat.speed_m_s.abs() < 0.05 => "yes".to_owned(),
        ["rest"] => "no".to_owned(),
        ["speed"] => boat.speed_m_s.to_string(),
        ["speed-error"] => (boat.speed_m_s - speed_m_s).abs().to_string(),
        ["heading-error"] => wrap_pi(psi_rad - boat.psi_rad).abs().to_string(),
        ["east"] => boat.at.east.to_string(),
        ["distance", "mark"] => boat.at.distance(rig.marked.0).to_string(),
        ["distance", x, y] => boat
            .at
            .distance(Ned::from_xy(number(x), number(y)))
            .to_string(),
        ["last"] => rig.oracle.last.trim_end().to_owned(),
        ["sentences"] => rig.oracle.all.to_string(),
        ["driving"] => rig.oracle.driving.to_string(),
        ["writes"] => rig.sent.len().to_string(),
        ["last-write"] => texts().next_back().unwrap_or_default(),
        ["sent"] => texts().collect::<Vec<_>>().join(" "),
        ["sent-names"] => {
            let sent = texts().collect::<Vec<_>>().join(" ");
            sent.split(' ')
                .map(|sentence| sentence.chars().skip(1).take(7).collect())
                .collect::<Vec<String>>()
                .join(" ")
        }
        ["kinds-of-writes"] => texts()
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect::<Vec<_>>()
            .join(" "),
        ["reports"] => rig.navs.len().to_string(),
        ["eastward-reports"] => rig
            .navs
            .windows(2)
            .filter(|two| two[1].1.nav.east_m > two[0].1.nav.east_m)
            .count()
            .to_string(),
        ["count", name @ ..] => {
            let name = name.join(" ");
            let of = |counts: &[(String, u64)]| {
                counts
                    .iter()
                    .find(|(known, _)| *known == name)
                    .map_or(0, |(_, count)| *count)
            };
            (of(&rig.counts()) - of(&rig.marked.1)).to_string()
        }
        other => panic!("no value is {other:?}"),
    }
}
