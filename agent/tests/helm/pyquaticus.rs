//! Observations compared with those of Pyquaticus: states of its own games of two and of six
//! Surveyors, including boats that carry, are tagged, or have recently tagged. The files give the
//! commit and the names of the values.

use crate::scene::{self, loaded};
use agent::{ActionSpace, ObservationSpace, Pilot, Spaces};
use messages::Picture;
use messages::picture::{Contact, FlagView, OwnBoat};
use primitives::{SimTime, TeamId, VehicleId};
use rules::Event;
use rules::event::{EventRecord, Logged, TagCause};
use scenario::Scenario;
use serde::Deserialize;
use std::path::Path;

/// The values are in single precision with six digits.
const TOLERANCE: f32 = 3e-6;
/// Cooldown after a tag, s.
const COOLDOWN_S: f64 = 60.0;
/// The time of every picture, s.
const NOW_S: f64 = 1000.0;

#[derive(Deserialize)]
struct Reference {
    names: Vec<String>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    captures: [u32; 2],
    boats: Vec<Boat>,
}

/// x (east) and y (north), m.
#[derive(Deserialize)]
struct Boat {
    x: f64,
    y: f64,
    heading_deg: f64,
    speed_m_s: f64,
    has_flag: u8,
    tagged: u8,
    #[serde(default)]
    disabled: u8,
    since_tag_s: f64,
    observation: Vec<f32>,
}

fn scenario(team_size: usize) -> Scenario {
    let fleet = |team: &str| {
        format!(
            "[[fleet]]\nteam = \"{team}\"\ncount = {team_size}\nspawn = {{ along_m = [5, 75], across_m = [5, 75], gap_m = 4 }}\n"
        )
    };
    let base = "base = \"SCENARIOS/games/pyquaticus_2v2.toml\"\nvehicle = []\n";
    loaded(&[(
        "game.toml",
        &format!("{base}{}{}", fleet("blue"), fleet("red")),
    )])
}

/// The knowledge of a boat's team in a given state.
fn picture(state: &State, team: usize) -> Picture {
    let team_size = state.boats.len() / 2;
    let now = SimTime::from_s(NOW_S);
    let mut picture = Picture {
        team: team as u8,
        score: state.captures.to_vec(),
        ..Picture::default()
    };
    picture.stamp.valid_ns = now;
    picture.flags = vec![FlagView { carrier: -1 }; 2];
    for (i, boat) in state.boats.iter().enumerate() {
        let vehicle = i as u16;
        let of = i / team_size;
        let tagged = boat.tagged == 1;
        let here = scene::Boat::at(boat.x, boat.y).going(boat.heading_deg, boat.speed_m_s);
        let carrying = if boat.has_flag == 1 {
            1 - of as i16
        } else {
            -1
        };
        if of == team {
            let tag_ready_ns = SimTime::from_s(NOW_S + COOLDOWN_S - boat.since_tag_s);
            picture.own.push(OwnBoat {
                tagged,
                carrying,
                disabled: boat.disabled == 1,
                tag_ready_ns,
                fix_ns: now,
                ..here.own(vehicle)
            });
            continue;
        }
        let team_of = TeamId(of as u8);
        picture.contacts.push(Contact {
            team: team_of,
            tagged,
            carrying,
            ..here.contact(vehicle, now)
        });
        let mut happened = |at_s, event| {
            let at = SimTime::from_s(at_s);
            let logged = Logged { tick: 0, at, event };
            picture.events.push(EventRecord::from(logged));
        };
        if boat.disabled == 1 {
            happened(NOW_S - 10.0, Event::Disabled(VehicleId(vehicle)));
        }
        if boat.since_tag_s < COOLDOWN_S {
            let cause = TagCause::Opponent(VehicleId(vehicle));
            let tagged = Event::Tagged {
                vehicle: VehicleId::at(team * team_size),
                cause,
            };
            happened(NOW_S - boat.since_tag_s, tagged);
        }
    }
    picture
}

#[test]
fn observations_are_those_of_the_program() {
    for (file, observation) in [
        ("1v1", ObservationSpace::Pyquaticus),
        ("3v3", ObservationSpace::Pyquaticus),
        ("2023_2v2", ObservationSpace::Pyquaticus2023),
        ("2026_3v3", ObservationSpace::Pyquaticus2026),
    ] {
        let spaces = Spaces {
            observation,
            action: ActionSpace::Pyquaticus,
        };
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join(format!("tests/helm/pyquaticus/{file}.json"));
        let reference: Reference =
            serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let team_size = reference.states[0].boats.len() / 2;
        let scenario = scenario(team_size);
        for (s, state) in reference.states.iter().enumerate() {
            for (i, boat) in state.boats.iter().enumerate() {
                let mut pilot = Pilot::direct(&scenario, VehicleId::at(i), spaces);
                let got = pilot.observe(&picture(state, i / team_size));
                assert_eq!(got.len(), boat.observation.len());
                let numbers = got.iter().zip(&boat.observation).zip(&reference.names);
                numbers.for_each(|((got, want), name)| {
                    let off = off(name, *got, *want);
                    assert!(
                        off < TOLERANCE,
                        "{file} state {s} boat {i} {name}: {got}, want {want}"
                    );
                });
            }
        }
    }
}

/// The absolute error of a value. Half-turns to either side are the same bearing.
fn off(name: &str, got: f32, want: f32) -> f32 {
    let off = (got - want).abs();
    if name.ends_with("bearing") || name.ends_with("heading") {
        off.min((2.0 - off).abs())
    } else {
        off
    }
}
