//! Boats on crossing paths: they keep clear of each other, and do not both turn into each other's
//! path.

use crate::files::{loaded, watch};
use analysis::HullRectangle;
use primitives::stream::Stream;
use primitives::{Ned, VehicleId};
use scenario::Scenario;

/// Where their paths cross: along and across the field, m.
const MIDDLE_M: (f64, f64) = (400.0, 200.0);
/// Their initial distance from that point, m.
const START_M: f64 = 45.0;

/// Two teammates in calm water, each heading through the middle to the other side.
fn encounter(stream: &mut Stream) -> Scenario {
    let mut game = "base = \"SCENARIOS/games/attack_1v1.toml\"\nfield = \"SCENARIOS/fields/open_800x400.toml\"\n\
         boat = \"SCENARIOS/boats/surveyor_m1_8.toml\"\nsea = \"SCENARIOS/seas/calm.toml\"\nduration_s = 60\n\
         [[team]]\nname = \"blue\"\nstrategy = \"team.toml\"\n\
         [[team]]\nname = \"red\"\nstrategy = \"SCENARIOS/strategies/idle.toml\"\n\
         [[vehicle]]\nname = \"red_one\"\nteam = \"red\"\nat = [790, 390]\n"
        .to_owned();
    let mut files = vec![(
        "team.toml",
        "about = \"Two\"\nroles = [\"blue_one.toml\", \"blue_two.toml\"]\n".to_owned(),
    )];
    let speed_m_s = stream.between(1.5, 3.0);
    let one_deg = stream.between(0.0, 360.0);
    let other_deg = one_deg + stream.between(40.0, 320.0);
    for (name, file, way_deg) in [
        ("blue_one", "blue_one.toml", one_deg),
        ("blue_two", "blue_two.toml", other_deg),
    ] {
        let beside_m = stream.between(-4.0, 4.0);
        let (sin, cos) = primitives::math::sin_cos(f64::to_radians(way_deg));
        let place = |way_m: f64| {
            (
                MIDDLE_M.0 + way_m * cos - beside_m * sin,
                MIDDLE_M.1 + way_m * sin + beside_m * cos,
            )
        };
        let from = place(-START_M);
        let to = place(2.0 * START_M);
        let heading_deg = f64::rem_euclid(90.0 - way_deg, 360.0);
        game += &format!(
            "[[vehicle]]\nname = \"{name}\"\nteam = \"blue\"\nat = [{}, {}]\nheading_deg = {}\n",
            from.0, from.1, heading_deg
        );
        let strategy = format!(
            "base = \"SCENARIOS/strategies/safety.toml\"\nabout = \"Across\"\n[behaviour.across]\nkind = \"waypoint\"\n\
             points = [[{}, {}]]\nspeed_m_s = {speed_m_s}\nweight = 50\n",
            to.0, to.1
        );
        files.push((file, strategy));
    }
    files.push(("game.toml", game));
    loaded(&files)
}

/// The closest distance between the two (m), and whether their hulls touch.
fn nearest(scenario: &Scenario) -> (f64, bool) {
    let boats: Vec<VehicleId> = (0..scenario.vehicles.len())
        .map(VehicleId::at)
        .filter(|boat| scenario.vehicles[boat.index()].name.starts_with("blue"))
        .collect();
    let mut nearest_m = f64::INFINITY;
    let mut touch = false;
    watch(scenario, |contest, _| {
        let hull = |vehicle: VehicleId| {
            let boat = scenario.boat_of(vehicle);
            let pose = contest.world().state().boats[vehicle.index()].pose;
            HullRectangle {
                pose,
                length_m: boat.length_m,
                beam_m: boat.beam_m,
            }
        };
        let one = hull(boats[0]);
        let other = hull(boats[1]);
        nearest_m = nearest_m.min(Ned::distance(one.pose.at, other.pose.at));
        touch |= one.overlaps(&other);
        true
    });
    (nearest_m, touch)
}

#[test]
fn boats_whose_ways_cross_choose_different_sides() {
    let mut stream = Stream::new(1, "encounters");
    let mut touches = 0;
    let mut near = 0;
    let mut met = 0;
    for _ in 0..150 {
        let (nearest_m, touch) = nearest(&encounter(&mut stream));
        touches += u32::from(touch);
        near += u32::from(nearest_m < 4.0);
        met += u32::from(nearest_m < 30.0);
    }
    assert!(met > 120, "{met} of 150 met");
    assert!(
        touches == 0 && near <= 3,
        "{touches} of 150 touched, {near} came within 4 m"
    );
}
