//! Boats too near: to each other, to their own flag.

use crate::preset::{aquaticus_2023, pyquaticus};
use crate::scene::{Scene, back, grabbed};
use game::rules::Rules;
use game::{Event, Ned, VehicleId};

fn solid() -> Rules {
    Rules { collision_distance_m: 4.0, ..aquaticus_2023() }
}

fn collided(first: u16, second: u16) -> Event {
    Event::Collided { first: VehicleId(first), second: VehicleId(second) }
}

#[test]
fn a_collision_counts_once_for_as_long_as_the_boats_stay_close() {
    let mut scene = Scene::new(solid(), 3);
    for (x, want) in
        [(54.0, vec![]), (53.9, vec![collided(0, 1)]), (51.0, vec![]), (54.0, vec![]), (53.0, vec![collided(0, 1)])]
    {
        assert_eq!(scene.put(0, 50.0, 60.0).put(1, x, 60.0).look(), want, "{x}");
    }
    assert_eq!(scene.put(2, 51.0, 60.0).look(), [collided(0, 2), collided(1, 2)]);
    assert_eq!(scene.standing.touching.len(), 3);
    assert_eq!(scene.put(0, 20.0, 20.0).look(), []);
    assert_eq!(scene.standing.touching, [(VehicleId(1), VehicleId(2))]);
    assert_eq!(scene.put(0, 50.0, 60.0).look(), [collided(0, 1), collided(0, 2)]);
}

#[test]
fn boats_out_of_play_are_solid() {
    let mut scene = Scene::new(solid(), 2);
    scene.referee.retire(&mut scene.standing, VehicleId(1), &mut vec![]);
    assert_eq!(scene.put(0, 50.0, 60.0).put(1, 52.0, 60.0).look(), [collided(0, 1)]);
}

#[test]
fn the_reach_covers_tags_and_collisions() {
    for (tag_radius_m, collision_distance_m, want_m) in [(10.0, 4.0, 10.0), (1.0, 4.0, 4.0)] {
        let scene = Scene::new(Rules { tag_radius_m, collision_distance_m, ..aquaticus_2023() }, 1);
        assert_eq!(scene.referee.rules().reach_m(), want_m);
    }
}

#[test]
fn defenders_are_kept_from_their_flag_only_while_it_is_home() {
    let entered = Event::EnteredKeepout { vehicle: VehicleId(0) };
    let mut scene = Scene::new(pyquaticus(), 1);
    let circle = |scene: &Scene| scene.referee.keepout(&scene.standing, VehicleId(0), scene.fleet[0]);
    assert_eq!(scene.put(0, 25.0, 40.0).look(), []);
    assert_eq!(scene.put(0, 24.9, 40.0).look(), [entered]);
    assert_eq!(scene.put(0, 22.0, 40.0).look(), []);
    assert_eq!(circle(&scene), Some((Ned::from_xy(20.0, 40.0), 5.0)));
    assert_eq!(scene.put(0, 45.0, 5.0).put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    assert_eq!(circle(&scene), None);
    assert_eq!(scene.put(0, 18.0, 40.0).put(1, 60.0, 60.0).look(), []);
    let events = scene.put(1, 60.0, -1.0).look();
    assert_eq!(events.last(), Some(&entered), "caught in the circle when the flag came home");
    assert_eq!(scene.put(1, 22.0, 40.0).look(), [back(1)], "the circle is for defenders only");
}
