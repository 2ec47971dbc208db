//! Starting positions: given in the scenario, or drawn from the game's `spawn` stream.

use primitives::angle::wrap_pi;
use primitives::frame::{Ned, Pose};
use primitives::stream::Stream;
use rules::field::Obstacle;
use scenario::{Problems, RealBoats, Scenario, StartPosition};
use thiserror::Error;

/// Number of draws after which the spawn area counts as full.
const TRIES: u32 = 10_000;

/// A spawn area is full.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "no free start position for {vehicle} after {TRIES} tries: enlarge its spawn area or lower gap_m"
)]
pub struct SpawnError {
    /// The vehicle that does not fit.
    pub vehicle: String,
}

/// A reason why a game cannot start.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoStart {
    /// The boats do not fit into their spawn area.
    #[error(transparent)]
    SpawnError(#[from] SpawnError),
    /// Each value drawn for this seed is allowed, but together they are inconsistent.
    #[error("the randomised values for this seed are inconsistent\n{0}")]
    Draw(#[from] Problems),
    /// The game has real boats but runs without a clock.
    #[error(transparent)]
    RealBoats(#[from] RealBoats),
}

/// The starting pose of every vehicle.
///
/// # Errors
/// [`SpawnError`] if a spawn area is full.
pub fn start_positions(scenario: &Scenario, seed: u64) -> Result<Vec<Pose>, SpawnError> {
    let mut stream = Stream::new(seed, "spawn");
    let mut taken: Vec<(usize, Pose)> = Vec::new();
    for (i, vehicle) in scenario.vehicles.iter().enumerate() {
        // Boats with given positions come first: drawn positions must avoid them, whatever their
        // order in the file.
        if let StartPosition::At(pose) = vehicle.start_position {
            taken.push((i, pose));
        }
    }
    for (i, vehicle) in scenario.vehicles.iter().enumerate() {
        if let StartPosition::Somewhere {
            along_m,
            across_m,
            gap_m,
        } = vehicle.start_position
        {
            let free = |at: Ned| {
                let apart = |other: &(usize, Pose)| other.1.at.distance(at) >= gap_m;
                let clear =
                    |obstacle: &Obstacle| !obstacle.contains(at) && obstacle.distance(at) >= gap_m;
                taken.iter().all(apart) && scenario.field.plan.obstacles.iter().all(clear)
            };
            let mut draw = || {
                let along_m = stream.between(along_m.0, along_m.1);
                let from_port_m = stream.between(across_m.0, across_m.1);
                scenario.field.seen_from(vehicle.team, along_m, from_port_m)
            };
            // Use rejection sampling, not a grid: every free place is equally likely, and a full
            // field is an error.
            let at = (0..TRIES).map(|_| draw()).find(|at| free(*at));
            let at = at.ok_or_else(|| SpawnError {
                vehicle: vehicle.name.clone(),
            })?;
            let psi_rad = wrap_pi(scenario.field.facing_deg(vehicle.team).to_radians());
            taken.push((i, Pose { at, psi_rad }));
        }
    }
    taken.sort_by_key(|(i, _)| *i);
    Ok(taken.into_iter().map(|(_, pose)| pose).collect())
}
