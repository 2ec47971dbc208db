//! Power play: one boat of each team temporarily out of action.

use crate::preset::mctf_2026;
use crate::scene::{Scene, freed, grabbed, tagged};
use primitives::stream::Stream;
use primitives::{SimTime, VehicleId};
use rules::{Directive, Event, Rules};

fn disabled(vehicle: u16) -> Event {
    Event::Disabled(VehicleId(vehicle))
}

/// The drawn windows in order of time: from, until, vehicle.
fn windows(scene: &Scene, seed: u64) -> Vec<(SimTime, SimTime, usize)> {
    let standing = scene.referee.start(&mut Stream::new(seed, "rules"));
    let drawn = standing
        .disabled
        .iter()
        .enumerate()
        .filter(|(_, (from, _))| *from < SimTime::NEVER);
    let mut drawn: Vec<_> = drawn
        .map(|(vehicle, (from, until))| (*from, *until, vehicle))
        .collect();
    drawn.sort_unstable();
    drawn
}

#[test]
fn one_boat_of_each_team_is_drawn_and_never_two_at_once() {
    let scene = Scene::new(mctf_2026(), 3);
    let mut drawn = [0; 6];
    let mut first_team_first = 0;
    for seed in 0..600 {
        let windows = windows(&scene, seed);
        let [(from_a, until_a, a), (from_b, until_b, b)] = windows[..] else {
            panic!("seed {seed}: {windows:?}")
        };
        assert!(
            SimTime::ZERO <= from_a && until_a <= from_b && until_b <= SimTime::from_s(600.0),
            "seed {seed}"
        );
        assert_eq!(
            (until_a - from_a, until_b - from_b),
            (SimTime::from_s(120.0), SimTime::from_s(120.0))
        );
        assert_ne!(a / 3, b / 3, "seed {seed}");
        drawn[a] += 1;
        drawn[b] += 1;
        first_team_first += u32::from(a < 3);
    }
    assert!(
        drawn.iter().all(|count| (150..250).contains(count)),
        "{drawn:?}"
    );
    assert!((250..350).contains(&first_team_first), "{first_team_first}");
}

#[test]
fn the_same_stream_draws_the_same_and_a_short_game_is_shared_out() {
    let scene = Scene::new(mctf_2026(), 3);
    assert_eq!(windows(&scene, 5), windows(&scene, 5));
    assert_ne!(windows(&scene, 5), windows(&scene, 6));
    let short = Scene::new(
        Rules {
            time_limit: SimTime::from_s(100.0),
            ..mctf_2026()
        },
        3,
    );
    let seconds: Vec<_> = windows(&short, 5)
        .iter()
        .map(|(from, until, _)| (from.as_s(), until.as_s()))
        .collect();
    assert_eq!(seconds, [(0.0, 50.0), (50.0, 100.0)]);
}

#[test]
fn a_reinforcement_holds_until_it_joins_even_in_power_play() {
    let mut scene = Scene::new(mctf_2026(), 2);
    scene.standing.disabled = vec![(SimTime::from_s(15.0), SimTime::from_s(25.0)); 4];
    scene.referee.joins[3] = SimTime::from_s(20.0);
    assert_eq!(
        scene.put(0, 60.0, 40.0).put(1, 60.0, 60.0).look(),
        [disabled(3)]
    );
    assert_eq!(scene.directive(3), Directive::Hold);
    assert_eq!(scene.directive(2), Directive::Free { speed_factor: 1.0 });
    let all = [disabled(0), disabled(1), disabled(2)];
    assert_eq!(scene.wait(15.0).look(), all);
    assert_eq!(scene.wait(9.8).look(), []);
    let all: Vec<Event> = (0..4).map(|i| Event::Enabled(VehicleId(i))).collect();
    assert_eq!(scene.look(), all);
}

#[test]
fn a_boat_out_of_action_holds_and_neither_tags_nor_grabs_but_can_be_tagged() {
    let mut scene = Scene::new(mctf_2026(), 2);
    scene.standing.disabled = vec![(SimTime::NEVER, SimTime::NEVER); 4];
    scene.standing.disabled[0] = (SimTime::from_s(10.0), SimTime::from_s(20.0));
    assert_eq!(scene.put(0, 60.0, 40.0).wait(10.0).look(), [disabled(0)]);
    assert_eq!(scene.directive(0), Directive::Hold);
    assert_eq!(scene.put(2, 65.0, 40.0).look(), [], "it cannot tag");
    scene.put(2, 115.0, 5.0);
    assert_eq!(scene.put(0, 140.0, 40.0).look(), [], "it cannot grab");
    assert_eq!(scene.put(2, 135.0, 40.0).look(), [tagged(0, 2)]);
    assert_eq!(scene.put(2, 115.0, 5.0).put(0, 5.0, 5.0).look(), [freed(0)]);
    scene.now = SimTime::ZERO;
    assert_eq!(scene.put(0, 140.0, 40.0).wait(19.9).look(), []);
    assert_eq!(scene.look(), [Event::Enabled(VehicleId(0)), grabbed(0, 1)]);
    assert_eq!(scene.directive(0), Directive::Free { speed_factor: 1.0 });
}
