//! The end of a game.

use crate::preset::{aquaticus_2023, pyquaticus};
use crate::scene::{Scene, captured, ended, grabbed};
use game::rules::{Points, Rules};

#[test]
fn a_team_with_the_winning_score_wins() {
    let mut scene = Scene::new(Rules { win_score: Some(3), ..aquaticus_2023() }, 1);
    assert_eq!(scene.put(0, 140.0, 40.0).look(), [grabbed(0, 1)]);
    assert_eq!(scene.put(0, 20.0, 40.0).look(), [captured(0, 1), ended(Some(0))]);
    assert!(scene.standing.over);
}

#[test]
fn at_the_time_limit_the_higher_score_wins_and_equal_scores_are_a_draw() {
    for (grabbers, want) in [(vec![], None), (vec![0], Some(0)), (vec![1], Some(1)), (vec![0, 1], None)] {
        let mut scene = Scene::new(aquaticus_2023(), 1);
        for vehicle in grabbers {
            let (x, _) = [(140.0, 0), (20.0, 1)][vehicle];
            scene.put(vehicle, x, 40.0).look();
        }
        scene.now = game::SimTime::ZERO;
        assert_eq!(scene.wait(599.9).look(), []);
        assert_eq!(scene.look(), [ended(want)]);
    }
}

#[test]
fn two_teams_that_reach_the_winning_score_at_once_are_parted_by_score_or_draw() {
    for (own, want) in [(vec![0, 1], Some(0)), (vec![0], None)] {
        let mut scene = Scene::new(
            Rules { win_score: Some(1), points: Points { tag: 1, ..pyquaticus().points }, ..pyquaticus() },
            3,
        );
        scene.put(0, 140.0, 40.0).put(3, 20.0, 40.0).look();
        for vehicle in own.iter().skip(1) {
            scene.put(*vehicle, 60.0, 70.0).put(4, 65.0, 70.0);
        }
        let events = scene.put(0, 78.0, 30.0).put(3, 82.0, 50.0).look();
        assert!(events.contains(&captured(0, 1)) && events.contains(&captured(3, 0)), "{events:?}");
        assert_eq!(events.last(), Some(&ended(want)));
    }
}

#[test]
fn after_the_end_nothing_happens() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.wait(600.0).look(), [ended(None)]);
    let standing = scene.standing.clone();
    assert_eq!(scene.put(0, 140.0, 40.0).put(1, -5.0, 40.0).look(), []);
    assert_eq!(scene.standing, standing);
}
