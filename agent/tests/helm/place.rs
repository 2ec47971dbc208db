//! Where boats steer to capture a flag and to be untagged: the nearest places that the referee
//! accepts.

use crate::scene::{helm, loaded, unsafely};
use agent::Mind;
use messages::picture::{FlagView, Nav, OwnBoat, Picture};
use primitives::frame::Leg;
use primitives::{Ned, SimTime, TeamId, VehicleId};
use rules::field::Route;
use scenario::Scenario;

const BLUE: TeamId = TeamId(0);
/// Rounding error of a variable in printed form, m.
const ROUNDING_M: f64 = 1e-3;

/// A shipped game in which all boats compute their distance to these places.
fn scenario(game: &str) -> Scenario {
    let teams = ["blue", "red"]
        .map(|team| format!("[[team]]\nname = \"{team}\"\nstrategy = \"strategy.toml\"\n"));
    let game = format!("base = 'SCENARIOS/games/{game}.toml'\n{}", teams.concat());
    let program = "[variables]\ncapture_m = 0\nown_flag_m = 0\nuntag_m = 0\n[[rule]]\nwhen = \"true\"\n\
                   set = { capture_m = \"distance(capture_place)\", own_flag_m = \"distance(own_flag)\", \
                   untag_m = \"distance(untag_place)\" }\n[behaviour.stop]\nkind = \"full_stop\"\n";
    loaded(&[("game.toml", &game), ("strategy.toml", &unsafely(program))])
}

/// The picture of a boat alone at this position.
fn alone(scenario: &Scenario, at: Ned) -> Picture {
    let nav = Nav {
        north_m: at.north,
        east_m: at.east,
        ..Nav::default()
    };
    Picture {
        own: vec![OwnBoat::new(VehicleId(0), nav)],
        flags: vec![FlagView { carrier: -1 }; scenario.field.flags.len()],
        score: vec![0, 0],
        ..Picture::default()
    }
}

#[test]
fn a_boat_makes_for_the_nearest_place_that_the_referee_takes() {
    for (game, flags) in [
        ("surveyor_2v2", 1),
        ("fleet_20v20", 3),
        ("fleet_100v100", 5),
    ] {
        let scenario = scenario(game);
        let field = &scenario.field;
        let rules = &scenario.rules;
        assert_eq!(field.own_flags(BLUE).count(), flags, "{game}");
        for (along, across) in [(0.1, 0.05), (0.3, 0.2), (0.4, 0.5), (0.6, 0.8), (0.9, 0.95)] {
            let at = field.at(along * field.plan.width_m, across * field.plan.depth_m);
            let homes = field.own_flags(BLUE).map(|(_, flag)| flag.start);
            let home = homes
                .min_by(|a, b| at.distance(*a).total_cmp(&at.distance(*b)))
                .expect("blue has a flag");
            assert!(
                rules.is_capture_place(
                    field,
                    BLUE,
                    Leg {
                        from: home,
                        to: home
                    },
                    SimTime::ZERO
                ),
                "{game}"
            );
            assert!(
                rules.is_untag_place(field, BLUE, home, SimTime::ZERO),
                "{game}"
            );
            let mut helm = helm(&scenario);
            helm.decide(&alone(&scenario, at));
            for variable in helm.report().expect("a helm has a report").variables {
                let got_m: f64 = variable.value.parse().expect("a number");
                let off_m = got_m - at.distance(home);
                assert!(
                    off_m.abs() < ROUNDING_M,
                    "{game}, {} from {at:?}: distance too large by {off_m} m",
                    variable.name
                );
            }
        }
    }
}

#[test]
fn a_boat_makes_for_the_current_homes_of_moving_flags() {
    let mut scenario = scenario("surveyor_2v2");
    let flag = &mut scenario.field.flags[0];
    let points = vec![flag.start, flag.start + Ned::from_xy(0.0, 20.0)];
    flag.settings.route = Some(Route::new(points, 0.5));
    let at = scenario.field.at(60.0, 30.0);
    let mut helm = helm(&scenario);
    for (time_s, moved_m) in [(0.0, 0.0), (10.0, 5.0), (50.0, 15.0), (80.0, 0.0)] {
        let mut picture = alone(&scenario, at);
        picture.stamp.valid_ns = SimTime::from_s(time_s);
        helm.decide(&picture);
        let home = scenario.field.flags[0].start + Ned::from_xy(0.0, moved_m);
        for variable in helm.report().expect("a helm has a report").variables {
            let got_m: f64 = variable.value.parse().expect("a number");
            let off_m = got_m - at.distance(home);
            assert!(
                off_m.abs() < ROUNDING_M,
                "{} after {time_s} s: distance too large by {off_m} m",
                variable.name
            );
        }
    }
}
