//! A boat's knowledge of a scene, as it appears in strategies.

use crate::scene::{Boat, decided, helm, picture, without_safety};
use agent::HelmMind;
use messages::picture::{OwnBoat, Picture};
use rules::UntagOn;

/// A helm that evaluates an expression at every decision.
fn asking(expression: &str) -> HelmMind {
    helm(&without_safety(&asks(expression)))
}

fn asks(expression: &str) -> String {
    format!(
        "[variables]\nanswer = 0\n[[rule]]\nwhen = \"true\"\nset = {{ answer = \"{expression}\" }}\n\
         [behaviour.stop]\nkind = \"full_stop\"\n"
    )
}

/// The value of the expression in this scene.
fn answer(helm: &mut HelmMind, picture: &Picture) -> f64 {
    decided(helm, picture).variables[0]
        .value
        .parse()
        .expect("a number")
}

#[test]
fn measures_are_of_one_place_or_between_two() {
    let [own, mate] = [Boat::at(-20.0, 0.0).going(90.0, 1.0), Boat::at(-40.0, 0.0)];
    let enemies = [Boat::at(10.0, 0.0).going(270.0, 2.0), Boat::at(-30.0, 30.0)];
    let mut scene = picture(0.0, [own, mate], enemies);
    scene.contacts[1].tagged = true;
    for (expression, want) in [
        ("distance(opponent)", 30.0),
        ("distance(opponent, own_flag)", 70.0),
        ("distance(own_flag, opponent)", 70.0),
        ("distance(mate_carrier, own_flag)", 1e9),
        ("closing(opponent)", 3.0),
        ("closing(opponent, own_flag)", 2.0),
        ("closing(own_flag, enemy_flag)", 0.0),
        ("closing(mate_carrier, own_flag)", 0.0),
        ("speed(opponent)", 2.0),
        ("speed(mate_carrier)", 0.0),
        ("is_tagged(opponent) ? 1 : 0", 0.0),
        ("is_tagged(nearest_defender) ? 1 : 0", 0.0),
        ("is_tagged(own_flag) ? 1 : 0", 0.0),
        ("distance(nearest_defender)", 30.0),
        ("mates_nearer(own_flag)", 1.0),
        ("mates_nearer(enemy_flag)", 0.0),
        ("mates_nearer(mate_carrier)", 0.0),
    ] {
        let got = answer(&mut asking(expression), &scene);
        assert!(
            (got - want).abs() < 1e-9,
            "{expression} is {got}, want {want}"
        );
    }
    // A teammate that is tagged, or on its way home with a flag, does not count.
    let changes: [fn(&mut OwnBoat); 2] = [|boat| boat.tagged = true, |boat| boat.carrying = 1];
    for change in changes {
        let mut other = scene.clone();
        change(&mut other.own[1]);
        assert_eq!(answer(&mut asking("mates_nearer(own_flag)"), &other), 0.0);
    }
    // A tagged enemy returns home to play again, so it counts as a defender too.
    scene.contacts[1].east_m = 50.0;
    assert_eq!(
        answer(&mut asking("is_tagged(nearest_defender) ? 1 : 0"), &scene),
        1.0
    );
}

#[test]
fn a_boat_that_is_out_for_good_stays_home_and_opponents_ignore_it() {
    let own = Boat::at(-60.0, 0.0);
    let enemies = [Boat::at(10.0, 0.0), Boat::at(50.0, 30.0)];
    let mut scene = picture(0.0, [own, Boat::at(-40.0, 0.0)], enemies);
    (scene.own[0].tagged, scene.contacts[0].tagged) = (true, true);
    scene.contacts[1].tagged = true;
    for (untag_on, wants) in [
        (UntagOn::Entering, [120.0, 70.0, 50.0]),
        (UntagOn::Never, [0.0, 1e9, 1e9]),
    ] {
        for (expression, want) in [
            "distance(untag_place)",
            "distance(opponent)",
            "distance(nearest_defender, opponent)",
        ]
        .into_iter()
        .zip(wants)
        {
            let mut scenario = without_safety(&asks(expression));
            scenario.rules.untag_on = untag_on;
            let mut helm = helm(&scenario);
            let got = answer(&mut helm, &scene);
            assert!(
                (got - want).abs() < 1e-3,
                "{expression} {untag_on:?}: {got}"
            );
        }
    }
}

#[test]
fn boats_of_the_team_go_on_while_their_fixes_drop_out() {
    // Two boats going east at 2 m/s that turn north, with their last fix at 10 s.
    let [own, mate] = [Boat::at(-20.0, 0.0), Boat::at(-40.0, 0.0)];
    let far = [Boat::at(70.0, 30.0), Boat::at(70.0, -30.0)];
    for expression in ["distance(own_flag)", "distance(mate_carrier, own_flag)"] {
        let mut helm = asking(expression);
        let east_m = if expression.contains("mate") {
            20.0
        } else {
            40.0
        };
        for (at_s, heading_deg, north_m, gone_m) in [
            (10.5, 90.0, 0.0, 1.0),
            (12.0, 90.0, 0.0, 4.0),
            (15.0, 0.0, 6.0, 4.0),
        ] {
            let mut scene = picture(
                at_s,
                [own, mate].map(|boat| boat.going(heading_deg, 2.0)),
                far,
            );
            scene.own[1].carrying = 1;
            for boat in &mut scene.own {
                boat.fix_ns = primitives::SimTime::from_s(10.0);
            }
            let want_m = primitives::math::length(east_m + gone_m, north_m);
            let got_m = answer(&mut helm, &scene);
            assert!(
                (got_m - want_m).abs() < 1e-9,
                "{expression} at {at_s} s: {got_m}"
            );
        }
    }
}

#[test]
fn an_intruder_is_assigned_to_one_boat_and_to_the_same_by_everybody() {
    let own_x = |x: f64| [Boat::at(x, 0.0), Boat::at(-70.0, 0.0)];
    let mut mine = asking("known(assigned_intruder) ? distance(assigned_intruder) : -1");
    let intruders = |x: f64| [Boat::at(x, 0.0), Boat::at(50.0, 0.0)];
    assert_eq!(
        answer(&mut mine, &picture(0.0, own_x(-20.0), intruders(10.0))),
        -1.0,
        "no intruder"
    );
    assert_eq!(
        answer(&mut mine, &picture(0.1, own_x(-20.0), intruders(-10.0))),
        10.0
    );
    // The teammate is closer: first slightly, which may be noise, then by a lot.
    assert_eq!(
        answer(&mut mine, &picture(0.2, own_x(-20.0), intruders(-46.0))),
        26.0
    );
    assert_eq!(
        answer(&mut mine, &picture(0.3, own_x(-20.0), intruders(-60.0))),
        -1.0
    );
    // The teammate is busy: it has just tagged a boat, is tagged, or carries a flag.
    let busy: [fn(&mut Picture); 3] = [
        |scene| scene.own[1].tag_ready_ns = primitives::SimTime::from_s(60.0),
        |scene| scene.own[1].tagged = true,
        |scene| scene.own[1].carrying = 1,
    ];
    for make_busy in busy {
        let mut scene = picture(0.4, own_x(-20.0), intruders(-60.0));
        make_busy(&mut scene);
        let expression = "known(assigned_intruder) ? distance(assigned_intruder) : -1";
        assert_eq!(answer(&mut asking(expression), &scene), 40.0);
    }
    // The intruder nearer to the flag is assigned to the boat nearer to the flag; the other is left
    // to this boat.
    let both = [Boat::at(-66.0, 0.0), Boat::at(-64.0, 0.0)];
    assert_eq!(answer(&mut mine, &picture(0.5, own_x(-20.0), both)), 46.0);
}

#[test]
fn a_boat_may_keep_out_of_the_reach_of_its_own_opponent_alone() {
    let avoids = |contacts: &str, own: Boat| {
        let program = format!(
            "[behaviour.avoid]\nkind = \"avoid_collision\"\ncontacts = \"{contacts}\"\n\
             [behaviour.go]\nkind = \"waypoint\"\npoints = [[60, 0]]\n"
        );
        // Boat 2 is the opponent and boat 3 its teammate: both are near, and could tag the boat.
        let enemies = [own, own].map(|own| Boat {
            y: own.y + 5.0,
            ..own
        });
        let report = decided(
            &mut helm(&without_safety(&program)),
            &picture(0.0, [own, Boat::at(-75.0, -35.0)], enemies),
        );
        report
            .functions
            .iter()
            .filter(|function| function.behaviour == "avoid")
            .filter_map(|f| f.contact)
            .collect::<Vec<_>>()
    };
    let beyond = Boat::at(20.0, 0.0);
    assert_eq!(avoids("taggers", beyond).len(), 2);
    assert_eq!(avoids("opponent", beyond), [primitives::VehicleId(2)]);
    assert!(
        avoids("opponent", Boat::at(-40.0, 0.0)).is_empty(),
        "at home it cannot be tagged"
    );
}
