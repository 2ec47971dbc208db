//! Boats in current and wind: the drift estimated by their helms, and where the boats end up in
//! spite of it.

use crate::files::{loaded, watch};
use primitives::{Ned, VehicleId};
use scenario::{Scenario, StartPosition};
use sim::Contest;

/// Speed of the point boat of these tests through the water, m/s.
const SPEED_M_S: f64 = 2.0;

/// A point boat that reaches speed and heading almost instantly: [`SPEED_M_S`] at two thirds of its
/// thrust.
const QUICK_BOAT: &str = "base = \"SCENARIOS/boats/surveyor_kinematic.toml\"\n\
    [kinematic]\nthrust_map = [[-100, -3.0], [0, 0], [100, 3.0]]\nspeed_factor = 33.333333333333336\nturn_rate = 20\n\
    turn_loss = 0\nheading_pid = { p = 4, d = 0 }\nacceleration_max_m_s2 = 0\ndeceleration_max_m_s2 = 0\n";

/// Blue has one boat in open water at (300, 200) m; red's is far away.
fn scenario(boat: &str, sea: &str, strategy: &str, heading_deg: f64) -> Scenario {
    let game = format!(
        "base = \"SCENARIOS/games/attack_1v1.toml\"\nfield = \"SCENARIOS/fields/open_800x400.toml\"\n\
         sea = \"sea.toml\"\ntick_s = 0.05\nduration_s = 600\n\
         [[team]]\nname = \"blue\"\nstrategy = \"strategy.toml\"\n\
         [[team]]\nname = \"red\"\nstrategy = \"SCENARIOS/strategies/idle.toml\"\n\
         [[vehicle]]\nname = \"blue_one\"\nteam = \"blue\"\nboat = \"boat.toml\"\nat = [300, 200]\nheading_deg = {heading_deg}\n\
         [[vehicle]]\nname = \"red_one\"\nteam = \"red\"\nat = [790, 390]\n"
    );
    loaded(&[
        ("game.toml", game.as_str()),
        ("sea.toml", sea),
        ("boat.toml", boat),
        ("strategy.toml", strategy),
    ])
}

/// Calm water with this current.
fn current(speed_m_s: f64, toward_deg: f64) -> String {
    format!(
        "base = \"SCENARIOS/seas/calm.toml\"\n[current]\nspeed_m_s = {speed_m_s}\ntoward_deg = {toward_deg}\n"
    )
}

fn blue_at(contest: &Contest) -> Ned {
    contest.world().state().boats[0].pose.at
}

/// A boat's path to a point 200 m east across a current of 0.5 m/s towards the north. Returns its
/// distances from the straight line by the remaining distance along it (m), and the duration (s).
fn crossing(compensate_drift: bool) -> (Vec<(f64, f64)>, f64) {
    let strategy = format!(
        "base = \"SCENARIOS/strategies/safety.toml\"\nabout = \"crosses\"\nhelm = {{ hysteresis = 0, compensate_drift = {compensate_drift} }}\n\
         [behaviour.cross]\nkind = \"waypoint\"\npoints = [[500, 200]]\nspeed_m_s = {SPEED_M_S}\ncapture_radius_m = 1\n\
         weight = 100\n"
    );
    let scenario = scenario(QUICK_BOAT, &current(0.5, 0.0), &strategy, 90.0);
    let start = Contest::new(&scenario, 1)
        .map(|contest| blue_at(&contest))
        .expect("a start");
    let mut track = Vec::new();
    let mut time_s = 0.0;
    watch(&scenario, |contest, _| {
        let way = blue_at(contest) - start;
        time_s = contest.now().as_s();
        track.push((200.0 - way.east, way.north));
        way.east < 199.0 && time_s < 300.0
    });
    (track, time_s)
}

#[test]
fn a_boat_that_only_points_at_its_goal_drifts_along_the_curve_of_pursuit() {
    // Let k be the ratio of current to speed through the water, and a the distance to the goal,
    // across the current. Then y = a/2 ((x/a)^(1-k) - (x/a)^(1+k)), as for a boat rowed to the
    // other bank (Boole 1859, ch. XI).
    let k = 0.5 / SPEED_M_S;
    let curve_m = |to_go_m: f64| {
        let share = (to_go_m / 200.0).clamp(0.0, 1.0);
        100.0 * (libm::pow(share, 1.0 - k) - libm::pow(share, 1.0 + k))
    };
    let (track, _) = crossing(false);
    for (to_go_m, off_m) in track.iter().filter(|(to_go_m, _)| *to_go_m > 5.0) {
        assert!(
            (off_m - curve_m(*to_go_m)).abs() < 1.0,
            "{to_go_m} m to go: {off_m} m, {} m",
            curve_m(*to_go_m)
        );
    }
    let farthest_m = track.iter().map(|(_, off_m)| *off_m).fold(0.0, f64::max);
    assert!(
        (farthest_m - 18.6).abs() < 1.0,
        "{farthest_m} m off the line"
    );
}

#[test]
fn a_boat_crosses_a_current_on_a_straight_line() {
    let (track, time_s) = crossing(true);
    let farthest_m = track
        .iter()
        .map(|(_, off_m)| off_m.abs())
        .fold(0.0, f64::max);
    assert!(farthest_m < 2.0, "{farthest_m} m off the line");
    // The velocity over the ground with the crab angle: sqrt(V² - c²).
    let want_s = 199.0 / (SPEED_M_S * SPEED_M_S - 0.25_f64).sqrt();
    assert!(
        (time_s - want_s).abs() < 0.03 * want_s,
        "{time_s} s, {want_s} s"
    );
}

#[test]
fn a_helm_sees_the_current_that_there_is() {
    let triangle = "base = \"SCENARIOS/strategies/safety.toml\"\nabout = \"goes round\"\n\
        [behaviour.round]\nkind = \"waypoint\"\npoints = [[340, 200], [320, 240], [300, 200]]\nspeed_m_s = 2\n\
        perpetual = true\nweight = 100\n";
    for boat in ["surveyor_m1_8", "heron", "surveyor_kinematic"] {
        for (speed_m_s, toward_deg) in [(0.0, 0.0), (0.4, 30.0), (0.5, 250.0)] {
            let file = format!("base = \"SCENARIOS/boats/{boat}.toml\"\n");
            let scenario = scenario(&file, &current(speed_m_s, toward_deg), triangle, 90.0);
            let mut off_m_s: Vec<f64> = Vec::new();
            watch(&scenario, |contest, runner| {
                let truth = contest.world().sea().current_at(blue_at(contest));
                let seen = runner
                    .mind(VehicleId(0))
                    .and_then(|mind| mind.report())
                    .expect("a helm reports")
                    .drift;
                if contest.now().as_s() > 120.0 {
                    off_m_s.push(truth.distance(Ned {
                        north: seen.north_m_s,
                        east: seen.east_m_s,
                    }));
                }
                contest.now().as_s() < 240.0
            });
            let mean_m_s = off_m_s.iter().sum::<f64>() / off_m_s.len() as f64;
            assert!(
                mean_m_s < 0.1,
                "{boat}, {speed_m_s} m/s towards {toward_deg}: off by {mean_m_s} m/s"
            );
        }
    }
}

#[test]
fn a_boat_outside_comes_back_against_a_wind_that_drifts_it_faster_than_its_recovery_speed() {
    let strategy = "base = \"SCENARIOS/strategies/safety.toml\"\nabout = \"comes back\"\n\
        [behaviour.stay_in]\nrecovery_speed_m_s = 0.5\n";
    // At the lee edge of open water: a gale from the south-east over a bay makes a free boat drift
    // at 0.75 m/s.
    let boat = "base = \"SCENARIOS/boats/surveyor_m1_8.toml\"\n";
    let mut scenario = scenario(
        boat,
        "base = \"SCENARIOS/seas/bay_gale.toml\"\n",
        strategy,
        0.0,
    );
    let field = scenario.field.clone();
    scenario.vehicles[0].start_position = StartPosition::At(primitives::Pose {
        at: field.at(300.0, 415.0),
        psi_rad: 0.0,
    });
    let mut inside_s = None;
    watch(&scenario, |contest, _| {
        let (_, y) = field.along_across(blue_at(contest));
        if y < 400.0 {
            inside_s = Some(contest.now().as_s());
        }
        inside_s.is_none() && contest.now().as_s() < 200.0
    });
    // 15 m at 0.5 m/s takes 30 s; the rest is time to turn.
    assert!(inside_s.is_some_and(|s| s < 150.0), "{inside_s:?}");
}
