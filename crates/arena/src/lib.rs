//! Whole Squall games in one process: no network, no clock.
//!
//! The world and the minds are the same as in games across processes, and so are the results, byte
//! for byte.

use agent::{Mind, MindRunner};
use primitives::VehicleId;
use scenario::{Outcome, Scenario};
use sim::Contest;
use sim::NoStart;

/// Plays the game of `scenario` with this seed to its end. `minds` are indexed by vehicle.
///
/// # Errors
/// [`NoStart`] if the boats do not fit into their spawn area, the randomised values are
/// inconsistent, or a boat is real.
///
/// # Panics
/// If the number of minds differs from the number of vehicles.
pub fn play(scenario: &Scenario, minds: Vec<Box<dyn Mind>>, seed: u64) -> Result<Outcome, NoStart> {
    play_watched(scenario, minds, seed, |_| true)
}

/// Like [`play`], with its errors and panics, but shows the contest to `watch` before every
/// decision and at the end. Stops when `watch` returns `false`.
pub fn play_watched(
    scenario: &Scenario,
    minds: Vec<Box<dyn Mind>>,
    seed: u64,
    mut watch: impl FnMut(&mut Contest) -> bool,
) -> Result<Outcome, NoStart> {
    play_observed(scenario, minds, seed, |contest, _| watch(contest))
}

/// Like [`play_watched`], but also passes the minds, in the state after their last decision. Errors
/// and panics are those of [`play`].
pub fn play_observed(
    scenario: &Scenario,
    minds: Vec<Box<dyn Mind>>,
    seed: u64,
    observe: impl FnMut(&mut Contest, &MindRunner) -> bool,
) -> Result<Outcome, NoStart> {
    assert_eq!(minds.len(), scenario.vehicles.len(), "one mind per vehicle");
    play_on(scenario, runner_of(minds), seed, observe)
}

/// Like [`play_observed`], with a runner of one mind per vehicle.
///
/// # Errors
/// As [`play`].
pub fn play_on(
    scenario: &Scenario,
    mut runner: MindRunner,
    seed: u64,
    mut observe: impl FnMut(&mut Contest, &MindRunner) -> bool,
) -> Result<Outcome, NoStart> {
    scenario.has_no_real_boats()?;
    let mut contest = Contest::new(scenario, seed)?;
    while observe(&mut contest, &runner) && !contest.is_over() {
        decide(&mut contest, &mut runner);
        contest.advance();
    }
    Ok(contest.outcome())
}

/// A runner for these minds, one per vehicle in the scenario's order.
pub fn runner_of<M: Mind + ?Sized>(minds: Vec<Box<M>>) -> MindRunner<M> {
    MindRunner::new(
        minds
            .into_iter()
            .enumerate()
            .map(|(i, mind)| (VehicleId::at(i), mind)),
    )
}

/// Passes its team's picture to every mind, and the mind's order to the contest.
pub fn decide<M: Mind + ?Sized>(contest: &mut Contest, runner: &mut MindRunner<M>) {
    let stamp = contest.pictures()[0].stamp;
    runner.decide(stamp, |vehicle| Some(contest.picture_of(vehicle)));
    for (vehicle, order) in runner.orders() {
        // As over the network: an order with invalid numbers is refused, and the boat holds.
        contest
            .order(vehicle, order, stamp.valid_ns)
            .unwrap_or_default();
    }
}
