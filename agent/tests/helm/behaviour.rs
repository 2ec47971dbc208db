//! Each behaviour on its own, and its decisions in given scenes.

use crate::scene::{
    Boat, alone, decided, helm, only, picture, scenario, set_time, steered, without_safety,
};
use agent::Mind;
use messages::helm::{HelmReport, RunState};
use messages::picture::Picture;
use primitives::SimTime;

/// Boat 0's decision by this behaviour alone in this scene.
fn alone_decides(behaviour: &str, picture: &Picture) -> HelmReport {
    decided(&mut helm(&only(behaviour)), picture)
}

fn is_active(report: &HelmReport) -> bool {
    report
        .behaviours
        .iter()
        .any(|b| b.name == "it" && b.run_state == RunState::Active)
}

/// A boat at the centre of the field.
fn here() -> Picture {
    alone(0.0, Boat::at(0.0, 0.0).going(0.0, 1.0))
}

/// Like [`here`], with one contact; all other boats are far away.
fn with_contact(own: Boat, contact: Boat) -> Picture {
    picture(
        0.0,
        [own, Boat::at(-70.0, -30.0)],
        [contact, Boat::at(75.0, -35.0)],
    )
}

/// The boat of `at X Y` or `at X Y going HEADING SPEED`.
fn boat(text: &str) -> Boat {
    let numbers: Vec<f64> = text
        .split(' ')
        .filter_map(|word| word.parse().ok())
        .collect();
    match (text.split(' ').count(), numbers.as_slice()) {
        (3, &[x, y]) => Boat::at(x, y),
        (6, &[x, y, heading_deg, speed_m_s]) => Boat::at(x, y).going(heading_deg, speed_m_s),
        _ => panic!("expected a boat, got {text}"),
    }
}

/// Whether a decision is as expected: a course and a speed, or none.
fn is_wanted(report: &HelmReport, want: &str) -> bool {
    match report
        .course_deg
        .zip(report.speed_m_s)
        .filter(|_| is_active(report))
    {
        None => want == "nothing",
        Some((course_deg, speed_m_s)) => {
            want.split_once(' ').is_some_and(|(want_deg, want_m_s)| {
                let number = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
                let off_deg = (course_deg - number(want_deg)).rem_euclid(360.0);
                // Half a step of the grid: 1 degree and 3/35 m/s.
                off_deg.min(360.0 - off_deg) <= 0.51
                    && (speed_m_s - number(want_m_s)).abs() <= 0.044
            })
        }
    }
}

#[test]
fn every_behaviour_alone_decides_as_the_cases_say() {
    let text = include_str!("behaviours.txt");
    let mut decided = 0;
    let mut wrong = vec![];
    for case in text.split("\n## ").skip(1) {
        let mut own = Boat::at(0.0, 0.0).going(0.0, 1.0);
        let mut contact = None;
        let mut behaviour = String::new();
        let mut lines = case.lines();
        let name = lines.next().unwrap_or_default();
        for line in lines.filter(|line| !line.is_empty() && !line.starts_with('#')) {
            if let Some(text) = line.strip_prefix("own ") {
                own = boat(text);
            } else if let Some(text) = line
                .strip_prefix("contact ")
                .filter(|text| text.starts_with("at "))
            {
                contact = Some(boat(text));
            } else if let Some(want) = line.strip_prefix("decides ") {
                let picture =
                    contact.map_or_else(|| alone(0.0, own), |contact| with_contact(own, contact));
                let report = alone_decides(&behaviour, &picture);
                decided += 1;
                let got = (report.course_deg, report.speed_m_s, is_active(&report));
                wrong.extend(
                    (!is_wanted(&report, want)).then(|| format!("{name}: {got:?}, want {want}")),
                );
            } else {
                behaviour += &format!("{line}\n");
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(
        decided,
        text.lines().filter(|line| line.starts_with("##")).count(),
        "every case has one decision"
    );
    assert!(decided >= 30, "only {decided} cases");
}

/// A boat with this maximum turn rate (rad/s) that takes a second to change its speed, simulated
/// for this many tenths of a second.
fn driven(behaviour: &str, from: Boat, turn_rad_s: f64, contact: Boat, steps: u32) -> Vec<Boat> {
    let mut helm = helm(&only(behaviour));
    let mut own = from;
    let mut track = vec![];
    for step in 0..steps {
        let mut scene = with_contact(own, contact);
        set_time(&mut scene, 0.1 * f64::from(step));
        let wanted = steered(&mut helm, &scene);
        let off_rad = primitives::angle::wrap_pi((wanted.0 - own.heading_deg).to_radians());
        own.heading_deg += off_rad
            .clamp(-0.1 * turn_rad_s, 0.1 * turn_rad_s)
            .to_degrees();
        own.speed_m_s += 0.1 * (wanted.1 - own.speed_m_s);
        let (east, north) = primitives::math::sin_cos(own.heading_deg.to_radians());
        (own.x, own.y) = (
            own.x + 0.1 * own.speed_m_s * east,
            own.y + 0.1 * own.speed_m_s * north,
        );
        track.push(own);
    }
    track
}

#[test]
fn a_shield_settles_at_its_station_from_wherever_it_comes() {
    const TURN_RAD_S: f64 = 0.35;
    let shield = "kind = 'shield'\nguarded = 'own_flag'\nagainst = 'opponent'\ndistance_m = 4";
    // The station is at (-56, 0).
    for heading_deg in [0.0, 90.0, 200.0, 270.0] {
        let from = Boat::at(-52.0, -8.0).going(heading_deg, 2.4);
        let track = driven(shield, from, TURN_RAD_S, Boat::at(40.0, 0.0), 600);
        let farthest_m = track[300..]
            .iter()
            .map(|own| libm::hypot(own.x + 56.0, own.y))
            .fold(0.0, f64::max);
        assert!(
            farthest_m < 4.0,
            "heading {heading_deg}: {farthest_m} m from its station after half a minute"
        );
    }
}

#[test]
fn a_loiter_goes_round_the_way_it_is_told() {
    // Due north of the centre: clockwise is east from there.
    let ring = |turn: &str| {
        format!(
            "kind = 'loiter'\nellipse = {{ centre = [0, 0], along_m = 40, across_m = 40, corners = 36 }}\nturn = '{turn}'\nspeed_m_s = 2"
        )
    };
    for (turn, heading_deg, east) in [
        ("clockwise", 270.0, true),
        ("counterclockwise", 90.0, false),
        ("best", 80.0, true),
        ("best", 280.0, false),
    ] {
        let picture = alone(0.0, Boat::at(0.0, 20.0).going(heading_deg, 1.0));
        let (course_deg, _) = steered(&mut helm(&only(&ring(turn))), &picture);
        assert_eq!(
            (0.0..180.0).contains(&course_deg),
            east,
            "{turn} with heading {heading_deg}: {course_deg}"
        );
    }
}

#[test]
fn a_loiter_goes_all_the_way_round() {
    let ring = "kind = 'loiter'\nellipse = { centre = [0, 0], along_m = 60, across_m = 30 }\nturn = 'clockwise'\nspeed_m_s = 2";
    // The boat turns at once.
    let track = driven(
        ring,
        Boat::at(0.0, 15.0).going(90.0, 2.0),
        100.0,
        Boat::at(75.0, 35.0),
        1500,
    );
    let bearings: Vec<f64> = track
        .iter()
        .map(|own| libm::atan2(own.x, own.y).to_degrees())
        .collect();
    let turned_deg: f64 = bearings
        .windows(2)
        .map(|two| (two[1] - two[0] + 540.0).rem_euclid(360.0) - 180.0)
        .sum();
    // The perimeter is 145 m, so 300 m is about two laps.
    assert!(
        (650.0..850.0).contains(&turned_deg),
        "turned {turned_deg} degrees"
    );
}

#[test]
fn weights_of_avoidance_grow_to_what_is_configured_and_no_further() {
    let weight = |distance_m: f64, grade: &str| {
        let behaviour = format!(
            "kind = 'avoid_collision'\nweight = 300\ninner_m = 10\nouter_m = 20\ngrade = '{grade}'"
        );
        // The contact is beyond the boat's own side, where no boat can be tagged.
        let report = alone_decides(
            &behaviour,
            &with_contact(Boat::at(10.0, 0.0), Boat::at(10.0, distance_m)),
        );
        report
            .functions
            .iter()
            .find(|f| f.behaviour == "it")
            .map_or(0.0, |f| f.weight)
    };
    for (distance_m, grade, want) in [
        (0.0, "linear", 300.0),
        (5.0, "linear", 300.0),
        (10.0, "linear", 300.0),
        (12.5, "linear", 225.0),
        (15.0, "quadratic", 75.0),
        (15.0, "quasi", 300.0 * 0.353_553_390_593),
        (20.0, "linear", 0.0),
    ] {
        let got = weight(distance_m, grade);
        assert!(
            (got - want).abs() < 1e-6,
            "{grade} at {distance_m} m: {got}, want {want}"
        );
    }
}

#[test]
fn a_boat_in_the_way_is_passed_and_one_astern_changes_nothing() {
    let behaviours = "[behaviour.go]\nkind = 'waypoint'\npoints = [[60, 0]]\nspeed_m_s = 2\nweight = 50\n\
        [behaviour.avoid]\nkind = 'avoid_collision'\nweight = 300\n";
    let scene = |x: f64| with_contact(Boat::at(0.0, 0.0).going(90.0, 2.0), Boat::at(x, 0.0));
    let scenario = without_safety(behaviours);
    let course_rad = steered(&mut helm(&scenario), &scene(13.0)).0.to_radians();
    // The boat keeps its motion for a moment before it turns.
    let miss_m = ((13.0 - 2.0 * 0.7) * libm::cos(course_rad)).abs();
    assert!(
        miss_m > 5.5,
        "on course {course_rad} rad it passes at {miss_m} m"
    );
    assert!((steered(&mut helm(&scenario), &scene(-9.0)).0 - 90.0).abs() < 0.51);
}

#[test]
fn obstacles_are_passed() {
    let behaviours = "[behaviour.go]\nkind = 'waypoint'\npoints = [[0, 39]]\nspeed_m_s = 2\nweight = 50\n\
        [behaviour.avoid]\nkind = 'avoid_obstacle'\nweight = 300\n";
    // The field's obstacle is a disc with a radius of 2 m at (0, 30).
    let scene = alone(0.0, Boat::at(0.0, 14.0).going(0.0, 2.0));
    let course_rad = steered(&mut helm(&without_safety(behaviours)), &scene)
        .0
        .to_radians();
    let miss_m = (16.0 * libm::sin(course_rad)).abs() - 2.0;
    assert!(
        miss_m > 2.9,
        "passes its edge at {miss_m} m on course {course_rad} rad"
    );
}

#[test]
fn a_boat_that_an_obstacle_stops_unexpectedly_backs_off() {
    let program = "[behaviour.go]\nkind = 'waypoint'\npoints = [[60, 34]]\nweight = 100\n\
        [behaviour.avoid]\nkind = 'avoid_obstacle'\nweight = 300\n";
    let mut helm = helm(&without_safety(program));
    // According to its receiver, the boat passes north of the disc, but it stands still.
    let stopped = |tenth: u32| {
        let at_s = 0.1 * f64::from(tenth);
        alone(at_s, Boat::at(-2.9, 34.0).going(90.0, 0.0))
    };
    let courses_deg: Vec<f64> = (0..50)
        .map(|tenth| steered(&mut helm, &stopped(tenth)).0)
        .collect();
    assert!(courses_deg[10] < 90.0, "{courses_deg:?}");
    assert!((courses_deg[49] - 270.0).abs() < 0.51, "{courses_deg:?}");
}

#[test]
fn a_boat_of_a_fleet_starts_early_to_pass_a_teammate_port_to_port() {
    let program = "base = \"SCENARIOS/strategies/strategy_4_assigned.toml\"\n";
    let meeting = |mate: Boat| {
        let own = Boat::at(-40.0, 0.0).going(90.0, 2.5);
        let enemies = [Boat::at(75.0, 35.0), Boat::at(75.0, -35.0)];
        steered(
            &mut helm(&scenario(program)),
            &picture(0.0, [own, mate], enemies),
        )
        .0
    };
    let alone_deg = meeting(Boat::at(-75.0, -35.0));
    let course_deg = meeting(Boat::at(-4.0, 0.0).going(270.0, 2.5));
    assert!(
        course_deg > alone_deg + 5.0,
        "{course_deg}, alone {alone_deg}"
    );
}

#[test]
fn the_operation_region_turns_a_boat_back_and_recovers_it_slowly() {
    let program = "[behaviour.go]\nkind = 'waypoint'\npoints = [[300, 0]]\nspeed_m_s = 3\nweight = 50\n\
        [behaviour.stay]\nkind = 'op_region'\nhalt_m = 20\nbeyond_halt = 'stops'\nexit_s = 1\nentry_s = 1\nrecovery_speed_m_s = 0.5\nweight = 300\n";
    let mut helm = helm(&without_safety(program));
    let scene = |at_s: f64, x: f64| alone(at_s, Boat::at(x, 5.0).going(90.0, 2.0));
    let (course_deg, _) = steered(&mut helm, &scene(0.0, 0.0));
    assert!(
        (course_deg - 91.0).abs() < 1.0,
        "far inside, the waypoint decides"
    );
    let (course_deg, speed_m_s) = steered(&mut helm, &scene(1.0, 76.0));
    let outward_m_s = speed_m_s * libm::sin(course_deg.to_radians());
    assert!(
        outward_m_s <= 0.01,
        "near the edge it still goes outward: {outward_m_s} m/s"
    );
    let (_, speed_m_s) = steered(&mut helm, &scene(2.0, 81.0));
    assert!(
        speed_m_s > 0.6,
        "outside only for a moment, it returns at normal speed"
    );
    let (course_deg, speed_m_s) = steered(&mut helm, &scene(3.1, 81.0));
    assert!(
        (course_deg - 270.0).abs() < 0.51 && (speed_m_s - 0.5).abs() < 0.05,
        "{course_deg}, {speed_m_s}"
    );
    let far_out = decided(&mut helm, &scene(4.0, 101.0));
    assert_eq!(far_out.hold.as_deref(), Some("stopped by a behaviour"));
    let (_, speed_m_s) = steered(&mut helm, &scene(5.0, 79.0));
    assert!(
        (speed_m_s - 0.5).abs() < 0.05,
        "inside only for a moment, it is still recovering"
    );
    let (_, speed_m_s) = steered(&mut helm, &scene(6.1, 60.0));
    assert!(speed_m_s > 1.0, "inside for good: {speed_m_s}");
}

#[test]
fn a_point_within_the_turning_circle_does_not_hold_a_boat_in_an_orbit() {
    // The boat turns at 0.3 rad/s at most: at 1.5 m/s it follows a circle of radius 5 m, initially
    // around the first point.
    let points = "kind = 'waypoint'\npoints = [[0, 0], [60, 0]]\nspeed_m_s = 1.5\ncapture_radius_m = 1\nslip_radius_m = 2";
    let track = driven(
        points,
        Boat::at(-5.0, 0.0).going(0.0, 1.5),
        0.3,
        Boat::at(75.0, 35.0),
        600,
    );
    let farthest_m = track
        .iter()
        .map(|own| libm::hypot(own.x, own.y))
        .fold(0.0, f64::max);
    assert!(
        farthest_m > 25.0,
        "after a minute it is only {farthest_m} m from the first point"
    );
}

#[test]
fn who_looks_inside_sees_the_utilities() {
    let mut helm = helm(&only(
        "kind = 'waypoint'\npoints = ['enemy_flag']\nspeed_m_s = 2",
    ));
    assert!(
        decided(&mut helm, &here())
            .functions
            .iter()
            .all(|f| f.utilities.is_empty() && f.utility.is_none())
    );
    helm.show(true);
    let report = decided(&mut helm, &here());
    assert_eq!(report.functions.len(), 3);
    for function in &report.functions {
        assert_eq!(
            function.utilities.len(),
            report.courses * report.speeds,
            "{}",
            function.behaviour
        );
    }
    let it = report
        .functions
        .iter()
        .find(|f| f.behaviour == "it")
        .expect("the waypoint has a function");
    let utility = it.utility.expect("it was requested");
    let best = it.utilities.iter().copied().fold(0.0, f32::max);
    assert!(
        utility > 99.0 && (best - utility).abs() < 1e-3,
        "the waypoint's preference prevails: {utility}, {best}"
    );
    let value: f64 = report
        .functions
        .iter()
        .map(|f| f.weight * f64::from(f.utility.unwrap_or(0.0)))
        .sum();
    assert!(
        (value - report.value.expect("a value")).abs() < 0.1,
        "{value}, {:?}",
        report.value
    );
}

#[test]
fn a_proposal_is_heard_while_it_is_fresh() {
    let mut helm = helm(&only("kind = 'policy'\nttl_s = 1"));
    assert!(!is_active(&decided(&mut helm, &here())));
    helm.propose(agent::Proposal {
        at: SimTime::from_s(1.0),
        course_rad: 2.0,
        speed_m_s: 1.5,
    });
    for (at_s, heard) in [(1.0, true), (1.9, true), (2.1, false)] {
        let report = decided(&mut helm, &alone(at_s, Boat::at(0.0, 0.0)));
        assert_eq!(is_active(&report), heard, "{at_s} s");
        if heard {
            assert!((report.course_deg.expect("a course") - 2.0_f64.to_degrees()).abs() <= 0.51);
            assert!((report.speed_m_s.expect("a speed") - 1.5).abs() <= 0.044);
        }
    }
}

#[test]
fn safety_arbitrates_what_a_policy_proposes() {
    let program =
        "base = \"SCENARIOS/strategies/safety.toml\"\n[behaviour.learned]\nkind = \"policy\"\n";
    let advised = |picture: &Picture, (course_rad, speed_m_s): (f64, f64)| {
        let mut helm = helm(&scenario(program));
        helm.propose(agent::Proposal {
            at: SimTime::ZERO,
            course_rad,
            speed_m_s,
        });
        let (course_deg, speed_m_s) = steered(&mut helm, picture);
        (course_deg.to_radians(), speed_m_s)
    };
    let east = (std::f64::consts::FRAC_PI_2, 3.0);
    let (course_rad, speed_m_s) = advised(&alone(0.0, Boat::at(0.0, 0.0).going(90.0, 2.0)), east);
    assert!(
        (course_rad - east.0).abs() < 0.01 && (speed_m_s - 3.0).abs() < 0.05,
        "in open water the proposal is followed"
    );
    let (course_rad, speed_m_s) = advised(&alone(0.0, Boat::at(74.0, 0.0).going(90.0, 2.0)), east);
    assert!(
        speed_m_s * libm::sin(course_rad) < 0.1,
        "it leaves the field: {course_rad} rad, {speed_m_s} m/s"
    );
    let ahead = with_contact(Boat::at(0.0, 0.0).going(90.0, 2.0), Boat::at(14.0, 0.0));
    let (course_rad, speed_m_s) = advised(&ahead, east);
    // The boat keeps its motion for a moment, then follows the decision for the eight seconds of
    // the look-ahead.
    let places = (0..=80).map(|i| 0.1 * f64::from(i) * speed_m_s);
    let from_m = |run_m: f64| {
        (
            run_m * libm::cos(course_rad),
            14.0 - 2.0 * 0.7 - run_m * libm::sin(course_rad),
        )
    };
    let miss_m = places
        .map(|run_m| primitives::math::length(from_m(run_m).0, from_m(run_m).1))
        .fold(f64::INFINITY, f64::min);
    assert!(
        miss_m > 4.9,
        "too close to a boat: {course_rad} rad, {speed_m_s} m/s, {miss_m} m"
    );
}

#[test]
fn a_full_stop_lies_still_and_lets_safety_have_its_way() {
    let stop = "[behaviour.stop]\nkind = \"full_stop\"\n";
    let alone_it_is = decided(&mut helm(&without_safety(stop)), &here());
    assert_eq!(
        alone_it_is.hold.as_deref(),
        Some("no behaviour prefers a course")
    );
    let go =
        "[behaviour.go]\nkind = \"waypoint\"\npoints = [[60, 0]]\nspeed_m_s = 2\nweight = 50\n";
    let against = decided(&mut helm(&without_safety(&format!("{stop}{go}"))), &here());
    assert_eq!(against.speed_m_s, Some(0.0));
    let safely = scenario(&format!(
        "base = \"SCENARIOS/strategies/safety.toml\"\n{stop}"
    ));
    let drifting = decided(
        &mut helm(&safely),
        &alone(0.0, Boat::at(79.5, 0.0).going(270.0, 0.0)),
    );
    assert!(
        drifting.speed_m_s.is_some_and(|speed_m_s| speed_m_s > 0.5),
        "{drifting:?}"
    );
}

#[test]
fn a_boat_that_came_too_near_halts_until_it_is_released() {
    let behaviour = "kind = 'avoid_collision'\nhalt_m = 3\nrelease_m = 10\nrelease_s = 30";
    let mut helm = helm(&only(behaviour));
    let mut halts = |at_s: f64, contact_m: f64| {
        let mut scene = with_contact(Boat::at(0.0, 0.0).going(0.0, 1.0), Boat::at(contact_m, 0.0));
        set_time(&mut scene, at_s);
        decided(&mut helm, &scene).hold.is_some()
    };
    for (at_s, contact_m, want) in [
        (0.0, 3.1, false),
        (0.1, 2.9, true),
        (5.0, 9.9, true),
        // Released because of the distance.
        (6.0, 10.1, false),
        (7.0, 4.0, false),
        (8.0, 2.0, true),
        (37.9, 2.0, true),
        // Released because of the time: it does not halt again until it has been clear.
        (38.0, 2.0, false),
        (39.0, 1.0, false),
        (40.0, 11.0, false),
        (41.0, 2.0, true),
    ] {
        assert_eq!(
            halts(at_s, contact_m),
            want,
            "at {at_s} s with a boat at {contact_m} m"
        );
    }
}
