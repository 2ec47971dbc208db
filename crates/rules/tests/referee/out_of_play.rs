//! Boats that have been retired and are out of play.

use crate::preset::aquaticus_2023;
use crate::scene::{Scene, grabbed, lost};
use primitives::VehicleId;
use rules::{Directive, Event, Rules};

#[test]
fn a_boat_out_of_play_takes_no_part_and_loses_its_flag() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    let mut events = vec![];
    scene
        .referee
        .retire(&mut scene.standing, VehicleId(1), &mut events);
    assert_eq!(events, [lost(1, 0)]);
    for (x, y) in [(20.0, 40.0), (20.0, -40.0), (44.0, 7.0), (140.0, 40.0)] {
        let events = scene.put(1, x, y).look();
        assert!(
            events
                .iter()
                .all(|event| matches!(event, Event::Collided { .. })),
            "{x}, {y}: {events:?}"
        );
    }
    assert_eq!(scene.directive(1), Directive::Hold);
}

#[test]
fn boats_out_of_play_are_solid() {
    let mut scene = Scene::new(
        Rules {
            collision_distance_m: 4.0,
            ..aquaticus_2023()
        },
        2,
    );
    scene
        .referee
        .retire(&mut scene.standing, VehicleId(1), &mut vec![]);
    assert_eq!(
        scene.put(0, 50.0, 60.0).put(1, 52.0, 60.0).look(),
        [Event::Collided {
            first: VehicleId(0),
            second: VehicleId(1)
        }]
    );
}
