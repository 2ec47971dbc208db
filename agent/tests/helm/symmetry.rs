//! A game rotated by half a turn, or with teams exchanged, gives decisions rotated by half a turn.

use crate::scene::{Boat, picture, scenario};
use agent::{HelmMind, Mind, roles};
use messages::{Order, Picture};
use primitives::stream::Stream;
use primitives::{TeamId, VehicleId};

/// The same scene seen by the other team: rotated by half a turn about the datum, which is the
/// centre of the field.
fn turned(picture: &Picture) -> Picture {
    let mut other = picture.clone();
    other.team = 1 - picture.team;
    let swap = |vehicle: VehicleId| VehicleId((vehicle.0 + 2) % 4);
    let half_a_turn = |psi_rad: f64| primitives::angle::wrap_pi(psi_rad + std::f64::consts::PI);
    for own in &mut other.own {
        own.vehicle = swap(own.vehicle);
        (own.nav.north_m, own.nav.east_m) = (-own.nav.north_m, -own.nav.east_m);
        own.nav.psi_rad = half_a_turn(own.nav.psi_rad);
    }
    for contact in &mut other.contacts {
        contact.vehicle = swap(contact.vehicle);
        contact.team = TeamId(1 - contact.team.0);
        (contact.north_m, contact.east_m) = (-contact.north_m, -contact.east_m);
        contact.psi_rad = half_a_turn(contact.psi_rad);
        contact.velocity_north_m_s *= -1.0;
        contact.velocity_east_m_s *= -1.0;
    }
    other.flags.reverse();
    for flag in &mut other.flags {
        flag.carrier = if flag.carrier < 0 {
            -1
        } else {
            (flag.carrier + 2) % 4
        };
    }
    other.score.reverse();
    other
}

/// A random scene on the field, sometimes with a boat tagged or carrying.
fn random(stream: &mut Stream) -> Picture {
    let mut boat = || {
        let place = Boat::at(stream.between(-79.0, 79.0), stream.between(-39.0, 39.0));
        place.going(stream.between(0.0, 360.0), stream.between(0.0, 3.0))
    };
    let mut scene = picture(10.0, [boat(), boat()], [boat(), boat()]);
    match stream.below(4) {
        0 => scene.own[0].tagged = true,
        1 => (scene.own[0].carrying, scene.flags[1].carrier) = (1, 0),
        2 => (scene.contacts[0].carrying, scene.flags[0].carrier) = (0, 2),
        _ => {}
    }
    scene
}

#[test]
fn a_scene_turned_by_half_a_turn_gives_a_decision_turned_by_half_a_turn() {
    let mut stream = Stream::new(4, "symmetry");
    for strategy in [
        "strategy_4",
        "medium_attacker",
        "medium_defender",
        "easy_defender",
    ] {
        let scenario = scenario(&format!(
            "base = \"SCENARIOS/strategies/{strategy}.toml\"\n"
        ));
        let decide = |vehicle: u16, picture: &Picture| {
            let vehicle = VehicleId(vehicle);
            HelmMind::new(&scenario, vehicle, roles::role_of(&scenario, vehicle)).decide(picture)
        };
        for scene in 0..500 {
            let picture = random(&mut stream);
            let here = decide(0, &picture);
            let there = decide(2, &turned(&picture));
            match (here, there) {
                (Order::Hold, Order::Hold) => {}
                (
                    Order::Steer {
                        heading_rad: a,
                        speed_m_s: u,
                    },
                    Order::Steer {
                        heading_rad: b,
                        speed_m_s: v,
                    },
                ) => {
                    let off_deg = primitives::angle::wrap_pi(b - a - std::f64::consts::PI)
                        .to_degrees()
                        .abs();
                    assert!(
                        off_deg < 1e-6 && u == v,
                        "{strategy}, scene {scene}: {here:?}, and turned {there:?}: {picture:#?}"
                    );
                }
                _ => panic!("{strategy}, scene {scene}: {here:?}, and turned {there:?}"),
            }
        }
    }
}
