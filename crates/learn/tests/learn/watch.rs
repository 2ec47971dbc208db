//! Watched games: their inputs suffice to replay them bit for bit.

use super::fixture::{checked, file, raw, written};
use agent::Action;
use learn::environment::{Games, Moment, ObservationSpace, RawObservation, RawSetup, Watch};
use messages::Frame;
use messages::input::Input;
use rules::event::EventCursor;
use scenario::{Outcome, Scenario};
use sim::Contest;
use std::sync::{Arc, Mutex};

/// A watched game: every frame, with the inputs before it.
#[derive(Default)]
struct Seen {
    number: u64,
    scenario: Option<Scenario>,
    cursor: EventCursor,
    decisions: Vec<(Vec<Input>, Frame)>,
    outcome: Option<Outcome>,
}

impl Seen {
    fn see(&mut self, contest: &mut Contest, moment: Moment) {
        contest.keep_inputs();
        match moment {
            Moment::Decision => {
                self.scenario
                    .get_or_insert_with(|| contest.scenario().clone());
                self.decisions
                    .push((contest.take_inputs(), contest.frame(&mut self.cursor)));
            }
            Moment::End => self.outcome = Some(contest.outcome()),
        }
    }

    /// Replays the game and compares every frame.
    fn check(&self) {
        let scenario = self.scenario.as_ref().expect("the game has begun");
        let seed = scenario.seed;
        let mut contest =
            Contest::new(scenario, seed).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let mut cursor = EventCursor::default();
        for (inputs, frame) in &self.decisions {
            inputs.iter().for_each(|input| contest.give(*input));
            assert_eq!(*frame, contest.frame(&mut cursor), "seed {seed}");
        }
        if let Some(outcome) = &self.outcome {
            assert_eq!(*outcome, contest.outcome(), "seed {seed}");
        }
    }
}

/// Plays this many steps of 2 s games in wind and waves. Returns the watched ones.
fn seen(
    starts: Option<u32>,
    steps: usize,
    every: u64,
    play: impl Fn(&mut Games, usize),
) -> Vec<Arc<Mutex<Seen>>> {
    let raw = RawSetup {
        game: file("games/surveyor_2v2.toml"),
        observation: RawObservation::Space(ObservationSpace::Pyquaticus),
        episode_max_s: Some(2.0),
        starts,
        rewards: None,
        ..raw()
    };
    let all: Arc<Mutex<Vec<Arc<Mutex<Seen>>>>> = Arc::default();
    let kept = Arc::clone(&all);
    let watches = move |number: u64| {
        number.is_multiple_of(every).then(|| -> Watch {
            let seen = Arc::new(Mutex::new(Seen {
                number,
                ..Seen::default()
            }));
            kept.lock()
                .expect("no thread has panicked")
                .push(Arc::clone(&seen));
            Box::new(move |contest, moment| {
                seen.lock()
                    .expect("no thread has panicked")
                    .see(contest, moment)
            })
        })
    };
    let games = Games::new(checked(&raw), 2, 2, 5, Some(Arc::new(watches)));
    let mut games = games.unwrap();
    (0..steps).for_each(|step| play(&mut games, step));
    drop(games);
    std::mem::take(&mut *all.lock().expect("no thread has panicked"))
}

fn step(games: &mut Games, step: usize) {
    written(games, |games, rows| {
        let actions: Vec<Action> = (0..games.rows().0)
            .map(|row| Action::Discrete((3 * step + row) % 17))
            .collect();
        games.step(&actions, true, rows).expect("new games begin");
    });
}

#[test]
fn games_are_seen_from_their_first_moment_to_their_end() {
    for starts in [None, Some(3)] {
        let games = seen(starts, 9, 1, step);
        assert_eq!(
            games.len(),
            6,
            "two complete games in each of two slots, and two that have begun"
        );
        for game in &games {
            let game = game.lock().expect("no thread has panicked");
            game.check();
            let is_whole = game.number < 4;
            assert_eq!(
                (game.outcome.is_some(), game.decisions.len()),
                (is_whole, if is_whole { 21 } else { 6 })
            );
        }
    }
}

#[test]
fn only_the_chosen_games_are_seen() {
    let numbers = |games: &[Arc<Mutex<Seen>>]| -> Vec<u64> {
        games
            .iter()
            .map(|game| game.lock().expect("no thread has panicked").number)
            .collect()
    };
    assert_eq!(numbers(&seen(None, 12, 4, step)), [0, 4]);
}

#[test]
fn a_game_that_is_given_up_is_seen_up_to_there_and_nothing_after_the_watches_end() {
    let games = seen(None, 6, 1, |games, i| {
        step(games, i);
        match i {
            1 => games.restart(Some(40)).expect("new games begin"),
            3 => games.end_watches(),
            _ => {}
        }
    });
    assert_eq!(games.len(), 4);
    for game in &games {
        let game = game.lock().expect("no thread has panicked");
        game.check();
        assert_eq!(
            (game.outcome.is_none(), game.decisions.len()),
            (true, 11),
            "two steps of five decisions"
        );
    }
}
