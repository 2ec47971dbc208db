//! Whole Squall games in one process: no network, no clock.
//!
//! The same world and the same minds as across processes, and the same bytes.

pub mod identify;
pub mod tournament;
pub mod trial;

use agent::Mind;
use game::message::Word;
use game::{Outcome, Scenario, VehicleId};
use sim::Contest;
use sim::NoStart;

/// Plays the game of `scenario` that `seed` chooses to its end. `minds` are by vehicle.
///
/// # Errors
/// [`NoStart`] where the boats do not fit into their spawn area, numbers drawn by lot do not go together, or boats are
/// real ones.
///
/// # Panics
/// If there is not one mind for each vehicle.
pub fn play(scenario: &Scenario, minds: &mut [Box<dyn Mind>], seed: u64) -> Result<Outcome, NoStart> {
    play_watched(scenario, minds, seed, |_| true)
}

/// As [`play`], but shows the contest to `watch` before every decision and at the end, and stops when that says `false`.
///
/// # Errors
/// [`NoStart`] where the boats do not fit into their spawn area, numbers drawn by lot do not go together, or boats are
/// real ones.
///
/// # Panics
/// If there is not one mind for each vehicle.
pub fn play_watched(
    scenario: &Scenario,
    minds: &mut [Box<dyn Mind>],
    seed: u64,
    mut watch: impl FnMut(&mut Contest) -> bool,
) -> Result<Outcome, NoStart> {
    assert_eq!(minds.len(), scenario.vehicles.len(), "one mind a vehicle");
    scenario.has_no_real_boats()?;
    let mut contest = Contest::new(scenario, seed)?;
    let mut talk = Talk::default();
    while watch(&mut contest) && !contest.is_over() {
        decide(&mut contest, minds, &mut talk);
        contest.advance();
    }
    Ok(contest.outcome())
}

/// What minds tell their teams between two decisions.
#[derive(Debug, Default)]
pub struct Talk {
    words: Vec<Word>,
}

/// Shows every mind its team's picture and puts its order in force. What minds say then, their mates know at the next
/// decision.
pub fn decide(contest: &mut Contest, minds: &mut [Box<dyn Mind>], talk: &mut Talk) {
    contest.pictures();
    for (i, mind) in minds.iter_mut().enumerate() {
        let order = mind.decide(contest.picture_of(VehicleId::at(i)));
        // As over the network: an order with bad numbers is refused, and the boat holds.
        contest.order(VehicleId::at(i), order.check().unwrap_or_default());
    }
    talk.words.clear();
    minds.iter().for_each(|mind| mind.say(&mut talk.words));
    if !talk.words.is_empty() {
        // Words of the other team are nothing to a mind: it listens to its mates.
        minds.iter_mut().for_each(|mind| mind.hear(&talk.words));
    }
}
